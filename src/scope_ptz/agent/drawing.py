"""Drawing primitives for filmstrips. Everything is drawn at twice its size and scaled down, to smooth edges and text."""

from __future__ import annotations

import unicodedata
from bisect import bisect_left
from functools import lru_cache

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

SCALE = 2  # drawing pixels per picture pixel

BACKGROUND = "#0E131A"
PANEL_COLOUR = "#18202B"
EDGE_COLOUR = "#2A3645"
TEXT_COLOUR = "#F2F5F9"
SECONDARY_TEXT_COLOUR = "#93A1B3"
CYAN = "#4CC3F7"
GREEN = "#57D68D"
AMBER = "#FFC94A"
RED = "#FF7B6E"

_REPLACEMENTS = str.maketrans({"×": "x", "–": "-", "—": "-", "−": "-", "→": ">", "‑": "-"})
_BOLD_STROKE = 0.28  # stroke width in picture pixels that makes the built-in font look bold at size 16


def to_printable(text: str) -> str:
    """Return the text on one line, limited to characters of the built-in font.

    Accents are dropped, and other unsupported characters become "?".
    """
    return "".join(_to_printable_character(c) for c in " ".join(text.translate(_REPLACEMENTS).split()))


def _to_printable_character(character: str) -> str:
    if (character.isascii() and character.isprintable()) or character in "°·…“”‘’›±":
        return character
    base = unicodedata.normalize("NFKD", character)[0]
    return base if base.isascii() and base.isprintable() else "?"


@lru_cache(maxsize=32)
def _font(size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return Pillow's built-in font, which is the same on every machine. ``size`` is in picture pixels."""
    return ImageFont.load_default(size * SCALE)


def width_of(text: str, size: float) -> float:
    """Return the width of a line of text in picture pixels."""
    return _font(size).getlength(text) / SCALE


def shorten(text: str, size: float, width: float) -> str:
    """Shorten text to ``width`` picture pixels. Shortened text ends with an ellipsis."""
    if width_of(text, size) <= width:
        return text
    kept = bisect_left(range(len(text)), True, key=lambda end: width_of(f"{text[: end + 1]}…", size) > width)
    return text[:kept].rstrip(" ,.;:") + "…"


def wrap(text: str, size: float, width: float, max_lines: int) -> list[str]:
    """Wrap text into at most ``max_lines`` lines of ``width`` picture pixels. If it is longer, the last line is shortened."""
    lines, words = [""], to_printable(text).split()
    for word in words:
        longer = f"{lines[-1]} {word}".strip()
        if width_of(longer, size) <= width or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)
    if len(lines) > max_lines:
        lines = [*lines[: max_lines - 1], " ".join(lines[max_lines - 1 :])]
    return [shorten(line, size, width) for line in lines]


def _resize(image: Image.Image, size: tuple[int, int]) -> Image.Image:
    """Resize an image. OpenCV is used because it is five times as fast as Pillow."""
    interpolation = cv2.INTER_AREA if size[0] < image.width else cv2.INTER_CUBIC
    return Image.fromarray(np.asarray(cv2.resize(np.asarray(image.convert("RGB")), size, interpolation=interpolation)))


class Canvas:
    """A picture to draw on. All lengths are in picture pixels."""

    def __init__(self, width: float, height: float) -> None:
        self.width, self.height = width, height
        self._image = Image.new("RGB", (round(width) * SCALE, round(height) * SCALE), BACKGROUND)
        self._draw = ImageDraw.Draw(self._image, "RGBA")

    def panel(
        self, x: float, y: float, width: float, height: float, fill: str, *, radius: float = 10, edge: str | None = None
    ) -> None:
        """Draw a rounded rectangle. ``fill`` may have an alpha channel (#RRGGBBAA)."""
        box = tuple(round(v * SCALE) for v in (x, y, x + width, y + height))
        self._draw.rounded_rectangle(box, round(radius * SCALE), fill=fill, outline=edge, width=SCALE)

    def text(
        self, x: float, y: float, text: str, size: float, fill: str = TEXT_COLOUR, *, bold: bool = False, anchor: str = "ls"
    ) -> None:
        """Draw a line of text. ``anchor`` is Pillow's text anchor ("ls": left end of the baseline)."""
        stroke_width = _BOLD_STROKE * SCALE * size / 16 if bold else 0
        self._draw.text(
            (x * SCALE, y * SCALE),
            to_printable(text),
            font=_font(size),
            fill=fill,
            anchor=anchor,
            stroke_width=stroke_width,
            stroke_fill=fill,
        )

    def picture(self, image: Image.Image, x: float, y: float, width: float, height: float, *, radius: float = 10) -> None:
        """Draw an image, scaled to the given size, with rounded corners."""
        size = (round(width * SCALE), round(height * SCALE))
        mask = Image.new("L", size, 0)
        ImageDraw.Draw(mask).rounded_rectangle((0, 0, size[0] - 1, size[1] - 1), round(radius * SCALE), fill=255)
        self._image.paste(_resize(image, size), (round(x * SCALE), round(y * SCALE)), mask)

    def frame(self, x: float, y: float, width: float, height: float, colour: str) -> None:
        """Draw a thin box that is visible on light and dark backgrounds."""
        for margin, thickness, fill in ((1.2, 4.2, "#0E131AB0"), (0.0, 2.0, colour)):
            edges = (x - margin, y - margin, x + width + margin, y + height + margin)
            box = tuple(round(v * SCALE) for v in edges)
            self._draw.rounded_rectangle(box, round(3 * SCALE), outline=fill, width=round(thickness * SCALE))

    def tag(
        self, x: float, y: float, text: str, size: float, *, fill: str, text_colour: str, padding: float = 7, anchor: str = "l"
    ) -> float:
        """Draw text on a rounded background, and return the width of the background.

        Args:
            x: Position of the left end, right end or centre, depending on ``anchor``.
            y: Position of the vertical centre.
            text: The text.
            size: Font size.
            fill: Background colour.
            text_colour: Text colour.
            padding: Space on each side of the text.
            anchor: "l", "r" or "m".
        """
        text = to_printable(text)
        width, height = max(width_of(text, size) + 2 * padding, size * 1.55), size * 1.55
        left = {"l": x, "r": x - width, "m": x - width / 2}[anchor]
        self.panel(left, y - height / 2, width, height, fill, radius=height / 2)
        self.text(left + width / 2, y, text, size, text_colour, bold=True, anchor="mm")
        return width

    def arrow(self, x: float, y: float, colour: str) -> float:
        """Draw a small arrow that points right, with its shaft at ``y``, and return the arrow's width."""
        width = 16.0
        points = [(x + width - 6, y - 4.5), (x + width, y), (x + width - 6, y + 4.5)]
        self._draw.line([(x * SCALE, y * SCALE), ((x + width - 1) * SCALE, y * SCALE)], fill=colour, width=2 * SCALE)
        self._draw.line([(px * SCALE, py * SCALE) for px, py in points], fill=colour, width=2 * SCALE, joint="curve")
        return width

    def finish(self) -> Image.Image:
        """Return the finished picture, scaled down to its final size."""
        return self._image.reduce(SCALE)
