"""An HTTP client with server-sent events that uses only the standard library."""

from __future__ import annotations

import http.client
import json
import socket
import ssl
from collections.abc import Iterator
from contextlib import suppress
from typing import Any, NamedTuple
from urllib.parse import quote

from .address import Address
from .errors import AddOnError, ServerRefusedError

TIMEOUT_S = 60.0
"""Seconds after which a request without a reply fails."""

STREAM_TIMEOUT_S = 40.0
"""Seconds without data after which a stream is considered lost. Servers send a heartbeat at least every 15 s."""

MAX_REPLY_BYTES = 64 * 1024 * 1024


class ServerEvent(NamedTuple):
    """A server-sent event."""

    name: str
    data: Any


class ServerClient:
    """A client of a server's API. Each thread needs its own client, because a client keeps one connection open.

    Args:
        address: The server.
        client: The name of this client. The server uses it to distinguish Blender instances with the same token.
    """

    def __init__(self, address: Address, client: str) -> None:
        self._address, self._client = address, client
        self._connection: http.client.HTTPConnection | None = None

    def close(self) -> None:
        """Close the connection. A thread that waits for a reply gets an ``AddOnError``."""
        connection, self._connection = self._connection, None
        if connection is not None:
            opened = connection.sock
            if opened is not None:
                with suppress(OSError):  # close() alone does not wake a thread that is reading
                    opened.shutdown(socket.SHUT_RDWR)
            connection.close()

    def request(self, method: str, path: str, body: object = None) -> Any:
        """Send a request with a JSON body, and return the JSON of the reply; None if the reply is empty.

        Raises:
            ServerRefusedError: The server refused the request.
            AddOnError: The server did not respond, or its reply is not JSON.
        """
        content = None if body is None else json.dumps(body).encode()
        return _parse_json(self.request_bytes(method, path, content, "application/json"))

    def request_bytes(
        self, method: str, path: str, body: bytes | None = None, media_type: str = "application/octet-stream"
    ) -> bytes:
        """Send a request, and return the body of the reply. Raises the same errors as ``request``."""
        is_new_connection = self._connection is None
        try:
            return self._send(method, path, body, media_type)
        except (http.client.RemoteDisconnected, BrokenPipeError, ConnectionResetError) as error:
            self.close()
            if is_new_connection:
                raise self._unreachable(error) from error
        except (OSError, http.client.HTTPException) as error:
            self.close()
            raise self._unreachable(error) from error
        try:  # the server had closed the idle connection, so the request did not reach it
            return self._send(method, path, body, media_type)
        except (OSError, http.client.HTTPException) as error:
            self.close()
            raise self._unreachable(error) from error

    def events(self, path: str) -> Iterator[ServerEvent | None]:
        """Yield server-sent events, and None for each comment, until the server ends the stream.

        Raises:
            ServerRefusedError: The server refused the request.
            AddOnError: The connection was lost.
        """
        try:
            connection = self._open()
            connection.timeout = STREAM_TIMEOUT_S
            connection.request("GET", self._path(path), headers={**self._headers(), "Accept": "text/event-stream"})
            if connection.sock is not None:
                connection.sock.settimeout(STREAM_TIMEOUT_S)
            reply = connection.getresponse()
            if reply.status != 200:
                raise _refusal(reply.status, reply.read(MAX_REPLY_BYTES))
            yield from _events(reply)
        except (OSError, http.client.HTTPException, ValueError) as error:
            raise self._unreachable(error) from error
        except AttributeError as error:  # another thread called `close`, which leaves http.client without a socket
            raise self._unreachable(error) from error
        finally:
            self.close()

    def _send(self, method: str, path: str, body: bytes | None, media_type: str) -> bytes:
        connection = self._connection or self._open()
        headers = {**self._headers(), **({"Content-Type": media_type} if body is not None else {})}
        connection.request(method, self._path(path), body=body, headers=headers)
        reply = connection.getresponse()
        data = reply.read(MAX_REPLY_BYTES)
        if reply.length:  # a read with a size limit does not report a reply that was cut off
            raise http.client.IncompleteRead(data, reply.length)
        if not 200 <= reply.status < 300:
            raise _refusal(reply.status, data)
        return data

    def _open(self) -> http.client.HTTPConnection:
        self.close()
        host, port = self._address.host, self._address.port
        if self._address.scheme == "https":
            self._connection = http.client.HTTPSConnection(host, port, timeout=TIMEOUT_S, context=ssl.create_default_context())
        else:
            self._connection = http.client.HTTPConnection(host, port, timeout=TIMEOUT_S)
        return self._connection

    def _headers(self) -> dict[str, str]:
        token = self._address.token
        return {"Scope-Client": self._client, **({"Authorization": f"Bearer {token}"} if token else {})}

    def _path(self, path: str) -> str:
        return f"/api/v1{path}"

    def _unreachable(self, error: Exception) -> AddOnError:
        if isinstance(error, ssl.SSLError):
            return AddOnError(f"The server at {self._address.url} does not have a certificate that this machine trusts.")
        if isinstance(error, ConnectionRefusedError):
            return AddOnError(f"No server is running at {self._address.url}. Start one, or check the address.")
        if isinstance(error, TimeoutError):
            return AddOnError(f"The server at {self._address.url} does not respond.")
        return AddOnError(f"The connection to the server at {self._address.url} was lost.")


def quote_part(name: str) -> str:
    """Return a name, percent-encoded as one segment of a path."""
    return quote(name, safe="")


def _events(reply: http.client.HTTPResponse) -> Iterator[ServerEvent | None]:
    name, data = "message", list[str]()
    while line := reply.readline(MAX_REPLY_BYTES):
        text = line.decode("utf-8", "replace").rstrip("\r\n")
        field, _, value = text.partition(":")
        if not text:
            if data:
                yield ServerEvent(name, _parse_json("\n".join(data).encode()))
            name, data = "message", list[str]()
        elif not field:
            yield None
        elif field == "event":
            name = value.strip()
        elif field == "data":
            data.append(value[1:] if value.startswith(" ") else value)


def _parse_json(content: bytes) -> Any:
    if not content:
        return None
    try:
        return json.loads(content)
    except ValueError:
        raise AddOnError("The server's reply is not JSON. Check that the address belongs to a SCOPE server.") from None


def _refusal(status: int, content: bytes) -> ServerRefusedError:
    try:
        message = str(json.loads(content)["error"]["message"])
    except (ValueError, KeyError, TypeError):
        message = f"The server replied with status {status}. Check that the address belongs to a SCOPE server."
    return ServerRefusedError(status, message[:500])
