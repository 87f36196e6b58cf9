"""A single-deck coach with seats behind its windows and a lit destination display."""

from __future__ import annotations

import math

from mathutils import Matrix

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings, wheels
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles.paintwork import GAP, TRIM, Patch

_COACH_FRONT, _COACH_REAR, _COACH_HALF, _COACH_TOP = 5.95, -5.75, 1.25, 3.25
"""y coordinates of front and rear, half width, and height of the coach in metres."""


def _coach_parts() -> Parts:
    parts = Parts()
    front, rear, half, top = _COACH_FRONT, _COACH_REAR, _COACH_HALF, _COACH_TOP
    paint, trim, glass = pw.paint_slot(), pw.black_trim(), pw.glass()
    section: list[Point2D] = [
        (rear + 0.02, 0.42), (rear, 0.9), (rear, 2.2), (rear + 0.10, top - 0.10), (rear + 0.35, top),
            (front - 0.55, top), (front - 0.22, top - 0.10),
        (front - 0.10, 2.6), (front, 1.25), (front, 0.6), (front - 0.06, 0.34),
    ]  # fmt: skip
    parts.prism(section, -half, half, paint, bevel_m=0.10, segments=3, smooth=True)
    lean = math.atan2(0.10, 1.35)
    parts.matrix = Matrix.Translation((0, front - 0.045, 1.86)) @ Matrix.Rotation(lean, 4, "X")
    parts.box((2.34, 0.03, 1.42), (0, 0.0, 0), trim, bevel_m=0.012)
    fittings.seats_behind_glass(parts, [(0.66, 0.0), (-0.75, 0.1), (-0.2, 0.16)], -0.42, 0.018, "Y")
    parts.box((2.26, 0.03, 0.26), (0, 0.003, -0.56), shading.plain("lorry dashboard", (0.05, 0.05, 0.052)), bevel_m=0.0)
    parts.box((2.34, 0.03, 1.42), (0, 0.024, 0), pw.clear_glass(), bevel_m=0.012)
    for x in (-0.75, 0.10):
        parts.tube([(x, 0.05, -0.66), (x + 0.75, 0.055, -0.55)], 0.013, trim, sides=4)
    parts.matrix = Matrix.Identity(4)
    parts.box((2.30, 0.10, 0.42), (0, front - 0.17, 2.84), wheels.shade(), bevel_m=0.03)
    parts.box((2.20, 0.04, 0.05), (0, front + 0.01, 0.95), fittings.aluminium())
    parts.box((1.3, 0.04, 0.18), (0, front + 0.005, 0.82), trim)
    windows = [4.05, 2.62, 1.19, -0.24, -1.67, -3.10, -4.53]
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        parts.box((0.02, 9.95, 1.12), (half - 0.003, -0.40 + 0.02, 2.14), trim, bevel_m=0.008)
        for y in windows:
            if sign < 0 and y == windows[0]:
                continue
            fittings.seats_behind_glass(parts, [(y - 0.55, 1.62), (y + 0.15, 1.62)], 0.02, half + 0.009, "X")
            parts.box((0.02, 1.36, 1.02), (half + 0.008, y - 0.15, 2.14), pw.clear_glass(), bevel_m=0.008)
            parts.box((0.008, 1.36, 0.02), (half + 0.012, y - 0.15, 2.42), trim, bevel_m=0.0)
        parts.box((0.02, 0.80, 1.0), (half + 0.003, 5.15, 2.0), glass, bevel_m=0.008)
        for y in (3.3, 2.0, 0.7, -0.6, -1.9):
            parts.box((0.006, 1.22, 0.62), (half + 0.001, y - 0.4, 0.80), paint, bevel_m=0.0)
            for edge in (-0.62, 0.62):
                parts.box((0.008, 0.012, 0.62), (half + 0.001, y - 0.4 + edge, 0.80), wheels.shade(), bevel_m=0.0)
        parts.box((0.008, 8.0, 0.012), (half + 0.001, -0.5, 1.14), wheels.shade(), bevel_m=0.0)
        parts.box((0.40, 0.05, 0.22), (half - 0.28, front + 0.005, 0.72), wheels.shade(), bevel_m=0.03)
        for k, colour in enumerate(("white", "white", "amber")):
            parts.box((0.115, 0.04, 0.14), (half - 0.41 + 0.13 * k, front + 0.02, 0.72), pw.lamp(colour), bevel_m=0.03)
        for k, colour in enumerate(("red", "red", "amber", "white")):
            parts.box((0.16, 0.04, 0.16), (half - 0.22, rear - 0.005, 1.30 - 0.18 * k), pw.lamp(colour), bevel_m=0.03)
        parts.tube(
            [(half - 0.10, front - 0.25, 2.95), (half + 0.10, front + 0.30, 2.90), (half + 0.16, front + 0.36, 2.62)],
            0.025,
            trim,
            sides=6,
        )
        parts.box((0.24, 0.12, 0.48), (half + 0.16, front + 0.36, 2.36), trim, bevel_m=0.04)
        for y in (3.55, -2.75):
            arch = [(y + 0.60 * math.cos(a), 0.46 + 0.60 * math.sin(a)) for a in (math.pi * k / 14 for k in range(15))]
            parts.prism([*arch, (y - 0.60, 0.30), (y + 0.60, 0.30)], half - 0.5, half + 0.006, wheels.shade())
            parts.tube([(half + 0.005, a, b) for a, b in arch], 0.022, trim, sides=6)
    parts.matrix = Matrix.Identity(4)
    for y, twin in ((3.55, False), (-2.75, True)):
        for sign in (-1, 1):
            wheels.lorry_wheel(parts, (sign * 1.14, y, 0.48), 0.48, sign, width=0.27, twin=twin)
    for y in (4.93, 4.37):
        parts.box((0.02, 0.53, 2.20), (-half - 0.004, y - 0.05 + 0.25, 1.52), trim, bevel_m=0.008)
        parts.box((0.02, 0.44, 1.95), (-half - 0.010, y - 0.05 + 0.25, 1.55), glass, bevel_m=0.008)
    parts.box((2.0, 0.03, 0.85), (0, rear + 0.01, 2.30), trim)
    parts.box((1.9, 0.03, 0.76), (0, rear + 0.004, 2.30), glass)
    for k in range(6):
        parts.box((1.3, 0.03, 0.04), (0, rear - 0.002, 0.95 + 0.09 * k), trim)
    parts.box((1.4, 2.2, 0.16), (0, -3.2, top + 0.05), paint, bevel_m=0.06)
    parts.box((0.9, 0.9, 0.06), (0, 1.5, top + 0.02), paint, bevel_m=0.03)
    return parts


