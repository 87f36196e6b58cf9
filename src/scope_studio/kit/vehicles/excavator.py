"""A tracked excavator with a movable arm."""

from __future__ import annotations

import math

from mathutils import Matrix, Vector

from scope_studio.kit.core.parts import Parts, Point, Point2D
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings
from scope_studio.kit.vehicles import paintwork as pw


def _rotated_frame(origin: Point, degrees: float) -> Matrix:
    """Return a frame at ``origin`` that is rotated about x. Positive angles tilt its +y axis upwards."""
    return Matrix.Translation(origin) @ Matrix.Rotation(math.radians(degrees), 4, "X")


def _cylinder(parts: Parts, start: Vector, end: Vector, radius: float, barrel_fraction: float) -> None:
    """Add a hydraulic cylinder: a painted barrel from ``start`` and a chromed rod to ``end``.

    ``barrel_fraction`` is the length of the barrel divided by the total length.
    """
    joint = start + (end - start) * barrel_fraction
    parts.tube([tuple(start), tuple(joint)], radius, pw.paint_slot(), sides=12)
    parts.tube(
        [tuple(start + (end - start) * (barrel_fraction - 0.03)), tuple(start + (end - start) * (barrel_fraction + 0.005))],
        radius * 1.2,
        fittings.iron(),
        sides=12,
    )
    parts.tube([tuple(joint), tuple(end)], radius * 0.55, fittings.chrome(), sides=12)
    for eye in (start, end):
        parts.disc(radius * 1.05, -radius, radius, tuple(eye), fittings.iron(), axis="X", steps=12)


def _track(parts: Parts, x: float, length: float, height: float, width: float) -> None:
    """Add a crawler track around its sprocket, idler wheel and rollers."""
    radius, reach = height / 2, length / 2 - height / 2
    straight, bend = 2 * reach, math.pi * radius
    total = 2 * (straight + bend)
    shoes = 46
    outer = parts.matrix.copy()
    for k in range(shoes):
        distance = total * k / shoes
        if distance < straight:
            y, z, a = -reach + distance, 0.0, 0.0
        elif distance < straight + bend:
            a = (distance - straight) / radius
            y, z = reach + radius * math.sin(a), radius - radius * math.cos(a)
        elif distance < 2 * straight + bend:
            y, z, a = reach - (distance - straight - bend), height, math.pi
        else:
            a = math.pi + (distance - 2 * straight - bend) / radius
            y, z = -reach + radius * math.sin(a), radius - radius * math.cos(a)
        parts.matrix = outer @ Matrix.Translation((x, y, z)) @ Matrix.Rotation(a, 4, "X")
        parts.box((width, total / shoes * 0.90, 0.03), (0, 0, 0.035), fittings.worn_steel(), bevel_m=0.004)
        for rib in (-0.3, 0.3):
            parts.box((width, 0.018, 0.035), (0, rib * total / shoes, 0.014), fittings.worn_steel(), bevel_m=0.004)
        parts.box((width * 0.30, total / shoes * 0.98, 0.06), (0, 0, 0.075), fittings.iron(), bevel_m=0.01)
    parts.matrix = outer
    frame: list[Point2D] = [
        (-reach, height * 0.36),
        (reach, height * 0.36),
        (reach + 0.05, height * 0.6),
        (reach - 0.5, height * 0.76),
        (-reach + 0.4, height * 0.76),
        (-reach, height * 0.6),
    ]
    parts.prism(frame, x - width * 0.36, x + width * 0.36, fittings.iron(), bevel_m=0.02)
    for y, teeth in ((reach, 0), (-reach, 18)):
        parts.disc(radius - 0.10, x - 0.13, x + 0.13, (0, y, radius), fittings.iron(), steps=28)
        parts.disc(radius * 0.55, x - 0.24, x + 0.24, (0, y, radius), pw.paint_slot(), steps=24)
        parts.disc(radius * 0.25, x - 0.27, x + 0.27, (0, y, radius), fittings.iron(), steps=16)
        for k in range(teeth):
            t = 2 * math.pi * k / teeth
            parts.box(
                (0.06, 0.05, 0.05),
                (x, y + (radius - 0.09) * math.cos(t), radius + (radius - 0.09) * math.sin(t)),
                fittings.iron(),
                bevel_m=0.01,
            )
    for k in range(7):
        y = -reach + 0.35 + (2 * reach - 0.7) * k / 6
        parts.disc(0.10, x - width * 0.38, x + width * 0.38, (0, y, 0.19), fittings.iron(), steps=16)


