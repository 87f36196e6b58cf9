"""Articulated lorries: tractor units and trailers (curtain-sided, box, skeletal with a container).

The tractor's fifth wheel is at y = ``COUPLING_Y`` in the tractor's coordinates. A trailer's origin is at half its length,
and its front faces +y.
"""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix, Vector

from scope_studio.kit.core import shading
from scope_studio.kit.core.finishes import glow
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings, wheels
from scope_studio.kit.vehicles import lorry_chassis as chassis
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.yard.containers import LENGTH_M, container

TRAILER_LENGTH_M = 13.6
"""Length of a trailer in metres."""
_FRONT, _REAR = 3.10, -2.75
"""y coordinates of the front and the rear of the tractor in metres."""
COUPLING_Y = -1.25
"""y coordinate in metres of the trailer's kingpin, in the tractor's coordinates."""
KINGPIN_SETBACK_M = 1.25
"""Distance in metres between a trailer's front and its kingpin."""


def _tractor_parts() -> Parts:
    parts = Parts()
    parts.slot(pw.paint_slot(0))
    chassis.running_gear(parts, 1.75, [-1.75], _REAR, _FRONT - 0.1)
    chassis.cab(parts, _FRONT, depth=2.15, top=3.02)
    chassis.tank_and_boxes(parts, 0.75)
    sleeper: list[Point2D] = [
        (0.95, 2.98),
        (_FRONT - 0.55, 3.0),
        (_FRONT - 0.42, 3.10),
        (_FRONT - 0.75, 3.55),
        (1.35, 3.82),
        (0.95, 3.82),
    ]
    parts.prism(sleeper, -1.12, 1.12, pw.paint_slot(0), bevel_m=0.08, segments=2, smooth=True)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        parts.prism([(0.93, 1.05), (0.93, 3.6), (0.35, 3.3), (0.35, 1.05)], 1.13, 1.17, pw.paint_slot(0), bevel_m=0.01)
        parts.box((0.03, 0.16, 0.05), (1.20, 2.2, 3.0), pw.lamp("amber"), bevel_m=0.01)
    parts.matrix = Matrix.Identity(4)
    dark = chassis.chassis_paint()
    parts.disc(0.48, 1.10, 1.18, (0, COUPLING_Y, 0), dark, axis="Z", steps=28)
    parts.box((0.9, 1.0, 0.10), (0, COUPLING_Y, 1.06), dark)
    parts.box((1.9, 0.9, 0.02), (0, 0.1, 1.08), fittings.aluminium())
    for x in (-0.28, 0.0, 0.28):
        parts.tube([(x, 0.85, 2.0), (x, 0.6, 1.5), (x * 0.6, 0.2, 1.45), (x * 0.4, -0.15, 1.9)], 0.018, pw.black_trim(), sides=6)
    return parts


def tractor(colour: str, *, plate: str, name: str | None = None, lit: bool = False) -> Built:
    """Build a two-axle tractor unit with a high sleeper cab, 5.9 m long.

    ``name`` is the lettering above the windscreen. ``lit`` turns on the headlamps and marker lamps.
    """
    extra_parts, letters = bw.number_plates(plate, (_FRONT + 0.14, 0.60), (_REAR - 0.03, 0.98))
    if name:
        letters.append(bw.text_line(name, 0.19, (0, _FRONT - 0.445, 3.20), "+Y", fittings.lettering_colour(colour), width_m=1.9))
    if lit:
        for sign in (-1, 1):
            extra_parts.box((0.26, 0.03, 0.12), (sign * 0.88, _FRONT + 0.145, 0.72), glow("cream", 9.0), bevel_m=0.02)
            extra_parts.box((0.10, 0.03, 0.05), (sign * 0.75, _FRONT - 0.62, 3.60), glow("amber", 5.0), bevel_m=0.01)
    return bw.finish(
        "tractor unit",
        bw.body_mesh("tractor unit", _tractor_parts),
        [pw.paint("lorry cab", colour, dirt_top_m=1.2)],
        letters,
        extra_parts,
    )


