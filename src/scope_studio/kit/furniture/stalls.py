"""Market stalls: canvas, crates of produce, price cards, flowers, hand carts. Customers stand towards +y."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import bpy

from scope_studio.kit.core.finishes import PALETTE, paint, sheet, steel, stripes, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

CRATE_M = (0.56, 0.38, 0.16)
"""Width, depth and height of a produce crate."""

COUNTER_M = 0.78
"""Height of a stall's counter at its front edge."""


def stall(first: str, second: str | None = None, *, sign: str | None = None, table: bool = True, rolled: bool = False) -> Built:
    """Build a stall, 3.0 x 2.2 m: steel poles, ridged canopy, sloping counter with a skirt, and a name board.

    The canopy is plain, or striped with ``second``. The name board hangs under its front edge. ``rolled`` leaves the frame
    without canvas.
    """
    s = Solid("market stall")
    pole, w, d = steel(), 1.5, 1.1
    cloth = stripes(f"canvas {first} {second or first}", first, second or first, 0.5)
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
        with s.at(0, 0.35, COUNTER_M + 0.12, pitch=-14):
            s.box((2 * w - 0.08, 1.24, 0.04), (0, 0, 0), timber(fresh=False), 0.006)
        for x in (-w + 0.15, 0.0, w - 0.15):
            s.rod((x, 0.88, 0.0), (x, 0.88, COUNTER_M - 0.03), 0.02, pole)
            s.rod((x, -0.2, 0.0), (x, -0.2, 1.02), 0.02, pole)
        skirt = plain("stall skirt", (0.030, 0.065, 0.034), 0.95)
        n = 40
        line = [(-w + 0.02 + (2 * w - 0.04) * k / n, 0.955 + 0.014 * math.sin(k * 2.1), 0.0) for k in range(n + 1)]
        points = [(x, y, 0.04) for x, y, _ in line] + [(x, 0.955, COUNTER_M - 0.02) for x, _, _ in line]
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
        s.text(sign, cap, (0, d + 0.2885, 2.13), paint("dark green" if first != "green" else "navy", dirt=0.05))
    return s.built()


def _canopy(s: Solid, cloth: bpy.types.Material, w: float, d: float) -> None:
    """Add canvas over the ridge that sags between the poles, with a scalloped valance front and back."""
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


def crate(colour: str = "timber") -> Built:
    """Build an empty slatted crate, standing on z = 0, in "timber" or a paint colour."""
    s = Solid("crate")
    _crate(s, colour)
    return s.built()


def _crate(s: Solid, colour: str) -> None:
    w, d, h = CRATE_M
    stuff = timber() if colour == "timber" else paint(colour, dirt=0.25, roughness=0.55)
    s.box((w, d, 0.012), (0, 0, 0.008), stuff, 0.0)
    for z in (0.045, 0.125):
        for y in (-d / 2, d / 2):
            s.box((w, 0.010, 0.052), (0, y, z), stuff, 0.002)
        for x in (-w / 2, w / 2):
            s.box((0.010, d, 0.052), (x, 0, z), stuff, 0.002)
    for x in (-w / 2 + 0.015, w / 2 - 0.015):
        for y in (-d / 2 + 0.015, d / 2 - 0.015):
            s.box((0.03, 0.03, h), (x, y, h / 2), stuff, 0.002)


Maker = Callable[[Solid, random.Random, float, float, float], None]


def _ball(radius: float, *tints: tuple[float, float, float], squash: float = 0.92, name: str) -> Maker:
    profile = [(0.15, -0.95), (0.7, -0.7), (1.0, 0.0), (0.75, 0.72), (0.3, 0.93), (0.08, 0.82)]

    def make(s: Solid, rng: random.Random, x: float, y: float, z: float) -> None:
        k = rng.randrange(len(tints))
        r = radius * rng.uniform(0.88, 1.1)
        with s.at(x, y, z, turn=rng.uniform(0, 360), pitch=rng.uniform(-60, 60)):
            s.lathe([(u * r, v * r * squash) for u, v in profile], plain(f"{name} {k}", tints[k], 0.35), steps=9)

    return make


