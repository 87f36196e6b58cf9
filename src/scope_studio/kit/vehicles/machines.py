"""Construction machines: tandem roller and site dumper."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings, wheels
from scope_studio.kit.vehicles import paintwork as pw


def roller(colour: str, *, number: str) -> Built:
    """Build a 10-tonne tandem road roller, 4.7 m long.

    It has two steel drums, a roll-over frame with a canopy, and an operator's seat.
    """
    mesh = bw.body_mesh("roller", _roller_parts)
    letters = bw.text_on_both_sides(number, 0.26, -0.14, 1.12, "black", x=0.765, width_m=0.7)
    letters.append(bw.text_line(number, 0.22, (0, -2.36, 1.33), "-Y", "black", width_m=0.8))
    return bw.finish("roller", mesh, [fittings.machine_paint("roller", colour)], letters)


def _roller_parts() -> Parts:
    parts = Parts()
    paint, iron, trim = pw.paint_slot(), fittings.iron(), pw.black_trim()
    steel = bpy.data.materials.get("roller drum")
    if steel is None:
        sh = shading.Shader("roller drum")
        streaks = sh.noise(sh.scaled(sh.object_coords(), (40, 3, 3)), 1.0)
        steel = sh.surface(base_color=sh.mix(streaks, (0.16, 0.155, 0.15), (0.40, 0.39, 0.38)), roughness=0.38, metallic=0.7)
    for y in (1.62, -1.62):
        parts.lathe(
            [(0.55, -0.80), (0.66, -0.84), (0.68, -0.83), (0.68, 0.83), (0.66, 0.84), (0.55, 0.80), (0.50, 0.70)],
            (0, y, 0.68),
            steel,
            axis="X",
            steps=56,
            smooth=False,
        )
        parts.disc(0.50, -0.72, 0.72, (0, y, 0.68), iron, steps=32)
        parts.disc(0.22, -0.86, 0.86, (0, y, 0.68), paint, steps=24)
        front = 1 if y > 0 else -1
        for sign in (-1, 1):
            yoke: list[Point2D] = [
                (y - front * 0.14, 0.54),
                (y + front * 0.14, 0.54),
                (y + front * 0.16, 0.95),
                (y + front * 0.02, 1.46),
                (y - front * 0.70, 1.46),
                (y - front * 0.60, 1.26),
            ]
            parts.prism(yoke, sign * 0.90 - 0.05, sign * 0.90 + 0.05, paint, bevel_m=0.02)
        deck: list[Point2D] = [
            (y + front * 0.72, 1.16),
            (y + front * 0.74, 1.42),
            (y + front * 0.60, 1.54),
            (y - front * 0.75, 1.54),
            (y - front * 0.75, 1.40),
            (y + front * 0.40, 1.40),
        ]
        parts.prism(deck, -0.95, 0.95, paint, bevel_m=0.03, segments=2)
        parts.box((1.66, 0.05, 0.10), (0, y + front * 0.74, 0.80), iron)
        parts.box((1.66, 0.03, 0.16), (0, y + front * 0.69, 0.80), wheels.rubber(), bevel_m=0.004)
        for sign in (-1, 1):
            parts.box(
                (0.18, 0.05, 0.12),
                (sign * 0.70, y + front * 0.755, 1.34),
                pw.lamp("white" if front > 0 else "red"),
                bevel_m=0.02,
            )
    parts.box((1.50, 1.62, 0.72), (0, 0.0, 1.10), paint, bevel_m=0.05)
    parts.box((1.10, 0.95, 0.30), (0, 0.62, 1.60), paint, bevel_m=0.08)
    for k in range(6):
        for sign in (-1, 1):
            parts.box((0.02, 0.36, 0.025), (sign * 0.752, 0.54, 0.92 + 0.075 * k), trim, bevel_m=0.0)
    parts.disc(0.24, 0.50, 1.0, (0, 0, 0), iron, axis="Z")
    parts.box((1.5, 1.0, 0.06), (0, -0.45, 1.50), iron)
    parts.box((0.50, 0.48, 0.14), (0.12, -0.48, 1.84), trim, bevel_m=0.05)
    parts.box((0.50, 0.14, 0.56), (0.12, -0.76, 2.12), trim, bevel_m=0.06)
    parts.box((0.30, 0.30, 0.26), (0.12, -0.48, 1.64), iron)
    parts.prism([(0.0, 1.5), (0.26, 1.5), (0.18, 2.16), (0.02, 2.20)], -0.12, 0.36, iron, bevel_m=0.03)
    wheel = [
        (0.12 + 0.19 * math.cos(a), 0.0 + 0.19 * math.sin(a) * 0.8, 2.30 - 0.19 * math.sin(a) * 0.45)
        for a in (2 * math.pi * k / 18 for k in range(18))
    ]
    parts.tube(wheel, 0.016, trim, sides=6, closed=True)
    for sign in (-1, 1):
        for y in (-0.98, 0.30):
            parts.tube([(sign * 0.70, y, 1.45), (sign * 0.70, y, 2.86)], 0.045, paint, sides=4)
        parts.tube([(sign * 0.74, -0.9, 1.95), (sign * 0.74, 0.05, 1.95), (sign * 0.74, 0.05, 1.50)], 0.02, iron, sides=6)
        parts.box((0.16, 0.34, 0.04), (sign * 0.82, -0.1, 0.78), iron)
        parts.box((0.03, 0.30, 0.24), (sign * 0.86, 0.34, 2.36), trim, bevel_m=0.01)
    parts.box((1.70, 1.75, 0.07), (0, -0.34, 2.90), paint, bevel_m=0.03)
    parts.box((1.60, 1.65, 0.05), (0, -0.34, 2.85), trim, bevel_m=0.01)
    fittings.beacon(parts, 0.55, -0.95, 2.93)
    return parts


def dumper(colour: str, *, number: str) -> Built:
    """Build a nine-tonne forward-tipping site dumper, 4.6 m long, with a skip full of earth, four big wheels and a roll bar."""
    mesh = bw.body_mesh("dumper", _dumper_parts)
    letters = bw.text_on_both_sides(number, 0.24, 0.95, 1.40, "black", x=0.86, width_m=0.8)
    return bw.finish("dumper", mesh, [fittings.machine_paint("dumper", colour)], letters)


def _dumper_parts() -> Parts:
    parts = Parts()
    paint, iron, trim = pw.paint_slot(), fittings.iron(), pw.black_trim()
    earth = shading.plain("machine earth", (0.075, 0.048, 0.030), 0.95)
    for y in (1.35, -1.35):
        parts.tube([(-0.9, y, 0.58), (0.9, y, 0.58)], 0.11, iron)
        for sign in (-1, 1):
            wheels.steel_wheel(parts, (sign * 0.92, y, 0.58), 0.58, sign, width=0.44)
    parts.box((0.8, 3.4, 0.30), (0, -0.3, 0.70), iron)
    parts.box((1.40, 1.45, 0.62), (0, -1.42, 1.20), paint, bevel_m=0.07)
    parts.box((1.36, 0.85, 0.08), (0, -0.35, 0.92), iron)
    for k in range(6):
        parts.box((0.9, 0.02, 0.03), (0, -2.15, 1.02 + 0.07 * k), trim, bevel_m=0.0)
    skip: list[Point2D] = [(-0.02, 1.10), (1.70, 1.02), (2.35, 1.62), (0.0, 1.75), (-0.12, 1.60)]
    parts.prism(skip, -0.86, 0.86, paint, bevel_m=0.04)
    for sign in (-1, 1):
        rim: list[Point2D] = [(-0.16, 1.60), (-0.05, 2.02), (2.00, 1.86), (2.38, 1.62), (2.3, 1.52), (0.0, 1.62)]
        parts.prism(rim, sign * 0.94 - 0.05, sign * 0.94 + 0.05, paint, bevel_m=0.02)
        parts.tube([(sign * 0.56, -0.72, 1.5), (sign * 0.56, -0.72, 2.72)], 0.05, iron, sides=8)
        parts.box((0.34, 1.15, 0.05), (sign * 0.92, -1.35, 1.26), trim, bevel_m=0.02)
        parts.box((0.14, 0.05, 0.10), (sign * 0.55, -2.16, 1.40), pw.lamp("red"), bevel_m=0.02)
    parts.prism([(-0.14, 1.58), (0.02, 1.58), (0.06, 2.02), (-0.08, 2.04)], -0.94, 0.94, paint, bevel_m=0.02)
    points, faces, n = [], [], 12
    for i in range(n + 1):
        for j in range(n + 1):
            u, v = i / n, j / n
            heap = 0.34 * math.sin(math.pi * u) * math.sin(math.pi * min(1.0, v * 1.1)) + 0.03 * math.sin(31.0 * i + 17.0 * j * j)
            points.append((-0.9 + 1.8 * u, 0.0 + 2.2 * v, 1.80 - 0.20 * v + heap))
    for i in range(n):
        for j in range(n):
            a = i * (n + 1) + j
            faces.append((a, a + n + 1, a + n + 2, a + 1))
    parts.add(points, faces, earth, smooth=True)
    parts.tube([(-0.56, -0.72, 2.72), (0.56, -0.72, 2.72)], 0.05, iron, sides=8)
    fittings.beacon(parts, 0.3, -0.72, 2.75)
    parts.box((0.48, 0.46, 0.14), (0, -0.80, 1.60), trim, bevel_m=0.05)
    parts.box((0.48, 0.13, 0.50), (0, -1.02, 1.86), trim, bevel_m=0.05)
    parts.prism([(-0.30, 0.95), (-0.12, 0.95), (-0.22, 1.72), (-0.34, 1.75)], -0.35, 0.35, paint, bevel_m=0.03)
    wheel = [
        (0.18 * math.cos(a), -0.36 + 0.14 * math.sin(a), 1.85 + 0.10 * math.sin(a))
        for a in (2 * math.pi * k / 16 for k in range(16))
    ]
    parts.tube(wheel, 0.016, trim, sides=6, closed=True)
    return parts