def _bogie(parts: Parts, *, bed_m: float) -> None:
    """Add the parts below the bed of a trailer: frame, three axles, landing legs, guards, bumper bar and lamps.

    ``bed_m`` is the height of the bed's underside.
    """
    half, dark = TRAILER_LENGTH_M / 2, chassis.chassis_paint()
    for x in (-0.46, 0.46):
        parts.box((0.10, TRAILER_LENGTH_M - 0.3, 0.32), (x, 0, bed_m - 0.17), dark)
    for k in range(12):
        parts.box((2.40, 0.06, 0.10), (0, -half + 0.6 + 1.12 * k, bed_m - 0.06), dark)
    for k in range(3):
        y = -half + 2.1 + 1.32 * k
        parts.tube([(-0.95, y, 0.5), (0.95, y, 0.5)], 0.075, dark)
        for sign in (-1, 1):
            wheels.lorry_wheel(parts, (sign * 1.05, y, 0.50), 0.50, sign, twin=False)
    chassis.mudguard(parts, -half + 2.1, 0.52, 0.84, 1.22, dark)
    chassis.mudguard(parts, -half + 4.74, 0.52, 0.84, 1.22, dark)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        parts.box((0.12, 0.14, bed_m - 0.12), (0.75, half - 3.1, (bed_m - 0.12) / 2 + 0.10), dark)
        parts.box((0.30, 0.34, 0.05), (0.75, half - 3.1, 0.06), dark)
        for z in (0.58, 0.92):
            parts.box((0.03, 4.6, 0.10), (1.19, 0.6, z), fittings.aluminium())
        for y in (-1.4, 0.6, 2.6):
            parts.box((0.05, 0.05, 0.6), (1.16, y, 0.85), dark)
        parts.box((0.44, 0.06, 0.16), (0.96, -half + 0.02, 0.80), wheels.shade(), bevel_m=0.01)
        for x, colour in ((1.09, "amber"), (0.95, "red"), (0.81, "red")):
            parts.box((0.12, 0.04, 0.12), (x, -half - 0.012, 0.80), pw.lamp(colour), bevel_m=0.015)
        for y in (-5.2, -2.4, 0.4, 3.2, 6.0):
            parts.box((0.02, 0.10, 0.04), (1.25, y, bed_m - 0.04), pw.lamp("amber"), bevel_m=0.005)
        parts.box((0.5, 0.012, 0.36), (0.95, -half + 1.35, 0.36), wheels.rubber(), bevel_m=0.0)
    parts.matrix = Matrix.Identity(4)
    parts.box((2.30, 0.10, 0.14), (0, -half + 0.06, 0.60), fittings.aluminium())
    parts.disc(0.05, bed_m - 0.18, bed_m - 0.02, (0, half - KINGPIN_SETBACK_M, 0), fittings.iron(), axis="Z", steps=12)
    parts.box((0.9, 0.4, 0.5), (-0.6, 1.6, bed_m - 0.45), dark)