def _cab(parts: Parts, x0: float, x1: float, y0: float, y1: float, z0: float, z1: float) -> None:
    """Add a glazed operator's cab with painted pillars, a black roof edge and a sill at seat height."""
    paint, glass, trim = pw.paint_slot(), pw.glass(), pw.black_trim()
    profile: list[Point2D] = [
        (y0, z0),
        (y1 - 0.10, z0),
        (y1, z0 + 0.55),
        (y1 - 0.04, z0 + 0.9),
        (y1 - 0.28, z1 - 0.05),
        (y1 - 0.42, z1),
        (y0 + 0.06, z1),
        (y0, z1 - 0.08),
    ]
    parts.prism(profile, x0, x1, paint, bevel_m=0.045, segments=2, smooth=True)
    upper: list[Point2D] = [
        (y0 + 0.52, z0 + 0.70),
        (y1 - 0.08, z0 + 0.70),
        (y1 - 0.10, z0 + 0.92),
        (y1 - 0.32, z1 - 0.12),
        (y0 + 0.52, z1 - 0.12),
    ]
    rear: list[Point2D] = [(y0 + 0.10, z0 + 0.78), (y0 + 0.44, z0 + 0.78), (y0 + 0.44, z1 - 0.14), (y0 + 0.10, z1 - 0.14)]
    lower: list[Point2D] = [(y0 + 0.56, z0 + 0.18), (y1 - 0.16, z0 + 0.18), (y1 - 0.08, z0 + 0.62), (y0 + 0.56, z0 + 0.62)]
    for x, out in ((x0, -1), (x1, 1)):
        for shape, material, lift in ((upper, glass, 0.006), (rear, glass, 0.006), (lower, glass, 0.004)):
            low, high = sorted((x - out * 0.02, x + out * lift))
            middle = (sum(p[0] for p in shape) / len(shape), sum(p[1] for p in shape) / len(shape))
            grown = [(a + math.copysign(0.03, a - middle[0]), b + math.copysign(0.03, b - middle[1])) for a, b in shape]
            parts.prism(grown, min(low, x), max(x + out * (lift - 0.003), x), trim)
            parts.prism(shape, low, high, material)
        parts.box((0.03, 0.05, 0.9), (x + out * 0.02, y0 + 0.49, z0 + 0.9), trim)
        parts.tube(
            [(x + out * 0.05, y1 - 0.16, z0 + 0.5), (x + out * 0.06, y1 - 0.13, z0 + 1.1)],
            0.014,
            fittings.iron(),
            sides=6,
        )
    low_front, high_front = Vector((0, y1 - 0.02, z0 + 0.72)), Vector((0, y1 - 0.29, z1 - 0.14))
    middle = (low_front + high_front) / 2
    span = high_front - low_front
    outer = parts.matrix.copy()
    parts.matrix = (
        outer
        @ Matrix.Translation(middle + Vector(((x0 + x1) / 2, 0.015, 0)))
        @ Matrix.Rotation(math.atan2(-span.y, span.z), 4, "X")
    )
    parts.box((x1 - x0 - 0.08, 0.02, span.length + 0.04), (0, -0.005, 0), trim, bevel_m=0.006)
    parts.box((x1 - x0 - 0.14, 0.02, span.length - 0.03), (0, 0.004, 0), glass, bevel_m=0.006)
    parts.tube([(0.05, 0.025, -span.length / 2), (-0.22, 0.028, span.length * 0.15)], 0.010, trim, sides=4)
    parts.matrix = outer
    parts.prism(
        [(y1 - 0.085, z0 + 0.12), (y1 - 0.02, z0 + 0.50), (y1 + 0.012, z0 + 0.50), (y1 - 0.05, z0 + 0.12)],
        x0 + 0.12,
        x1 - 0.12,
        glass,
    )
    parts.box((x1 - x0 - 0.16, 0.02, 0.75), ((x0 + x1) / 2, y0 - 0.004, z1 - 0.62), glass)
    parts.box((x1 - x0 + 0.04, y1 - y0 - 0.36, 0.05), ((x0 + x1) / 2, (y0 + y1) / 2 - 0.14, z1 + 0.015), trim, bevel_m=0.02)


