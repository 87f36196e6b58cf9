"""Traffic cones, drums and barriers.

Pieces that are placed in a row (boards, water barriers) extend along x, and their fronts face +y. The concrete barrier
extends along y.
"""

from __future__ import annotations

import itertools

from scope_studio.kit.core.finishes import concrete, glow, lens, paint, rubber, sheet, steel
from scope_studio.kit.core.shapes import rounded_rectangle
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def cone(height: float = 0.75) -> Built:
    """Build an orange traffic cone with two white reflective sleeves on a black rubber base. ``height`` is 0.75 or 1.0 m."""
    s = Solid("cone")
    k = height / 0.75
    orange, white = paint("orange", dirt=0.34, roughness=0.46), sheet("white", dirt=0.30)
    base = rounded_rectangle(0.43 * k, 0.43 * k, 0.05 * k)
    s.prism(base, (0.0, 0.022 * k), rubber(), "XY")
    s.prism([(x * 0.93, y * 0.93) for x, y in base], (0.022 * k, 0.040 * k), rubber(), "XY")
    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        s.box((0.07 * k, 0.07 * k, 0.02 * k), (sx * 0.155 * k, sy * 0.155 * k, 0.047 * k), rubber(), 0.008)

    def radius(z: float) -> float:
        return k * (0.142 + (0.030 - 0.142) * z / 0.75)

    cuts = [0.038, 0.30, 0.43, 0.50, 0.62, 0.75]
    for index, (low, high) in enumerate(itertools.pairwise(cuts)):
        sleeve = index in (1, 3)
        lift = 0.003 if sleeve else 0.0
        profile = [(radius(z) + lift * k, z * k) for z in (low, high)]
        if index == 0:
            profile = [(0.168 * k, 0.036 * k), (0.160 * k, 0.060 * k), (radius(0.085), 0.085 * k), *profile[1:]]
        if index == 4:
            profile += [(0.024 * k, 0.752 * k), (0.020 * k, 0.70 * k)]
        s.lathe(profile, white if sleeve else orange, steps=28)
    s.lathe([(0.019 * k, 0.70 * k), (0.0185 * k, 0.701 * k)], lens("black"), steps=12)
    return s.built()


def drum() -> Built:
    """Build a traffic drum: an orange barrel with white bands, 1.0 m high, on a rubber ring."""
    s = Solid("drum")
    orange, white = paint("orange", dirt=0.34, roughness=0.46), sheet("white", dirt=0.26)
    s.lathe([(0.36, 0.0), (0.37, 0.02), (0.36, 0.07), (0.30, 0.085)], rubber(), steps=36)
    steps = [
        (0.292, 0.06, 0.22),
        (0.278, 0.22, 0.36),
        (0.266, 0.36, 0.51),
        (0.254, 0.51, 0.65),
        (0.242, 0.65, 0.79),
        (0.230, 0.79, 0.93),
    ]
    for index, (r, low, high) in enumerate(steps):
        s.lathe(
            [(r + 0.010, low), (r + 0.010, low + 0.012), (r, low + 0.022), (r - 0.004, high - 0.01), (r - 0.012, high)],
            orange,
            steps=36,
        )
        if index % 2 == 1 or index == 4:
            s.lathe(
                [(r + 0.004, low + 0.026), (r + 0.001, high - 0.012)],
                white if index % 2 else sheet("hi-vis orange"),
                steps=36,
            )
    s.lathe([(0.222, 0.925), (0.215, 0.955), (0.14, 0.965), (0.13, 0.955)], orange, steps=36)
    s.tube(
        [(-0.10, 0, 0.95), (-0.085, 0, 1.0), (-0.03, 0, 1.02), (0.03, 0, 1.02), (0.085, 0, 1.0), (0.10, 0, 0.95)],
        0.018,
        orange,
    )
    return s.built()


def delineator() -> Built:
    """Build a flexible orange post, 1.0 m high, with two white bands, on a black foot."""
    s = Solid("delineator post")
    s.lathe([(0.20, 0.0), (0.20, 0.03), (0.17, 0.055), (0.07, 0.075)], rubber(), steps=24)
    orange, white = paint("orange", dirt=0.34), sheet("white")
    s.lathe([(0.042, 0.07), (0.040, 0.96), (0.034, 0.99), (0.015, 1.0)], orange, steps=20)
    for low in (0.56, 0.76):
        s.lathe([(0.0435, low), (0.0435, low + 0.10)], white, steps=20)
    return s.built()


