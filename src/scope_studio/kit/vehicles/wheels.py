"""Wheels of road vehicles: tyres with alloy, steel and lorry rims. The axles are along x."""

from __future__ import annotations

import math

import bpy
from mathutils import Matrix

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point


def rubber() -> bpy.types.Material:
    """Return the material of tyres."""
    return shading.plain("vehicle rubber", (0.018, 0.018, 0.019), 0.85)


def alloy() -> bpy.types.Material:
    """Return the material of alloy rims."""
    return shading.plain("vehicle alloy", (0.40, 0.41, 0.42), 0.32, 0.6)


def steel() -> bpy.types.Material:
    """Return the material of steel rims."""
    return shading.plain("vehicle wheel steel", (0.30, 0.31, 0.32), 0.5, 0.3)


def shade() -> bpy.types.Material:
    """Return the dark material of the space behind spokes."""
    return shading.plain("vehicle shade", (0.006, 0.006, 0.006), 0.9)


def _frame(centre: Point, side: int) -> Matrix:
    """Return a frame whose +x points away from the vehicle, on the right (``side`` +1) or left (-1)."""
    mirror = Matrix.Scale(-1, 4, (1, 0, 0)) if side < 0 else Matrix.Identity(4)
    return Matrix.Translation(centre) @ mirror


def _tyre(parts: Parts, radius: float, width: float, rim: float) -> None:
    h = width / 2
    profile = [
        (rim, -h * 0.85), (rim + 0.02, -h), (radius - 0.05, -h * 1.04), (radius - 0.012, -h * 0.86),
            (radius, -h * 0.66),
        (radius, -h * 0.30), (radius - 0.010, -h * 0.27), (radius - 0.010, -h * 0.23), (radius, -h * 0.20),
            (radius, h * 0.20),
        (radius - 0.010, h * 0.23), (radius - 0.010, h * 0.27), (radius, h * 0.30), (radius, h * 0.66),
            (radius - 0.012, h * 0.86),
        (radius - 0.05, h * 1.04), (rim + 0.02, h), (rim, h * 0.85),
    ]  # fmt: skip
    parts.lathe(profile, (0, 0, 0), rubber(), axis="X", steps=36, caps=False)


def car_wheel(parts: Parts, centre: Point, radius: float, side: int, *, width: float = 0.21, spokes: int = 5) -> None:
    """Add a car wheel with ``spokes`` pairs of spokes. ``radius`` and ``width`` are in metres.

    ``side`` is +1 on the right of the vehicle, -1 on the left.
    """
    outer, rim = parts.matrix.copy(), radius * 0.70
    parts.matrix = outer @ _frame(centre, side)
    _tyre(parts, radius, width, rim)
    h = width / 2
    parts.lathe([(rim, h * 0.88), (rim + 0.012, h * 1.0), (rim + 0.004, h * 1.02), (rim - 0.012, h * 0.9),
        (rim - 0.02, h * 0.2)],
                (0, 0, 0), alloy(), axis="X", steps=36, caps=False)  # fmt: skip
    parts.disc(rim - 0.015, -0.02, h * 0.25, (0, 0, 0), shade(), steps=28)
    parts.disc(
        rim * 0.60,
        h * 0.25,
        h * 0.34,
        (0, 0, 0),
        shading.plain("vehicle brake disc", (0.07, 0.07, 0.07), 0.4, 0.5),
        steps=24,
    )
    hub = parts.matrix.copy()
    for k in range(spokes):
        turn = Matrix.Rotation(2 * math.pi * k / spokes, 4, "X")
        for lean in (-0.13, 0.13):
            parts.matrix = hub @ turn @ Matrix.Rotation(lean, 4, "X")
            y0, y1, w = 0.05, rim - 0.006, 0.017
            front, back = h * 0.86, h * 0.5
            points = [(back, -w, y0), (back, w, y0), (front, w * 0.7, y0), (front, -w * 0.7, y0),
                      (back, -w, y1), (back, w, y1), (front * 1.04, w * 0.7, y1),
                          (front * 1.04, -w * 0.7, y1)]  # fmt: skip
            faces = [(0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0), (4, 7, 6, 5), (0, 1, 2, 3)]
            parts.add(points, faces, alloy())
    parts.matrix = hub
    parts.disc(0.075, h * 0.5, h * 0.90, (0, 0, 0), alloy(), steps=20)
    parts.disc(0.032, h * 0.9, h * 0.95, (0, 0, 0), shade(), steps=16)
    parts.matrix = outer


