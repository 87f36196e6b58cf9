"""An incremental parser for server-sent events."""

from __future__ import annotations

import codecs
import json

DONE = b"[DONE]"


class EventParser:
    """Extracts the data of events from bytes that arrive in arbitrary chunks.

    As the standard specifies, lines end with LF, CR or CRLF, comments and other fields are skipped, an event's data lines are
    joined, and a byte order mark is ignored. In addition, the blank line after an event and the final line ending may be missing.
    """

    def __init__(self) -> None:
        self._incomplete = b""
        self._data: list[bytes] = []
        self._start_read = False

    def feed(self, piece: bytes) -> list[bytes]:
        """Add a chunk, and return the data of the events that it completes."""
        text = self._incomplete + piece
        if not self._start_read:
            if codecs.BOM_UTF8.startswith(text):
                self._incomplete = text  # all or part of the byte order mark
                return []
            text, self._start_read = text.removeprefix(codecs.BOM_UTF8), True
        # A carriage return at the end may be the first half of CRLF.
        ends_with_cr = text.endswith(b"\r")
        lines = (text[:-1] if ends_with_cr else text).replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
        self._incomplete = lines.pop() + (b"\r" if ends_with_cr else b"")
        return [event for line in lines for event in self._line(line)]

    def end(self) -> list[bytes]:
        """End the stream, and return the data of the remaining events."""
        last_line, self._incomplete = self._incomplete.strip(b"\r").removeprefix(codecs.BOM_UTF8), b""
        return [*self._line(last_line), *self._line(b"")]

    def _line(self, line: bytes) -> list[bytes]:
        if line.startswith(b"data:"):
            complete = self._pop_event() if self._data and _is_complete(b"\n".join(self._data)) else []
            self._data.append(line[5:].strip())
            return complete
        return [] if line else self._pop_event()

    def _pop_event(self) -> list[bytes]:
        data, self._data = b"\n".join(self._data).strip(), []
        return [data] if data else []


def _is_complete(data: bytes) -> bool:
    """Return whether data is a complete JSON document or the end marker."""
    if data == DONE:
        return True
    try:
        json.loads(data)
    except (ValueError, RecursionError):
        return False
    return True
