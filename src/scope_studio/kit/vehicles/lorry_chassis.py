"""Parts that all rigid lorries share: the day cab, and the chassis with its running gear."""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.vehicles import fittings, wheels
from scope_studio.kit.vehicles import paintwork as pw


def chassis_paint() -> bpy.types.Material:
    """Return the material of chassis parts."""
    return shading.plain("lorry chassis", (0.030, 0.030, 0.032), 0.6)


def cab(parts: Parts, front_y: float, *, depth: float = 1.72, width: float = 2.40, top: float = 2.86) -> None:
    """Add a day cab with its front face at ``front_y``: body, glazing, grille, bumper, lamps, steps, mirrors, visor."""
    half, y, back = width / 2, front_y, front_y - depth
    body: list[Point2D] = [
        (back, 1.02), (y - 0.35, 1.02), (y - 0.05, 0.90), (y - 0.01, 1.30), (y - 0.03, 1.72), (y - 0.19, 2.58),
        (y - 0.32, top - 0.08), (y - 0.55, top), (back + 0.10, top + 0.04), (back, top - 0.05),
    ]  # fmt: skip
    parts.prism(body, -half, half, pw.paint_slot(), bevel_m=0.06, segments=3, smooth=True)
    trim, glass = pw.black_trim(), pw.glass()
    lean = math.atan2(0.16, 0.86)
    parts.matrix = Matrix.Translation((0, y - 0.105, 2.15)) @ Matrix.Rotation(lean, 4, "X")
    parts.box((width - 0.16, 0.03, 0.90), (0, 0.0, 0), trim, bevel_m=0.012)
    fittings.seats_behind_glass(parts, [(-0.62, 0.0), (0.62, 0.0)], -0.42, 0.02, "Y")
    parts.box(
        (width - 0.22, 0.03, 0.16),
        (0, 0.002, -0.34),
        shading.plain("lorry dashboard", (0.05, 0.05, 0.052), 0.8),
        bevel_m=0.0,
    )
    wheel = [(0.62 + 0.22 * math.cos(a), 0.022, -0.24 + 0.10 * math.sin(a)) for a in (2 * math.pi * k / 20 for k in range(20))]
    parts.tube(wheel, 0.014, shading.plain("lorry dashboard", (0.05, 0.05, 0.052)), sides=4, closed=True)
    parts.box((width - 0.22, 0.03, 0.83), (0, 0.026, 0), pw.clear_glass(), bevel_m=0.012)
    for x in (-0.55, 0.15):
        parts.tube([(x, 0.03, -0.42), (x + 0.62, 0.034, -0.36)], 0.011, trim, sides=4)
    parts.matrix = Matrix.Identity(4)
    parts.box(
        (width - 0.10, 0.26, 0.03),
        (0, y + 0.03, 2.70),
        shading.plain("lorry visor", (0.01, 0.011, 0.012), 0.15),
        bevel_m=0.01,
    )
    parts.box((width - 0.30, 0.04, 0.62), (0, y - 0.005, 1.30), trim, bevel_m=0.015)
    for k in range(5):
        parts.box(
            (width - 0.42, 0.05, 0.055),
            (0, y + 0.012, 1.09 + 0.105 * k),
            pw.paint_slot() if k == 4 else chassis_paint(),
            bevel_m=0.015,
        )
    parts.box((0.34, 0.03, 0.07), (0, y + 0.03, 1.62), fittings.aluminium(), bevel_m=0.01)
    parts.prism([(y - 0.62, 0.36), (y + 0.08, 0.36), (y + 0.12, 0.52), (y + 0.08, 0.92), (y - 0.30, 0.92),
        (y - 0.34, 0.60), (y - 0.62, 0.55)],
                -half - 0.01, half + 0.01, pw.paint_slot(), bevel_m=0.04, segments=2)  # fmt: skip
    parts.box((width - 0.9, 0.05, 0.16), (0, y + 0.11, 0.74), trim)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        x = half + 0.004
        side: list[Point2D] = [
            (y - 0.24, 1.66),
            (y - 0.36, 2.52),
            (back + 0.52, 2.56),
            (back + 0.50, 1.74),
            (y - 0.95, 1.74),
            (y - 1.02, 1.66),
        ]
        inner = [(a + (0.035 if a < y - 0.6 else -0.045), b + (0.035 if b < 2 else -0.035)) for a, b in side]
        parts.prism(side, x - 0.02, x + 0.006, trim)
        fittings.seats_behind_glass(parts, [(y - 0.95, 1.70)], 0.0, x + 0.004, "X")
        parts.prism(inner, x - 0.02, x + 0.012, pw.clear_glass())
        for gy in (y - 0.17, back + 0.42):
            parts.box((0.008, 0.012, 1.50), (x, gy, 1.80), wheels.shade(), bevel_m=0.0)
        parts.box((0.008, 1.14, 0.012), (x, y - 0.74, 1.04), wheels.shade(), bevel_m=0.0)
        parts.box((0.03, 0.18, 0.035), (x + 0.012, back + 0.58, 1.50), trim)
        parts.tube(
            [
                (x + 0.03, back + 0.38, 1.2),
                (x + 0.06, back + 0.38, 1.25),
                (x + 0.06, back + 0.38, 2.0),
                (x + 0.03, back + 0.38, 2.05),
            ],
            0.014,
            trim,
        )
        for k, z in enumerate((0.46, 0.74)):
            parts.box((0.26, 0.46, 0.05), (half - 0.13, y - 0.38 - 0.04 * k, z), chassis_paint())
        parts.box((0.04, 0.10, 0.45), (half - 0.02, y - 0.62, 0.60), chassis_paint())
        parts.tube(
            [
                (x - 0.02, y - 0.16, 2.45),
                (x + 0.24, y + 0.02, 2.42),
                (x + 0.24, y + 0.02, 1.72),
                (x - 0.02, y - 0.12, 1.70),
            ],
            0.018,
            trim,
            sides=6,
        )
        parts.box((0.24, 0.09, 0.40), (x + 0.22, y + 0.01, 2.18), trim, bevel_m=0.035)
        parts.box((0.24, 0.09, 0.20), (x + 0.22, y + 0.01, 1.83), trim, bevel_m=0.03)
        parts.box((0.20, 0.01, 0.34), (x + 0.22, y - 0.038, 2.18), glass)
        parts.box((0.46, 0.05, 0.20), (half - 0.27, y + 0.098, 0.72), wheels.shade(), bevel_m=0.02)
        for k, (wide, colour) in enumerate(((0.15, "white"), (0.15, "white"), (0.08, "amber"))):
            parts.box(
                (wide, 0.04, 0.15),
                (half - 0.42 + 0.155 * k - (0.035 if k == 2 else 0), y + 0.115, 0.72),
                pw.lamp(colour),
                bevel_m=0.02,
            )
        parts.box((0.05, 0.12, 0.05), (half - 0.35, y - 0.25, top - 0.02), pw.lamp("amber"))
    parts.matrix = Matrix.Identity(4)


