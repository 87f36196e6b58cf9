"""Sign faces: rounded reflective boards with borders, lettering, arrows, route patches and pictograms.

A face is drawn in the plane y = 0 of the current frame of a ``Solid`` and faces +y. Positions are (u, v), as seen by a viewer:
``u`` increases to the right and ``v`` upwards (so x = -u).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from scope_studio.kit.core.finishes import sheet, steel
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shapes import rounded_rectangle
from scope_studio.kit.core.solid import Solid

LETTERING_GAP_M = 0.0035
"""Distance in metres between lettering and its board, large enough to be rendered correctly in distant views."""

INK_BY_BACKGROUND = {"blue": "white", "green": "white", "red": "white", "dark green": "white", "brown": "white", "black": "white"}
"""Colour of lettering for each background colour. On other backgrounds, lettering is black."""

ARROW_ROTATION_DEG = {
    "up": 0.0,
    "left": 90.0,
    "right": -90.0,
    "down": 180.0,
    "up-right": -45.0,
    "up-left": 45.0,
    "down-right": -135.0,
    "down-left": 135.0,
}
"""Anticlockwise rotation in degrees of an upward arrow, for each direction."""


@dataclass(frozen=True)
class Panel:
    r"""Parameters of a direction or information sign. Sizes are in metres.

    The text after a tab in a line, as in "Halden\t12", is aligned to the right edge. ``arrows`` gives a direction (a key of
    ``ARROW_ROTATION_DEG``) or None for each line, or a single direction for the whole panel. ``route`` is a road number, shown
    on a patch in the first row.
    """

    lines: Sequence[str]
    width: float
    height: float
    background: str = "blue"
    cap_height: float | None = None
    align: str = "LEFT"
    arrows: Sequence[str | None] = ()
    route: str | None = None
    route_background: str | None = None


def board(
    s: Solid,
    width: float,
    height: float,
    background: str,
    *,
    border: str | None = None,
    edge: float | None = None,
    back: bool = True,
) -> None:
    """Add a rounded board with a border stripe. Its face is at y = 0."""
    edge = edge if edge is not None else min(0.05, 0.035 * min(width, height) + 0.006)
    corner = min(0.10, 0.09 * min(width, height))
    ink = border or INK_BY_BACKGROUND.get(background, "black")
    s.prism(rounded_rectangle(width, height, corner), (-0.010, -0.006), steel(), "XZ")
    s.prism(rounded_rectangle(width, height, corner), (-0.006, -0.004), sheet(background), "XZ")
    gap = edge * 0.45
    s.prism(rounded_rectangle(width - 2 * gap, height - 2 * gap, max(0.004, corner - gap)), (-0.004, -0.002), sheet(ink), "XZ")
    s.prism(
        rounded_rectangle(width - 2 * edge, height - 2 * edge, max(0.004, corner - edge)), (-0.002, 0.0), sheet(background), "XZ"
    )
    if back and height > 0.35:
        for k in range(max(2, round(height / 0.6))):
            z = height * ((k + 0.5) / max(2, round(height / 0.6)) - 0.5)
            s.box((width * 0.96, 0.03, 0.045), (0, -0.026, z), steel(), 0.003)


def flat(s: Solid, outline: Sequence[tuple[float, float]], material: bpy.types.Material, lift: float = LETTERING_GAP_M) -> None:
    """Add a flat shape on the face. ``outline`` is in (u, v) coordinates."""
    s.prism([(-u, v) for u, v in outline], (lift - 0.002, lift), material, "XZ")


def stroke(
    s: Solid, path: Sequence[tuple[float, float]], width: float, material: bpy.types.Material, lift: float = LETTERING_GAP_M
) -> None:
    """Add a thick line with round ends, made of flat shapes."""
    for (u1, v1), (u2, v2) in itertools.pairwise(path):
        length = math.hypot(u2 - u1, v2 - v1)
        nu, nv = -(v2 - v1) / length * width / 2, (u2 - u1) / length * width / 2
        flat(s, [(u1 + nu, v1 + nv), (u1 - nu, v1 - nv), (u2 - nu, v2 - nv), (u2 + nu, v2 + nv)], material, lift)
    for u, v in path:
        disc(s, u, v, width / 2, material, lift)


def disc(
    s: Solid, u: float, v: float, radius: float, material: bpy.types.Material, lift: float = LETTERING_GAP_M, sides: int = 24
) -> None:
    """Add a filled circle on the face."""
    angles = [2 * math.pi * k / sides for k in range(sides)]
    flat(s, [(u + radius * math.cos(a), v + radius * math.sin(a)) for a in angles], material, lift)


def arrow(s: Solid, u: float, v: float, size: float, direction: str, material: bpy.types.Material) -> None:
    """Add a road-sign arrow of height ``size``, centred at (u, v)."""
    shape = [
        (-0.10, -0.5),
        (0.10, -0.5),
        (0.10, 0.12),
        (0.27, -0.05),
        (0.40, 0.07),
        (0.0, 0.5),
        (-0.40, 0.07),
        (-0.27, -0.05),
        (-0.10, 0.12),
    ]
    a = math.radians(ARROW_ROTATION_DEG[direction])
    cos, sin = math.cos(a) * size, math.sin(a) * size
    flat(s, [(u + x * cos - y * sin, v + x * sin + y * cos) for x, y in shape], material, LETTERING_GAP_M + 0.0005)


def write(
    s: Solid,
    body: str,
    cap: float,
    u: float,
    v: float,
    ink: str,
    *,
    align: str = "CENTER",
    bold: bool = True,
    lift: float = LETTERING_GAP_M,
) -> float:
    """Add one line of lettering and return its width in metres."""
    return s.text(
        body,
        cap,
        (-u, lift, v),
        sheet(ink, dirt=0.06),
        align=align,
        bold=bold,
    )[0]


def panel_face(s: Solid, spec: Panel) -> None:
    """Add a complete panel, centred on the frame's origin."""
    board(s, spec.width, spec.height, spec.background)
    ink = INK_BY_BACKGROUND.get(spec.background, "black")
    rows = len(spec.lines)
    margin = 0.075 * min(spec.width, spec.height) + 0.03
    pitch = (spec.height - 1.4 * margin) / max(1, rows)
    cap = min(spec.cap_height or 0.55 * pitch, 0.66 * pitch)
    arrows = list(spec.arrows)
    panel_arrow = arrows[0] if len(arrows) == 1 and rows > 1 else None
    available_width = spec.width - 2 * margin
    if panel_arrow:
        available_width -= spec.height * 0.34
    arrow_width = 2.05 if arrows and not panel_arrow else 0.0
    patch = extent(spec.route, 1.0) + 1.8 if spec.route else 0.0
    relative_widths = [_relative_width(line) + arrow_width + (patch if i == 0 else 0.0) for i, line in enumerate(spec.lines)]
    cap = min([cap, *(available_width / width for width in relative_widths if width > 0)])
    arrow_size = cap * 1.5
    for i, line in enumerate(spec.lines):
        v = (spec.height - 1.4 * margin) / 2 - (i + 0.5) * pitch
        direction = arrows[i] if len(arrows) == rows and not panel_arrow else None
        left, right = -spec.width / 2 + margin, -spec.width / 2 + margin + available_width
        if direction in ("left", "up-left", "down-left"):
            arrow(s, left + arrow_size / 2, v, arrow_size, direction, sheet(ink))
            left += arrow_size * 1.35
        elif direction:
            arrow(s, right - arrow_size / 2, v, arrow_size, direction, sheet(ink))
            right -= arrow_size * 1.35
        if i == 0 and spec.route:
            left += _route_patch(s, spec, left, v, cap) + cap * 0.7
        _write_line(s, line, cap, left, right, v, ink, spec.align)
    if panel_arrow:
        size = spec.height * 0.36
        arrow(s, spec.width / 2 - margin - size * 0.45, 0.0, size, panel_arrow, sheet(ink))


