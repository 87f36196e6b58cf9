"""Two-dimensional outlines (arcs, rounded rectangles), and a block without chamfers."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.solid import Solid


def arc(centre: tuple[float, float], radius: float, start_deg: float, stop_deg: float, steps: int = 8) -> list[tuple[float, float]]:
    """Return the points of a circular arc in a plane, including both ends."""
    angles = [math.radians(start_deg + (stop_deg - start_deg) * k / steps) for k in range(steps + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]


def rounded_rectangle(
    width: float, height: float, radius: float, centre: tuple[float, float] = (0.0, 0.0), steps: int = 5
) -> list[tuple[float, float]]:
    """Return the outline of a rectangle with rounded corners, anticlockwise."""
    u, v = width / 2 - radius, height / 2 - radius
    corners = [(u, v, 0), (-u, v, 90), (-u, -v, 180), (u, -v, 270)]
    return [p for cu, cv, a in corners for p in arc((centre[0] + cu, centre[1] + cv), radius, a, a + 90, steps)]


def block(s: Solid, size: Point, centre: Point, material: bpy.types.Material) -> None:
    """Add a box of six faces without chamfers, for parts that are never seen in close-up."""
    x, y, z = (v / 2 for v in size)
    points = [(centre[0] + a * x, centre[1] + b * y, centre[2] + c * z) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    s.add(points, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)], material)
