"""Furniture of a café terrace: tables, chairs, parasols, cups and a chalk menu board."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy

from scope_studio.kit.core.finishes import concrete, paint, steel, stripes, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

TABLE_HEIGHT_M = 0.74
"""Height of a table top in metres."""
SEAT_HEIGHT_M = 0.45
"""Height of a seat in metres."""


def table(colour: str = "light grey", *, radius: float = 0.36) -> Built:
    """Build a round pedestal table with a metal-edged top."""
    s = Solid("café table")
    iron = paint("black", dirt=0.2)
    s.lathe(
        [
            (radius - 0.004, TABLE_HEIGHT_M - 0.028),
            (radius, TABLE_HEIGHT_M - 0.022),
            (radius, TABLE_HEIGHT_M - 0.004),
            (radius - 0.006, TABLE_HEIGHT_M),
        ],
        paint(colour, dirt=0.08, roughness=0.3),
        steps=40,
    )
    s.tube(
        [
            ((radius + 0.003) * math.cos(a), (radius + 0.003) * math.sin(a), TABLE_HEIGHT_M - 0.013)
            for a in (2 * math.pi * k / 40 for k in range(40))
        ],
        0.012,
        steel(),
        sides=6,
        closed=True,
    )
    s.lathe([(0.05, 0.05), (0.032, 0.12), (0.028, 0.60), (0.06, 0.70), (0.16, TABLE_HEIGHT_M - 0.028)], iron, steps=20)
    for k in range(3):
        a = 2 * math.pi * k / 3 + 0.4
        s.tube(
            [(0, 0, 0.14), (0.14 * math.cos(a), 0.14 * math.sin(a), 0.09), (0.30 * math.cos(a), 0.30 * math.sin(a), 0.014)],
            0.018,
            iron,
        )
    return s.built()


def chair(colour: str = "dark green") -> Built:
    """Build a slatted bistro chair. A person on it faces +y, with the hips over the origin."""
    s = Solid("café chair")
    metal, wood = paint(colour, dirt=0.15, roughness=0.35), paint(colour, dirt=0.1, roughness=0.5)
    for sign in (-1, 1):
        x = sign * 0.19
        s.tube(
            [(x, 0.20, 0.0), (x, 0.17, SEAT_HEIGHT_M - 0.02), (x, -0.16, SEAT_HEIGHT_M - 0.02), (x * 0.98, -0.24, 0.88)],
            0.012,
            metal,
            sides=8,
        )
        s.rod((x, -0.26, 0.0), (x, -0.12, SEAT_HEIGHT_M - 0.02), 0.012, metal, sides=8)
        s.rod((x, 0.19, 0.18), (x, -0.22, 0.18), 0.007, metal, sides=6)
    for k in range(7):
        s.box((0.40, 0.044, 0.014), (0, 0.17 - 0.055 * k, SEAT_HEIGHT_M - 0.007), wood, 0.004)
    for k in range(3):
        z = 0.60 + 0.11 * k
        with s.at(0, -0.178 - 0.185 * (z - SEAT_HEIGHT_M) / 1.0, z, pitch=-10):
            s.box((0.40, 0.014, 0.055), (0, 0, 0), wood, 0.004)
    return s.built()


def parasol(colour: str, second_colour: str | None = None, *, is_open: bool = True, text: str | None = None) -> Built:
    """Build an octagonal parasol on a concrete base, 2.9 m wide and 2.75 m high. If ``is_open`` is false, it is folded."""
    s = Solid("parasol")
    cloth = stripes(f"parasol {colour} {second_colour or colour}", colour, second_colour or colour, 0.7)
    s.box((0.55, 0.55, 0.10), (0, 0, 0.05), concrete(light=False), 0.03)
    s.lathe([(0.05, 0.10), (0.035, 0.14), (0.035, 0.40)], steel(), steps=16)
    s.rod((0, 0, 0.1), (0, 0, 2.78), 0.024, timber())
    if not is_open:
        s.lathe([(0.05, 1.05), (0.15, 1.12), (0.13, 1.6), (0.105, 2.2), (0.07, 2.62), (0.02, 2.80)], cloth, steps=18)
        s.lathe([(0.128, 1.70), (0.126, 1.76)], paint("black"), steps=18)
        s.lathe([(0.04, 2.78), (0.05, 2.84), (0.01, 2.90)], timber(), steps=14)
        return s.built()
    rim, top, n = 1.45, 2.74, 8
    rows = [(0.10, top), (0.5, top - 0.13), (1.0, top - 0.31), (rim, top - 0.50), (rim + 0.01, top - 0.66)]
    sub = 4
    count = n * sub
    points = []
    for r, z in rows:
        for k in range(count):
            a = 2 * math.pi * (k / count) + math.pi / 8
            between = abs(math.sin(math.pi * (k % sub) / sub))
            flat = math.cos(math.pi / n) / math.cos(math.pi / n * (2 * (k % sub) / sub - 1)) if k % sub else 1.0
            points.append((r * math.cos(a) * flat, r * math.sin(a) * flat, z - 0.02 * between * r))
    faces = [
        (i * count + k, (i + 1) * count + k, (i + 1) * count + (k + 1) % count, i * count + (k + 1) % count)
        for i in range(len(rows) - 1)
        for k in range(count)
    ]
    s.add(points, [*faces, tuple(range(count))], cloth)
    for k in range(n):
        a = 2 * math.pi * k / n + math.pi / 8
        s.rod((0, 0, top - 0.06), (rim * math.cos(a), rim * math.sin(a), top - 0.53), 0.010, timber(), sides=4)
        s.rod((0, 0, 2.05), (0.75 * math.cos(a), 0.75 * math.sin(a), top - 0.27), 0.008, timber(), sides=4)
    s.lathe([(0.05, top), (0.06, top + 0.05), (0.01, top + 0.14)], timber(), steps=14)
    if text:
        flat = math.cos(math.pi / n)
        for turn in (0, 90, 180, 270):
            with s.at(turn=turn):
                s.text(
                    text,
                    0.10,
                    (0, (rim + 0.01) * flat + 0.012, top - 0.59),
                    paint("white" if colour != "white" else "navy", dirt=0.0),
                )
    return s.built()


def cup(colour: str = "white") -> Built:
    """Build a coffee cup on its saucer, standing on z = 0."""
    s = Solid("cup")
    china = paint(colour, dirt=0.0, roughness=0.15)
    s.lathe([(0.035, 0.0), (0.075, 0.012), (0.078, 0.016), (0.03, 0.008)], china, steps=24)
    s.lathe([(0.024, 0.010), (0.036, 0.035), (0.041, 0.072), (0.038, 0.072), (0.034, 0.060)], china, steps=24)
    s.lathe([(0.035, 0.058), (0.034, 0.062)], plain("coffee", (0.035, 0.014, 0.006), 0.2), steps=24)
    s.tube([(0.036, 0, 0.062), (0.062, 0, 0.058), (0.062, 0, 0.032), (0.034, 0, 0.026)], 0.005, china, sides=6)
    return s.built()


def menu_board(lines: Sequence[str], *, cap: float = 0.062) -> Built:
    """Build a folding chalkboard, 0.65 x 1.1 m, with the same text on both faces (+y and -y). The first line is the heading."""
    s = Solid("menu board")
    slate = _slate()
    chalk = [plain(f"chalk {k}", c, 0.95) for k, c in enumerate(((0.80, 0.79, 0.74), (0.80, 0.66, 0.30), (0.62, 0.74, 0.80)))]
    width = max(0.66, max(extent(line, cap) for line in lines) + 0.16)
    for turn in (0.0, 180.0):
        with s.at(turn=turn), s.at(0, 0.30, 0.0, pitch=14.0):
            s.box((width, 0.035, 1.14), (0, 0, 0.57), timber(fresh=False), 0.008)
            s.box((width - 0.08, 0.012, 1.02), (0, 0.014, 0.58), slate, 0.0)
            pitch = min(0.15, 0.98 / len(lines))
            for k, line in enumerate(lines):
                ink = chalk[1 if k == 0 else 0 if k % 3 else 2]
                s.text(line, cap * (1.15 if k == 0 else 1.0), (0, 0.0215, 1.03 - pitch * (k + 0.35)), ink, bold=k == 0)
    return s.built()


def _slate() -> bpy.types.Material:
    s = Shader("chalk slate")
    p = s.object_coords()
    smear = s.ramp(s.noise(s.scaled(p, (3.0, 3.0, 6.0)), 1.0, 5.0), 0.45, 0.75, 0.0, 0.16)
    return s.surface(base_color=s.mix(smear, (0.018, 0.020, 0.021), (0.30, 0.30, 0.29)), roughness=0.9)
