"""Parts of shop fronts on a market square: fronts, doors, sign boards, awnings with lettered valances, and a pharmacy cross."""

from __future__ import annotations

import random

from scope_studio.kit.core.finishes import PALETTE, glass, glow, lens, paint, sheet, stripes
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.shapes import block
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def front(width: float, colour: str, *, height: float = 3.4, seed: int = 0) -> Built:
    """Build a timber shop front, 0.3 m deep, in front of y = 0.

    It has pilasters, stall risers, transoms, and plate glass with goods behind it. A dark gap in the centre, 1.1 m wide,
    takes a ``shop_door``.
    """
    s = Solid("shop front")
    rng = random.Random(f"shop front {seed}")
    wood = paint(colour, dirt=0.18, roughness=0.4)
    y, top, half = 0.14, height - 0.62, width / 2
    block(s, (width, 0.12, height), (0, 0.06, height / 2), wood)
    for low, high in ((-half, -0.62), (0.62, half)):
        w, x = high - low - 0.3, (low + high) / 2
        block(s, (w, 0.03, top - 0.62), (x, y, (top + 0.62) / 2), glass())
        s.box((w + 0.1, 0.14, 0.10), (x, y + 0.04, 0.60), wood, 0.015)
        s.box((w, 0.04, 0.36), (x, y + 0.005, 0.32), wood, 0.02)
        bars = max(1, round(w / 1.5))
        for k in range(bars + 1):
            s.box((0.06, 0.08, top - 0.62), (x - w / 2 + w * k / bars, y + 0.02, (top + 0.62) / 2), wood, 0.008)
        s.box((w, 0.07, 0.05), (x, y + 0.02, top - 0.52), wood, 0.008)
        _display(s, x, w, y + 0.017, rng)
    block(s, (1.14, 0.03, top), (0, y - 0.02, top / 2), plain("shop dark", (0.012, 0.012, 0.013), 0.6))
    for x in (-half + 0.13, -0.70, 0.70, half - 0.13):
        s.box((0.26 if abs(x) > 1 else 0.14, 0.20, height - 0.1), (x, y + 0.03, height / 2 - 0.05), wood, 0.02)
        s.box((0.32 if abs(x) > 1 else 0.18, 0.26, 0.3), (x, y + 0.03, 0.15), wood, 0.02)
    s.box((width, 0.26, 0.72), (0, y - 0.02, height - 0.36), wood, 0.02)
    s.box((width + 0.16, 0.44, 0.14), (0, y + 0.06, height + 0.05), wood, 0.03)
    return s.built()


def _display(s: Solid, x: float, w: float, y: float, rng: random.Random) -> None:
    """Add posters and the pale outlines of goods, flat behind the glass."""
    tints = ("cream", "light blue", "dark red", "beige", "pink", "green", "yellow", "light grey")
    u = -w / 2 + 0.3
    while u < w / 2 - 0.3:
        height, width, tint = rng.uniform(0.18, 0.55), rng.uniform(0.16, 0.34), rng.choice(tints)
        block(
            s,
            (width, 0.004, height),
            (x + u, y, 0.70 + height / 2),
            plain(f"display {tint}", tuple(c * 0.4 for c in PALETTE[tint]), 0.7),
        )
        u += width + rng.uniform(0.05, 0.3)


def shop_door(colour: str, *, is_open: bool = False, notice: str | None = None) -> Built:
    """Build a half-glazed door, 1.0 x 2.2 m, hinged at x = 0.5.

    ``is_open`` turns it outwards. ``notice`` is the text of a card on the glass.
    """
    s = Solid("shop door")
    wood = paint(colour, dirt=0.12, roughness=0.3)
    with s.at(0.5, 0.0, 0.0, turn=-100.0 if is_open else 0.0):
        for z, height in ((0.42, 0.80), (2.14, 0.12)):
            s.box((1.0, 0.05, height), (-0.5, 0, z), wood, 0.01)
        for x in (-0.94, -0.06):
            s.box((0.12, 0.05, 2.2), (x, 0, 1.1), wood, 0.01)
        block(s, (0.80, 0.014, 1.3), (-0.5, 0, 1.45), glass())
        s.box((0.62, 0.02, 0.5), (-0.5, 0.025, 0.42), wood, 0.02)
        s.rod((-0.90, 0.06, 0.95), (-0.90, 0.06, 1.35), 0.014, paint("yellow", roughness=0.25))
        if notice:
            is_closed = notice == "CLOSED"
            s.box((0.46, 0.006, 0.18), (-0.5, 0.012, 1.65), sheet("red" if is_closed else "white"), 0.0)
            s.text(notice, 0.08, (-0.5, 0.0165, 1.65), sheet("white" if is_closed else "green"))
    return s.built()


