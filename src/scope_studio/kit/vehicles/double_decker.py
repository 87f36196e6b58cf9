"""A double-deck town bus with seats behind its two rows of windows, a lit destination display, and side advertisements."""

from __future__ import annotations

import math

from mathutils import Matrix

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings, wheels
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles.paintwork import TRIM, Patch

FRONT_M, REAR_M, HALF_M, TOP_M = 5.2, -5.2, 1.25, 4.30
"""y coordinates of front and rear, half width, and height of the bus in metres."""
_LOWER = (1.92, 0.98)
"""Windows of the lower deck: height of their centre, and their height, in metres."""
_UPPER = (3.46, 0.92)
"""Windows of the upper deck: height of their centre, and their height, in metres."""


def _parts() -> Parts:
    parts = Parts()
    paint = pw.paint_slot()
    section: list[Point2D] = [
        (REAR_M, 0.40), (REAR_M, 3.9), (REAR_M + 0.10, TOP_M - 0.06), (REAR_M + 0.30, TOP_M), (FRONT_M - 0.60, TOP_M),
        (FRONT_M - 0.30, TOP_M - 0.12), (FRONT_M - 0.14, 2.9), (FRONT_M, 1.2), (FRONT_M, 0.5), (FRONT_M - 0.06, 0.32),
    ]  # fmt: skip
    parts.prism(section, -HALF_M, HALF_M, paint, bevel_m=0.09, segments=3, smooth=True)
    _front(parts)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        _side(parts, kerb=sign < 0)
    parts.matrix = Matrix.Identity(4)
    for y, twin in ((2.75, False), (-2.65, True)):
        for sign in (-1, 1):
            wheels.lorry_wheel(parts, (sign * 1.13, y, 0.48), 0.48, sign, width=0.27, twin=twin)
    for z, height in ((3.46, 0.86), (1.95, 0.70)):
        parts.box((1.9, 0.03, height), (0, REAR_M - 0.002, z), pw.black_trim())
        parts.box((1.8, 0.03, height - 0.1), (0, REAR_M - 0.008, z), pw.glass())
    for k in range(6):
        parts.box((1.5, 0.03, 0.04), (0, REAR_M - 0.004, 0.80 + 0.10 * k), pw.black_trim())
    return parts


def _front(parts: Parts) -> None:
    trim = pw.black_trim()
    lean = math.atan2(0.14, 1.7)
    parts.matrix = Matrix.Translation((0, FRONT_M - 0.055, 1.86)) @ Matrix.Rotation(lean, 4, "X")
    parts.box((2.30, 0.03, 1.25), (0, 0, 0), trim, bevel_m=0.012)
    fittings.seats_behind_glass(parts, [(0.66, 0.0)], -0.35, 0.018, "Y")
    parts.box((2.26, 0.03, 0.22), (0, 0.003, -0.5), shading.plain("bus dashboard", (0.05, 0.05, 0.052)), bevel_m=0.0)
    parts.box((2.24, 0.03, 1.20), (0, 0.022, 0), pw.clear_glass(), bevel_m=0.012)
    for x in (-0.75, 0.15):
        parts.tube([(x, 0.05, -0.58), (x + 0.7, 0.055, -0.46)], 0.013, trim, sides=4)
    parts.matrix = Matrix.Translation((0, FRONT_M - 0.205, 3.46)) @ Matrix.Rotation(math.atan2(0.14, 1.2), 4, "X")
    parts.box((2.28, 0.03, 0.98), (0, 0, 0), trim, bevel_m=0.012)
    fittings.seats_behind_glass(parts, [(x, 0.0) for x in (-0.8, -0.3, 0.3, 0.8)], -0.42, 0.018, "Y")
    parts.box((2.22, 0.03, 0.92), (0, 0.022, 0), pw.clear_glass(), bevel_m=0.012)
    parts.matrix = Matrix.Identity(4)
    parts.box((1.90, 0.10, 0.36), (0, FRONT_M - 0.16, 2.72), wheels.shade(), bevel_m=0.03)
    parts.box((1.5, 0.04, 0.18), (0, FRONT_M + 0.005, 0.78), trim)


