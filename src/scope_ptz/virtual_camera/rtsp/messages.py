"""Read and write RTSP 1.0 messages (RFC 2326) and the RTP packets interleaved with them."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from scope_ptz.errors import CameraError

MAX_LINE_BYTES = 8 * 1024
MAX_HEAD_LINES = 64
MAX_BODY_BYTES = 64 * 1024

_INTERLEAVED = b"$"
_METHOD = re.compile(r"[A-Z_]{1,32}")
_PRINTABLE = re.compile(r"[\x20-\x7e\t\x80-\xff]*")
_TUNNEL = re.compile(rb"(GET|POST) \S+ HTTP/1\.[01]")
_CSEQ = re.compile(r"\d{1,10}")

REASONS = {
    200: "OK",
    400: "Bad Request",
    401: "Unauthorized",
    404: "Not Found",
    406: "Not Acceptable",
    413: "Request Entity Too Large",
    414: "Request-URI Too Large",
    451: "Parameter Not Understood",
    453: "Not Enough Bandwidth",
    454: "Session Not Found",
    455: "Method Not Valid in This State",
    461: "Unsupported Transport",
    500: "Internal Server Error",
    501: "Not Implemented",
    503: "Service Unavailable",
    505: "RTSP Version Not Supported",
    551: "Option not supported",
}


class RefusedError(CameraError):
    """Raised to reject a request with a status code.

    Args:
        status: The RTSP status code.
        headers: Additional headers for the reply.
    """

    def __init__(self, status: int, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(f"The RTSP request was rejected: {status} {REASONS[status]}.")
        self.status, self.headers = status, dict(headers or {})


class MalformedError(RefusedError):
    """The received data is not an RTSP request, so the connection can no longer be used."""


@dataclass(frozen=True, slots=True)
class Request:
    """An RTSP request. Header names are in lower case."""

    method: str
    uri: str
    headers: Mapping[str, str]
    body: bytes = b""

    @property
    def cseq(self) -> str:
        """The sequence number of the request, which the reply repeats."""
        return self.headers["cseq"]


@dataclass(frozen=True, slots=True)
class TunnelRequest:
    """The head of an HTTP request that opens one direction of an RTSP-over-HTTP tunnel. Header names are in lower case."""

    method: str
    headers: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class InterleavedPacket:
    """An RTP or RTCP packet that a client sent on a channel of an RTSP connection."""

    channel: int
    packet: bytes


@dataclass(frozen=True, slots=True)
class Reply:
    """An RTSP reply. Header names may be repeated."""

    status: int = 200
    headers: tuple[tuple[str, str], ...] = ()
    body: bytes = field(default=b"", repr=False)

    def encode(self, cseq: str | None) -> bytes:
        """Encode the reply.

        Args:
            cseq: The sequence number of the request; None if the request could not be parsed.
        """
        head = [f"RTSP/1.0 {self.status} {REASONS[self.status]}"]
        if cseq is not None:
            head.append(f"CSeq: {cseq}")
        head += [f"{name}: {value}" for name, value in self.headers]
        if self.body:
            head.append(f"Content-Length: {len(self.body)}")
        return ("\r\n".join(head) + "\r\n\r\n").encode("latin-1", "replace") + self.body


async def read_message(reader: asyncio.StreamReader, first: bytes) -> Request | TunnelRequest | InterleavedPacket | None:
    """Read the rest of a message.

    Args:
        reader: The connection. Its line limit is ``MAX_LINE_BYTES``.
        first: The first byte of the message.

    Returns:
        The message; None for an empty line between messages.

    Raises:
        MalformedError: The message is not an RTSP request, or a part of it is too large.
        asyncio.IncompleteReadError: The client disconnected in the middle of the message.
    """
    if first == _INTERLEAVED:
        head = await reader.readexactly(3)
        return InterleavedPacket(head[0], await reader.readexactly(int.from_bytes(head[1:], "big")))
    if first == b"\n":
        return None
    line = (first + await _line(reader, 414)).strip(b"\r\n")
    if not line:
        return None
    if _TUNNEL.fullmatch(line):
        return TunnelRequest(line[:4].decode().strip(), await _headers(reader))
    method, uri = _request_line(line)
    headers = await _headers(reader)
    if not _CSEQ.fullmatch(headers.get("cseq", "")):
        raise MalformedError(400)
    length = headers.get("content-length", "0")
    if not length.isdecimal():
        raise MalformedError(400)
    if len(length) > 9 or int(length) > MAX_BODY_BYTES:
        raise MalformedError(413)
    return Request(method, uri, headers, await reader.readexactly(int(length)))


async def _line(reader: asyncio.StreamReader, status_if_too_long: int) -> bytes:
    try:
        return await reader.readuntil(b"\n")
    except asyncio.LimitOverrunError as error:
        raise MalformedError(status_if_too_long) from error


def _request_line(line: bytes) -> tuple[str, str]:
    parts = line.decode("latin-1").split(" ")
    if len(parts) != 3 or not _METHOD.fullmatch(parts[0]) or not all(part.isascii() and part.isprintable() for part in parts):
        raise MalformedError(400)
    if parts[2] != "RTSP/1.0":
        raise MalformedError(505 if parts[2].startswith(("RTSP/", "HTTP/")) else 400)
    return parts[0], parts[1]


async def _headers(reader: asyncio.StreamReader) -> dict[str, str]:
    headers: dict[str, str] = {}
    for _ in range(MAX_HEAD_LINES):
        line = (await _line(reader, 413)).strip(b"\r\n").decode("latin-1")
        if not line:
            return headers
        name, colon, value = line.partition(":")
        if not colon or not _PRINTABLE.fullmatch(line):
            raise MalformedError(400)
        headers[name.strip().lower()] = value.strip()
    raise MalformedError(413)
