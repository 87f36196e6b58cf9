"""A pram with a hood and spoked wheels."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import cloth, paint, rubber, steel
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def pram(colour: str = "navy") -> Built:
    """Build a pram facing +y, with a carrycot, a folding hood, a blanket and spoked wheels. Its handle is towards -y."""
    s = Solid(f"{colour} pram")
    fabric, chrome = cloth(colour, 0.7), steel()
    sections = [(-0.36, 0.10, 0.10), (-0.30, 0.19, 0.20), (0.0, 0.215, 0.24), (0.34, 0.205, 0.22), (0.42, 0.12, 0.12)]
    points: list[Point] = []
    n = 12
    for y, half, depth in sections:
        for k in range(n):
            a = math.pi * k / (n - 1)
            points.append((half * math.cos(a) * (1.0 if k not in (0, n - 1) else 1.02), y, 0.88 - depth * math.sin(a) ** 0.7))
    faces = [(i * n + k, i * n + k + 1, i * n + n + k + 1, i * n + n + k) for i in range(len(sections) - 1) for k in range(n - 1)]
    s.add(points, [*faces, tuple(range(n)), tuple(range(4 * n, 5 * n))[::-1]], fabric)
    rim = [(x, y, 0.885) for y, x, _ in sections] + [(-x, y, 0.885) for y, x, _ in sections[::-1]]
    s.tube(rim, 0.014, paint("black", dirt=0.1), sides=6, closed=True)
    s.box((0.36, 0.44, 0.06), (0, 0.17, 0.885), cloth("cream"), 0.025)
    s.box((0.37, 0.10, 0.065), (0, -0.03, 0.89), cloth("white"), 0.025)
    hood: list[Point] = []
    for i in range(6):
        a = math.radians(8 + 22 * i)
        for k in range(9):
            b = math.pi * k / 8
            hood.append(
                (
                    0.215 * math.cos(b),
                    -0.12 - 0.30 * math.cos(a) * math.sin(b) ** 0.6,
                    0.89 + 0.33 * math.sin(a) * math.sin(b) ** 0.6,
                )
            )
    s.add(hood, [(9 * i + k, 9 * i + k + 1, 9 * i + k + 10, 9 * i + k + 9) for i in range(5) for k in range(8)], fabric)
    for x in (-0.25, 0.25):
        s.tube([(x, -0.40, 0.19), (x, 0.30, 0.62), (x * 0.9, 0.34, 0.66)], 0.013, chrome)
        s.tube([(x, 0.38, 0.19), (x, -0.30, 0.66), (x * 0.95, -0.55, 1.02)], 0.013, chrome)
        for y, r in ((-0.40, 0.19), (0.38, 0.19)):
            ring = [
                (x * 1.12, y + r * 0.93 * math.cos(a), r + r * 0.93 * math.sin(a)) for a in (math.pi * k / 12 for k in range(24))
            ]
            s.tube(ring, 0.014, rubber(), sides=6, closed=True)
            for k in range(10):
                a = 2 * math.pi * k / 10
                s.rod((x * 1.12, y, r), (x * 1.12, y + 0.16 * math.cos(a), r + 0.16 * math.sin(a)), 0.0025, chrome, sides=4)
            s.rod((x * 1.0, y, r), (x * 1.2, y, r), 0.018, chrome)
    for y in (-0.40, 0.38):
        s.rod((-0.28, y, 0.19), (0.28, y, 0.19), 0.010, chrome)
    s.tube([(-0.24, -0.55, 1.02), (-0.20, -0.59, 1.04), (0.20, -0.59, 1.04), (0.24, -0.55, 1.02)], 0.016, paint("black", dirt=0.1))
    s.box((0.40, 0.48, 0.02), (0, -0.02, 0.30), steel(dark=True), 0.006)
    return s.built()
