"""Site equipment: arrow board, light tower, generator, plate compactor, wheelbarrow. Fronts face +y."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import glow, granular, lens, paint, rubber, sheet, steel
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.works.materials import heap


def wheel(s: Solid, x: float, y: float, radius: float, width: float) -> None:
    """Add a small wheel that stands on the ground, with its axle along x."""
    half = width / 2
    tyre = [
        (radius * 0.62, -half),
        (radius * 0.92, -half),
        (radius, -half * 0.7),
        (radius, half * 0.7),
        (radius * 0.92, half),
        (radius * 0.62, half),
    ]
    s.lathe(tyre, rubber(), (x, y, radius), "X", 28)
    s.lathe(
        [
            (radius * 0.25, -half * 1.02),
            (radius * 0.6, -half * 0.85),
            (radius * 0.6, half * 0.85),
            (radius * 0.25, half * 1.02),
        ],
        steel(),
        (x, y, radius),
        "X",
        20,
    )


def _trailer(s: Solid, width: float, length: float, colour: str) -> None:
    """Add a chassis along y with a draw bar towards -y, two wheels under mudguards, corner jacks and tail lamps."""
    body = paint(colour, dirt=0.35)
    for x in (-width * 0.36, width * 0.36):
        s.box((0.08, length, 0.10), (x, 0, 0.48), body, 0.01)
        s.rod((x, -length / 2, 0.48), (0, -length / 2 - 0.95, 0.45), 0.035, body)
    for y in (-length * 0.45, 0.0, length * 0.45):
        s.box((width * 0.76, 0.08, 0.08), (0, y, 0.48), body, 0.01)
    s.rod((0, -length / 2 - 0.9, 0.45), (0, -length / 2 - 1.25, 0.46), 0.04, steel(dark=True))
    s.rod((0, -length / 2 - 0.75, 0.75), (0, -length / 2 - 0.75, 0.14), 0.028, steel())
    s.lathe([(0.09, -0.03), (0.09, 0.03)], rubber(), (0, -length / 2 - 0.75, 0.09), "X", 16)
    for side in (-1, 1):
        wheel(s, side * (width / 2 - 0.05), 0.0, 0.31, 0.17)
        guard = [(0.38 * math.cos(math.radians(a)), 0.31 + 0.38 * math.sin(math.radians(a))) for a in range(10, 171, 20)]
        inner = [(u * 0.94, 0.31 + (v - 0.31) * 0.94) for u, v in guard[::-1]]
        x = side * (width / 2 - 0.05)
        s.prism([*guard, *inner], (x - 0.11, x + 0.11), paint("black"), "YZ")
        s.box((0.18, 0.03, 0.09), (side * width * 0.36, length / 2 + 0.06, 0.50), lens("red"), 0.008)
        for y in (-length * 0.46, length * 0.46):
            s.rod((side * width * 0.36, y, 0.55), (side * width * 0.36, y, 0.03), 0.025, steel())
            s.box((0.14, 0.14, 0.02), (side * width * 0.36, y, 0.012), steel(dark=True), 0.004)


def arrow_board(direction: str = "left", *, lit: bool = True) -> Built:
    """Build a trailer with a black board that faces +y. Its lamps show an arrow to the left or right, as seen by a driver.

    Red and white stripes are below the board.
    """
    s = Solid("arrow board")
    _trailer(s, 1.6, 1.9, "orange")
    s.box((0.95, 0.70, 0.40), (0, -0.30, 0.74), paint("orange", dirt=0.3), 0.03)
    for x in (-0.62, 0.62):
        s.box((0.08, 0.08, 2.5), (x, 0.72, 1.72), steel(), 0.008)
        s.rod((x, 0.70, 1.9), (x, -0.6, 0.55), 0.03, steel())
    s.box((2.3, 0.05, 1.35), (0, 0.80, 2.35), paint("dark grey", dirt=0.25), 0.015)
    s.box((2.2, 0.012, 1.25), (0, 0.829, 2.35), lens("black"), 0.004)
    for k in range(10):
        s.box((0.22, 0.03, 0.26), (-0.99 + 0.22 * k, 0.80, 1.45), sheet("red" if k % 2 == 0 else "white"), 0.002)
    sign = -1.0 if direction == "left" else 1.0
    shaft = [(0.75 - 0.215 * i, 0.0) for i in range(8)]
    head = [(-0.75 + 0.17 * i, side * 0.16 * i) for i in range(1, 4) for side in (-1, 1)]
    lamps = {(round(u, 3), round(v, 3)) for u, v in shaft + head}
    unlit = {(0.75 - 0.17 * i, side * 0.16 * i) for i in range(1, 4) for side in (-1, 1)}
    for u, v in sorted(lamps | unlit):
        bright = glow("amber", 6.0) if lit and (u, v) in lamps else lens("black")
        s.lathe([(0.072, 0.0), (0.072, 0.03), (0.066, 0.03)], paint("black"), (sign * u, 0.835, 2.35 + v), "Y", 18)
        s.lathe([(0.062, 0.012), (0.055, 0.030), (0.025, 0.042)], bright, (sign * u, 0.835, 2.35 + v), "Y", 18)
    for x in (-0.85, 0.85):
        s.lathe(
            [(0.10, 0.0), (0.10, 0.05), (0.07, 0.16), (0.02, 0.19)],
            glow("amber", 3.0) if lit else lens("amber"),
            (x, 0.78, 3.03),
            steps=18,
        )
    return s.built()


def light_tower(*, lit: bool = False) -> Built:
    """Build a mobile lighting mast, 7.5 m high: a trailer with an engine housing, a telescopic mast and four floodlights."""
    s = Solid("light tower")
    _trailer(s, 1.5, 2.0, "yellow")
    s.box((1.05, 1.65, 0.95), (0, 0.0, 1.02), paint("yellow", dirt=0.34), 0.06)
    for side in (-1, 1):
        for k in range(7):
            s.box((0.01, 0.5, 0.02), (side * 0.527, 0.35, 0.80 + 0.05 * k), lens("black"), 0.002)
        s.box((0.012, 0.55, 0.70), (side * 0.527, -0.40, 1.0), paint("yellow", dirt=0.45), 0.01)
    s.rod((0.3, 0.5, 1.45), (0.3, 0.5, 1.75), 0.035, steel(dark=True))
    for low, high, w in ((0.6, 3.2, 0.15), (3.0, 5.3, 0.12), (5.1, 7.2, 0.09)):
        s.box((w, w, high - low), (0, -0.92, (low + high) / 2), steel(), 0.008)
    s.box((1.3, 0.09, 0.09), (0, -0.92, 7.2), steel(), 0.01)
    for x in (-0.52, 0.52):
        for dz in (-0.20, 0.20):
            with s.at(x, -0.86, 7.25 + dz, pitch=-32):
                s.box((0.42, 0.14, 0.30), (0, 0, 0), paint("dark grey"), 0.03)
                s.box((0.37, 0.01, 0.25), (0, 0.071, 0), glow("white", 8.0) if lit else lens("light grey"), 0.003)
    return s.built()


def generator(colour: str = "green") -> Built:
    """Build a silenced generator on skids, 2.2 x 1.0 x 1.3 m, with louvres, a control panel and an exhaust."""
    s = Solid("generator")
    body = paint(colour, dirt=0.34)
    for y in (-0.35, 0.35):
        s.box((2.3, 0.14, 0.14), (0, y, 0.07), steel(dark=True), 0.01)
    s.box((2.2, 1.0, 1.10), (0, 0, 0.69), body, 0.05)
    s.box((2.1, 0.9, 0.05), (0, 0, 1.26), body, 0.02)
    for side in (-1, 1):
        for x in (-0.78, 0.0, 0.78):
            s.box((0.66, 0.012, 0.92), (x, side * 0.503, 0.70), body, 0.006)
            s.box((0.03, 0.03, 0.12), (x + 0.26, side * 0.518, 0.72), paint("black"), 0.005)
        for k in range(9):
            s.box((0.46, 0.012, 0.022), (-0.78, side * 0.512, 0.45 + 0.055 * k), lens("black"), 0.002)
    for k in range(12):
        s.box((0.012, 0.76, 0.024), (1.104, 0, 0.36 + 0.06 * k), lens("black"), 0.002)
    s.box((0.44, 0.02, 0.30), (0.78, 0.508, 0.92), lens("dark grey"), 0.006)
    s.lathe([(0.02, 0.0), (0.018, 0.006)], glow("green", 4.0), (0.66, 0.52, 0.99), "Y", 12)
    s.lathe([(0.05, 0.0), (0.05, 0.02), (0.03, 0.025)], paint("red", dirt=0.1), (0.88, 0.518, 0.86), "Y", 16)
    s.tube([(-0.85, 0.2, 1.25), (-0.85, 0.2, 1.42), (-0.92, 0.2, 1.47)], 0.04, steel(dark=True), sides=12)
    s.tube([(-0.12, 0, 1.28), (-0.12, 0, 1.36), (0.12, 0, 1.36), (0.12, 0, 1.28)], 0.018, steel(dark=True))
    s.text("100 kVA", 0.09, (0.0, 0.5125, 1.0), sheet("white"))
    return s.built()


def plate_compactor() -> Built:
    """Build a vibrating plate with an engine, a water tank, and a handle towards -y."""
    s = Solid("plate compactor")
    yellow = paint("yellow", dirt=0.45)
    s.prism(
        [
            (-0.30, 0.10),
            (-0.24, 0.02),
            (0.24, 0.02),
            (0.32, 0.12),
            (0.30, 0.13),
            (0.23, 0.05),
            (-0.23, 0.05),
            (-0.29, 0.11),
        ],
        (-0.22, 0.22),
        steel(dark=True),
        "YZ",
    )
    s.box((0.36, 0.40, 0.10), (0, 0, 0.13), yellow, 0.02)
    s.box((0.30, 0.30, 0.26), (0, -0.02, 0.33), paint("black", dirt=0.4), 0.04)
    s.box((0.20, 0.12, 0.14), (0.06, 0.08, 0.50), paint("red", dirt=0.3), 0.02)
    s.lathe([(0.06, 0.0), (0.06, 0.05)], steel(), (-0.10, 0.02, 0.46), steps=16)
    s.box((0.34, 0.14, 0.26), (0, 0.20, 0.42), yellow, 0.04)
    for x in (-0.17, 0.17):
        s.tube([(x, -0.12, 0.18), (x, -0.30, 0.45), (x, -0.72, 0.95), (x, -0.80, 0.97)], 0.016, yellow)
    s.rod((-0.17, -0.80, 0.97), (0.17, -0.80, 0.97), 0.018, rubber())
    return s.built()


def wheelbarrow(colour: str = "green", *, load: bool = True) -> Built:
    """Build a builder's wheelbarrow with its wheel towards +y. ``load`` fills it with sand."""
    s = Solid("wheelbarrow")
    body = paint(colour, dirt=0.45)
    low, high = (
        [(-0.20, -0.22), (0.20, -0.22), (0.15, 0.22), (-0.15, 0.22)],
        [(-0.33, -0.44), (0.33, -0.44), (0.28, 0.50), (-0.28, 0.50)],
    )
    outer = [(x, y, 0.34) for x, y in low] + [(x, y, 0.64) for x, y in high]
    inner = [(x * 0.94, y * 0.96, 0.35) for x, y in low] + [(x * 0.96, y * 0.97, 0.64) for x, y in high]
    shell = [(0, 3, 2, 1), *((k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4))]
    lining = [tuple(8 + i for i in f[::-1]) for f in shell]
    rim = [(4 + k, 4 + (k + 1) % 4, 12 + (k + 1) % 4, 12 + k) for k in range(4)]
    s.add(outer + inner, [*shell, *lining, *rim], body)
    s.tube([(x, y, 0.64) for x, y in high], 0.012, body, closed=True)
    for sx in (-1, 1):
        s.tube(
            [(sx * 0.07, 0.66, 0.20), (sx * 0.17, 0.20, 0.31), (sx * 0.24, -0.45, 0.44), (sx * 0.27, -0.88, 0.60)],
            0.016,
            steel(dark=True),
        )
        s.rod((sx * 0.265, -0.76, 0.55), (sx * 0.272, -0.90, 0.61), 0.021, rubber())
        s.tube(
            [(sx * 0.23, -0.30, 0.40), (sx * 0.25, -0.34, 0.02), (sx * 0.25, -0.24, 0.02), (sx * 0.19, 0.02, 0.33)],
            0.013,
            steel(dark=True),
        )
    wheel(s, 0.0, 0.66, 0.19, 0.09)
    if load:
        with s.at(0, 0.02, 0.50):
            heap(
                s,
                granular("sand", (0.30, 0.20, 0.095), (0.52, 0.38, 0.20), 160.0),
                (0.28, 0.40),
                0.20,
                seed=1.0,
                square=True,
            )
    return s.built()