def mudguard(parts: Parts, y: float, radius: float, x0: float, x1: float, material: bpy.types.Material) -> None:
    """Add mudguards over the wheels at ``y`` on both sides, from ``x0`` to ``x1``."""
    outer = [
        (y + (radius + 0.09) * math.cos(a), radius + (radius + 0.09) * math.sin(a))
        for a in (math.pi * (0.02 + 0.96 * k / 10) for k in range(11))
    ]
    inner = [
        (y + (radius + 0.06) * math.cos(a), radius + (radius + 0.06) * math.sin(a))
        for a in (math.pi * (0.98 - 0.96 * k / 10) for k in range(11))
    ]
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        for k in range(10):
            ring = [outer[k], outer[k + 1], inner[9 - k], inner[10 - k]]
            parts.prism(ring, x0, x1, material)
    parts.matrix = Matrix.Identity(4)


def running_gear(parts: Parts, front_axle_y: float, rear_axles_y: list[float], rear_end: float, front_end: float) -> None:
    """Add frame rails, axles, wheels, mudguards, mudflaps, and the rear bumper bar with its lamps."""
    dark = chassis_paint()
    for x in (-0.42, 0.42):
        parts.box((0.09, front_end - rear_end, 0.26), (x, (front_end + rear_end) / 2, 0.92), dark)
    for y in (front_axle_y, *rear_axles_y):
        parts.tube([(-0.95, y, 0.5), (0.95, y, 0.5)], 0.08, dark)
        for sign in (-1, 1):
            driven = y != front_axle_y
            wheels.lorry_wheel(parts, (sign * (1.06 if driven else 1.04), y, 0.50), 0.50, sign, twin=driven)
        if y != front_axle_y:
            mudguard(parts, y, 0.5, 0.62, 1.20, dark)
    mudguard(parts, front_axle_y, 0.5, 0.80, 1.20, pw.black_trim())
    parts.box((2.30, 0.10, 0.14), (0, rear_end + 0.06, 0.56), fittings.aluminium())
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        parts.box((0.08, 0.10, 0.40), (0.45, rear_end + 0.10, 0.74), dark)
        parts.box((0.44, 0.06, 0.15), (0.96, rear_end + 0.03, 0.74), wheels.shade(), bevel_m=0.015)
        for x, colour in ((1.09, "amber"), (0.95, "red"), (0.81, "red")):
            parts.box((0.12, 0.04, 0.12), (x, rear_end - 0.002, 0.74), pw.lamp(colour), bevel_m=0.015)
        parts.box((0.50, 0.012, 0.40), (0.90, rear_axles_y[-1] - 0.78, 0.36), wheels.rubber(), bevel_m=0.0)
    parts.matrix = Matrix.Identity(4)


def side_guards(parts: Parts, y0: float, y1: float) -> None:
    """Add guard rails between the axles, from ``y0`` to ``y1`` on both sides."""
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        for z in (0.50, 0.80):
            parts.box((0.03, y1 - y0, 0.12), (1.17, (y0 + y1) / 2, z), fittings.aluminium())
        for k in range(3):
            parts.box((0.05, 0.05, 0.62), (1.14, y0 + 0.15 + (y1 - y0 - 0.3) * k / 2, 0.76), chassis_paint())
    parts.matrix = Matrix.Identity(4)


def tank_and_boxes(parts: Parts, y: float) -> None:
    """Add the fuel tank on the right, and the battery and air boxes on the left, behind the cab."""
    parts.prism(
        [(0.62, 0.42), (1.16, 0.42), (1.20, 0.48), (1.20, 0.90), (1.14, 0.96), (0.62, 0.96)],
        y - 1.1,
        y,
        fittings.aluminium(),
        axis="Y",
        bevel_m=0.03,
        segments=2,
    )
    for k in (0.25, 0.85):
        parts.box((0.60, 0.05, 0.57), (0.915, y - k, 0.69), chassis_paint(), bevel_m=0.02)
    parts.lathe([(0.05, 0), (0.05, 0.05), (0.03, 0.06)], (0.9, y - 0.55, 0.955), pw.black_trim())
    parts.box((0.55, 0.70, 0.45), (-0.90, y - 0.35, 0.70), chassis_paint(), bevel_m=0.03)
    parts.lathe([(0.02, -0.32), (0.13, -0.29), (0.13, 0.29), (0.02, 0.32)], (-0.98, y - 1.06, 0.62), chassis_paint(), axis="Y")
