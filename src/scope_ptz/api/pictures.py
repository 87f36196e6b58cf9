"""Store the pictures of tool calls outside runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.agent.filmstrip import open_picture
from scope_ptz.agent.store import EncodedImages, RunFolder

if TYPE_CHECKING:
    from PIL import Image


class ToolCallImages(EncodedImages):
    """Stores pictures in memory, or in a folder that is created when the first picture is stored.

    In memory, only the pictures taken by ``take_image`` are stored, because the frames that perception receives would use too much
    memory in a long session.
    """

    def __init__(self, runs_dir: Path | None) -> None:
        super().__init__()
        self._runs_dir = runs_dir
        self._folder: RunFolder | None = None
        self._files: dict[str, bytes] = {}

    def write(self, name: str, data: bytes) -> None:
        """Store an encoded picture under a name."""
        if self._runs_dir is None:
            if name.startswith("pictures/"):
                self._files[name] = data
            return
        if self._folder is None:
            self._folder = RunFolder.create(self._runs_dir, "tool calls")
        self._folder.write(name, data)

    def picture(self, name: str) -> Image.Image:
        """Open a stored picture. Raises ``TraceError`` if no picture has this name."""
        if self._folder is not None:
            return open_picture(name, self._folder.path)
        return open_picture(name, Path(), self._files)