def _body_parts(kind: str) -> Parts:
    parts = Parts()
    parts.slot(pw.paint_slot(0))
    bed, top, half = 1.22, 4.0, TRAILER_LENGTH_M / 2
    _bogie(parts, bed_m=bed)
    rail = fittings.aluminium()
    finish = pw.paint_slot(0) if kind == "box" else _curtain()
    parts.box((2.54, TRAILER_LENGTH_M, 0.14), (0, 0, bed + 0.03), chassis.chassis_paint(), bevel_m=0.02)
    parts.box((2.50, 0.10, top - bed), (0, half - 0.05, (top + bed) / 2), pw.paint_slot(0), bevel_m=0.02)
    parts.box((2.50, TRAILER_LENGTH_M, 0.08), (0, 0, top), shading.plain("trailer roof", (0.42, 0.43, 0.43), 0.6), bevel_m=0.02)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        if kind == "box":
            parts.box((0.06, TRAILER_LENGTH_M - 0.1, top - bed - 0.1), (1.23, 0, (top + bed) / 2), pw.paint_slot(0), bevel_m=0.01)
        else:
            _curtain_side(parts, bed + 0.10, top - 0.16, half, finish)
            for k in range(18):
                y = -half + 0.55 + 0.735 * k
                parts.box((0.012, 0.05, 0.42), (1.268, y, bed + 0.14), wheels.shade(), bevel_m=0.0)
                parts.box((0.02, 0.06, 0.05), (1.27, y, bed + 0.02), rail, bevel_m=0.005)
        parts.box((0.05, TRAILER_LENGTH_M, 0.16), (1.25, 0, top - 0.05), rail, bevel_m=0.01)
        parts.box((0.05, TRAILER_LENGTH_M, 0.10), (1.255, 0, bed + 0.02), rail, bevel_m=0.01)
        for y in (-half + 0.05, half - 0.05):
            parts.box((0.10, 0.10, top - bed), (1.21, y, (top + bed) / 2), rail, bevel_m=0.02)
        parts.box((1.20, 0.06, top - bed - 0.16), (0.61, -half - 0.01, (top + bed) / 2 + 0.02), pw.paint_slot(0), bevel_m=0.012)
        for x in (0.22, 0.92):
            parts.tube([(x, -half - 0.075, bed), (x, -half - 0.075, top - 0.05)], 0.018, rail, sides=6)
            parts.box((0.22, 0.03, 0.05), (x - 0.05, -half - 0.07, 2.1), rail, bevel_m=0.005)
            for z in (1.45, 2.6, 3.75):
                parts.box((0.09, 0.05, 0.07), (x, -half - 0.06, z), rail, bevel_m=0.005)
        for z in (1.5, 2.2, 2.9, 3.6):
            parts.box((0.14, 0.05, 0.07), (1.16, -half - 0.045, z), rail, bevel_m=0.005)
        parts.box(
            (0.06, 0.02, top - bed - 0.2),
            (1.21, -half - 0.055, (top + bed) / 2),
            shading.plain("trailer conspicuity", (0.5, 0.02, 0.02), 0.4),
            bevel_m=0.0,
        )
        parts.box((0.10, 0.04, 0.08), (1.10, -half - 0.05, top - 0.08), pw.lamp("red"), bevel_m=0.01)
    parts.matrix = Matrix.Identity(4)
    parts.box((0.02, 0.02, top - bed - 0.2), (0, -half - 0.045, (top + bed) / 2), wheels.shade(), bevel_m=0.0)
    if kind == "box":
        parts.box((1.5, 0.42, 0.9), (0, half + 0.20, 3.2), shading.plain("chiller", (0.55, 0.56, 0.56), 0.4), bevel_m=0.05)
        for k in range(7):
            parts.box((1.1, 0.02, 0.05), (0, half + 0.42, 2.95 + 0.09 * k), wheels.shade(), bevel_m=0.0)
    return parts


def _curtain_side(parts: Parts, z0: float, z1: float, half: float, finish: bpy.types.Material) -> None:
    """Add a taut curtain along the right-hand side, with shallow folds between its straps."""
    steps = 120
    points, faces = [], []
    for k in range(steps + 1):
        y = -half + 0.1 + (2 * half - 0.2) * k / steps
        wave = 0.008 * ((k % 6) - 3) / 3 * (1 if k % 12 < 6 else -1)
        for z, amount in ((z0, 0.3), ((z0 + z1) / 2, 1.0), (z1, 0.3)):
            points.append((1.252 + wave * amount, y, z))
    for k in range(steps):
        for r in range(2):
            a = 3 * k + r
            faces.append((a, a + 3, a + 4, a + 1))
    parts.add(points, faces, finish, smooth=True)