def striped_plank(s: Solid, width: float, height: float, x0: float, y: float, z: float, count: int, depth: float = 0.03) -> None:
    """Add a plank with alternating red and white reflective blocks on both faces."""
    step = width / count
    for i in range(count):
        s.box(
            (step, depth, height),
            (x0 + (i + 0.5) * step, y, z),
            sheet("red" if i % 2 == 0 else "white", dirt=0.26),
            0.003,
        )


def barrier_board(*, lit: bool = True) -> Built:
    """Build a red and white plank barrier on folding feet, 2.0 m wide and 1.05 m high, with two amber lamps."""
    s = Solid("barrier board")
    for z in (0.92, 0.52):
        striped_plank(s, 2.0, 0.24, -1.0, 0.0, z, 8)
    for x in (-0.78, 0.78):
        s.rod((x, -0.025, 1.02), (x, -0.025, 0.10), 0.022, steel())
        for sign in (-1, 1):
            s.rod((x, -0.025, 0.55), (x, sign * 0.34, 0.05), 0.016, steel())
        s.box((0.16, 0.82, 0.09), (x, 0.0, 0.045), rubber(), 0.015)
        lamp(s, x, 0.0, 1.04, lit)
    return s.built()


def lamp(s: Solid, x: float, y: float, z: float, lit: bool, colour: str = "amber") -> None:
    """Add a road-works lamp: a yellow battery box with a round lens on each side. ``z`` is the height of its lower edge."""
    s.box((0.15, 0.09, 0.13), (x, y, z + 0.065), paint("yellow", dirt=0.35), 0.012)
    s.lathe(
        [(0.05, -0.045), (0.088, -0.038), (0.092, 0.0), (0.088, 0.038), (0.05, 0.045)],
        paint("black"),
        (x, y, z + 0.225),
        "Y",
    )
    bright = glow(colour, 2.2) if lit else lens(colour)
    for side in (-1, 1):
        s.lathe(
            [(0.03, side * 0.062), (0.062, side * 0.055), (0.078, side * 0.04)][:: 1 if side < 0 else -1],
            bright,
            (x, y, z + 0.225),
            "Y",
        )


def water_barrier(colour: str = "red") -> Built:
    """Build a water-filled plastic barrier, 1.5 m long and 0.9 m high, with interlocking ends.

    ``colour`` is "red", "white" or "orange".
    """
    s = Solid(f"{colour} water barrier")
    body = paint(colour, dirt=0.36, roughness=0.42)
    half = [
        (0.25, 0.03),
        (0.255, 0.10),
        (0.25, 0.24),
        (0.165, 0.36),
        (0.115, 0.62),
        (0.105, 0.80),
        (0.09, 0.88),
        (0.05, 0.90),
    ]
    stations = [(-0.75, 0.86), (-0.735, 1.0), (-0.42, 1.0), (-0.39, 0.80), (-0.31, 0.80), (-0.28, 1.0)]
    stations += [(-0.05, 1.0), (-0.03, 0.86), (0.03, 0.86), (0.05, 1.0)] + [(-x, w) for x, w in stations[::-1]]
    points = []
    for x, width in stations:
        ring = [(y, z) for y, z in half] + [(-y, z) for y, z in half[::-1]]
        points += [
            (x, y * width if 0.15 < z < 0.86 else y * (0.5 + 0.5 * width), z - (1.0 - width) * 0.06 * (z > 0.85)) for y, z in ring
        ]
    n = 2 * len(half)
    faces = [
        (i * n + (k + 1) % n, i * n + k, (i + 1) * n + k, (i + 1) * n + (k + 1) % n)
        for i in range(len(stations) - 1)
        for k in range(n)
    ]
    s.add(points, [*faces, tuple(range(n)), tuple(range((len(stations) - 1) * n, len(stations) * n))[::-1]], body)
    for sx in (-1, 1):
        s.box((0.24, 0.53, 0.085), (sx * 0.35, 0.0, 0.062), lens("black"), 0.01)
        s.lathe([(0.05, 0.28), (0.05, 0.62)], body, (sx * 0.765, 0.0, 0.0), steps=14)
        s.lathe([(0.035, 0.62), (0.035, 0.78)], body, (sx * 0.765, 0.0, 0.0), steps=14)
    s.lathe([(0.055, 0.885), (0.058, 0.915), (0.05, 0.93)], paint("black"), (-0.35, 0, 0), steps=14)
    band = sheet("white" if colour != "white" else "red", dirt=0.28)
    for side in (-1, 1):
        for cx in (-0.56, -0.17, 0.17, 0.56):
            s.add(
                [
                    (cx - 0.09, side * 0.1215, 0.64),
                    (cx + 0.09, side * 0.1215, 0.64),
                    (cx + 0.09, side * 0.110, 0.78),
                    (cx - 0.09, side * 0.110, 0.78),
                ],
                [(0, 1, 2, 3) if side < 0 else (3, 2, 1, 0)],
                band,
            )
    return s.built()