def _relative_width(line: str) -> float:
    """Return the width of a line, including the gap at a tab, as a multiple of the cap height."""
    head, _, tail = line.partition("\t")
    return extent(head, 1.0) + (extent(tail, 1.0) + 1.2 if tail else 0.0)


def _write_line(s: Solid, line: str, cap: float, left: float, right: float, v: float, ink: str, align: str) -> None:
    """Add one line of text. The part after a tab is aligned to ``right``."""
    head, _, tail = line.partition("\t")
    if head:
        write(s, head, cap, {"LEFT": left, "CENTER": (left + right) / 2, "RIGHT": right}[align], v, ink, align=align)
    if tail:
        write(s, tail, cap, right, v, ink, align="RIGHT")


def _route_patch(s: Solid, spec: Panel, left: float, v: float, cap: float) -> float:
    """Add a road number on a patch and return the width of the patch in metres."""
    colour = spec.route_background or ("yellow" if spec.background == "green" else spec.background)
    width = extent(spec.route or "", cap) + 1.1 * cap
    centre = left + width / 2
    if spec.route_background or colour != spec.background:
        flat(s, rounded_rectangle(width, cap * 1.75, cap * 0.22, (centre, v)), sheet(colour), 0.003)
    write(
        s,
        spec.route or "",
        cap,
        centre,
        v,
        "yellow" if colour in ("green", "dark green") else INK_BY_BACKGROUND.get(colour, "black"),
        lift=0.006,
    )
    return width
