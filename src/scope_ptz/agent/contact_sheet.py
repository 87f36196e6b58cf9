"""Contact sheets: captioned pictures in a grid, in the style of the filmstrip."""

from __future__ import annotations

from collections.abc import Sequence

from PIL import Image

from scope_ptz.agent.drawing import EDGE_COLOUR, PANEL_COLOUR, TEXT_COLOUR, Canvas, shorten, to_printable

_WIDTH, _MARGIN, _GAP, _CAPTION_HEIGHT, _TITLE_HEIGHT = 1600, 32, 20, 44, 64  # picture pixels
_COLUMNS = 3  # pictures per row


def contact_sheet(title: str, pictures: Sequence[tuple[str, Image.Image]]) -> Image.Image:
    """Draw a contact sheet with three pictures per row.

    Args:
        title: The heading.
        pictures: Pairs of a caption and an image; at least one. All images must have the same size.

    Returns:
        The sheet, 1600 pixels wide.
    """
    width = (_WIDTH - 2 * _MARGIN - _GAP * (_COLUMNS - 1)) / _COLUMNS
    height = width * pictures[0][1].height / pictures[0][1].width
    rows = -(-len(pictures) // _COLUMNS)
    canvas = Canvas(_WIDTH, _TITLE_HEIGHT + rows * (height + _CAPTION_HEIGHT + _GAP) + _MARGIN)
    canvas.text(_MARGIN, 46, title, 26, bold=True)
    for number, (caption, image) in enumerate(pictures):
        row, column = divmod(number, _COLUMNS)
        x, y = _MARGIN + column * (width + _GAP), _TITLE_HEIGHT + row * (height + _CAPTION_HEIGHT + _GAP)
        canvas.panel(x, y, width, height + _CAPTION_HEIGHT, PANEL_COLOUR, radius=12, edge=EDGE_COLOUR)
        canvas.picture(image, x + 1, y + 1, width - 2, height - 1, radius=11)
        canvas.text(
            x + 16, y + height + _CAPTION_HEIGHT / 2, shorten(to_printable(caption), 18, width - 32), 18, TEXT_COLOUR, anchor="lm"
        )
    return canvas.finish()
