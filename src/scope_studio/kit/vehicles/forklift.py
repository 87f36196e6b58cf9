"""A counterbalance forklift with its mast, carriage and forks at any height."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import glow, lens, paint, rubber, sheet, steel
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

SEAT: tuple[float, float, float] = (0.0, -0.22, 1.02)
"""Position of the driver's hips in metres. The driver faces +y."""


def forklift(colour: str = "yellow", *, number: str = "3", fork_m: float = 0.10, lit: bool = True, beacon: bool = True) -> Built:
    """Build a 2.5-tonne forklift facing +y, with its forks at the height ``fork_m``.

    ``lit`` turns on its front lamps, its tail lamps and, if ``beacon`` is set, its beacon.
    """
    s = Solid("forklift")
    body, dark, black = paint(colour, dirt=0.42), paint("dark grey", dirt=0.35), rubber()
    _wheels(s)
    s.prism([(-1.18, 0.28), (-1.28, 0.55), (-1.24, 1.02), (-0.95, 1.14), (-0.55, 1.06), (-0.50, 0.30)], (-0.52, 0.52), body, "YZ")
    s.box((0.80, 0.10, 0.34), (0, -1.24, 0.62), dark, 0.03)
    s.box((1.02, 1.25, 0.34), (0, 0.12, 0.40), body, 0.05)
    s.box((0.96, 0.62, 0.30), (0, -0.30, 0.76), dark, 0.04)
    s.box((0.50, 0.46, 0.14), (0, -0.22, 0.97), black, 0.05)
    s.box((0.48, 0.12, 0.50), (0, -0.50, 1.26), black, 0.05)
    s.box((0.98, 0.16, 0.52), (0, 0.62, 0.82), body, 0.04)
    s.box((0.90, 0.20, 0.10), (0, 0.52, 1.08), dark, 0.03)
    s.rod((0, 0.42, 1.02), (0, 0.24, 1.28), 0.025, black)
    wheel = [
        (0.16 * math.cos(a), 0.24 + 0.11 * math.sin(a), 1.28 + 0.12 * math.sin(a)) for a in (math.pi * k / 10 for k in range(20))
    ]
    s.tube(wheel, 0.015, black, closed=True)
    for x in (-0.50, 0.50):
        s.tube([(x, 0.64, 1.05), (x * 0.97, 0.46, 2.12), (x * 0.94, -0.66, 2.14), (x, -0.98, 1.10)], 0.038, dark, sides=10)
    for k in range(7):
        y = 0.40 - 0.17 * k
        s.box((0.94, 0.035, 0.05), (0, y, 2.13), dark, 0.006)
    for side in (-1, 1):
        s.box((0.17, 0.07, 0.13), (side * 0.40, 0.60, 1.86), dark, 0.02)
        s.box((0.14, 0.012, 0.10), (side * 0.40, 0.642, 1.86), glow("cream", 9.0) if lit else lens("light grey"), 0.004)
        s.box((0.10, 0.03, 0.16), (side * 0.44, -1.12, 1.20), glow("red", 3.0) if lit else lens("red"), 0.01)
    if beacon:
        s.lathe(
            [(0.055, 2.16), (0.055, 2.24), (0.03, 2.27)], glow("amber", 6.0) if lit else lens("amber"), (0.0, -0.55, 0), steps=14
        )
    for facing, x in (("+X", 0.527), ("-X", -0.527)):
        s.text(f"FLT {number}", 0.15, (x, -0.86, 0.80), sheet("black"), facing=facing)
    s.text(number, 0.22, (0, -1.296, 0.62), sheet("white"), facing="-Y")
    _mast(s, fork_m)
    return s.built()


def _wheels(s: Solid) -> None:
    hub = plain("forklift hub", (0.45, 0.44, 0.42), 0.5)
    for x, y, r, width in ((0.46, 0.55, 0.33, 0.24), (0.44, -0.82, 0.27, 0.20)):
        for side in (-1, 1):
            h = width / 2
            s.lathe(
                [(r * 0.6, -h), (r * 0.94, -h), (r, -h * 0.7), (r, h * 0.7), (r * 0.94, h), (r * 0.6, h)],
                rubber(),
                (side * x, y, r),
                "X",
                28,
            )
            s.lathe(
                [(r * 0.2, -h * 1.02), (r * 0.58, -h * 0.8), (r * 0.58, h * 0.8), (r * 0.2, h * 1.02)],
                hub,
                (side * x, y, r),
                "X",
                20,
            )


def _mast(s: Solid, fork_m: float) -> None:
    """Add the mast: rails, cross bars, lift cylinders, a carriage with a backrest, and two forks."""
    dark, iron = paint("dark grey", dirt=0.35), steel(dark=True)
    lift = max(0.0, fork_m - 1.4)
    for x in (-0.36, 0.36):
        s.box((0.10, 0.14, 2.05), (x, 0.86, 1.12), dark, 0.01)
        s.box((0.07, 0.10, 2.0), (x * 0.82, 0.88, 1.12 + lift), iron, 0.01)
        s.rod((x * 0.45, 0.86, 0.25), (x * 0.45, 0.86, 2.0 + lift), 0.035, plain("ram chrome", (0.6, 0.6, 0.6), 0.2, 1.0))
    for z in (0.25, 2.1):
        s.box((0.82, 0.10, 0.10), (0, 0.84, z), dark, 0.01)
    s.box((0.70, 0.08, 0.09), (0, 0.88, 2.10 + lift), iron, 0.01)
    base = fork_m
    for z in (0.10, 0.48):
        s.box((1.0, 0.05, 0.10), (0, 0.99, base + z), iron, 0.01)
    for k in range(6):
        s.box((0.03, 0.03, 0.75), (-0.45 + 0.18 * k, 0.99, base + 0.85), iron, 0.0)
    s.box((1.0, 0.03, 0.04), (0, 0.99, base + 1.22), iron, 0.005)
    for x in (-0.28, 0.28):
        s.box((0.12, 0.05, 0.55), (x, 1.04, base + 0.26), iron, 0.008)
        s.prism(
            [(1.02, base - 0.02), (2.12, base - 0.01), (2.12, base + 0.004), (1.05, base + 0.03)], (x - 0.06, x + 0.06), iron, "YZ"
        )