def _stick(length: float, radius: float, *tints: tuple[float, float, float], tip: float = 0.3, name: str) -> Maker:
    def make(s: Solid, rng: random.Random, x: float, y: float, z: float) -> None:
        k = rng.randrange(len(tints))
        a = math.radians(rng.uniform(-14, 14))
        c, w = math.cos(a) * length / 2, math.sin(a) * length / 2
        s.rod((x - w, y - c, z), (x + w, y + c, z + rng.uniform(-0.01, 0.01)), radius * rng.uniform(0.85, 1.1),
              plain(f"{name} {k}", tints[k], 0.55), radius_b=radius * tip, sides=8)  # fmt: skip

    return make


def _leafy(radius: float, low: tuple[float, float, float], high: tuple[float, float, float], name: str) -> Maker:
    def make(s: Solid, rng: random.Random, x: float, y: float, z: float) -> None:
        for k in range(7):
            a = 2 * math.pi * k / 7 + rng.uniform(-0.3, 0.3)
            u, v = math.cos(a), math.sin(a)
            r = radius * rng.uniform(0.9, 1.15)
            p = [
                (x, y, z),
                (x + u * r * 0.5 - v * r * 0.35, y + v * r * 0.5 + u * r * 0.35, z + r * 0.55),
                (x + u * r, y + v * r, z + r * 0.5),
                (x + u * r * 0.5 + v * r * 0.35, y + v * r * 0.5 - u * r * 0.35, z + r * 0.55),
            ]
            s.add(p, [(0, 1, 2, 3)], plain(f"{name} {k % 2}", low if k % 2 else high, 0.6))
        s.lathe(
            [
                (0.1 * radius, -0.2 * radius),
                (0.62 * radius, 0.1 * radius),
                (0.5 * radius, 0.6 * radius),
                (0.1 * radius, 0.8 * radius),
            ],
            plain(f"{name} 1", low, 0.6),
            (x, y, z),
            steps=8,
        )

    return make


PRODUCE: dict[str, tuple[Maker, float]] = {
    "apples": (_ball(0.040, (0.42, 0.020, 0.018), (0.36, 0.05, 0.02), (0.48, 0.10, 0.03), name="apple"), 0.078),
    "green apples": (_ball(0.040, (0.24, 0.34, 0.035), (0.30, 0.36, 0.05), name="green apple"), 0.078),
    "oranges": (_ball(0.043, (0.80, 0.22, 0.008), (0.76, 0.26, 0.012), name="orange"), 0.082),
    "lemons": (_ball(0.034, (0.82, 0.62, 0.03), (0.76, 0.60, 0.05), squash=1.3, name="lemon"), 0.070),
    "tomatoes": (_ball(0.036, (0.56, 0.022, 0.012), (0.60, 0.045, 0.014), squash=0.8, name="tomato"), 0.070),
    "potatoes": (_ball(0.040, (0.30, 0.205, 0.105), (0.25, 0.17, 0.085), squash=1.25, name="potato"), 0.076),
    "onions": (_ball(0.038, (0.40, 0.20, 0.065), (0.36, 0.17, 0.05), name="onion"), 0.074),
    "plums": (_ball(0.028, (0.075, 0.014, 0.075), (0.055, 0.010, 0.06), name="plum"), 0.056),
    "peppers": (_ball(0.044, (0.60, 0.025, 0.012), (0.82, 0.50, 0.015), (0.03, 0.20, 0.03), squash=1.15, name="pepper"), 0.086),
    "carrots": (_stick(0.20, 0.019, (0.78, 0.20, 0.012), (0.72, 0.22, 0.02), name="carrot"), 0.040),
    "leeks": (_stick(0.32, 0.018, (0.55, 0.60, 0.36), (0.10, 0.22, 0.045), tip=1.0, name="leek"), 0.042),
    "baguettes": (_stick(0.34, 0.032, (0.52, 0.28, 0.085), (0.46, 0.23, 0.065), tip=0.7, name="baguette"), 0.066),
    "loaves": (_ball(0.075, (0.42, 0.20, 0.06), (0.36, 0.16, 0.045), squash=0.62, name="loaf"), 0.145),
    "rolls": (_ball(0.043, (0.56, 0.33, 0.12), (0.48, 0.26, 0.085), squash=0.7, name="roll"), 0.085),
    "fish": (_stick(0.30, 0.036, (0.40, 0.44, 0.47), (0.30, 0.35, 0.40), tip=0.25, name="fish"), 0.066),
    "salmon": (_stick(0.30, 0.045, (0.72, 0.26, 0.16), (0.66, 0.24, 0.15), tip=0.6, name="salmon"), 0.085),
    "prawns": (_ball(0.022, (0.72, 0.30, 0.20), (0.66, 0.32, 0.24), squash=1.3, name="prawn"), 0.045),
    "cabbages": (_leafy(0.095, (0.10, 0.21, 0.055), (0.20, 0.32, 0.10), "cabbage"), 0.165),
    "lettuces": (_leafy(0.080, (0.17, 0.33, 0.045), (0.28, 0.43, 0.085), "lettuce"), 0.140),
    "cheeses": (_ball(0.085, (0.66, 0.42, 0.08), (0.62, 0.50, 0.26), squash=0.5, name="cheese"), 0.165),
}
"""Kinds of produce: the pieces that fill a crate, and their spacing (m)."""