def steel_wheel(parts: Parts, centre: Point, radius: float, side: int, *, width: float = 0.21) -> None:
    """Add a pressed steel wheel with a black trim, for vans and work vehicles."""
    outer, rim = parts.matrix.copy(), radius * 0.66
    parts.matrix = outer @ _frame(centre, side)
    _tyre(parts, radius, width, rim)
    h = width / 2
    parts.lathe([(rim, h * 0.86), (rim + 0.012, h * 1.0), (rim - 0.008, h * 0.98), (rim - 0.03, h * 0.55),
        (rim * 0.62, h * 0.62),
                 (rim * 0.52, h * 0.86), (0.06, h * 0.9), (0.05, h * 1.05), (0.02, h * 1.07)],
                (0, 0, 0), steel(), axis="X", steps=32, caps=False)  # fmt: skip
    for k in range(10):
        a = 2 * math.pi * k / 10
        y, z = rim * 0.76 * math.cos(a), rim * 0.76 * math.sin(a)
        parts.disc(0.022, h * 0.5, h * 0.66, (0, y, z), shade(), steps=8)
    parts.matrix = outer


def lorry_wheel(parts: Parts, centre: Point, radius: float, side: int, *, width: float = 0.29, twin: bool = False) -> None:
    """Add a lorry wheel. Its disc bulges outwards with a projecting hub or, if ``twin``, inwards (for driven axles)."""
    outer, rim = parts.matrix.copy(), radius * 0.60
    parts.matrix = outer @ _frame(centre, side)
    _tyre(parts, radius, width, rim)
    h = width / 2
    sink = -0.75 if twin else 0.45
    parts.lathe([(rim, h * 0.86), (rim + 0.014, h * 1.0), (rim - 0.012, h * 0.98), (rim - 0.035, h * 0.6),
        (rim - 0.045, h * sink),
                 (rim * 0.62, h * (sink + 0.2)), (rim * 0.48, h * (sink + 0.35))],
                (0, 0, 0), steel(), axis="X", steps=32, caps=False)  # fmt: skip
    for k in range(8):
        a = 2 * math.pi * (k + 0.5) / 8
        parts.disc(
            0.028,
            h * sink,
            h * (sink + 0.17),
            (0, rim * 0.73 * math.cos(a), rim * 0.73 * math.sin(a)),
            shade(),
            steps=8,
        )
    reach = h * (0.62 if twin else 1.1)
    parts.lathe([(rim * 0.36, h * (sink + 0.3)), (rim * 0.33, reach - 0.02), (rim * 0.26, reach), (0.02, reach + 0.01)],
                (0, 0, 0), shading.plain("vehicle hub", (0.30, 0.30, 0.31), 0.5, 0.3), axis="X", steps=20)  # fmt: skip
    for k in range(10):
        a = 2 * math.pi * k / 10
        parts.disc(
            0.014,
            h * (sink + 0.3),
            h * (sink + 0.62),
            (0, rim * 0.46 * math.cos(a), rim * 0.46 * math.sin(a)),
            alloy(),
            steps=6,
        )
    if twin:
        parts.matrix = parts.matrix @ Matrix.Translation((-width - 0.04, 0, 0))
        _tyre(parts, radius, width, rim)
    parts.matrix = outer
