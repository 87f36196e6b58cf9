"""Split the data from an RTSP connection into messages and interleaved media packets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from scope_ptz.camera.network.errors import CameraReplyError

MAX_HEAD_BYTES = 64 * 1024
MAX_BODY_BYTES = 1024 * 1024

_PACKET_START = ord("$")
_PACKET_HEAD_BYTES = 4


@dataclass(frozen=True, slots=True)
class RtspMessage:
    """An RTSP request or reply.

    Attributes:
        start: The first line: ``METHOD URI RTSP/1.0`` or ``RTSP/1.0 STATUS REASON``.
        headers: The headers in order. Names may be repeated.
        body: The body.
    """

    start: str
    headers: tuple[tuple[str, str], ...] = ()
    body: bytes = field(default=b"", repr=False)

    @property
    def status(self) -> int | None:
        """The status code of a reply; None for a request."""
        words = self.start.split(" ", 2)
        return int(words[1]) if words[0].startswith("RTSP/") and len(words) > 1 and words[1].isdecimal() else None

    def values(self, name: str) -> list[str]:
        """Return the values of all headers with a name, given in lower case."""
        return [value for key, value in self.headers if key.lower() == name]

    def with_header(self, name: str, value: str | None) -> RtspMessage:
        """Return a copy with a header set, or removed if the value is None."""
        others = tuple(pair for pair in self.headers if pair[0].lower() != name.lower())
        return RtspMessage(self.start, others if value is None else (*others, (name, value)), self.body)

    def encode(self) -> bytes:
        """Return the bytes of the message."""
        lines = [self.start, *(f"{name}: {value}" for name, value in self.headers)]
        return "\r\n".join([*lines, "", ""]).encode("latin-1", "replace") + self.body


class MessageSplitter:
    """Splits received data into messages and media packets.

    Args:
        source: The device at the other end, for error messages.
    """

    def __init__(self, source: str) -> None:
        self._source, self._data = source, bytearray()

    def feed(self, data: bytes) -> Iterator[RtspMessage | bytes]:
        """Add data, and yield the messages and media packets (as bytes) that it completes.

        Raises:
            CameraReplyError: The data is not RTSP, or a message is too large.
        """
        self._data += data
        while self._data:
            if self._data[0] == _PACKET_START:
                item: RtspMessage | bytes | None = self._packet()
            else:
                item = self._message()
            if item is None:
                return
            yield item

    def _packet(self) -> bytes | None:
        if len(self._data) < _PACKET_HEAD_BYTES:
            return None
        size = _PACKET_HEAD_BYTES + int.from_bytes(self._data[2:4], "big")
        return self._take(size) if len(self._data) >= size else None

    def _message(self) -> RtspMessage | None:
        end = self._data.find(b"\r\n\r\n")
        if max(end, 0 if end >= 0 else len(self._data)) > MAX_HEAD_BYTES:
            raise self._invalid_error()
        if end < 0:
            return None
        start, *lines = self._data[:end].decode("latin-1").lstrip("\r\n").split("\r\n")
        pairs = [line.partition(":") for line in lines]
        headers = tuple((name.strip(), value.strip()) for name, _, value in pairs)
        message = RtspMessage(start, headers)
        length = (message.values("content-length") or ["0"])[-1]
        if "RTSP/" not in start or not all(colon for _, colon, _ in pairs) or not length.isdecimal() or len(length) > 9:
            raise self._invalid_error()
        if (size := int(length)) > MAX_BODY_BYTES:
            raise self._invalid_error()
        if len(self._data) < end + 4 + size:
            return None
        self._take(end + 4)
        return RtspMessage(start, headers, self._take(size))

    def _take(self, size: int) -> bytes:
        content = bytes(self._data[:size])
        del self._data[:size]
        return content

    def _invalid_error(self) -> CameraReplyError:
        return CameraReplyError(f"The data from {self._source} is not valid RTSP. Check the camera's RTSP port.")
