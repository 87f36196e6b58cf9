"""Objects outside shops: awnings, projecting signs, pavement boards, crates of fruit, buckets of flowers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random

import bpy

from scope_studio.kit.core.finishes import PALETTE, paint, steel, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import write


def _stripes(colour: str, second_colour: str) -> bpy.types.Material:
    """Return the material of striped canvas."""
    name = f"awning {colour} {second_colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    x, _, _ = s.xyz(s.object_coords())
    stripe = s.ramp(s.math("PINGPONG", x, 0.22), 0.108, 0.112)
    tint = s.mix(stripe, PALETTE[colour], PALETTE[second_colour])
    grime = s.ramp(s.noise(s.object_coords(), 2.2, 5.0), 0.45, 0.8, 0.0, 0.45)
    return s.surface(base_color=s.mix(grime, tint, (0.10, 0.095, 0.085)), roughness=0.55)


def awning(width_m: float, colour: str, second_colour: str = "white", *, out_m: float = 1.35, is_open: bool = True) -> Built:
    """Build a striped shop awning with its roller at the origin. If it is closed, only the roll and the valance are visible."""
    s = Solid(f"{colour} awning")
    cloth, metal = _stripes(colour, second_colour), paint("dark grey", dirt=0.2)
    w = width_m / 2
    s.box((width_m + 0.06, 0.20, 0.20), (0, 0.10, 0.02), paint("cream", dirt=0.3), 0.04)
    if not is_open:
        s.lathe([(0.075, -w), (0.075, w)], cloth, (0, 0.16, -0.11), "X", 20)
        _valance(s, w, 0.22, -0.13, cloth)
        return s.built()
    drop = -0.62 * out_m
    rows = 6
    points: list[Point] = []
    for k in range(rows + 1):
        t = k / rows
        sag = -0.035 * math.sin(math.pi * t)
        points += [(-w, 0.14 + (out_m - 0.14) * t, drop * t + sag), (w, 0.14 + (out_m - 0.14) * t, drop * t + sag)]
    s.add(points, [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2)[::-1] for k in range(rows)], cloth)
    s.box((width_m + 0.04, 0.05, 0.06), (0, out_m, drop - 0.01), metal, 0.01)
    _valance(s, w, out_m + 0.03, drop - 0.02, cloth)
    for x in (-w + 0.08, w - 0.08):
        elbow = (x * 0.93, out_m * 0.45, -0.30)
        s.rod((x, 0.05, -0.45), elbow, 0.018, metal)
        s.rod(elbow, (x, out_m - 0.03, drop - 0.02), 0.018, metal)
    return s.built()


def _valance(s: Solid, w: float, y: float, z: float, cloth: bpy.types.Material) -> None:
    """Add the scalloped front edge of an awning."""
    count = max(4, round(2 * w / 0.22))
    step = 2 * w / count
    for k in range(count):
        x0 = -w + step * k
        lower = [
            (x0 + step * (0.5 + 0.5 * math.cos(a)), z - 0.13 - 0.06 * math.sin(a)) for a in (math.pi * j / 6 for j in range(7))
        ]
        s.prism([(x0, z), (x0 + step, z), *lower], (y - 0.002, y + 0.002), cloth)


def hanging_sign(lines: Sequence[str], colour: str, ink: str, *, cap_m: float = 0.10) -> Built:
    """Build a projecting sign on an iron bracket.

    The bracket is fixed to the wall at the origin and extends towards +y. The board has the lines on both sides.
    """
    s = Solid(f"{lines[0]} hanging sign")
    iron = paint("black", dirt=0.15)
    width = max(0.55, max(extent(line, cap_m) for line in lines) + 0.18)
    height = cap_m * (1.6 * len(lines) + 0.9)
    reach = width + 0.30
    s.box((0.12, 0.03, 0.40), (0, 0.015, 0.05), iron, 0.008)
    s.rod((0, 0.0, 0.12), (0, reach, 0.12), 0.014, iron)
    s.tube([(0, 0.02, -0.12), (0, reach * 0.25, -0.08), (0, reach * 0.42, 0.10)], 0.010, iron)
    s.lathe([(0.005, -0.02), (0.028, 0.0), (0.005, 0.03)], iron, (0, reach, 0.12), "Y", 12)
    middle = 0.20 + width / 2
    top = 0.04
    for y in (middle - width * 0.35, middle + width * 0.35):
        s.rod((0, y, 0.12), (0, y, top - 0.02), 0.005, iron)
    s.box((0.035, width, height), (0, middle, top - height / 2), paint(colour, dirt=0.12, roughness=0.3), 0.006)
    s.box((0.039, width - 0.05, height - 0.05), (0, middle, top - height / 2), paint(ink, dirt=0.1), 0.002)
    s.box((0.042, width - 0.07, height - 0.07), (0, middle, top - height / 2), paint(colour, dirt=0.12, roughness=0.3), 0.002)
    for side in (-1, 1):
        with s.at(side * 0.0215, middle, top - height / 2, turn=-90 * side):
            for k, line in enumerate(lines):
                write(s, line, cap_m, 0, cap_m * 1.6 * ((len(lines) - 1) / 2 - k), ink, lift=0.001)
    return s.built()


def a_board(lines: Sequence[str], colour: str, ink: str, *, cap_m: float = 0.075) -> Built:
    """Build a folding pavement board, 0.62 x 1.05 m, with the same lines on its two faces (+y and -y)."""
    s = Solid(f"{lines[0]} A-board")
    frame, lean = timber(fresh=False), 11.0
    for turn in (0, 180):
        with s.at(0, 0, 0, turn=turn), s.at(0, 0.24, 0, pitch=lean):
            s.box((0.62, 0.03, 0.92), (0, 0, 0.58), paint(colour, dirt=0.12, roughness=0.5), 0.006)
            for x in (-0.31, 0.31):
                s.box((0.045, 0.045, 1.08), (x, 0, 0.54), frame, 0.008)
            for z in (0.11, 1.05):
                s.box((0.60, 0.045, 0.045), (0, 0, z), frame, 0.008)
            for k, line in enumerate(lines):
                cap = min(cap_m, cap_m * 0.52 / extent(line, cap_m))
                with s.at(0, 0.016, 0.90 - 0.165 * k):
                    write(s, line, cap, 0, 0, ink, lift=0.0015)
    return s.built()


PRODUCE: dict[str, tuple[tuple[float, float, float], float]] = {
    "apples": ((0.42, 0.035, 0.03), 0.038),
    "green apples": ((0.26, 0.40, 0.05), 0.038),
    "oranges": ((0.80, 0.27, 0.015), 0.040),
    "lemons": ((0.80, 0.60, 0.04), 0.034),
    "tomatoes": ((0.55, 0.03, 0.015), 0.033),
    "potatoes": ((0.30, 0.20, 0.10), 0.042),
    "cabbages": ((0.16, 0.30, 0.09), 0.085),
}
"""Colour (linear RGB) and radius in metres of fruit and vegetables."""


def crate(load: str | None = None, *, colour: str | None = None) -> Built:
    """Build a slatted crate of timber or plastic, 0.55 x 0.38 x 0.24 m, with its long side along x.

    It is empty, or heaped with ``load``, a key of ``PRODUCE``.
    """
    s = Solid(f"crate of {load}" if load else "empty crate")
    body = timber() if colour is None else paint(colour, dirt=0.2, roughness=0.5)
    for x in (-0.265, 0.265):
        for y in (-0.18, 0.18):
            s.box((0.03, 0.03, 0.25), (x, y, 0.125), body, 0.004)
    for z in (0.05, 0.125, 0.20):
        for y in (-0.19, 0.19):
            s.box((0.55, 0.012, 0.060), (0, y, z), body, 0.003)
        for x in (-0.275, 0.275):
            s.box((0.012, 0.38, 0.060), (x, 0, z), body, 0.003)
    s.box((0.54, 0.37, 0.012), (0, 0, 0.025), body, 0.002)
    if load is None:
        return s.built()
    colour_rgb, r = PRODUCE[load]
    finish = plain(f"fruit {load}", colour_rgb, 0.32)
    rng = Random(load)
    s.box((0.52, 0.35, 0.10), (0, 0, 0.13), plain(f"fruit shade {load}", tuple(c * 0.25 for c in colour_rgb), 0.8), 0.02)
    profile = [(r * math.sin(a) + 0.001, -r * math.cos(a)) for a in (math.pi * k / 6 for k in range(7))]
    for i in range(int(0.50 / (1.85 * r))):
        for j in range(int(0.33 / (1.75 * r))):
            x = -0.25 + r + 1.85 * r * (i + 0.5 * (j % 2)) + rng.uniform(-0.004, 0.004)
            y = -0.165 + r + 1.75 * r * j
            if x < 0.26 - r:
                heap = 0.035 * (1 - (x / 0.26) ** 2) * (1 - (y / 0.18) ** 2)
                s.lathe(profile, finish, (x, y, 0.20 + heap + rng.uniform(-0.006, 0.006)), steps=10)
    return s.built()


PETALS = {
    "red": (0.55, 0.02, 0.03),
    "yellow": (0.80, 0.55, 0.03),
    "pink": (0.70, 0.20, 0.32),
    "white": (0.75, 0.74, 0.70),
    "purple": (0.22, 0.05, 0.38),
    "orange": (0.80, 0.24, 0.02),
}
"""Flower colours by plain name."""


def blooms(
    s: Solid, colours: Sequence[str], spread_m: float, low: float, high: float, count: int, seed: int, *, trailing: bool = False
) -> None:
    """Add flower heads and leaves between two heights.

    They stand upright or, with ``trailing``, hang over the edge of a container.
    """
    rng = Random(f"blooms {seed} {colours}")
    green = [plain("flower leaf 0", (0.085, 0.190, 0.040), 0.6), plain("flower leaf 1", (0.15, 0.27, 0.07), 0.6)]
    for k in range(count * 6):
        a, fraction = rng.uniform(0, 2 * math.pi), rng.random() ** 0.5
        r, flower = spread_m * fraction, k % 3 == 0
        if trailing:
            z = low + (high - low) * (0.75 - 1.7 * fraction**3 * rng.random()) + (0.03 if flower else 0.0)
        else:
            z = low + (high - low) * (rng.uniform(0.55, 1.0) if flower else rng.uniform(0.0, 0.75)) * (1.1 - 0.35 * fraction**2)
        tip = (r * math.cos(a), r * math.sin(a), z)
        turn = rng.uniform(0, 2 * math.pi)
        if flower:
            tint = colours[(k // 3) % len(colours)]
            _flower(s, tip, rng.uniform(0.030, 0.046), turn, plain(f"petal {tint}", PETALS[tint], 0.6))
        else:
            _leaf(s, tip, rng.uniform(0.028, 0.055), turn, rng.uniform(-0.6, 0.5), green[k % 2])


def _leaf(s: Solid, at: Point, size: float, turn: float, lift: float, material: bpy.types.Material) -> None:
    """Add a flat leaf that grows from ``at``."""
    (x, y, z), c, w = at, size * math.cos(turn), size * math.sin(turn)
    up = lift * size
    points = [
        at,
        (x + c - w * 0.45, y + w + c * 0.45, z + up),
        (x + 2 * c, y + 2 * w, z + up),
        (x + c + w * 0.45, y + w - c * 0.45, z + up),
    ]
    s.add(points, [(0, 1, 2, 3)], material)


def _flower(s: Solid, at: Point, size: float, turn: float, material: bpy.types.Material) -> None:
    """Add five petals around a raised centre."""
    x, y, z = at
    for j in range(5):
        b = turn + 2 * math.pi * j / 5
        c, w = size * math.cos(b), size * math.sin(b)
        points = [
            at,
            (x + c - w * 0.6, y + w + c * 0.6, z + 0.016),
            (x + c * 1.35, y + w * 1.35, z - 0.004),
            (x + c + w * 0.6, y + w - c * 0.6, z + 0.016),
        ]
        s.add(points, [(0, 1, 2, 3)], material)


def flower_bucket(colours: Sequence[str], *, seed: int = 0) -> Built:
    """Build a zinc bucket of cut flowers, 0.7 m high."""
    s = Solid(f"bucket of {colours[0]} flowers")
    s.lathe([(0.11, 0.0), (0.115, 0.01), (0.15, 0.30), (0.158, 0.305), (0.15, 0.31), (0.13, 0.28)], steel(), steps=20)
    blooms(s, colours, 0.19, 0.30, 0.70, 40, seed)
    return s.built()


def price_card(item: str, price: str) -> Built:
    """Build a small handwritten card on a stick, facing +y, with an item and its price."""
    s = Solid(f"{item} price card")
    s.rod((0, 0, 0), (0, 0, 0.16), 0.004, steel(), sides=6)
    width = max(extent(item, 0.032), extent(price, 0.05)) + 0.05
    s.box((width, 0.006, 0.15), (0, 0.003, 0.22), paint("white", dirt=0.05), 0.002)
    with s.at(0, 0.006, 0.22):
        write(s, item, 0.032, 0, 0.042, "black", lift=0.001)
        write(s, price, 0.05, 0, -0.028, "red", lift=0.001)
    return s.built()