def excavator(
    colour: str,
    *,
    number: str,
    boom_deg: float = 52.0,
    stick_deg: float = -68.0,
    bucket_deg: float = -70.0,
    slew_deg: float = 0.0,
) -> Built:
    """Build a 20-tonne tracked excavator. Its tracks are 3.9 m long and parallel to y.

    Args:
        colour: Name of the paint.
        number: Fleet number, lettered on both sides and at the rear.
        boom_deg: Elevation of the lower part of the boom.
        stick_deg, bucket_deg: Elevations of stick and bucket. Negative values point down; values below -90 point back towards
            the cab.
        slew_deg: Rotation of the upper structure, clockwise as seen from above.
    """
    parts = Parts()
    parts.slot(pw.paint_slot())
    for sign in (-1, 1):
        _track(parts, sign * 1.10, 3.9, 0.88, 0.58)
    parts.box((1.7, 1.5, 0.34), (0, 0, 0.66), fittings.iron(), bevel_m=0.05)
    parts.lathe([(0.62, 0.80), (0.62, 1.02)], (0, 0, 0), fittings.iron(), steps=32)
    upper = Matrix.Rotation(-math.radians(slew_deg), 4, "Z")
    parts.matrix = upper
    _upper_works(parts)
    _arm(parts, upper, boom_deg, stick_deg, bucket_deg)
    letters = []
    for sign, facing in ((1, "+X"), (-1, "-X")):
        letters.append(bw.text_line(number, 0.26, (sign * 1.255, -1.10, 1.64), facing, "black", width_m=0.80))
    letters.append(bw.text_line(number, 0.30, (0, -2.304, 1.62), "-Y", "black", width_m=1.3))
    for line in letters:
        mark = line.mark
        line.points = [tuple(upper @ Vector(p)) for p in line.points]
        mark.centre, mark.right, mark.up = (tuple(upper @ Vector(v)) for v in (mark.centre, mark.right, mark.up))
    return bw.finish("excavator", parts.build("excavator"), [fittings.machine_paint("excavator", colour)], letters)


def _upper_works(parts: Parts) -> None:
    paint, iron = pw.paint_slot(), fittings.iron()
    parts.box((2.46, 3.3, 0.16), (0, -0.30, 1.10), iron, bevel_m=0.03)
    counterweight = [(1.22 * math.sin(a) if abs(math.sin(a)) < 0.999 else math.copysign(1.22, math.sin(a)),
                      -1.62 - 0.68 * max(0.0, math.cos(a)) ** 0.4)
                     for a in (math.pi * (-0.5 + k / 12) for k in range(13))]  # fmt: skip
    parts.prism(counterweight, 1.08, 1.98, paint, axis="Z", bevel_m=0.06, segments=2)
    parts.box((2.2, 0.02, 0.05), (0, -2.26, 1.16), pw.black_trim())
    parts.box((1.10, 1.9, 0.86), (0.70, -0.70, 1.60), paint, bevel_m=0.06)
    parts.box((1.10, 1.0, 0.86), (-0.70, -1.15, 1.60), paint, bevel_m=0.06)
    parts.box((0.9, 1.0, 0.72), (0, -1.1, 1.55), paint, bevel_m=0.04)
    parts.box((1.0, 1.2, 0.10), (0.25, -1.2, 2.06), paint, bevel_m=0.04)
    parts.box((1.02, 0.95, 0.62), (0.72, 0.75, 1.46), paint, bevel_m=0.05)
    parts.tube([(-0.4, -1.35, 2.0), (-0.4, -1.35, 2.35), (-0.4, -1.45, 2.45)], 0.05, iron, sides=10)
    for k in range(7):
        parts.box((0.012, 0.55, 0.02), (1.252, -0.22, 1.36 + 0.075 * k), pw.black_trim(), bevel_m=0.0)
    for side, y0, y1 in ((1.22, -1.55, 1.15), (-1.22, -1.6, -0.7)):
        rail: list[Point] = [
            (side, y0, 2.02),
            (side, y0, 2.36),
            (side, y1, 2.36),
            (side, y1, 1.8 if side > 0 else 2.02),
        ]
        parts.tube(rail, 0.02, iron, sides=6)
        parts.tube([(side, (y0 + y1) / 2, 1.9), (side, (y0 + y1) / 2, 2.36)], 0.016, iron, sides=6)
    _cab(parts, -1.24, -0.26, -0.62, 1.22, 1.16, 2.95)
    fittings.beacon(parts, -0.95, -0.40, 2.98)
    for x in (-1.10, -0.42):
        parts.box((0.14, 0.08, 0.10), (x, 0.82, 3.02), pw.lamp("white"), bevel_m=0.02)
    parts.tube([(-1.26, 1.0, 2.3), (-1.50, 1.12, 2.35)], 0.012, iron, sides=6)
    parts.box((0.20, 0.05, 0.32), (-1.52, 1.12, 2.28), pw.black_trim(), bevel_m=0.02)
    parts.tube([(1.2, 1.0, 1.8), (1.36, 1.1, 2.2)], 0.012, iron, sides=6)
    parts.box((0.18, 0.05, 0.28), (1.38, 1.1, 2.25), pw.black_trim(), bevel_m=0.02)


