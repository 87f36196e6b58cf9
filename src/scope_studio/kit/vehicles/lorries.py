"""Rigid lorries: box lorry, tipper and tanker."""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings, wheels
from scope_studio.kit.vehicles import lorry_chassis as chassis
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles.paintwork import Patch


def _box_parts() -> Parts:
    parts = Parts()
    parts.slot(pw.paint_slot(0))
    parts.slot(pw.paint_slot(1))
    chassis.running_gear(parts, 2.35, [-2.35], -4.25, 3.6)
    chassis.cab(parts, 3.72)
    chassis.tank_and_boxes(parts, 1.55)
    chassis.side_guards(parts, -1.55, 0.35)
    box = pw.paint_slot(1)
    parts.box((2.48, 6.10, 2.55), (0, -1.20, 2.42), box, bevel_m=0.03)
    rail, dark = fittings.aluminium(), chassis.chassis_paint()
    parts.box((2.30, 6.0, 0.12), (0, -1.20, 1.10), dark)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        for z in (1.17, 3.66):
            parts.box((0.03, 6.14, 0.09), (1.24, -1.20, z), rail)
        for y in (-4.24, 1.84):
            parts.box((0.07, 0.07, 2.56), (1.22, y, 2.42), rail, bevel_m=0.02)
        parts.box((0.02, 0.02, 2.40), (0.012, -4.262, 2.42), wheels.shade(), bevel_m=0.0)
        for x in (0.18, 0.85):
            parts.tube([(x, -4.285, 1.25), (x, -4.285, 3.60)], 0.017, rail, sides=6)
            parts.box((0.10, 0.03, 0.05), (x, -4.275, 2.0), rail)
        for z in (1.45, 2.1, 2.75, 3.4):
            parts.box((0.16, 0.025, 0.06), (1.12, -4.268, z), rail)
        parts.box((0.10, 0.04, 0.10), (1.17, -4.25, 3.60), pw.lamp("red"), bevel_m=0.01)
        for y in (-3.9, -2.6, 0.0, 1.4):
            parts.box((0.02, 0.10, 0.04), (1.262, y, 1.10), pw.lamp("amber"), bevel_m=0.005)
    parts.matrix = Matrix.Identity(4)
    fairing: list[Point2D] = [(1.90, 2.80), (2.95, 2.82), (2.90, 2.95), (2.45, 3.45), (2.05, 3.66), (1.90, 3.66)]
    parts.prism(fairing, -1.10, 1.10, pw.paint_slot(0), bevel_m=0.07, segments=2, smooth=True)
    parts.box((2.40, 0.05, 0.10), (0, -4.27, 1.17), dark)
    return parts


_SEAMS = [Patch((0.22, 0.22, 0.22), x=(1.2, 9), y=(y - 0.006, y + 0.006), roughness=0.6) for y in (-3.2, -2.2, -1.2, -0.2, 0.8)]


def box_lorry(cab_colour: str, box_colour: str, *, plate: str, lettering: str) -> Built:
    """Build a two-axle rigid lorry, 8 m long, with a box body and barn doors.

    ``lettering`` is on both sides and on the doors.
    """
    body = bw.body_mesh("box lorry", _box_parts)
    extra_parts, letters = bw.number_plates(plate, (3.86, 0.60), (-4.30, 0.98))
    tint = fittings.lettering_colour(box_colour)
    letters += bw.text_on_both_sides(lettering, 0.42, -1.2, 2.55, tint, x=1.242, width_m=5.0)
    letters.append(bw.text_line(lettering, 0.16, (0, -4.281, 3.30), "-Y", tint, width_m=0.30 * 7))
    paints = [
        pw.paint("lorry cab", cab_colour, dirt_top_m=1.2),
        pw.paint("lorry box", box_colour, _SEAMS, dirt_top_m=1.9, dirt=0.35),
    ]
    return bw.finish("box lorry", body, paints, letters, extra_parts)


