"""Market stalls: canopies, counters, flowers and hand carts. Customers stand on the +y side."""

from __future__ import annotations

import math
import random

import bpy

from scope_studio.kit.core.finishes import PALETTE, paint, steel, stripes, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

COUNTER_HEIGHT_M = 0.78
"""Height in metres of a stall's counter at its front edge."""


def stall(
    colour: str, second_colour: str | None = None, *, sign: str | None = None, table: bool = True, rolled: bool = False
) -> Built:
    """Build a stall, 3.0 x 2.2 m, with steel poles, a ridged canopy, a sloping counter with a skirt, and a name board.

    The canopy is plain, or striped if ``second_colour`` is given. The name board hangs under its front edge. With ``rolled``, the
    canvas is rolled up at the back of the frame.
    """
    s = Solid("market stall")
    pole, w, d = steel(), 1.5, 1.1
    cloth = stripes(f"canvas {colour} {second_colour or colour}", colour, second_colour or colour, 0.5)
    for x in (-w, w):
        for y in (-d, d):
            s.rod((x, y, 0.0), (x, y, 2.30), 0.022, pole)
            s.box((0.16, 0.16, 0.012), (x, y, 0.006), steel(dark=True), 0.003)
        s.rod((x, -d, 2.28), (x, d, 2.28), 0.018, pole)
        s.rod((x, -d, 2.28), (x, 0, 2.78), 0.016, pole)
        s.rod((x, d, 2.28), (x, 0, 2.78), 0.016, pole)
    for y, z in ((-d, 2.28), (d, 2.28), (0, 2.78)):
        s.rod((-w, y, z), (w, y, z), 0.018, pole)
    if rolled:
        s.lathe([(0.09, -w), (0.11, -w * 0.5), (0.10, 0.2), (0.11, w * 0.6), (0.08, w)], cloth, (0, -d + 0.02, 2.40), "X", 14)
    else:
        _canopy(s, cloth, w + 0.14, d + 0.22)
    if table:
        with s.at(0, 0.35, COUNTER_HEIGHT_M + 0.12, pitch=-14):
            s.box((2 * w - 0.08, 1.24, 0.04), (0, 0, 0), timber(fresh=False), 0.006)
        for x in (-w + 0.15, 0.0, w - 0.15):
            s.rod((x, 0.88, 0.0), (x, 0.88, COUNTER_HEIGHT_M - 0.03), 0.02, pole)
            s.rod((x, -0.2, 0.0), (x, -0.2, 1.02), 0.02, pole)
        skirt = plain("stall skirt", (0.030, 0.065, 0.034), 0.95)
        n = 40
        line = [(-w + 0.02 + (2 * w - 0.04) * k / n, 0.955 + 0.014 * math.sin(k * 2.1), 0.0) for k in range(n + 1)]
        points = [(x, y, 0.04) for x, y, _ in line] + [(x, 0.955, COUNTER_HEIGHT_M - 0.02) for x, _, _ in line]
        s.add(points, [(k + 1, k, n + 1 + k, n + 2 + k) for k in range(n)], skirt)
        s.add(
            [(-w + 0.02, 0.955, 0.04), (-w + 0.02, -0.2, 0.04), (-w + 0.02, -0.2, 1.0), (-w + 0.02, 0.955, 0.76)],
            [(0, 1, 2, 3)],
            skirt,
        )
        s.add(
            [(w - 0.02, 0.955, 0.04), (w - 0.02, -0.2, 0.04), (w - 0.02, -0.2, 1.0), (w - 0.02, 0.955, 0.76)], [(3, 2, 1, 0)], skirt
        )
    if sign:
        cap = min(0.19, 2.5 / extent(sign, 1.0))
        s.box((2.75, 0.03, 0.34), (0, d + 0.27, 2.13), paint("white", dirt=0.12), 0.01)
        s.text(sign, cap, (0, d + 0.2885, 2.13), paint("dark green" if colour != "green" else "navy", dirt=0.05))
    return s.built()


def _canopy(s: Solid, cloth: bpy.types.Material, w: float, d: float) -> None:
    """Add a canvas that is laid over the ridge and sags between the poles, with scalloped valances at the front and back."""
    n, rows = 24, [(-d, 2.30), (-d * 0.5, 2.53), (0.0, 2.82), (d * 0.5, 2.53), (d, 2.30)]
    points = []
    for y, z in rows:
        for i in range(n + 1):
            u = i / n
            sag = 0.035 * math.sin(math.pi * u) * (1.0 if y else 0.4) + 0.01 * math.sin(19 * u + y)
            points.append((-w + 2 * w * u, y, z - sag))
    m = n + 1
    faces = [(r * m + i, r * m + i + 1, (r + 1) * m + i + 1, (r + 1) * m + i) for r in range(len(rows) - 1) for i in range(n)]
    s.add(points, faces, cloth)
    for y in (-d, d):
        base, low = [], []
        for i in range(n * 2 + 1):
            u = i / (n * 2)
            z = 2.30 - 0.035 * math.sin(math.pi * u)
            base.append((-w + 2 * w * u, y, z))
            low.append((-w + 2 * w * u, y + math.copysign(0.03, y), z - 0.17 - 0.06 * abs(math.sin(math.pi * u * 12))))
        k = n * 2 + 1
        ring = [(i, i + 1, k + i + 1, k + i) for i in range(n * 2)]
        s.add(base + low, ring if y < 0 else [f[::-1] for f in ring], cloth)
    for x in (-w, w):
        s.add([(x, -d, 2.29), (x, 0, 2.81), (x, d, 2.29)], [(0, 1, 2)] if x < 0 else [(2, 1, 0)], cloth)