_BOOM, _STICK = 5.5, 2.8
"""Lengths of boom and stick in metres."""


def _arm(parts: Parts, upper: Matrix, boom_deg: float, stick_deg: float, bucket_deg: float) -> None:
    """Add boom, stick and bucket with their cylinders, in the plane x = 0.12 of the upper structure."""
    paint, iron = pw.paint_slot(), fittings.iron()
    x, foot = 0.12, Vector((0.12, 0.85, 1.75))
    for side in (-0.34, 0.34):
        parts.prism(
            [(0.4, 1.1), (1.35, 1.1), (1.15, 1.6), (1.0, 1.95), (0.72, 1.95)],
            x + side - 0.04,
            x + side + 0.04,
            paint,
            bevel_m=0.015,
        )
    chord = _rotated_frame((0, 0, 0), boom_deg - 21.0)
    boom = upper @ Matrix.Translation(foot) @ chord
    parts.matrix = boom
    # The boom is bent: its lower part is steeper than the line between its ends, and its upper part is less steep.
    bend: Point2D = (_BOOM * 0.42, 1.10)
    low: list[Point2D] = [
        (-0.16, -0.18),
        (0.4, -0.05),
        (bend[0] - 0.05, bend[1] - 0.42),
        (bend[0] + 0.5, bend[1] - 0.40),
        (_BOOM, -0.16),
    ]
    high: list[Point2D] = [
        (_BOOM + 0.16, 0.06),
        (_BOOM, 0.22),
        (bend[0] + 0.8, bend[1] + 0.18),
        (bend[0] + 0.1, bend[1] + 0.28),
        (bend[0] - 0.5, bend[1] + 0.02),
        (-0.1, 0.22),
        (-0.22, 0.05),
    ]
    parts.prism(low + high, -0.19, 0.19, paint, bevel_m=0.02)
    parts.disc(0.16, -0.30, 0.30, (0, 0, 0), iron, steps=16)
    parts.disc(0.13, -0.27, 0.27, (0, _BOOM, 0), iron, steps=16)
    for hose in (-0.10, -0.03, 0.04, 0.11):
        parts.tube(
            [
                (hose, 0.1, 0.32),
                (hose, bend[0] - 0.5, bend[1] + 0.08),
                (hose, bend[0] + 0.1, bend[1] + 0.34),
                (hose, bend[0] + 0.8, bend[1] + 0.24),
                (hose, _BOOM - 0.3, 0.32),
            ],
            0.022,
            iron,
            sides=6,
        )
    lug_world = boom @ Vector((0, bend[0] - 0.1, bend[1] - 0.18))
    back_lug = boom @ Vector((0, bend[0] + 0.2, bend[1] + 0.42))
    nose = boom @ Vector((0, _BOOM, 0))
    parts.prism(
        [(bend[0] - 0.1, bend[1] + 0.2), (bend[0] + 0.5, bend[1] + 0.2), (bend[0] + 0.22, bend[1] + 0.52)],
        -0.12,
        0.12,
        paint,
        bevel_m=0.01,
    )
    parts.box((0.10, 0.08, 0.10), (0.24, bend[0] + 0.3, bend[1] - 0.05), pw.lamp("white"), bevel_m=0.02)
    stick = Matrix.Translation(nose) @ upper.to_3x3().to_4x4() @ _rotated_frame((0, 0, 0), stick_deg)
    parts.matrix = stick
    parts.prism(
        [
            (-0.75, 0.34),
            (-0.55, 0.46),
            (0.3, 0.36),
            (_STICK, 0.14),
            (_STICK + 0.12, 0.0),
            (_STICK, -0.13),
            (0.2, -0.22),
            (-0.15, -0.14),
            (-0.6, 0.18),
        ],
        -0.16,
        0.16,
        paint,
        bevel_m=0.02,
    )
    tail = stick @ Vector((0, -0.62, 0.32))
    tip = stick @ Vector((0, _STICK, 0))
    heel = stick @ Vector((0, 0.15, 0.42))
    crank = stick @ Vector((0, _STICK - 0.42, 0.30))
    parts.disc(0.11, -0.26, 0.26, (0, _STICK, 0), iron, steps=14)
    bucket = Matrix.Translation(tip) @ upper.to_3x3().to_4x4() @ _rotated_frame((0, 0, 0), bucket_deg)
    parts.matrix = bucket
    _bucket(parts)
    ear = bucket @ Vector((0, 0.10, 0.36))
    parts.matrix = Matrix.Identity(4)
    for side in (-0.34, 0.34):
        shift = upper.to_3x3() @ Vector((side, 0, 0))
        _cylinder(parts, upper @ Vector((x, 1.30, 1.28)) + shift, lug_world + shift, 0.09, 0.62)
    _cylinder(parts, back_lug, tail, 0.095, 0.6)
    link = (crank + ear) / 2 + stick.to_3x3() @ Vector((0, 0.05, 0.28))
    _cylinder(parts, heel, link, 0.08, 0.6)
    for start in (crank, ear):
        for side in (-0.20, 0.20):
            shift = upper.to_3x3() @ Vector((side, 0, 0))
            parts.tube([tuple(start + shift), tuple(link + shift)], 0.06, iron, sides=4)
    parts.matrix = Matrix.Identity(4)


