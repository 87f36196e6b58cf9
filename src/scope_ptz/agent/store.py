"""Image stores for runs: a folder, memory, or a placeholder that stores nothing.

This module creates all file names. Text from users becomes part of a path only in the form that ``slug`` returns.
"""

from __future__ import annotations

import re
import secrets
import shutil
from abc import ABC, abstractmethod
from datetime import UTC, datetime
from pathlib import Path

import cv2
from anyio import to_thread

from scope_ptz.camera.base import Frame
from scope_ptz.errors import OutputError
from scope_ptz.geometry import Perspective

JPEG_QUALITY = 92
_MAX_SLUG_CHARS = 40  # longer run folder names are truncated at a word boundary


def slug(text: str) -> str:
    """Return the first words of a text in lower case, joined by hyphens; "run" if there are none."""
    words = re.findall(r"[a-z0-9]+", text.lower())
    result = ""
    for word in words:
        if len(result) + len(word) + 1 > _MAX_SLUG_CHARS:
            break
        result = f"{result}-{word}" if result else word
    return result or "run"


class PictureNames:
    """Generates picture names, numbered in the order in which pictures are stored."""

    def __init__(self) -> None:
        self._frames = self._pictures = 0

    def frame(self, frame: Frame) -> str:
        """Return the name for the next frame in the run."""
        self._frames += 1
        return f"frames/{self._frames:03d}-{'view' if isinstance(frame.projection, Perspective) else 'full'}.jpg"

    def picture(self) -> str:
        """Return the name for the next picture requested by the user."""
        self._pictures += 1
        return f"pictures/{self._pictures:03d}.png"


class NoImages:
    """An image store that stores nothing, for replays and evaluations. It returns the same names as a run folder."""

    def __init__(self) -> None:
        self._names = PictureNames()

    async def save_frame(self, frame: Frame) -> str:
        return self._names.frame(frame)

    async def save_picture(self, frame: Frame) -> str:  # noqa: ARG002 - the contract's signature
        return self._names.picture()


class EncodedImages(ABC):
    """An image store that encodes frames as JPEG, and pictures that the user requested as PNG, both in a worker thread."""

    def __init__(self) -> None:
        self._names = PictureNames()

    async def save_frame(self, frame: Frame) -> str:
        """Store a frame of the run, such as one that perception receives, and return its name. Raises ``OutputError``."""
        return await to_thread.run_sync(self._store, self._names.frame(frame), frame, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])

    async def save_picture(self, frame: Frame) -> str:
        """Store a picture that the user requested and return its name. Raises ``OutputError``."""
        return await to_thread.run_sync(self._store, self._names.picture(), frame, [])

    def _store(self, name: str, frame: Frame, options: list[int]) -> str:
        suffix = Path(name).suffix
        encoded, data = cv2.imencode(suffix, cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), options)
        if not encoded:
            raise OutputError(f"A frame of {frame.width}x{frame.height} pixels cannot be encoded as {suffix}.")
        self.write(name, data.tobytes())
        return name

    @abstractmethod
    def write(self, name: str, data: bytes) -> None:
        """Store an encoded picture under its name."""


class MemoryImages(EncodedImages):
    """An image store in memory. ``files`` maps picture names to encoded bytes."""

    def __init__(self) -> None:
        super().__init__()
        self.files: dict[str, bytes] = {}

    def write(self, name: str, data: bytes) -> None:
        """Store an encoded picture under its name."""
        self.files[name] = data


class RunFolder(EncodedImages):
    """A new folder that holds the trace, frames, pictures and filmstrip of one run."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path

    @classmethod
    def create(cls, root: Path, instruction: str) -> RunFolder:
        """Create the folder ``root/<UTC time>-<first words>-<random>``. Two runs never share a folder.

        Raises:
            OutputError: The folder cannot be created.
        """
        timestamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
        try:
            root.mkdir(parents=True, exist_ok=True)
            while True:
                path = root / f"{timestamp}-{slug(instruction)}-{secrets.token_hex(3)}"
                try:
                    path.mkdir()
                except FileExistsError:
                    continue
                return cls(path)
        except OSError as error:
            raise OutputError(
                f"The runs folder {root} cannot be written to: {error.strerror}. Choose another with --runs-dir."
            ) from error

    @property
    def trace(self) -> Path:
        """Path of the trace."""
        return self.path / "trace.jsonl"

    @property
    def filmstrip(self) -> Path:
        """Path of the filmstrip."""
        return self.path / "filmstrip.png"

    def discard_if_not_started(self) -> None:
        """Remove the folder if the run failed or was cancelled before the first line of its trace was written."""
        if not self.trace.is_file() or self.trace.stat().st_size == 0:
            shutil.rmtree(self.path, ignore_errors=True)

    def write(self, name: str, data: bytes) -> None:
        """Write an encoded picture to a new file. Raises ``OutputError``."""
        target = self.path / name
        try:
            target.parent.mkdir(exist_ok=True)
            with target.open("xb") as file:
                file.write(data)
        except OSError as error:
            raise OutputError(f"{target} cannot be written: {error.strerror}.") from error