def produce_crate(kind: str, *, seed: int = 0, colour: str = "timber") -> Built:
    """Build a crate heaped with one kind of ``PRODUCE``."""
    s = Solid(f"crate of {kind}")
    rng = random.Random(f"{kind} {seed}")
    _crate(s, colour)
    w, d, h = CRATE_M
    make, pitch = PRODUCE[kind]
    bed = {"fish": (0.62, 0.70, 0.74), "salmon": (0.62, 0.70, 0.74), "prawns": (0.62, 0.70, 0.74)}.get(kind, (0.10, 0.08, 0.05))
    s.box((w - 0.02, d - 0.02, h - 0.06), (0, 0, (h - 0.06) / 2 + 0.01), plain(f"crate bed {bed[0]:.2f}", bed, 0.7), 0.0)
    long = kind in ("carrots", "leeks", "baguettes", "fish", "salmon")
    nx = max(2, int((w - 0.04) / pitch))
    ny = 1 if long else max(2, int((d - 0.04) / pitch))
    for layer in range(2):
        for i in range(nx - layer):
            for j in range(ny - (layer if ny > 1 else 0)):
                x = (i + 0.5 * layer + 0.5) * (w - 0.04) / nx - (w - 0.04) / 2 + rng.uniform(-0.08, 0.08) * pitch
                y = (
                    0.0
                    if ny == 1
                    else (j + 0.5 * layer + 0.5) * (d - 0.04) / ny - (d - 0.04) / 2 + rng.uniform(-0.08, 0.08) * pitch
                )
                make(s, rng, x, y, h - 0.04 + pitch * (0.35 + 0.62 * layer) + rng.uniform(-0.004, 0.008))
    return s.built()


def price_card(text: str, *, cap: float = 0.055, colour: str = "white") -> Built:
    """Build a card on a stick with a word and a price, on one line or two (split at the newline).

    The foot of the stick is at the origin.
    """
    s = Solid("price card")
    lines = text.split("\n")
    width = max(extent(line, cap) for line in lines) + 0.07
    tall = (len(lines) * 1.55 + 0.5) * cap
    s.rod((0, -0.006, 0.0), (0, -0.006, 0.20 + tall / 2), 0.006, timber(), sides=6)
    s.box((width, 0.006, tall), (0, 0.0, 0.19 + tall / 2), sheet(colour, dirt=0.06), 0.0)
    ink = paint("black", dirt=0.0) if colour in ("white", "yellow") else paint("white", dirt=0.0)
    for k, line in enumerate(lines):
        s.text(line, cap, (0, 0.0036, 0.19 + tall - cap * (1.02 + 1.55 * k)), ink)
    return s.built()


def flower_bucket(bloom: str, *, seed: int = 0) -> Built:
    """Build a zinc bucket of cut flowers, 0.6 m high. ``bloom`` is a colour of the palette."""
    s = Solid(f"bucket of {bloom} flowers")
    rng = random.Random(f"bucket {bloom} {seed}")
    s.lathe([(0.105, 0.0), (0.135, 0.28), (0.145, 0.285), (0.130, 0.275), (0.12, 0.24)], steel(), steps=20)
    flowers(s, rng, bloom, count=34, reach=0.20, low=0.26, high=0.56)
    return s.built()


def flowers(s: Solid, rng: random.Random, bloom: str, *, count: int, reach: float, low: float, high: float) -> None:
    """Add a round bunch of flowers: stems, leaves and six-petalled heads."""
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