def _bucket(parts: Parts) -> None:
    """Add a digging bucket that hangs from the origin.

    It opens towards -z, which is towards the cab when the bucket points down.
    """
    wear, half = fittings.worn_steel(), 0.62
    spine: list[Point2D] = [(0.05, 0.34), (0.35, 0.46), (0.75, 0.42), (1.08, 0.20), (1.22, -0.10), (1.22, -0.48)]
    inside: list[Point2D] = [(1.17, -0.46), (1.16, -0.09), (1.03, 0.16), (0.73, 0.36), (0.36, 0.40), (0.10, 0.28)]
    for k in range(5):
        parts.prism([spine[k], spine[k + 1], inside[4 - k], inside[5 - k]], -half, half, wear)
    for side in (-half, half):
        parts.prism([*spine, (0.62, -0.50), (0.10, -0.10), (-0.02, 0.10)], side - 0.025, side + 0.025, wear)
        parts.prism([(0.60, -0.52), (1.24, -0.50), (1.24, -0.40), (0.66, -0.40)], side - 0.04, side + 0.04, wear)
    for k in range(5):
        xt = -0.52 + 0.26 * k
        parts.prism([(1.15, -0.38), (1.24, -0.38), (1.25, -0.56), (1.21, -0.72), (1.17, -0.56)], xt - 0.05, xt + 0.05, wear)
    for side in (-0.22, 0.22):
        parts.prism([(-0.12, 0.0), (0.0, -0.13), (0.35, 0.35), (0.42, 0.50), (0.10, 0.48)], side - 0.03, side + 0.03, wear)