def sign_board(
    text: str, width: float, *, colour: str = "dark green", ink: str = "cream", cap: float = 0.30, height: float = 0.56
) -> Built:
    """Build a shop's name board, centred on the origin. Its back is at y = 0."""
    s = Solid("shop sign")
    s.box((width, 0.05, height), (0, 0.025, 0), paint(colour, dirt=0.15, roughness=0.35), 0.012)
    for z in (-height / 2 + 0.04, height / 2 - 0.04):
        s.box((width - 0.08, 0.012, 0.02), (0, 0.055, z), paint(ink, dirt=0.1), 0.003)
    s.text(text, min(cap, (width - 0.4) / extent(text, 1.0)), (0, 0.054, 0), paint(ink, dirt=0.06))
    return s.built()


def awning(
    width: float, colour: str, second_colour: str, *, reach: float = 1.6, text: str | None = None, is_open: bool = True
) -> Built:
    """Build a canvas awning, fixed at the origin. If open, it slopes down by 0.7 m over ``reach`` and has a lettered valance."""
    s = Solid("awning")
    cloth = stripes(f"canvas {colour} {second_colour}", colour, second_colour, 0.42)
    iron = paint("dark grey", dirt=0.15)
    if not is_open:
        s.lathe([(0.11, -width / 2), (0.11, width / 2)], cloth, (0, 0.16, 0), "X", 16)
        s.box((width + 0.1, 0.14, 0.10), (0, 0.08, 0.12), iron, 0.02)
        return s.built()
    drop, columns = 0.72, 24
    rows = [(0.06, 0.0), (reach * 0.5, -drop * 0.46), (reach, -drop), (reach + 0.02, -drop - 0.26)]
    n = columns + 1
    points = [
        (-width / 2 + width * i / columns, y, z - 0.012 * (i % 2) * (k > 0)) for k, (y, z) in enumerate(rows) for i in range(n)
    ]
    faces = [(k * n + i, (k + 1) * n + i, (k + 1) * n + i + 1, k * n + i + 1) for k in range(len(rows) - 1) for i in range(columns)]
    s.add(points, faces, cloth)
    for x in (-width / 2 + 0.05, width / 2 - 0.05):
        s.rod((x, 0.05, -0.75), (x, reach - 0.02, -drop - 0.02), 0.016, iron)
    s.rod((-width / 2, reach, -drop), (width / 2, reach, -drop), 0.018, iron)
    s.box((width + 0.06, 0.16, 0.14), (0, 0.06, 0.04), iron, 0.03)
    if text:
        cap = min(0.17, (width - 0.5) / extent(text, 1.0))
        s.box((extent(text, cap) + 0.3, 0.012, 0.25), (0, reach + 0.03, -drop - 0.13), paint("cream", dirt=0.08), 0.0)
        s.text(text, cap, (0, reach + 0.0395, -drop - 0.13), paint("black", dirt=0.0))
    return s.built()


def pharmacy_cross(size: float = 0.9, *, lit: bool = True) -> Built:
    """Build a green cross on a bracket, visible from both sides (+x and -x). The wall is the plane y = 0."""
    s = Solid("pharmacy cross")
    s.rod((0, 0, 0), (0, 0.5, 0), 0.03, paint("dark grey"))
    arm, cy = size / 3, 0.5 + size / 2
    for material, margin, thickness in (
        (paint("dark grey", dirt=0.1), 0.04, 0.08),
        (glow("green", 2.5) if lit else lens("green"), 0.0, 0.10),
    ):
        a, b = arm / 2 + margin / 2, size / 2 + margin / 2
        shape = [(-a, -b), (a, -b), (a, -a), (b, -a), (b, a), (a, a), (a, b), (-a, b), (-a, a), (-b, a), (-b, -a), (-a, -a)]
        s.prism([(cy + u, v) for u, v in shape], (-thickness, thickness), material, "YZ")
    return s.built()