def coach(colour: str, *, plate: str, lettering: str, destination: str) -> Built:
    """Build a single-deck coach, 11.7 m long, with its door on the left (kerb) side.

    The destination is lit above the windscreen.
    """
    extra_parts, letters = bw.number_plates(plate, (_COACH_FRONT + 0.01, 0.52), (_COACH_REAR - 0.012, 0.66))
    letters += bw.text_on_both_sides(lettering, 0.30, 0.2, 1.38, fittings.lettering_colour(colour), x=_COACH_HALF, width_m=4.4)
    letters.append(bw.text_line(destination, 0.20, (0, _COACH_FRONT - 0.116, 2.84), "+Y", "display", width_m=2.05))
    patches = [
        Patch(TRIM, z=(0.0, 0.46), roughness=0.6),
        Patch((0.55, 0.56, 0.57), x=(1.1, 9), z=(1.17, 1.21), roughness=0.3),
        Patch((0.55, 0.56, 0.57), x=(1.1, 9), y=(-9, -3.6), z=(1.6, 1.75), z_per_y=0.16, roughness=0.3),
        Patch((0.55, 0.56, 0.57), x=(1.1, 9), y=(-9, -3.9), z=(1.9, 1.98), z_per_y=0.16, roughness=0.3),
        Patch(GAP, x=(0, 9), y=(-9, -5.5), z=(1.60, 1.61), roughness=0.9),
    ]
    return bw.finish(
        "coach", bw.body_mesh("coach", _coach_parts), [pw.paint("coach", colour, patches, dirt_top_m=1.0)], letters, extra_parts
    )
