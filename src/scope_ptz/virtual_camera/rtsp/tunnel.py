"""RTSP over HTTP: a client sends base64-encoded requests in a POST, and receives replies and media in the response to a GET.

Both connections send the same cookie. Clients use such tunnels where a firewall permits only HTTP.
"""

from __future__ import annotations

import asyncio
from binascii import Error as BinasciiError
from binascii import a2b_base64
from dataclasses import dataclass, field

from scope_ptz.virtual_camera.rtsp.messages import MAX_LINE_BYTES, RefusedError, TunnelRequest

GET_REPLY = (
    b"HTTP/1.0 200 OK\r\nConnection: close\r\nCache-Control: no-store\r\nPragma: no-cache\r\n"
    b"Content-Type: application/x-rtsp-tunnelled\r\n\r\n"
)

_COOKIE = "x-sessioncookie"
_CHUNK_BYTES = 4096
_GROUP = 4  # number of base64 characters that encode three bytes


@dataclass(slots=True)
class Tunnels:
    """A server's tunnels that are waiting for their POST connection, each with a reader for its decoded requests."""

    _readers: dict[tuple[str, str], asyncio.StreamReader] = field(default_factory=dict)

    def open(self, request: TunnelRequest, peer: str) -> asyncio.StreamReader:
        """Open a tunnel for a client that has sent a GET, and return a reader for its requests.

        Args:
            request: The GET request.
            peer: The client's address.

        Raises:
            RefusedError: The cookie is missing or already in use.
        """
        key = _key(request, peer)
        if key in self._readers:
            raise RefusedError(400)
        self._readers[key] = asyncio.StreamReader(limit=MAX_LINE_BYTES)
        return self._readers[key]

    def close(self, reader: asyncio.StreamReader) -> None:
        """Remove a reader's tunnel after its GET connection has ended. Unknown readers are ignored."""
        self._readers = {key: other for key, other in self._readers.items() if other is not reader}

    async def receive(
        self, request: TunnelRequest, peer: str, source: asyncio.StreamReader, transport: asyncio.BaseTransport
    ) -> None:
        """Decode the body of a POST into the requests of its tunnel, until the client closes the connection.

        Args:
            request: The POST request.
            peer: The client's address.
            source: The body.
            transport: The connection, from which nothing is read while the tunnel has many unanswered requests.

        Raises:
            RefusedError: There is no such tunnel, or it already has a POST connection.
        """
        requests, pending = self._readers.pop(_key(request, peer), None), b""
        if requests is None:
            raise RefusedError(404)
        requests.set_transport(transport)
        try:
            while chunk := await source.read(_CHUNK_BYTES):
                pending += chunk.translate(None, b"\r\n")
                complete_length = len(pending) - len(pending) % _GROUP
                requests.feed_data(_decode(pending[:complete_length]))
                pending = pending[complete_length:]
        except BinasciiError:
            pass  # the tunnel ends, as after any request that cannot be parsed
        finally:
            requests.feed_eof()


def _decode(text: bytes) -> bytes:
    """Decode base64 in which padding may occur anywhere, because each request is encoded separately."""
    return b"".join(a2b_base64(text[start : start + _GROUP]) for start in range(0, len(text), _GROUP))


def _key(request: TunnelRequest, peer: str) -> tuple[str, str]:
    cookie = request.headers.get(_COOKIE, "")
    if not cookie:
        raise RefusedError(400)
    return peer, cookie