def concrete_barrier(length: float = 3.0) -> Built:
    """Build a concrete safety barrier (New Jersey profile), 0.81 m high and ``length`` metres long, along y.

    It has drain slots, lifting loops and reflectors.
    """
    s = Solid("concrete barrier")
    half = [(0.290, 0.0), (0.300, 0.01), (0.300, 0.075), (0.175, 0.255), (0.095, 0.77), (0.08, 0.80), (0.06, 0.81)]
    ring = half + [(-x, z) for x, z in half[::-1]]
    n = len(ring)
    ends = [(-length / 2, 0.94), (-length / 2 + 0.02, 1.0), (length / 2 - 0.02, 1.0), (length / 2, 0.94)]
    points = [(x * f, y, z if z < 0.3 else 0.3 + (z - 0.3) * (0.96 + 0.04 * (f == 1.0))) for y, f in ends for x, z in ring]
    faces = [(i * n + k, i * n + (k + 1) % n, (i + 1) * n + (k + 1) % n, (i + 1) * n + k) for i in range(3) for k in range(n)]
    s.add(points, [*faces, tuple(range(n))[::-1], tuple(range(3 * n, 4 * n))], concrete())
    slots = max(1, round(length / 1.5))
    for i in range(slots):
        y = (i + 0.5) * length / slots - length / 2
        s.box((0.605, 0.34, 0.07), (0.0, y, 0.034), lens("black"), 0.01)
    for sign in (-1, 1):
        y = sign * length * 0.29
        s.tube(
            [(0, y - 0.06, 0.79), (0, y - 0.06, 0.87), (0, y + 0.06, 0.87), (0, y + 0.06, 0.79)],
            0.009,
            steel(dark=True),
        )
        for side in (-1, 1):
            s.box((0.02, 0.09, 0.06), (side * 0.128, y, 0.62), sheet("white" if side < 0 else "amber"), 0.004)
    return s.built()


def chapter8_barrier() -> Built:
    """Build an orange plastic pedestrian barrier, 2.0 x 1.0 m, as in Chapter 8 of the British Traffic Signs Manual.

    It has a red and white reflective board along the top, and swivelling feet.
    """
    s = Solid("pedestrian barrier")
    orange = paint("orange", dirt=0.3, roughness=0.45)
    for x in (-0.97, 0.97):
        s.box((0.06, 0.05, 0.94), (x, 0, 0.53), orange, 0.015)
    for z, h in ((0.98, 0.05), (0.74, 0.05), (0.12, 0.15)):
        s.box((1.94, 0.045, h), (0, 0, z), orange, 0.012)
    s.box((1.90, 0.03, 0.21), (0, 0, 0.86), orange, 0.004)
    for i in range(12):
        for side in (-1, 1):
            s.box(
                (0.15, 0.004, 0.15),
                (-0.88 + i * 0.16, side * 0.018, 0.86),
                sheet("red" if i % 2 else "white", dirt=0.25),
                0.001,
            )
    for i in range(10):
        s.box((0.035, 0.03, 0.56), (-0.81 + i * 0.18, 0, 0.46), orange, 0.008)
    for x in (-0.72, 0.72):
        s.box((0.12, 0.56, 0.045), (x, 0, 0.023), rubber(), 0.012)
        s.box((0.07, 0.07, 0.08), (x, 0, 0.07), rubber(), 0.012)
    for z in (0.35, 0.80):
        s.rod((1.0, 0, z), (1.05, 0, z), 0.02, orange)
    return s.built()