def _tipper_parts() -> Parts:
    parts = Parts()
    parts.slot(pw.paint_slot(0))
    parts.slot(pw.paint_slot(1))
    chassis.running_gear(parts, 2.55, [-1.35, -2.65], -3.95, 3.7)
    chassis.cab(parts, 3.85)
    chassis.tank_and_boxes(parts, 1.75)
    body, dark = pw.paint_slot(1), chassis.chassis_paint()
    floor, top, y0, y1 = 1.30, 2.45, -4.15, 1.65
    parts.box((2.36, y1 - y0, 0.14), (0, (y0 + y1) / 2, floor), body)
    for x in (-0.42, 0.42):
        parts.box((0.12, y1 - y0 - 0.2, 0.16), (x, (y0 + y1) / 2, floor - 0.14), dark)
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        parts.prism([(1.12, floor), (1.18, floor), (1.24, top), (1.16, top)], y0, y1, body, axis="Y")
        parts.box((0.12, y1 - y0 + 0.02, 0.12), (1.21, (y0 + y1) / 2, top), body, bevel_m=0.02)
        for k in range(8):
            y = y0 + 0.06 + (y1 - y0 - 0.12) * k / 7
            parts.prism(
                [(1.16, floor - 0.05), (1.26, floor - 0.05), (1.30, top), (1.20, top)],
                y - 0.05,
                y + 0.05,
                body,
                axis="Y",
                bevel_m=0.01,
            )
        parts.box((0.10, 0.10, 0.14), (1.12, y0 - 0.02, top + 0.05), dark)
    parts.matrix = Matrix.Identity(4)
    parts.box((2.34, 0.08, top - floor + 0.35), (0, y1, (top + floor + 0.35) / 2), body)
    parts.prism(
        [(y1 - 0.04, top + 0.28), (y1 + 0.85, top + 0.55), (y1 + 0.85, top + 0.62), (y1 - 0.04, top + 0.36)],
        -1.17,
        1.17,
        body,
    )
    parts.box((2.30, 0.07, top - floor), (0, y0, (top + floor) / 2), body)
    for x in (-0.8, 0.0, 0.8):
        parts.box((0.12, 0.08, top - floor - 0.08), (x, y0 - 0.05, (top + floor) / 2), body)
    parts.lathe([(0.11, 0.95), (0.11, 2.1), (0.09, 2.1), (0.09, 2.6)], (0, y1 + 0.22, 0), fittings.aluminium(), steps=16)
    _stone_load(parts, y0 + 0.06, y1 - 0.06, top - 0.32)
    return parts


def _stone_load(parts: Parts, y0: float, y1: float, z: float) -> None:
    """Add a heap of crushed stone as the load of a tipper."""
    stone = bpy.data.materials.get("lorry aggregate")
    if stone is None:
        sh = shading.Shader("lorry aggregate")
        cell = sh.voronoi(sh.object_coords(), 16.0, output="Distance")
        tone = sh.mix(sh.ramp(sh.noise(sh.object_coords(), 9.0), 0.3, 0.7), (0.10, 0.085, 0.07), (0.30, 0.27, 0.23))
        stone = sh.surface(
            base_color=sh.mix(sh.ramp(cell, 0.0, 0.6), tone, (0.05, 0.045, 0.04)),
            roughness=0.95,
            normal=sh.bump(cell, 1.0, 0.04),
        )
    nx, ny = 14, 36
    points, faces = [], []
    for i in range(nx + 1):
        for j in range(ny + 1):
            u, v = i / nx, j / ny
            heap = (
                0.42
                * math.sin(math.pi * u)
                * (0.55 + 0.45 * abs(math.sin(2 * math.pi * v * 1.0 + 0.3)))
                * min(1.0, 6 * v, 6 * (1 - v))
            )
            rough = 0.03 * math.sin(37.0 * i + 11.3 * j * j) + 0.02 * math.sin(5.1 * i * j)
            points.append((-1.14 + 2.28 * u, y0 + (y1 - y0) * v, z + heap + rough))
    for i in range(nx):
        for j in range(ny):
            a = i * (ny + 1) + j
            faces.append((a, a + ny + 1, a + ny + 2, a + 1))
    parts.add(points, faces, stone, smooth=True)


def tipper(cab_colour: str, body_colour: str, *, plate: str) -> Built:
    """Build a three-axle tipper loaded with crushed stone, 8 m long."""
    extra_parts, letters = bw.number_plates(plate, (3.99, 0.60), (-3.97, 0.98))
    paints = [
        pw.paint("lorry cab", cab_colour, dirt_top_m=1.2),
        pw.paint("tipper body", body_colour, dirt_top_m=2.2, dirt=0.5),
    ]
    return bw.finish("tipper", bw.body_mesh("tipper", _tipper_parts), paints, letters, extra_parts)


