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
    """Return the name of the user who runs this process.

    If the account has no name, as in some containers, return the user id.
    """
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return f"user {os.getuid()}" if hasattr(os, "getuid") else "a user without a name"


@dataclass(frozen=True, slots=True)
class Holder:
    """The holder of control over a camera.

    Attributes:
        name: The holder's name, such as "console: anna".
        process: The user, process id and machine.
        since: The time at which control was taken, in UTC as ISO 8601.
    """

    name: str
    process: str
    since: str

    def __str__(self) -> str:
        return f"{self.name} ({self.process}, since {self.since})"


class ControlHeldError(CameraError):
    """Someone else controls the camera.

    Attributes:
        holder: The holder of control; None if unknown.
    """

    def __init__(self, camera: str, holder: Holder | None) -> None:
        self.holder = holder
        controller = str(holder) if holder else "an unknown controller"
        super().__init__(f"{camera} is controlled by {controller}. Wait until control is released, or ask them to release it.")


class ControlLock:
    """An exclusive lock on the right to move a camera.

    Args:
        camera: The camera's name, for messages.
        key: Identifies the device, for example by its address and channel. Locks with the same key and folder exclude each other
            across processes. If None, the lock excludes only other users of this object.
        folder: The folder for lock files. Required if ``key`` is given.
    """

    def __init__(self, camera: str, key: str | None = None, folder: Path | None = None) -> None:
        if (key is None) != (folder is None):
            raise ValueError("a control lock requires both a key and a folder, or neither")
        self._camera = camera
        self._holder: Holder | None = None
        self._path = None if folder is None or key is None else folder / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.lock"
        self._file: FileLock | None = None

    @property
    def holder(self) -> Holder | None:
        """The holder of control through this object; None if there is none."""
        return self._holder

    def acquire(self, name: str) -> None:
        """Take control.

        Raises:
            ControlHeldError: Someone else has control. The message names the holder if known.
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
        """Release control. Calling this again has no effect."""
        self._holder = None
        if self._file is not None:
            self._file.release()
            self._file = None

    def _lock_file(self, path: Path, holder: Holder) -> None:
        from filelock import FileLock, Timeout

        lock = FileLock(path, timeout=0, thread_local=False)
        holder_path = path.with_suffix(".json")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            lock.acquire()
            holder_path.write_text(json.dumps(asdict(holder)), encoding="utf-8")
        except Timeout:
            raise ControlHeldError(self._camera, _read_holder(holder_path)) from None
        except OSError as error:
            lock.release()
            raise OutputError(f"The control lock {path} cannot be written: {error.strerror or error}.") from error
        self._file = lock


def _read_holder(holder_path: Path) -> Holder | None:
    """Read the file that names the holder of a lock. Return None if it is missing or damaged."""
    try:
        content = json.loads(holder_path.read_text(encoding="utf-8"))
        return Holder(str(content["name"]), str(content["process"]), str(content["since"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None
