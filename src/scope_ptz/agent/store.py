"""Run folders: where a run's trace and pictures are kept. Names are made here; no text from outside becomes a path as it is."""

from __future__ import annotations

import re
import secrets
from datetime import UTC, datetime
from pathlib import Path

import cv2

from scope_ptz.camera.base import Frame
from scope_ptz.errors import OutputError
from scope_ptz.geometry import Perspective

JPEG_QUALITY = 92
_SLUG_CHARS = 40


def slug(text: str) -> str:
    """The first words of a text in lower-case letters and digits joined by hyphens; "run" when none are left."""
    words = re.findall(r"[a-z0-9]+", text.lower())
    kept = ""
    for word in words:
        if len(kept) + len(word) + 1 > _SLUG_CHARS:
            break
        kept = f"{kept}-{word}" if kept else word
    return kept or "run"


class Numbering:
    """Names for pictures in the order in which they are kept."""

    def __init__(self) -> None:
        self._looks = self._pictures = 0

    def look(self, frame: Frame) -> str:
        self._looks += 1
        return f"frames/{self._looks:03d}-{'view' if isinstance(frame.projection, Perspective) else 'full'}.jpg"

    def picture(self) -> str:
        self._pictures += 1
        return f"pictures/{self._pictures:03d}.png"


class NoImages:
    """Keeps nothing but gives the names that a run folder would give: for replays and evaluation."""

    def __init__(self) -> None:
        self._names = Numbering()

    def save_look(self, frame: Frame) -> str:
        return self._names.look(frame)

    def save_picture(self, frame: Frame) -> str:  # noqa: ARG002 - the contract's signature
        return self._names.picture()


class RunFolder:
    """A fresh folder of one run. It implements the tools' image store."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._names = Numbering()

    @classmethod
    def create(cls, root: Path, instruction: str) -> RunFolder:
        """Make ``root/<UTC time>-<first words>-<random>``; two runs never share one. Raises ``OutputError``."""
        stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
        try:
            root.mkdir(parents=True, exist_ok=True)
            while True:
                path = root / f"{stamp}-{slug(instruction)}-{secrets.token_hex(3)}"
                try:
                    path.mkdir()
                except FileExistsError:
                    continue
                return cls(path)
        except OSError as error:
            raise OutputError(
                f"The runs folder {root} cannot be written: {error.strerror}. Choose another with --runs-dir."
            ) from error

    @property
    def trace(self) -> Path:
        return self.path / "trace.jsonl"

    @property
    def filmstrip(self) -> Path:
        return self.path / "filmstrip.png"

    def save_look(self, frame: Frame) -> str:
        return self._write(self._names.look(frame), frame, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])

    def save_picture(self, frame: Frame) -> str:
        return self._write(self._names.picture(), frame, [])

    def discard_if_empty(self) -> None:
        """Take the folder away again when the run failed before anything was kept."""
        if self.path.is_dir() and not any(self.path.iterdir()):
            self.path.rmdir()

    def _write(self, name: str, frame: Frame, options: list[int]) -> str:
        target = self.path / name
        coded, data = cv2.imencode(target.suffix, cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), options)
        if not coded:
            raise OutputError(f"A frame of {frame.width}x{frame.height} pixels cannot be coded as {target.suffix}.")
        try:
            target.parent.mkdir(exist_ok=True)
            with target.open("xb") as file:
                file.write(data.tobytes())
        except OSError as error:
            raise OutputError(f"{target} cannot be written: {error.strerror}.") from error
        return name
