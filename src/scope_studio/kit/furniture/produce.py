"""Market produce: crates, the fruit, vegetables, bread, cheese and fish that fill them, and price cards."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

from scope_studio.kit.core.finishes import paint, sheet, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

CRATE_SIZE_M = (0.56, 0.38, 0.16)
"""Width, depth and height of a produce crate in metres."""


def crate(colour: str = "timber") -> Built:
    """Build an empty slatted crate, standing on z = 0, in "timber" or a paint colour."""
    s = Solid("crate")
    _crate(s, colour)
    return s.built()


def _crate(s: Solid, colour: str) -> None:
    """Add an empty crate."""
    w, d, h = CRATE_SIZE_M
    material = timber() if colour == "timber" else paint(colour, dirt=0.25, roughness=0.55)
    s.box((w, d, 0.012), (0, 0, 0.008), material, 0.0)
    for z in (0.045, 0.125):
        for y in (-d / 2, d / 2):
            s.box((w, 0.010, 0.052), (0, y, z), material, 0.002)
        for x in (-w / 2, w / 2):
            s.box((0.010, d, 0.052), (x, 0, z), material, 0.002)
    for x in (-w / 2 + 0.015, w / 2 - 0.015):
        for y in (-d / 2 + 0.015, d / 2 - 0.015):
            s.box((0.03, 0.03, h), (x, y, h / 2), material, 0.002)


AddPiece = Callable[[Solid, random.Random, float, float, float], None]
"""A function that adds one piece of produce at a position (x, y, z). The generator varies its appearance."""


def _ball(radius: float, *tints: tuple[float, float, float], squash: float = 0.92, name: str) -> AddPiece:
    """Return a function that adds a round fruit or vegetable in one of the colours, chosen at random."""
    profile = [(0.15, -0.95), (0.7, -0.7), (1.0, 0.0), (0.75, 0.72), (0.3, 0.93), (0.08, 0.82)]

    def make(s: Solid, rng: random.Random, x: float, y: float, z: float) -> None:
        k = rng.randrange(len(tints))
        r = radius * rng.uniform(0.88, 1.1)
        with s.at(x, y, z, turn=rng.uniform(0, 360), pitch=rng.uniform(-60, 60)):
            s.lathe([(u * r, v * r * squash) for u, v in profile], plain(f"{name} {k}", tints[k], 0.35), steps=9)

    return make


def _stick(length: float, radius: float, *tints: tuple[float, float, float], tip: float = 0.3, name: str) -> AddPiece:
    """Return a function that adds a long vegetable, loaf or fish in one of the colours, chosen at random."""

    def make(s: Solid, rng: random.Random, x: float, y: float, z: float) -> None:
        k = rng.randrange(len(tints))
        a = math.radians(rng.uniform(-14, 14))
        c, w = math.cos(a) * length / 2, math.sin(a) * length / 2
        s.rod((x - w, y - c, z), (x + w, y + c, z + rng.uniform(-0.01, 0.01)), radius * rng.uniform(0.85, 1.1),
              plain(f"{name} {k}", tints[k], 0.55), radius_b=radius * tip, sides=8)  # fmt: skip

    return make


def _leafy(radius: float, low: tuple[float, float, float], high: tuple[float, float, float], name: str) -> AddPiece:
    """Return a function that adds a leafy vegetable."""

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


PRODUCE: dict[str, tuple[AddPiece, float]] = {
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
"""For each kind of produce, a function that adds one piece to a crate, and the distance between pieces in metres."""


def produce_crate(kind: str, *, seed: int = 0, colour: str = "timber") -> Built:
    """Build a crate heaped with one kind of produce, a key of ``PRODUCE``."""
    s = Solid(f"crate of {kind}")
    rng = random.Random(f"{kind} {seed}")
    _crate(s, colour)
    w, d, h = CRATE_SIZE_M
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
    """Build a price card on a stick. A newline splits its text into two lines.

    The foot of the stick is at the origin.
    """
    s = Solid("price card")
    lines = text.split("\n")
    width = max(extent(line, cap) for line in lines) + 0.07
    height = (len(lines) * 1.55 + 0.5) * cap
    s.rod((0, -0.006, 0.0), (0, -0.006, 0.20 + height / 2), 0.006, timber(), sides=6)
    s.box((width, 0.006, height), (0, 0.0, 0.19 + height / 2), sheet(colour, dirt=0.06), 0.0)
    ink = paint("black", dirt=0.0) if colour in ("white", "yellow") else paint("white", dirt=0.0)
    for k, line in enumerate(lines):
        s.text(line, cap, (0, 0.0036, 0.19 + height - cap * (1.02 + 1.55 * k)), ink)
    return s.built()
