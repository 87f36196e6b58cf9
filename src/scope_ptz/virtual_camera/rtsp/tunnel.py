"""RTSP over HTTP: a client sends requests, as base64, in a POST, and receives replies and media as the answer to a GET.

Both connections state the same cookie. Clients use this where a firewall lets only HTTP through.
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
_GROUP = 4  # characters of base64 that represent three bytes


@dataclass(slots=True)
class Tunnels:
    """The tunnels of a server that wait for their POST connection, with the readers of its decoded requests."""

    _readers: dict[tuple[str, str], asyncio.StreamReader] = field(default_factory=dict)

    def open(self, request: TunnelRequest, peer: str) -> asyncio.StreamReader:
        """Return the requests of a client that has sent a GET.

        Args:
            request: The GET.
            peer: The address of the client.

        Raises:
            RefusedError: The cookie is missing or in use.
        """
        key = _key(request, peer)
        if key in self._readers:
            raise RefusedError(400)
        self._readers[key] = asyncio.StreamReader(limit=MAX_LINE_BYTES)
        return self._readers[key]

    def close(self, reader: asyncio.StreamReader) -> None:
        """Forget a tunnel whose GET connection has ended. Other readers are ignored."""
        self._readers = {key: each for key, each in self._readers.items() if each is not reader}

    async def receive(
        self, request: TunnelRequest, peer: str, source: asyncio.StreamReader, transport: asyncio.BaseTransport
    ) -> None:
        """Decode the body of a POST into the requests of its tunnel, which ends when the client closes the connection.

        Args:
            request: The POST.
            peer: The address of the client.
            source: The body.
            transport: The connection, which is not read while the tunnel has many unanswered requests.

        Raises:
            RefusedError: There is no such tunnel, or it has a POST connection already.
        """
        requests, waiting = self._readers.pop(_key(request, peer), None), b""
        if requests is None:
            raise RefusedError(404)
        requests.set_transport(transport)
        try:
            while chunk := await source.read(_CHUNK_BYTES):
                waiting += chunk.translate(None, b"\r\n")
                whole = len(waiting) - len(waiting) % _GROUP
                requests.feed_data(_decoded(waiting[:whole]))
                waiting = waiting[whole:]
        except BinasciiError:
            pass  # the tunnel ends, as after any request that cannot be parsed
        finally:
            requests.feed_eof()


def _decoded(text: bytes) -> bytes:
    """Return decoded base64. Each request is encoded on its own, so padding may be anywhere."""
    return b"".join(a2b_base64(text[start : start + _GROUP]) for start in range(0, len(text), _GROUP))


def _key(request: TunnelRequest, peer: str) -> tuple[str, str]:
    cookie = request.headers.get(_COOKIE, "")
    if not cookie:
        raise RefusedError(400)
    return peer, cookie
