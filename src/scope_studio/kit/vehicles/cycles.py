"""Bicycles and bicycle stands."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy

from scope_studio.kit.core.finishes import lens, paint, rubber, steel
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

WHEEL_RADIUS_M = 0.345
"""Radius of the wheels in metres."""
REAR_HUB: Point = (0.0, -0.52, WHEEL_RADIUS_M)
"""Position of the rear hub in metres."""
FRONT_HUB: Point = (0.0, 0.54, WHEEL_RADIUS_M)
"""Position of the front hub in metres."""
CRANK_AXLE: Point = (0.0, -0.08, 0.29)
"""Position of the crank axle in metres."""
CRANK_LENGTH_M = 0.165
"""Length of a crank in metres."""
SADDLE: Point = (0.0, -0.27, 0.96)
"""Position of the top of the saddle in metres."""
GRIP: Point = (0.27, 0.24, 1.05)
"""Position of the right hand in metres. The left hand is its mirror image."""


@dataclass(frozen=True)
class _BicycleKind:
    """Parameters of a kind of bicycle. ``bar`` is the path of the right half of the handlebar, starting at the stem."""

    tyre_m: float
    bar: tuple[Point, ...]
    mudguards: bool
    step_through: bool = False


KINDS = {
    "town": _BicycleKind(0.019, ((0.06, 0.39, 1.03), (0.22, 0.35, 1.06), (0.29, 0.20, 1.045)), True),
    "step-through": _BicycleKind(0.019, ((0.06, 0.38, 1.06), (0.22, 0.34, 1.09), (0.29, 0.17, 1.07)), True, True),
    "road": _BicycleKind(
        0.013,
        ((0.18, 0.42, 0.98), (0.205, 0.50, 0.98), (0.21, 0.54, 0.93), (0.21, 0.50, 0.86), (0.21, 0.40, 0.855)),
        False,
    ),
    "mountain": _BicycleKind(0.028, ((0.10, 0.41, 1.01), (0.31, 0.37, 1.02)), False),
}
"""Parameters of each kind of bicycle."""


def bicycle(
    colour: str = "blue",
    *,
    kind: str = "town",
    basket: bool = False,
    front_wheel: bool = True,
    crank_deg: float = 35.0,
) -> Built:
    """Build an upright bicycle that faces +y.

    Args:
        basket: Add a wicker basket in front.
        front_wheel: Add the front wheel. If false, the bicycle stands on its fork.
        crank_deg: Angle of the right crank, measured forwards from the top.
    """
    s = Solid(f"{colour} bicycle")
    model, frame_paint = KINDS[kind], paint(colour, dirt=0.12, roughness=0.25)
    _wheel(s, REAR_HUB, model)
    if front_wheel:
        _wheel(s, FRONT_HUB, model)
    _frame(s, model, frame_paint)
    _bars(s, model)
    _drive(s, crank_deg)
    if basket:
        _basket(s)
    return s.built()


def _ring(hub: Point, radius: float, start: float = 0.0, stop: float = 360.0, steps: int = 36) -> list[Point]:
    """Return the points of a circular arc around a hub, in the plane of the wheel."""
    count = steps if stop - start >= 360 else steps + 1
    angles = [math.radians(start + (stop - start) * k / steps) for k in range(count)]
    return [(0.0, hub[1] + radius * math.cos(a), hub[2] + radius * math.sin(a)) for a in angles]


def _wheel(s: Solid, hub: Point, model: _BicycleKind) -> None:
    chrome, r = steel(), WHEEL_RADIUS_M
    s.tube(_ring(hub, r - model.tyre_m), model.tyre_m, rubber(), sides=8, closed=True)
    s.tube(_ring(hub, r * 0.89), 0.010, chrome, sides=6, closed=True)
    s.rod((-0.05, hub[1], r), (0.05, hub[1], r), 0.017, chrome)
    for k in range(28):
        a = 2 * math.pi * k / 28
        b = a + (0.6 if k % 2 else -0.6)
        x = 0.028 if k % 4 < 2 else -0.028
        s.tube(
            [
                (x, hub[1] + 0.02 * math.cos(b), r + 0.02 * math.sin(b)),
                (0, hub[1] + 0.30 * math.cos(a), r + 0.30 * math.sin(a)),
            ],
            0.0012,
            chrome,
            sides=4,
        )
    if model.mudguards:
        guard = _ring(hub, 0.372, *((15, 200) if hub is REAR_HUB else (20, 150)), steps=16)
        for dx in (-0.014, 0.0, 0.014):
            s.tube([(dx, y, z) for _, y, z in guard], 0.010, paint("black", dirt=0.1), sides=6)


def _frame(s: Solid, model: _BicycleKind, frame_paint: bpy.types.Material) -> None:
    seat, low, top = (0.0, -0.24, 0.80), (0.0, 0.40, 0.70), (0.0, 0.36, 0.86)
    bars: list[tuple[Point, Point, float]] = [(CRANK_AXLE, seat, 0.017), (CRANK_AXLE, low, 0.020), (low, top, 0.023)]
    bars.append(((0.0, -0.14, 0.50), (0.0, 0.385, 0.77), 0.017) if model.step_through else (seat, top, 0.017))
    for a, b, radius in bars:
        s.rod(a, b, radius, frame_paint, sides=12)
    for x in (-0.05, 0.05):
        s.rod((x * 0.5, *CRANK_AXLE[1:]), (x, *REAR_HUB[1:]), 0.011, frame_paint)
        s.rod((x * 0.4, seat[1] + 0.02, seat[2] - 0.06), (x, *REAR_HUB[1:]), 0.009, frame_paint)
        s.tube([(x * 0.9, low[1], low[2] - 0.01), (x, 0.47, 0.52), (x, *FRONT_HUB[1:])], 0.012, frame_paint)
    s.rod(seat, (0, -0.275, 0.94), 0.013, steel())
    saddle = [(-0.085, -0.40), (0.085, -0.40), (0.07, -0.27), (0.025, -0.13), (-0.025, -0.13), (-0.07, -0.27)]
    s.prism(saddle, (0.935, 0.985), paint("brown" if model.step_through else "black", dirt=0.1), "XY")
    s.box((0.05, 0.03, 0.05), (0, -0.47, 0.80), lens("red"), 0.01)
    if model.mudguards:
        s.box((0.12, 0.36, 0.016), (0, -0.58, 0.765), paint("black", dirt=0.1), 0.004)
        for x in (-0.10, 0.10):
            s.rod((x * 0.6, -0.62, 0.76), (x * 0.5, -0.52, 0.345), 0.005, steel())


def _bars(s: Solid, model: _BicycleKind) -> None:
    right = list(model.bar)
    path = [(-x, y, z) for x, y, z in right[::-1]] + right
    s.tube(path, 0.011, steel(), sides=10)
    for sign in (-1, 1):
        (x0, y0, z0), (x1, y1, z1) = right[-2], right[-1]
        s.rod((sign * (x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2), (sign * x1, y1, z1), 0.016, paint("black", dirt=0.1))
    s.tube([(0, 0.36, 0.86), (0, 0.345, 0.97), (0, right[0][1], right[0][2])], 0.013, steel())
    s.lathe([(0.012, -0.05), (0.035, 0.0), (0.033, 0.008)], lens("white"), (0, 0.47, 0.92), "Y", 16)


def _drive(s: Solid, crank_deg: float) -> None:
    """Add chain ring, chain, cranks and pedals."""
    black, chrome = paint("black", dirt=0.1), steel()
    s.lathe([(0.02, -0.004), (0.085, -0.002), (0.085, 0.002)], chrome, (0.055, CRANK_AXLE[1], CRANK_AXLE[2]), "X", 28)
    for z, end in ((0.372, 0.385), (0.208, 0.305)):
        s.tube([(0.055, CRANK_AXLE[1], z), (0.055, REAR_HUB[1], end)], 0.005, black, sides=4)
    for side in (1, -1):
        y, z = pedal(crank_deg, side)
        s.rod((side * 0.07, *CRANK_AXLE[1:]), (side * 0.085, y, z), 0.010, chrome)
        s.box((0.09, 0.075, 0.022), (side * 0.14, y, z), black, 0.005)


def pedal(crank_deg: float, side: int) -> tuple[float, float]:
    """Return the position (y, z) in metres of the right (``side`` +1) or left (-1) pedal."""
    a = math.radians(crank_deg) + (0.0 if side > 0 else math.pi)
    return CRANK_AXLE[1] + CRANK_LENGTH_M * math.sin(a), CRANK_AXLE[2] + CRANK_LENGTH_M * math.cos(a)


def _basket(s: Solid) -> None:
    wicker = plain("wicker", (0.26, 0.15, 0.06), 0.8)
    for k in range(7):
        z, grow = 0.80 + 0.035 * k, 0.012 * k
        w, d = 0.14 + grow, 0.10 + grow * 0.7
        y = 0.57
        ring = [(w, y - d, z), (w, y + d, z), (-w, y + d, z), (-w, y - d, z)]
        s.tube(ring, 0.009, wicker, sides=6, closed=True)
    for k in range(9):
        x = -0.14 + 0.035 * k
        for side in (-1, 1):
            s.rod((x, 0.57 + side * 0.10, 0.80), (x * 1.4, 0.57 + side * 0.15, 1.01), 0.004, wicker, sides=4)
    for k in range(6):
        y = 0.48 + 0.036 * k
        for side in (-1, 1):
            s.rod((side * 0.14, y, 0.80), (side * 0.21, y, 1.01), 0.004, wicker, sides=4)
    s.box((0.27, 0.19, 0.01), (0, 0.57, 0.80), wicker, 0.0)


def bike_stand() -> Built:
    """Build a bicycle stand for two bicycles: a steel hoop along y, 0.75 m high and long."""
    s = Solid("bike stand")
    bend = [(0.0, 0.375 - 0.09 + 0.09 * math.sin(a), 0.66 + 0.09 * math.cos(a)) for a in (k * math.pi / 12 for k in range(7))]
    path = [(0.0, 0.375, 0.0), *bend[::-1], *[(0.0, -y, z) for _, y, z in bend], (0.0, -0.375, 0.0)]
    s.tube(path, 0.024, plain("stainless tube", (0.55, 0.56, 0.57), 0.28, 0.9), sides=12)
    for y in (-0.375, 0.375):
        s.lathe([(0.07, 0.0), (0.07, 0.008), (0.03, 0.012)], steel(), (0, y, 0), steps=16)
    return s.built()