def _side(parts: Parts, *, kerb: bool) -> None:
    trim = pw.black_trim()
    for z, height in (_LOWER, _UPPER):
        parts.box((0.02, 9.4, height), (HALF_M - 0.003, -0.15, z), trim, bevel_m=0.008)
        for k in range(7):
            y = 3.85 - 1.33 * k
            if kerb and k == 0 and z < 3:
                continue
            fittings.seats_behind_glass(parts, [(y - 0.36, z - height / 2), (y + 0.30, z - height / 2)], -0.10, HALF_M + 0.009, "X")
            parts.box((0.02, 1.25, height - 0.08), (HALF_M + 0.008, y, z), pw.clear_glass(), bevel_m=0.008)
            parts.box((0.008, 1.25, 0.018), (HALF_M + 0.013, y, z + height * 0.26), trim, bevel_m=0.0)
    if kerb:
        for y in (4.35, 3.80):
            parts.box((0.02, 0.54, 2.10), (HALF_M + 0.004, y, 1.42), trim, bevel_m=0.008)
            parts.box((0.02, 0.46, 1.90), (HALF_M + 0.010, y, 1.45), pw.glass(), bevel_m=0.008)
    parts.box((0.40, 0.05, 0.20), (HALF_M - 0.28, FRONT_M + 0.005, 0.70), wheels.shade(), bevel_m=0.03)
    for k, colour in enumerate(("white", "white", "amber")):
        parts.box((0.115, 0.04, 0.14), (HALF_M - 0.41 + 0.13 * k, FRONT_M + 0.02, 0.70), pw.lamp(colour), bevel_m=0.03)
    for k, colour in enumerate(("red", "red", "amber", "white")):
        parts.box((0.16, 0.04, 0.16), (HALF_M - 0.22, REAR_M - 0.005, 1.35 - 0.18 * k), pw.lamp(colour), bevel_m=0.03)
    arm = [(HALF_M - 0.10, FRONT_M - 0.22, 2.62), (HALF_M + 0.10, FRONT_M + 0.22, 2.60), (HALF_M + 0.15, FRONT_M + 0.28, 2.40)]
    parts.tube(arm, 0.022, trim, sides=6)
    parts.box((0.20, 0.10, 0.40), (HALF_M + 0.15, FRONT_M + 0.28, 2.20), trim, bevel_m=0.04)
    for y in (2.75, -2.65):
        bow = [(y + 0.60 * math.cos(a), 0.46 + 0.60 * math.sin(a)) for a in (math.pi * k / 14 for k in range(15))]
        parts.prism([*bow, (y - 0.60, 0.30), (y + 0.60, 0.30)], HALF_M - 0.5, HALF_M + 0.006, wheels.shade())
        parts.tube([(HALF_M + 0.005, a, b) for a, b in bow], 0.022, trim, sides=6)


def double_decker(colour: str, *, plate: str, route: str, destination: str, operator: str, poster: str) -> Built:
    """Build a double-deck bus, 10.4 m long and 4.3 m high, with its door on the left.

    A lit display at the front shows the route and destination. ``operator`` is the lettering above the lower windows, and
    ``poster`` is the text of an advertisement between the decks.
    """
    extra_parts, letters = bw.number_plates(plate, (FRONT_M + 0.01, 0.50), (REAR_M - 0.012, 0.60))
    letters.append(bw.text_line(f"{route} {destination}", 0.17, (0, FRONT_M - 0.106, 2.72), "+Y", "display", width_m=1.75))
    letters.append(bw.text_line(route, 0.26, (0, REAR_M - 0.03, 2.66), "-Y", "white"))
    letters += bw.text_on_both_sides(operator, 0.15, 0.0, 1.22, fittings.lettering_colour(colour), x=HALF_M, width_m=3.2)
    board = shading.plain("bus poster", (0.66, 0.60, 0.40), 0.4)
    for sign in (-1, 1):
        extra_parts.box((0.02, 5.2, 0.42), (sign * (HALF_M + 0.004), -0.4, 2.72), board, bevel_m=0.004)
    letters += bw.text_on_both_sides(poster, 0.22, -0.4, 2.72, "dark blue", x=HALF_M + 0.014, width_m=4.8)
    patches = [
        Patch(TRIM, z=(0.0, 0.42), roughness=0.6),
        Patch((0.62, 0.57, 0.42), x=(1.1, 9), z=(2.46, 2.98), roughness=0.3),
        Patch((0.62, 0.57, 0.42), x=(1.1, 9), z=(1.38, 1.42), roughness=0.3),
    ]
    body = bw.body_mesh("double decker", _parts)
    return bw.finish("double decker", body, [pw.paint("double decker", colour, patches, dirt_top_m=1.1)], letters, extra_parts)