def _curtain() -> bpy.types.Material:
    """Return the placeholder material of the curtains."""
    return pw.paint_slot(1)


def trailer(colour: str, *, kind: str = "curtain", lettering: str, plate: str, front: str = "white") -> Built:
    """Build a 13.6 m semi-trailer: with coloured curtains if ``kind`` is "curtain", or refrigerated if ``kind`` is "box".

    ``front`` is the colour of the front wall and the doors of a trailer with curtains.
    """
    model = f"{kind} trailer"
    body = bw.body_mesh(model, lambda: _body_parts(kind))
    extra_parts, letters = Parts(), []
    _, plate_letters = bw.number_plates(plate, (90.0, 0.60), (-TRAILER_LENGTH_M / 2 - 0.045, 1.02))
    face = shading.plain("number plate yellow", (0.86, 0.52, 0.01), 0.35)
    extra_parts.box((0.52, 0.012, 0.111), (0, -TRAILER_LENGTH_M / 2 - 0.045, 1.02), face, bevel_m=0.003)
    letters.append(plate_letters[1])
    tint = fittings.lettering_colour(colour)
    letters += bw.text_on_both_sides(lettering, 0.72, 0.0, 2.72, tint, x=1.268, width_m=11.0)
    letters.append(
        bw.text_line(
            lettering,
            0.22,
            (0, -TRAILER_LENGTH_M / 2 - 0.05, 3.35),
            "-Y",
            fittings.lettering_colour(front if kind == "curtain" else colour),
            width_m=2.0,
        )
    )
    paints = [pw.paint("trailer ends", front if kind == "curtain" else colour, dirt_top_m=1.9, dirt=0.4)]
    if kind == "curtain":
        paints.append(pw.paint("trailer curtain", colour, dirt_top_m=2.3, dirt=0.45, gloss=0.1))
    return bw.finish(model, body, paints, letters, extra_parts)


def skeletal(code: str, colour: str, *, livery: str | None = None, plate: str, feet: int = 40) -> Built:
    """Build a skeletal trailer that carries a container with its doors to the rear."""
    mesh = bw.body_mesh("skeletal trailer", _skeletal_parts)
    extra_parts, letters = Parts(), []
    _, plate_letters = bw.number_plates(plate, (90.0, 0.60), (-TRAILER_LENGTH_M / 2 - 0.045, 1.02))
    extra_parts.box(
        (0.52, 0.012, 0.111),
        (0, -TRAILER_LENGTH_M / 2 - 0.045, 1.02),
        shading.plain("number plate yellow", (0.86, 0.52, 0.01), 0.35),
        bevel_m=0.003,
    )
    letters.append(plate_letters[1])
    built = bw.finish("skeletal trailer", mesh, [], letters, extra_parts)
    load = container(colour, code, feet=feet, livery=livery)
    transform = Matrix.Translation((0, -TRAILER_LENGTH_M / 2 + LENGTH_M[feet] / 2 + 0.25, 1.24)) @ Matrix.Rotation(math.pi, 4, "Z")
    for obj in load.objects:
        obj.data.transform(transform)
        obj.parent = built.root
    marks = []
    for mark in load.texts:
        marks.append(
            type(mark)(
                mark.text,
                tuple(transform @ Vector(mark.centre)),
                tuple(transform.to_3x3() @ Vector(mark.right)),
                mark.up,
                mark.width_m,
                mark.height_m,
                mark.cap_height_m,
            )
        )
    bpy.data.objects.remove(load.root)
    return Built(built.root, [*built.objects, *load.objects], [*built.texts, *marks])


def _skeletal_parts() -> Parts:
    parts = Parts()
    _bogie(parts, bed_m=1.22)
    for y in (-TRAILER_LENGTH_M / 2 + 0.35, -0.3, TRAILER_LENGTH_M / 2 - 0.5):
        parts.box((2.44, 0.22, 0.16), (0, y, 1.15), chassis.chassis_paint())
    return parts
