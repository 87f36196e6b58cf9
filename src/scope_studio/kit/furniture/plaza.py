"""Furniture of a town square: lanterns, planters, post box, recycling bin, ticket machine, flags, news kiosk."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from scope_studio.kit.core.finishes import PALETTE, glass, glow, lens, paint, sheet, steel, stripes, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.shapes import block
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.furniture.stalls import flowers


def lantern_post(*, arms: int = 2, colour: str = "dark green", height: float = 4.4, lit: bool = False) -> Built:
    """Build a cast-iron lamp post with one lantern on top, or two lanterns on a cross arm."""
    s = Solid("lantern post")
    iron = paint(colour, dirt=0.2, roughness=0.35)
    s.lathe(
        [
            (0.24, 0.0),
            (0.24, 0.08),
            (0.18, 0.14),
            (0.15, 0.55),
            (0.19, 0.60),
            (0.19, 0.66),
            (0.09, 0.80),
            (0.075, 1.4),
            (0.10, 1.44),
            (0.10, 1.50),
            (0.06, 1.58),
            (0.05, height - 0.8),
            (0.08, height - 0.74),
            (0.05, height - 0.66),
            (0.045, height - 0.1),
        ],
        iron,
        steps=24,
    )
    heads = [(0.0, height)] if arms == 1 else [(-0.55, height - 0.12), (0.55, height - 0.12)]
    for x, z in heads:
        if x:
            bend = [(0, 0, height - 0.6), (x * 0.5, 0, height - 0.68), (x, 0, height - 0.42), (x, 0, z)]
            s.tube(bend, 0.022, iron)
        s.lathe([(0.06, z - 0.04), (0.09, z), (0.10, z + 0.03)], iron, (x, 0, 0), steps=6)
        s.lathe(
            [(0.10, z + 0.03), (0.17, z + 0.42)],
            glow("cream", 3.0) if lit else plain("lantern glass", (0.50, 0.50, 0.44), 0.2),
            (x, 0, 0),
            steps=6,
        )
        s.lathe(
            [(0.20, z + 0.42), (0.19, z + 0.46), (0.07, z + 0.60), (0.06, z + 0.66), (0.01, z + 0.74)], iron, (x, 0, 0), steps=6
        )
    if arms > 1:
        s.lathe([(0.045, height - 0.1), (0.07, height - 0.04), (0.01, height + 0.2)], iron, steps=12)
    return s.built()


def planter(colour: str = "red", second_colour: str = "yellow", *, side: float = 0.95, seed: int = 0) -> Built:
    """Build a square timber planter full of flowers in two colours."""
    s = Solid("planter")
    rng = random.Random(f"planter {seed}")
    wood = timber(fresh=False)
    for k in range(4):
        with s.at(turn=90 * k):
            for z in (0.09, 0.25, 0.41):
                s.box((side - 0.06, 0.045, 0.15), (0, side / 2 - 0.02, z), wood, 0.008)
            s.box((0.09, 0.09, 0.54), (side / 2 - 0.03, side / 2 - 0.03, 0.27), wood, 0.01)
    s.box((side - 0.08, side - 0.08, 0.04), (0, 0, 0.44), plain("potting soil", (0.03, 0.022, 0.015), 0.95), 0.0)
    for i in range(3):
        for j in range(3):
            with s.at((i - 1) * 0.26, (j - 1) * 0.26):
                flowers(s, rng, colour if (i + j) % 2 else second_colour, count=13, reach=0.17, low=0.44, high=0.70)
    return s.built()


def post_box(*, hours: str = "9.30 AM") -> Built:
    """Build a red cast-iron pillar box, 1.6 m high, with its slot and collection plate towards +y."""
    s = Solid("post box")
    red = paint("red", dirt=0.15, roughness=0.3)
    s.lathe([(0.28, 0.0), (0.28, 0.16)], paint("black", dirt=0.3), steps=40)
    s.lathe(
        [(0.25, 0.16), (0.245, 1.28), (0.27, 1.30), (0.27, 1.36), (0.29, 1.38), (0.29, 1.43), (0.20, 1.52), (0.05, 1.57)],
        red,
        steps=40,
    )
    s.box((0.30, 0.05, 0.05), (0, 0.235, 1.16), lens("black"), 0.01)
    s.box((0.36, 0.07, 0.03), (0, 0.25, 1.205), red, 0.01)
    s.text("POST", 0.075, (0, 0.272, 1.335), paint("yellow", dirt=0.0))
    s.box((0.20, 0.03, 0.26), (0, 0.235, 0.94), paint("white", dirt=0.05), 0.006)
    s.text("NEXT", 0.028, (0, 0.2515, 1.01), paint("black", dirt=0.0))
    s.text(hours, 0.034, (0, 0.2515, 0.93), paint("black", dirt=0.0))
    s.box((0.30, 0.02, 0.58), (0, 0.236, 0.52), red, 0.01)
    s.lathe([(0.012, 0.0), (0.010, 0.012)], paint("yellow"), (0.11, 0.247, 0.60), "Y", 12)
    return s.built()


def recycling_bin(colour: str, word: str) -> Built:
    """Build a steel recycling bin, 0.5 x 0.5 x 1.25 m, with a round opening and a label towards +y."""
    s = Solid("recycling bin")
    body = paint(colour, dirt=0.25, roughness=0.4)
    s.box((0.52, 0.50, 0.06), (0, 0, 0.03), paint("black"), 0.01)
    s.box((0.50, 0.48, 1.10), (0, 0, 0.60), body, 0.02)
    s.box((0.54, 0.52, 0.10), (0, 0, 1.20), paint("dark grey", dirt=0.2), 0.03)
    s.lathe([(0.105, 0.0), (0.10, 0.012)], paint("dark grey"), (0, 0.24, 0.98), "Y", 28)
    s.lathe([(0.085, 0.0), (0.085, 0.0145)], lens("black"), (0, 0.24, 0.98), "Y", 28)
    s.box((0.44, 0.008, 0.16), (0, 0.243, 0.72), sheet("white"), 0.0)
    s.text(word, min(0.07, 0.38 / extent(word, 1.0)), (0, 0.2485, 0.72), paint("black", dirt=0.0))
    return s.built()


def ticket_machine(*, lit: bool = True) -> Built:
    """Build a ticket machine, 0.75 x 0.55 x 1.85 m, with a lettered panel at the top. The screen, slots and keypad face +y."""
    s = Solid("ticket machine")
    body = paint("blue", dirt=0.15, roughness=0.35)
    s.box((0.75, 0.50, 1.60), (0, 0, 0.80), body, 0.02)
    s.box((0.80, 0.56, 0.26), (0, 0.01, 1.73), paint("yellow", dirt=0.1), 0.03)
    s.text("TICKETS", 0.11, (0, 0.2915, 1.73), paint("black", dirt=0.0))
    s.box((0.62, 0.03, 1.05), (0, 0.245, 0.95), steel(), 0.01)
    s.box((0.40, 0.02, 0.30), (0.06, 0.26, 1.28), glow("light blue", 0.9) if lit else lens("black"), 0.004)
    for i in range(3):
        for j in range(4):
            s.box((0.035, 0.02, 0.028), (-0.20 - 0.045 * i + 0.04, 0.262, 1.08 - 0.045 * j), paint("dark grey"), 0.004)
    s.box((0.12, 0.02, 0.02), (0.16, 0.262, 1.02), lens("black"), 0.003)
    s.box((0.30, 0.06, 0.14), (0.0, 0.25, 0.60), lens("black"), 0.01)
    return s.built()


def flagpole(*, height: float = 7.5, colours: tuple[str, ...] = ("blue", "white", "red"), seed: int = 0) -> Built:
    """Build a white pole with a flag that has vertical stripes and flies towards +x."""
    s = Solid("flagpole")
    rng = random.Random(f"flag {seed}")
    s.lathe(
        [
            (0.16, 0.0),
            (0.16, 0.25),
            (0.06, 0.30),
            (0.032, height),
            (0.05, height + 0.03),
            (0.05, height + 0.09),
            (0.01, height + 0.13),
        ],
        paint("white", dirt=0.2),
        steps=16,
    )
    w, h, n = 1.5, 0.95, 24
    start = rng.uniform(0, 6)
    columns = n // len(colours)
    for k, colour in enumerate(colours):
        points, faces = [], []
        for i in range(columns + 1):
            u = (k * columns + i) / n
            for v in (0.0, 0.5, 1.0):
                swing = 0.16 * u * math.sin(start + 7.0 * u + 1.2 * v) + 0.05 * math.sin(start + 13 * u)
                points.append((0.05 + w * u * 0.96, swing, height - 0.1 - h * (1 - v) - 0.22 * u * u))
        for i in range(columns):
            for j in range(2):
                a = i * 3 + j
                faces.append((a, a + 3, a + 4, a + 1))
        s.add(points, faces, plain(f"flag {colour}", PALETTE[colour], 0.8))
    return s.built()


def news_kiosk(name: str = "NEWS", *, colour: str = "dark green") -> Built:
    """Build a newspaper kiosk, 2.6 x 2.3 x 3.8 m, with an eight-sided roof and a striped awning.

    The counter and the newspaper racks face +y; the fascia is lettered on four sides.
    """
    s = Solid("kiosk")
    wood = paint(colour, dirt=0.18, roughness=0.35)
    inside = plain("kiosk inside", (0.05, 0.045, 0.04), 0.9)
    s.box((2.5, 2.0, 0.10), (0, 0, 0.05), paint("grey", dirt=0.4), 0.02)
    s.box((2.4, 0.10, 2.35), (0, -0.92, 1.25), wood, 0.02)
    for x in (-1.16, 1.16):
        s.box((0.10, 1.9, 2.35), (x, 0, 1.25), wood, 0.02)
        for y in (-0.5, 0.4):
            s.box((0.03, 0.7, 0.8), (math.copysign(1.22, x), y, 0.65), wood, 0.02)
            block(s, (0.012, 0.66, 0.8), (math.copysign(1.215, x), y, 1.70), glass())
    s.box((2.4, 0.12, 0.95), (0, 0.90, 0.55), wood, 0.02)
    s.box((2.5, 0.55, 0.06), (0, 0.98, 1.05), timber(), 0.012)
    block(s, (2.3, 0.02, 1.4), (0, -0.1, 1.75), inside)
    for k in range(3):
        for i in range(9):
            tint = ("cream", "light blue", "pink", "yellow", "white", "orange")[(i * 2 + k) % 6]
            block(s, (0.19, 0.02, 0.26), (-0.98 + 0.245 * i, -0.06, 1.28 + 0.32 * k), plain(f"magazine {tint}", PALETTE[tint], 0.6))
    for i in range(5):
        height = 0.05 + 0.02 * (i * 7 % 4)
        s.box((0.32, 0.24, height), (-0.90 + 0.45 * i, 1.08, 1.08 + height / 2), plain("newsprint", (0.58, 0.57, 0.53), 0.9), 0.004)
        block(s, (0.26, 0.09, 0.002), (-0.90 + 0.45 * i, 1.06, 1.082 + height), plain("newsprint picture", (0.20, 0.20, 0.21), 0.9))
    s.box((2.6, 2.3, 0.46), (0, 0.05, 2.62), wood, 0.03)
    s.box((2.9, 2.6, 0.10), (0, 0.05, 2.88), wood, 0.03)
    for facing, (x, y) in {"+Y": (0.0, 1.2035), "-Y": (0.0, -1.1035), "+X": (1.3035, 0.05), "-X": (-1.3035, 0.05)}.items():
        s.text(name, 0.24, (x, y, 2.62), paint("yellow", dirt=0.05), facing=facing)
    s.lathe(
        [(1.75, 2.92), (0.9, 3.25), (0.35, 3.40), (0.30, 3.62), (0.02, 3.80)],
        paint("grey", dirt=0.4, roughness=0.6),
        (0, 0.05, 0),
        steps=8,
    )
    cloth = stripes("canvas dark green cream", "dark green", "cream", 0.42)
    points = [(-1.25 + 2.5 * i / 12, y, z) for y, z in ((1.18, 2.38), (1.95, 2.06), (1.96, 1.88)) for i in range(13)]
    s.add(
        points, [(r * 13 + i + 1, r * 13 + i, (r + 1) * 13 + i, (r + 1) * 13 + i + 1) for r in range(2) for i in range(12)], cloth
    )
    return s.built()


def headline_board(paper: str, lines: Sequence[str], *, cap: float = 0.085) -> Built:
    """Build a newspaper headline board on an A-frame, 0.66 x 1.0 m, facing +y."""
    s = Solid("headline board")
    with s.at(0, 0.18, 0.0, pitch=12.0):
        s.box((0.66, 0.03, 0.98), (0, 0, 0.52), paint("red", dirt=0.25), 0.01)
        s.box((0.58, 0.008, 0.78), (0, 0.016, 0.45), sheet("white", dirt=0.08), 0.0)
        s.text(paper, min(0.06, 0.56 / extent(paper, 1.0)), (0, 0.0165, 0.92), paint("white", dirt=0.0))
        for k, line in enumerate(lines):
            s.text(
                line,
                min(cap, 0.53 / extent(line, 1.0)),
                (0, 0.0215, 0.45 + 0.21 * ((len(lines) - 1) / 2 - k)),
                paint("black", dirt=0.0),
            )
    with s.at(0, -0.18, 0.0, pitch=-12.0):
        s.box((0.62, 0.02, 0.92), (0, 0, 0.48), paint("red", dirt=0.25), 0.01)
    return s.built()
