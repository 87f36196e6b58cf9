"""Open umbrellas."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core.finishes import PALETTE, paint, steel, timber
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.shading import Shader
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

RIBS = 8
"""Number of ribs of an umbrella."""


def umbrella(colour: str, *, second_colour: str | None = None, radius_m: float = 0.54) -> Built:
    """Build an open umbrella, held at the origin. ``second_colour`` is the colour of every other panel."""
    s = Solid(f"{colour} umbrella")
    top = 0.72
    s.rod((0, 0, 0.05), (0, 0, top + 0.05), 0.0055, steel())
    s.rod((0, 0, top), (0, 0, top + 0.07), 0.008, paint("black"), radius_b=0.003)
    hook = [(0, 0.05 - 0.05 * math.cos(a), -0.10 - 0.05 * math.sin(a)) for a in (k * math.pi / 8 for k in range(9))]
    s.tube([(0, 0, 0.06), (0, 0, -0.10), *hook[1:]], 0.012, timber(), sides=8)
    for panel in range(RIBS):
        cloth = _nylon(second_colour if second_colour and panel % 2 else colour)
        rows = 7
        points: list[Point] = []
        for i in range(rows + 1):
            for j in range(5):
                points.append(_canopy(panel + j / 4, i / rows, radius_m, top, sag=4 * (j / 4) * (1 - j / 4)))
        faces = [(5 * i + j, 5 * i + 5 + j, 5 * i + 6 + j, 5 * i + 1 + j) for i in range(rows) for j in range(4)]
        s.add(points, faces, cloth)
        rib = [_canopy(panel, k / 6, radius_m, top - 0.006, sag=0.0) for k in range(7)]
        s.tube(rib, 0.0025, steel(), sides=4)
        s.rod((0, 0, top - 0.22), rib[3], 0.002, steel(), sides=4)
    return s.built()


def _canopy(turn: float, fraction: float, radius_m: float, top: float, sag: float) -> Point:
    """Return a point of the canopy. ``sag`` is 0 at a rib and 1 midway between ribs, where the cloth sags."""
    r = radius_m * fraction * (1 - 0.07 * sag * fraction)
    drop = 0.24 * fraction**2.2 + 0.012 * sag * fraction * (1 - fraction) * 4
    a = 2 * math.pi * turn / RIBS
    return (r * math.cos(a), r * math.sin(a), top - drop)


def _nylon(colour: str) -> bpy.types.Material:
    name = f"umbrella {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    drops = s.ramp(s.voronoi(s.object_coords(), 60.0), 0.05, 0.12, 0.6, 0.0)
    return s.surface(
        base_color=PALETTE[colour], roughness=s.math("SUBTRACT", 0.42, s.math("MULTIPLY", drops, 0.4)), coat_weight=0.25
    )