def flower_bucket(bloom: str, *, seed: int = 0) -> Built:
    """Build a zinc bucket of cut flowers, 0.6 m high. ``bloom`` is the name of a colour in ``PALETTE``."""
    s = Solid(f"bucket of {bloom} flowers")
    rng = random.Random(f"bucket {bloom} {seed}")
    s.lathe([(0.105, 0.0), (0.135, 0.28), (0.145, 0.285), (0.130, 0.275), (0.12, 0.24)], steel(), steps=20)
    flowers(s, rng, bloom, count=34, reach=0.20, low=0.26, high=0.56)
    return s.built()


def flowers(s: Solid, rng: random.Random, bloom: str, *, count: int, reach: float, low: float, high: float) -> None:
    """Add a round bunch of flowers with stems, leaves and six-petalled heads."""
    stem = plain("flower stem", (0.055, 0.14, 0.030), 0.7)
    colour = PALETTE[bloom]
    petals = [plain(f"petal {bloom} {k}", tuple(min(1.0, c * f) for c in colour), 0.7) for k, f in enumerate((1.0, 0.8, 1.25))]
    for k in range(count):
        a, r = rng.uniform(0, 2 * math.pi), reach * math.sqrt(rng.random())
        z = high - 0.35 * reach * (r / reach) ** 2 + rng.uniform(-0.05, 0.03)
        x, y = r * math.cos(a), r * math.sin(a)
        s.tube([(x * 0.35, y * 0.35, low), (x, y, z)], 0.004, stem, sides=3)
        leaf = rng.uniform(0, 6.28)
        mid = (x * 0.75, y * 0.75, low + (z - low) * 0.7)
        s.add(
            [
                mid,
                (mid[0] + 0.07 * math.cos(leaf) - 0.02, mid[1] + 0.07 * math.sin(leaf), mid[2] + 0.03),
                (mid[0] + 0.12 * math.cos(leaf), mid[1] + 0.12 * math.sin(leaf), mid[2] + 0.02),
                (mid[0] + 0.07 * math.cos(leaf) + 0.02, mid[1] + 0.07 * math.sin(leaf), mid[2] + 0.05),
            ],
            [(0, 1, 2, 3)],
            stem,
        )
        size, tint = rng.uniform(0.030, 0.045), petals[k % 3]
        for n in range(6):
            b = 2 * math.pi * n / 6
            u, v = math.cos(b), math.sin(b)
            s.add(
                [
                    (x, y, z),
                    (x + (u * 0.6 - v * 0.35) * size, y + (v * 0.6 + u * 0.35) * size, z + 0.012),
                    (x + u * size, y + v * size, z + 0.006),
                    (x + (u * 0.6 + v * 0.35) * size, y + (v * 0.6 - u * 0.35) * size, z + 0.012),
                ],
                [(0, 1, 2, 3)],
                tint,
            )
        s.lathe(
            [(0.008, -0.002), (0.010, 0.010), (0.003, 0.015)], plain("flower heart", (0.55, 0.36, 0.03), 0.8), (x, y, z), steps=6
        )


def hand_cart(colour: str = "green") -> Built:
    """Build a two-wheeled market barrow, 1.9 m long, with spoked wheels. It rests on its legs with the handles towards -y."""
    s = Solid("hand cart")
    wood, iron = paint(colour, dirt=0.35, roughness=0.6), paint("black", dirt=0.25)
    s.box((0.95, 1.5, 0.04), (0, 0.1, 0.62), timber(fresh=False), 0.008)
    for x in (-0.46, 0.46):
        s.box((0.05, 2.3, 0.08), (x, -0.25, 0.57), wood, 0.015)
        s.box((0.03, 1.5, 0.26), (x, 0.1, 0.76), wood, 0.01)
        s.rod((x, -0.52, 0.57), (x, -0.58, 0.0), 0.028, wood)
        cx = x + math.copysign(0.11, x)
        ring = [(cx, 0.30 + 0.42 * math.cos(a), 0.44 + 0.42 * math.sin(a)) for a in (2 * math.pi * k / 32 for k in range(32))]
        s.tube(ring, 0.022, iron, sides=6, closed=True)
        for k in range(12):
            a = 2 * math.pi * k / 12
            s.rod((cx, 0.30, 0.44), (cx, 0.30 + 0.41 * math.cos(a), 0.44 + 0.41 * math.sin(a)), 0.015, wood, sides=6)
        s.lathe([(0.05, -0.06), (0.06, 0.0), (0.05, 0.06)], iron, (cx, 0.30, 0.44), "X", 14)
    s.box((0.95, 0.03, 0.26), (0, 0.84, 0.76), wood, 0.01)
    s.rod((-0.56, 0.30, 0.44), (0.56, 0.30, 0.44), 0.02, iron)
    return s.built()
