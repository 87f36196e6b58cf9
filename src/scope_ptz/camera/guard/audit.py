"""An append-only log of a camera's commands, of who issued them, and of the resulting moves."""

from __future__ import annotations

import json
import os
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from scope_ptz.errors import OutputError


class AuditLog:
    """A file with one JSON object per line. Each line is appended in a single write, so several processes can share the file.

    Args:
        path: The file. Its folder is created if needed.
        camera: The camera's name.
        actor: The name of the program or person that controls the camera.

    Raises:
        OutputError: The file cannot be opened for writing.
    """

    def __init__(self, path: Path, camera: str, actor: str) -> None:
        self.path, self._camera, self._actor = path, camera, actor
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
        except OSError as error:
            raise OutputError(f"The audit log {path} cannot be written to: {error.strerror}. Choose another file.") from error

    def write(self, event: str, **fields: Any) -> None:
        """Append an event.

        Raises:
            OutputError: The file cannot be written to. Callers that need a complete log must not send further commands.
        """
        entry = {"time": datetime.now(UTC).isoformat(timespec="milliseconds"), "camera": self._camera, "actor": self._actor}
        line = json.dumps({**entry, "event": event, **fields}, ensure_ascii=False, default=str) + "\n"
        try:
            os.write(self._file, line.encode())
        except OSError as error:
            raise OutputError(f"The audit log {self.path} cannot be written to: {error.strerror}.") from error

    def close(self) -> None:
        """Close the file. Calling this again has no effect."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
