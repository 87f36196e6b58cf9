"""Show pictures to a person, as files and inline in terminals that support inline pictures."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import IO

import cv2
from PIL import Image

from scope_ptz.agent.drawing import TEXT_COLOUR, Canvas
from scope_ptz.camera.base import Frame
from scope_ptz.errors import OutputError
from scope_ptz.settings import InlineProtocol

JPEG_QUALITY = 92
_KITTY_CHUNK_CHARS = 4096
"""Maximum length in characters of a data chunk in kitty's graphics protocol."""
_GRID_PERCENT = range(10, 100, 10)
"""Positions of the grid lines, in percent of the width or height."""


class Viewer:
    """Writes numbered pictures to a folder, and shows them in a terminal that supports inline pictures.

    Args:
        folder: Folder for the pictures.
        terminal: The terminal; None to write only files.
        inline: The terminal's protocol for inline pictures; None if it does not support them.
    """

    def __init__(self, folder: Path, terminal: IO[str] | None, inline: InlineProtocol | None) -> None:
        self._folder, self._terminal, self._inline = folder, terminal, inline
        self._shown = 0

    def show(self, frame: Frame, *, grid: bool = False) -> Path:
        """Show a frame, and return the path of its file.

        Args:
            frame: The frame.
            grid: Whether to draw grid lines at every tenth of the width and height.

        Raises:
            OutputError: The file cannot be written.
        """
        self._shown += 1
        path = self._folder / f"{self._shown:03d}.jpg"
        image = Image.fromarray(frame.image)
        if grid:
            image = _draw_grid(image)
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            image.save(path, quality=JPEG_QUALITY)
        except OSError as error:
            raise OutputError(f"{path} cannot be written: {error.strerror}.") from error
        if self._terminal is not None and self._inline is not None:
            self._terminal.write(inline_sequence(frame, self._inline))
            self._terminal.flush()
        return path


def _draw_grid(image: Image.Image) -> Image.Image:
    canvas = Canvas(image.width, image.height)
    canvas.picture(image, 0, 0, image.width, image.height, radius=0)
    for percent in _GRID_PERCENT:
        x, y = percent / 100 * image.width, percent / 100 * image.height
        canvas.panel(x, 0, 1, image.height, "#FFFFFF60", radius=0)
        canvas.panel(0, y, image.width, 1, "#FFFFFF60", radius=0)
        canvas.text(x + 3, 15, str(percent), 14, TEXT_COLOUR, bold=True)
        canvas.text(3, y - 3, str(percent), 14, TEXT_COLOUR, bold=True)
    return canvas.finish()


def inline_sequence(frame: Frame, inline: InlineProtocol) -> str:
    """Return the escape sequence that shows a frame in a terminal at half its size."""
    small = cv2.resize(cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    suffix = ".png" if inline == "kitty" else ".jpg"
    _, encoded = cv2.imencode(suffix, small)
    data = base64.b64encode(encoded.tobytes()).decode()
    if inline == "iterm":
        return f"\x1b]1337;File=inline=1;width=100%;preserveAspectRatio=1:{data}\x07\n"
    chunks = [data[start : start + _KITTY_CHUNK_CHARS] for start in range(0, len(data), _KITTY_CHUNK_CHARS)]
    commands = (
        f"\x1b_G{'f=100,a=T,' if n == 0 else ''}m={int(n < len(chunks) - 1)};{chunk}\x1b\\" for n, chunk in enumerate(chunks)
    )
    return "".join(commands) + "\n"
