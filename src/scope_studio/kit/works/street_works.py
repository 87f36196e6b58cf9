"""Building works and street works: scaffolding, a ladder and an open manhole."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import lens, paint, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def scaffolding(width_m: float, lifts: int = 3, *, depth_m: float = 1.1, first_lift_m: float = 2.6) -> Built:
    """Build tube scaffolding along x in front of a wall on y = 0: boarded lifts with guard rails, braces, base plates."""
    s = Solid("scaffolding")
    tube, r = steel(), 0.024
    bays = max(2, round(width_m / 2.0))
    xs = [-width_m / 2 + width_m * k / bays for k in range(bays + 1)]
    top = first_lift_m + 2.0 * (lifts - 1) + 1.15
    for x in xs:
        for y in (0.25, 0.25 + depth_m):
            s.rod((x, y, 0.02), (x, y, top), r, tube, sides=8)
            s.box((0.15, 0.15, 0.012), (x, y, 0.012), steel(dark=True), 0.003)
            s.box((0.45, 0.22, 0.04), (x, y, 0.0), timber(fresh=False), 0.004)
    for k in range(lifts):
        z = first_lift_m + 2.0 * k
        for y in (0.25, 0.25 + depth_m):
            s.rod((xs[0] - 0.25, y, z - 0.06), (xs[-1] + 0.25, y, z - 0.06), r, tube, sides=8)
        for rail in (0.5, 1.0):
            s.rod((xs[0] - 0.2, 0.25 + depth_m + 0.05, z + rail), (xs[-1] + 0.2, 0.25 + depth_m + 0.05, z + rail), r, tube, sides=8)
        for x in xs:
            s.rod((x, 0.02, z - 0.11), (x, 0.45 + depth_m, z - 0.11), r, tube, sides=8)
            for y in (0.25, 0.25 + depth_m):
                s.box((0.075, 0.075, 0.06), (x, y, z - 0.085), steel(dark=True), 0.012)
        for j in range(5):
            s.box((width_m + 0.5, 0.215, 0.036), (0, 0.30 + j * 0.235, z), timber(fresh=(j + k) % 3 == 0), 0.004)
        s.box((width_m + 0.4, 0.03, 0.20), (0, 0.25 + depth_m + 0.02, z + 0.12), timber(), 0.004)
    for k in range(bays):
        x0, x1 = (xs[k], xs[k + 1]) if k % 2 == 0 else (xs[k + 1], xs[k])
        s.rod((x0, 0.31 + depth_m, 0.15), (x1, 0.31 + depth_m, first_lift_m + 2.0 * (lifts - 1)), r, tube, sides=8)
    return s.built()


def ladder(length_m: float = 5.0, lean_deg: float = 14.0) -> Built:
    """Build a metal ladder with its rungs along x and its feet at the origin, leaning back towards -y."""
    s = Solid("ladder")
    metal = steel()
    with s.at(pitch=lean_deg):
        for x in (-0.19, 0.19):
            s.box((0.028, 0.065, length_m), (x, 0, length_m / 2), metal, 0.006)
        for k in range(int(length_m / 0.28)):
            s.rod((-0.19, 0, 0.22 + 0.28 * k), (0.19, 0, 0.22 + 0.28 * k), 0.014, metal, sides=8)
    return s.built()


def open_manhole() -> Built:
    """Build a round manhole with its frame and a dark shaft. The cast-iron cover lies next to it (towards +x)."""
    s = Solid("open manhole")
    iron = steel(dark=True)
    n = 32
    ring = [(0.30, 0.012), (0.37, 0.014), (0.40, 0.002)]
    points = [(r * math.cos(2 * math.pi * k / n), r * math.sin(2 * math.pi * k / n), z) for r, z in ring for k in range(n)]
    faces = [(i * n + k, (i + 1) * n + k, (i + 1) * n + (k + 1) % n, i * n + (k + 1) % n) for i in range(2) for k in range(n)]
    s.add(points, [f[::-1] for f in faces], iron)
    s.lathe([(0.305, 0.004), (0.30, 0.006)], lens("black"), steps=n)
    with s.at(0.72, 0.25, 0.03, pitch=3, roll=-2):
        s.lathe([(0.30, -0.02), (0.305, 0.0), (0.30, 0.02)], iron, steps=n)
        for k in range(-4, 5):
            half = math.sqrt(max(0.01, 0.27**2 - (0.062 * k) ** 2))
            s.box((2 * half, 0.022, 0.008), (0, 0.062 * k, 0.022), iron, 0.002)
        for x in (-0.2, 0.2):
            s.box((0.05, 0.02, 0.012), (x, 0.0, 0.024), lens("black"), 0.002)
    s.box((0.06, 0.5, 0.02), (0.25, -0.55, 0.012), paint("yellow", dirt=0.3), 0.004)
    return s.built()
