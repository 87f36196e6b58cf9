"""Filmstrips: one picture of a whole run, in the style of the paper's Figure 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from PIL import Image

from scope_ptz.agent.drawing import (
    AMBER,
    BACKGROUND,
    CYAN,
    EDGE_COLOUR,
    GREEN,
    PANEL_COLOUR,
    RED,
    SECONDARY_TEXT_COLOUR,
    TEXT_COLOUR,
    Canvas,
    shorten,
    to_printable,
    width_of,
    wrap,
)
from scope_ptz.agent.panels import Panel, panels_of
from scope_ptz.agent.trace import Trace, picture_path
from scope_ptz.errors import OutputError, TraceError

# Lengths in picture pixels.
WIDTH = 1600
MARGIN = 32
GAP = 20
CAPTION_HEIGHT = 60  # height of a caption

MAX_PANELS = 12  # in runs with more panels, the middle ones are omitted
COMPRESSION = 3  # zlib.Z_RLE: three times as fast as the default compression, with 5% larger files
MAX_NUMBERED_BOXES = 40  # with more boxes in a panel, the numbers would cover the picture

_BOX_MARGIN = 2.0  # picture pixels between an object and its box, so that the box does not cover small objects
_HEADLINES = {
    "answered": ("ANSWER", GREEN),
    "clarification": ("CLARIFICATION", AMBER),
    "refused": ("REFUSED", AMBER),
    "step_limit": ("STEP LIMIT", RED),
    "budget": ("BUDGET SPENT", RED),
    "planner_error": ("PLANNER FAILED", RED),
    "camera_error": ("CAMERA FAILED", RED),
    "cancelled": ("CANCELLED", RED),
}


def write_filmstrip(trace: Trace) -> Path | None:
    """Draw the filmstrip of a run and write it to the run folder.

    Returns:
        The path, or None when the run has no pictures.

    Raises:
        OutputError: The file cannot be written.
        TraceError: A picture of the run is missing or damaged.
    """
    image = draw_filmstrip(trace)
    if image is None:
        return None
    path = trace.folder / "filmstrip.png"
    try:
        image.save(path, optimize=False, compress_level=1, compress_type=COMPRESSION)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error}.") from error
    return path


def draw_filmstrip(trace: Trace, files: Mapping[str, bytes] | None = None) -> Image.Image | None:
    """Draw the filmstrip of a run, ``WIDTH`` pixels wide.

    Args:
        trace: The run.
        files: Encoded pictures by name, for a run that is kept in memory; None to read them from the run folder.

    Returns:
        The picture, or None when the run has no pictures.

    Raises:
        TraceError: A picture of the run is missing or damaged.
    """
    panels = [p for p in panels_of(trace) if p.file is not None]
    if not panels:
        return None
    shown, omitted = _omit_middle(panels)
    rows = _rows([_Tile(panel, open_picture(panel.file or "", trace.folder, files)) for panel in shown])
    heights = [_row_height(row) for row in rows]
    instruction_banner = _Banner("INSTRUCTION", CYAN, trace.started.instruction)
    label, colour = _HEADLINES[trace.ended.outcome] if trace.ended else ("INTERRUPTED", RED)
    outcome_banner = _Banner(label, colour, trace.ended.text if trace.ended else "The program stopped before the run ended.")
    total = MARGIN + instruction_banner.height + GAP + sum(heights) + GAP * len(rows) + outcome_banner.height + 22 + MARGIN
    canvas = Canvas(WIDTH, total)
    instruction_banner.draw(canvas, MARGIN)
    y = MARGIN + instruction_banner.height + GAP
    for row, height in zip(rows, heights, strict=True):
        _draw_row(canvas, row, y)
        y += height + GAP
    outcome_banner.draw(canvas, y)
    _draw_footer(canvas, trace, omitted, y + outcome_banner.height + 26)
    return canvas.finish()


@dataclass(frozen=True, slots=True)
class _Tile:
    panel: Panel
    image: Image.Image

    @property
    def aspect(self) -> float:
        return self.image.width / self.image.height


class _Banner:
    """A labelled panel across the whole width of the filmstrip, with up to three lines of text."""

    def __init__(self, label: str, colour: str, text: str) -> None:
        self._label, self._colour = label, colour
        width = WIDTH - 2 * MARGIN - 56
        self._size = 30 if width_of(to_printable(text), 30) <= 2 * width else 24
        self._lines = wrap(text, self._size, width, 3)
        self.height = 52 + len(self._lines) * self._size * 1.3

    def draw(self, canvas: Canvas, y: float) -> None:
        canvas.panel(MARGIN, y, WIDTH - 2 * MARGIN, self.height, PANEL_COLOUR, radius=12, edge=EDGE_COLOUR)
        canvas.panel(MARGIN + 14, y + 16, 5, self.height - 32, self._colour, radius=2.5)
        canvas.text(MARGIN + 34, y + 32, self._label, 15, self._colour, bold=True)
        for number, line in enumerate(self._lines):
            canvas.text(MARGIN + 34, y + 40 + (number + 0.85) * self._size * 1.3, line, self._size, TEXT_COLOUR, bold=True)


def open_picture(name: str, folder: Path, files: Mapping[str, bytes] | None = None) -> Image.Image:
    """Open a picture from a run.

    Args:
        name: Name of the picture in the trace.
        folder: The run folder.
        files: Encoded pictures by name, for a run that is kept in memory; None to read them from the run folder.

    Raises:
        TraceError: The picture is missing or damaged.
    """
    path = picture_path(folder, name)
    try:
        with Image.open(path if files is None else BytesIO(files.get(name, b""))) as image:
            return image.convert("RGB")
    except OSError as error:
        raise TraceError(f"The picture {path} of the run is missing or damaged.") from error


def _omit_middle(panels: list[Panel]) -> tuple[list[Panel], int]:
    """Return at most ``MAX_PANELS`` panels, and the number of omitted ones. Panels are omitted from the middle of the run."""
    if len(panels) <= MAX_PANELS:
        return panels, 0
    first = MAX_PANELS // 2 - 1
    return [*panels[:first], *panels[first - MAX_PANELS :]], len(panels) - MAX_PANELS


def _rows(tiles: list[_Tile]) -> list[list[_Tile]]:
    """Arrange tiles in rows. Each panorama has its own row; the tiles between panoramas are distributed evenly over rows."""
    rows: list[list[_Tile]] = []
    group: list[_Tile] = []
    for tile in [*tiles, None]:
        if tile is not None and not tile.panel.is_panorama:
            group.append(tile)
            continue
        rows += _distribute(group)
        group = []
        if tile is not None:
            rows.append([tile])
    return rows


def _distribute(group: list[_Tile]) -> list[list[_Tile]]:
    """Distribute tiles over rows of two, three or four, as evenly as possible."""
    if not group:
        return []
    columns = 2 if len(group) in (2, 4) else 4 if len(group) in (7, 8) or len(group) > 9 else 3
    count = -(-len(group) // columns)
    rows, taken = [], 0
    for number in range(count):
        size = -(-(len(group) - taken) // (count - number))
        rows.append(group[taken : taken + size])
        taken += size
    return rows


def _picture_height(row: list[_Tile]) -> float:
    """Return the height at which the pictures of a row fill its width, limited so that a single picture is not huge."""
    return min((WIDTH - 2 * MARGIN - GAP * (len(row) - 1)) / sum(tile.aspect for tile in row), 640.0)


def _row_height(row: list[_Tile]) -> float:
    return _picture_height(row) + CAPTION_HEIGHT


def _draw_row(canvas: Canvas, row: list[_Tile], y: float) -> None:
    height = _picture_height(row)
    row_width = sum(tile.aspect for tile in row) * height + GAP * (len(row) - 1)
    x = (WIDTH - row_width) / 2
    for tile in row:
        width = tile.aspect * height
        _draw_tile(canvas, tile, x, y, width, height)
        x += width + GAP


def _draw_tile(canvas: Canvas, tile: _Tile, x: float, y: float, width: float, height: float) -> None:
    panel = tile.panel
    canvas.panel(x, y, width, height + CAPTION_HEIGHT, PANEL_COLOUR, radius=12, edge=EDGE_COLOUR)
    canvas.picture(tile.image, x + 1, y + 1, width - 2, height - 1, radius=11)
    _draw_boxes(canvas, panel, x, y, width, height)
    pose = panel.pose.as_dict()
    pose_text = f"pan {pose['pan_deg']:+.1f}° · tilt {pose['tilt_deg']:+.1f}° · {pose['zoom']:.1f}x"
    readout = "full scene" if panel.is_panorama else pose_text
    canvas.tag(x + 12, y + height - 22, readout, 14, fill="#0E131AC8", text_colour=TEXT_COLOUR, padding=10)
    if panel.badge:
        fill, text_colour = (AMBER, BACKGROUND) if panel.boxes else ("#0E131AC8", TEXT_COLOUR)
        canvas.tag(x + width - 12, y + 28, panel.badge, 20, fill=fill, text_colour=text_colour, padding=13, anchor="r")
    _draw_caption(canvas, panel, x + 16, y + height + CAPTION_HEIGHT / 2, width - 32)


def _draw_boxes(canvas: Canvas, panel: Panel, x: float, y: float, width: float, height: float) -> None:
    for box in panel.boxes:
        left, top = x + box.x_min * width - _BOX_MARGIN, y + box.y_min * height - _BOX_MARGIN
        canvas.frame(left, top, box.width * width + 2 * _BOX_MARGIN, box.height * height + 2 * _BOX_MARGIN, AMBER)
    if not panel.badge or len(panel.boxes) > MAX_NUMBERED_BOXES:
        return
    # Boxes are numbered from left to right, independently of the order of the detections.
    for number, box in enumerate(sorted(panel.boxes, key=lambda b: b.centre[0]), 1):
        top = y + box.y_min * height - 11 - _BOX_MARGIN
        label_y = top if top > y + 10 else y + box.y_max * height + 11 + _BOX_MARGIN
        canvas.tag(x + box.centre[0] * width, label_y, str(number), 11, fill=AMBER, text_colour=BACKGROUND, padding=4, anchor="m")


def _draw_caption(canvas: Canvas, panel: Panel, x: float, y: float, width: float) -> None:
    """Draw a caption such as ``2  pan right 15° -> 4 cones``, wrapped to a second line if necessary."""
    number_width = (
        canvas.tag(x, y, str(panel.number), 17, fill=CYAN, text_colour=BACKGROUND, padding=7) + 12 if panel.number else 0.0
    )
    left, available, colour = x + number_width, width - number_width, RED if panel.failed else AMBER
    action, finding = to_printable(panel.action), to_printable(panel.finding)
    if width_of(action, 20) + 36 + width_of(finding, 20) <= available or not finding:
        shortened = shorten(action, 20, available)
        canvas.text(left, y, shortened, 20, TEXT_COLOUR, anchor="lm")
        if finding:
            text_x = left + width_of(shortened, 20) + 12
            text_x += canvas.arrow(text_x, y, SECONDARY_TEXT_COLOUR) + 9
            canvas.text(text_x, y, finding, 20, colour, bold=True, anchor="lm")
        return
    canvas.text(left, y - 13, shorten(action, 18, available), 18, TEXT_COLOUR, anchor="lm")
    text_x = left + canvas.arrow(left, y + 13, SECONDARY_TEXT_COLOUR) + 8
    canvas.text(text_x, y + 13, shorten(finding, 18, available - 26), 18, colour, bold=True, anchor="lm")


def _draw_footer(canvas: Canvas, trace: Trace, omitted: int, y: float) -> None:
    started = trace.started
    perception = started.labels.perception_note.rstrip(".") or f"Perception: {started.perception}"
    canvas.text(MARGIN + 4, y, f"SCOPE · {started.camera} · Planner: {started.planner} · {perception}", 15, SECONDARY_TEXT_COLOUR)
    if omitted:
        note = f"steps {MAX_PANELS // 2} to {MAX_PANELS // 2 + omitted - 1} are not shown"
        canvas.text(WIDTH - MARGIN - 4, y, note, 15, SECONDARY_TEXT_COLOUR, anchor="rs")
