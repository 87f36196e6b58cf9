"""Parse Motion JPEG: extract pictures from a ``multipart/x-mixed-replace`` body."""

from __future__ import annotations

import re
from typing import Final

from scope_ptz.camera.network.errors import CameraReplyError, PictureError

MAX_PART_BYTES: Final = 16 * 2**20
"""Maximum size of a picture in bytes."""

MAX_HEADER_BYTES: Final = 8192
"""Maximum size of a part's header in bytes."""

_BOUNDARY = re.compile(r'boundary="?([^";,\s]+)"?', re.IGNORECASE)
_LENGTH = re.compile(rb"^content-length:[ \t]*(\d{1,9})[ \t]*\r?$", re.IGNORECASE | re.MULTILINE)
_HEADER_END = re.compile(rb"\r?\n\r?\n")


def parse_boundary(content_type: str) -> bytes:
    """Return the multipart boundary from a content type, with its leading dashes.

    Raises:
        CameraReplyError: The content type is not multipart, or has no boundary.
    """
    match = _BOUNDARY.search(content_type)
    if not content_type.lower().startswith("multipart/") or match is None:
        raise CameraReplyError("The camera's MJPEG stream is not multipart. Use ?stream=rtsp, or check the camera's firmware.")
    # Some devices report the boundary with its leading dashes, and some without.
    return b"--" + match.group(1).encode("latin-1", "replace").lstrip(b"-")


class MjpegParser:
    """An incremental parser that splits a multipart body into pictures.

    Args:
        boundary: The boundary, as returned by ``parse_boundary``.
    """

    def __init__(self, boundary: bytes) -> None:
        self._boundary = boundary
        self._buffer = bytearray()
        self._length: int | None = None
        self._in_part = False
        self._search_start = 0

    def feed(self, chunk: bytes) -> list[bytes]:
        """Add a chunk of any size, and return the pictures that it completes.

        Raises:
            PictureError: A part or its header is too large.
        """
        self._buffer += chunk
        pictures = []
        while (picture := self._next()) is not None:
            if picture:
                pictures.append(picture)
        return pictures

    def _next(self) -> bytes | None:
        """Return the content of the next part, which may be empty; None if more bytes are needed."""
        if not self._in_part and not self._read_header():
            return None
        buffer = self._buffer
        if self._length is not None:
            if len(buffer) < self._length:
                return None
            return self._take(self._length)
        end = buffer.find(self._boundary, self._search_start)
        if end < 0:
            self._search_start = max(0, len(buffer) - len(self._boundary))
            if len(buffer) > MAX_PART_BYTES:
                raise PictureError("A picture in the camera's MJPEG stream is larger than 16 MB. Restart the camera.", "damaged")
            return None
        return self._take(end).rstrip(b"\r\n") if end else self._take(0)

    def _read_header(self) -> bool:
        """Discard everything up to the end of the next header. Return False if that header is not complete."""
        buffer = self._buffer
        start = buffer.find(self._boundary)
        if start < 0:
            del buffer[: max(0, len(buffer) - len(self._boundary))]
            return False
        # The boundary line precedes the header, so an empty line right after it means an empty header.
        match = _HEADER_END.search(buffer, start + len(self._boundary))
        if match is None:
            del buffer[:start]
            if len(buffer) > MAX_HEADER_BYTES:
                raise PictureError("A header in the camera's MJPEG stream is too long. Restart the camera.", "damaged")
            return False
        length = _LENGTH.search(buffer, start, match.start() + 1)
        self._length = int(length.group(1)) if length else None
        if self._length is not None and self._length > MAX_PART_BYTES:
            raise PictureError("A picture in the camera's MJPEG stream is larger than 16 MB. Restart the camera.", "damaged")
        del buffer[: match.end()]
        self._in_part, self._search_start = True, 0
        return True

    def _take(self, length: int) -> bytes:
        part = bytes(self._buffer[:length])
        del self._buffer[:length]
        self._in_part, self._length = False, None
        return part