def _tank_outline(margin_m: float = 0.0) -> list[Point2D]:
    """Return the cross-section of the tank, enlarged by ``margin_m`` metres."""
    return [
        ((1.20 + margin_m) * math.cos(a), 2.12 + (0.90 + margin_m) * math.sin(a))
        for a in (2 * math.pi * (k + 0.5) / 40 for k in range(40))
    ]


def _tanker_parts() -> Parts:
    parts = Parts()
    parts.slot(pw.paint_slot(0))
    parts.slot(pw.paint_slot(1))
    chassis.running_gear(parts, 2.75, [-1.35, -2.70], -4.20, 3.9)
    chassis.cab(parts, 4.05)
    chassis.tank_and_boxes(parts, 1.90)
    y0, y1 = -4.25, 1.90
    parts.prism(_tank_outline(), y0 + 0.12, y1 - 0.12, pw.paint_slot(1), axis="Y", smooth=True)
    for y, sign in ((y0 + 0.12, -1), (y1 - 0.12, 1)):
        for shrink, push in ((-0.06, 0.07), (-0.20, 0.12)):
            low, high = sorted((y - sign * 0.05, y + sign * push))
            parts.prism(_tank_outline(shrink), low, high, pw.paint_slot(1), axis="Y", bevel_m=0.03)
    for y in (y0 + 0.15, -2.7, -1.2, 0.35, y1 - 0.15):
        parts.prism(_tank_outline(0.012), y - 0.03, y + 0.03, fittings.aluminium(), axis="Y", smooth=True)
    parts.box((0.62, y1 - y0 - 0.5, 0.04), (0, (y0 + y1) / 2, 3.05), fittings.aluminium())
    for y in (-3.3, -1.9, -0.4, 1.0):
        parts.lathe([(0.27, 0), (0.27, 0.10), (0.22, 0.14), (0.05, 0.16)], (0, y, 3.04), fittings.aluminium())
    for sign in (-1, 1):
        fittings.set_side(parts, sign)
        parts.tube(
            [(0.38, y0 + 0.4, 3.05), (0.38, y0 + 0.4, 3.50), (0.38, y1 - 0.4, 3.50), (0.38, y1 - 0.4, 3.05)],
            0.02,
            fittings.aluminium(),
            sides=6,
        )
        for k in range(4):
            y = y0 + 1.4 + k * 1.15
            parts.tube([(0.38, y, 3.05), (0.38, y, 3.50)], 0.016, fittings.aluminium(), sides=6)
        parts.prism(
            [(0.5, 1.0), (1.20, 1.05), (1.20, 1.60), (1.14, 1.64), (0.5, 1.3)],
            y0 + 0.05,
            y1 - 0.3,
            chassis.chassis_paint(),
            axis="Y",
        )
    parts.matrix = Matrix.Identity(4)
    for x in (0.62, 0.98):
        parts.tube(
            [(x, y0 - 0.16, 0.75), (x, y0 - 0.16, 2.75), (x * 0.9, y0 + 0.2, 3.05)],
            0.018,
            fittings.aluminium(),
            sides=6,
        )
    for k in range(8):
        parts.tube(
            [(0.62, y0 - 0.16, 0.85 + 0.27 * k), (0.98, y0 - 0.16, 0.85 + 0.27 * k)],
            0.013,
            fittings.aluminium(),
            sides=6,
        )
    chassis.side_guards(parts, -0.55, 0.65)
    return parts


def tanker(cab_colour: str, *, plate: str, lettering: str) -> Built:
    """Build a three-axle fuel tanker, 8.4 m long, with a silver tank and lettering on both sides."""
    body = bw.body_mesh("tanker", _tanker_parts)
    extra_parts, letters = bw.number_plates(plate, (4.19, 0.60), (-4.22, 0.98))
    letters += bw.text_on_both_sides(
        lettering,
        0.40,
        -1.2,
        2.22,
        cab_colour if cab_colour in fittings.DARK_PAINTS else "dark blue",
        width_m=4.4,
        onto=bw.Surface(body),
    )
    letters += [bw.text_line("HIGHLY FLAMMABLE", 0.11, (0, -4.262, 2.3), "-Y", "red", width_m=1.4)]
    paints = [pw.paint("lorry cab", cab_colour, dirt_top_m=1.2), pw.paint("tank", "silver", dirt_top_m=2.0, dirt=0.4)]
    return bw.finish("tanker", body, paints, letters, extra_parts)
