"""A lock that allows one controller at a time, within a process and, for network cameras, across processes."""

from __future__ import annotations

import getpass
import hashlib
import json
import os
import socket
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import CameraError, OutputError

if TYPE_CHECKING:
    from filelock import FileLock


def user_name() -> str:
    """Return the name of the user that runs this process.

    If the account has no name, as in some containers, return the user number.
    """
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return f"user {os.getuid()}" if hasattr(os, "getuid") else "a user without a name"


@dataclass(frozen=True, slots=True)
class Holder:
    """The controller of a camera.

    Attributes:
        name: Name of the controller, such as "console: anna".
        process: The user, process number and machine.
        since: When control was taken, as an ISO 8601 time in UTC.
    """

    name: str
    process: str
    since: str

    def __str__(self) -> str:
        return f"{self.name} ({self.process}, since {self.since})"


class ControlHeldError(CameraError):
    """Someone else controls the camera.

    Attributes:
        holder: The controller; None if its name is unknown.
    """

    def __init__(self, camera: str, holder: Holder | None) -> None:
        self.holder = holder
        who = str(holder) if holder else "someone whose name is unknown"
        super().__init__(f"{camera} is controlled by {who}. Wait until control is released, or ask them to release it.")


class ControlLock:
    """The right to move one camera.

    Args:
        camera: The camera's name, for messages.
        key: Identifies the device, for example by its address and channel. Locks with the same key and folder exclude each
            other across processes; None excludes only other users of this object.
        folder: The folder of the lock files. It is required with a key.
    """

    def __init__(self, camera: str, key: str | None = None, folder: Path | None = None) -> None:
        if (key is None) != (folder is None):
            raise ValueError("a control lock needs both a key and a folder, or neither")
        self._camera = camera
        self._holder: Holder | None = None
        self._path = None if folder is None or key is None else folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.lock"
        self._file: FileLock | None = None

    @property
    def holder(self) -> Holder | None:
        """The controller that holds the camera through this object."""
        return self._holder

    def acquire(self, name: str) -> None:
        """Take control.

        Raises:
            ControlHeldError: Someone else has control. The message names them.
            OutputError: The lock file cannot be written.
        """
        if self._holder is not None:
            raise ControlHeldError(self._camera, self._holder)
        process = f"{user_name()}, process {os.getpid()} on {socket.gethostname()}"
        holder = Holder(name[:80], process, datetime.now(UTC).isoformat(timespec="seconds"))
        if self._path is not None:
            self._lock_file(self._path, holder)
        self._holder = holder

    def release(self) -> None:
        """Release control. Calling it again has no effect."""
        self._holder = None
        if self._file is not None:
            self._file.release()
            self._file = None

    def _lock_file(self, path: Path, holder: Holder) -> None:
        from filelock import FileLock, Timeout

        lock = FileLock(path, timeout=0, thread_local=False)
        note = path.with_suffix(".json")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            lock.acquire()
            note.write_text(json.dumps(asdict(holder)), encoding="utf-8")
        except Timeout:
            raise ControlHeldError(self._camera, _read_holder(note)) from None
        except OSError as error:
            lock.release()
            raise OutputError(f"The control lock {path} cannot be written: {error.strerror or error}.") from error
        self._file = lock


def _read_holder(note: Path) -> Holder | None:
    """Return the controller that the note beside a lock file names; None if the note is missing or damaged."""
    try:
        found = json.loads(note.read_text(encoding="utf-8"))
        return Holder(str(found["name"]), str(found["process"]), str(found["since"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None
