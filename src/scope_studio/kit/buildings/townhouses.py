"""Town houses that form rows, with modelled window openings, shutters, cornices, and roofs with dormers and chimneys.

A house faces north (+y), and its body extends towards -y. Its front wall is the plane y = 0, so that the fronts of a row align.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy

from scope_studio.kit.buildings.wall_materials import tile_material
from scope_studio.kit.core.finishes import glass, paint
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.shapes import block
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

Rgb = tuple[float, float, float]

REVEAL_M = 0.17
"""Depth in metres of the window reveals."""
SLATE: Rgb = (0.085, 0.092, 0.105)
CLAY: Rgb = (0.27, 0.105, 0.062)


@dataclass(frozen=True)
class House:
    """Parameters of a town house. Sizes are in metres. ``shutters`` is a paint colour, or None for no shutters.

    ``bays`` is the number of windows on each upper floor, and ``window`` is their width and height. ``ground_m`` is the height of
    the ground floor, and ``storey_m`` that of each upper floor. ``door`` is the colour of the street door; None means a blank wall
    on the ground floor, for a shop front.
    """

    width: float
    wall: bpy.types.Material
    storeys: int = 3
    bays: int = 3
    depth: float = 9.0
    ground_m: float = 3.9
    storey_m: float = 3.1
    shutters: str | None = None
    roof: Rgb = SLATE
    trim: str = "cream"
    window: tuple[float, float] = (1.05, 1.75)
    dormers: int = 0
    door: str | None = None
    quoins: bool = False
    balconies: bool = False
    seed: int = 0

    @property
    def eaves_m(self) -> float:
        """Height of the eaves in metres."""
        return self.ground_m + (self.storeys - 1) * self.storey_m


def wall_with_openings(
    s: Solid,
    width: float,
    z0: float,
    z1: float,
    openings: list[tuple[float, float, float, float]],
    material: bpy.types.Material,
) -> None:
    """Add a horizontal strip of wall in the plane y = 0 that faces +y, with openings and their reveals.

    ``openings`` are (centre x, width, low z, high z). All must have the same low z and the same high z.
    """
    low, high = (openings[0][2], openings[0][3]) if openings else (z0, z0)

    def quad(xa: float, xb: float, za: float, zb: float) -> None:
        if xb - xa > 1e-4 and zb - za > 1e-4:
            s.add([(xa, 0, za), (xb, 0, za), (xb, 0, zb), (xa, 0, zb)], [(3, 2, 1, 0)], material)

    quad(-width / 2, width / 2, z0, low)
    quad(-width / 2, width / 2, high, z1)
    edge = -width / 2
    for x, w, za, zb in sorted(openings):
        quad(edge, x - w / 2, low, high)
        edge = x + w / 2
        a, b, d = x - w / 2, x + w / 2, -REVEAL_M
        points = [(a, 0, za), (b, 0, za), (b, 0, zb), (a, 0, zb), (a, d, za), (b, d, za), (b, d, zb), (a, d, zb)]
        s.add(points, [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)], material)
    quad(edge, width / 2, low, high)


def sash(s: Solid, x: float, w: float, za: float, zb: float, rng: random.Random, *, frame: str = "white") -> None:
    """Add the glazing and bars of a sash window, set back in its opening. Some windows have a blind or curtains."""
    wood = paint(frame, dirt=0.12, roughness=0.5)
    y, mid = -REVEAL_M + 0.03, (za + zb) / 2
    block(s, (w, 0.02, zb - za), (x, -REVEAL_M + 0.005, mid), glass())
    inside = plain("window curtain", (0.52, 0.49, 0.43), 0.9)
    choice = rng.random()
    if choice < 0.22:
        drop = rng.uniform(0.25, 0.7) * (zb - za)
        block(s, (w - 0.1, 0.004, drop), (x, -REVEAL_M + 0.018, zb - drop / 2), inside)
    elif choice < 0.55:
        for sign in (-1, 1):
            block(s, (w * 0.22, 0.004, zb - za - 0.06), (x + sign * w * 0.36, -REVEAL_M + 0.018, mid), inside)
    for sign in (-1, 1):
        block(s, (0.06, 0.05, zb - za), (x + sign * (w / 2 - 0.03), y, mid), wood)
    for z, t in ((za + 0.04, 0.08), (zb - 0.03, 0.06), (mid, 0.05)):
        block(s, (w - 0.1, 0.05, t), (x, y, z), wood)
    block(s, (0.03, 0.04, zb - za), (x, y, mid), wood)


def shutter_pair(s: Solid, x: float, w: float, za: float, zb: float, colour: str) -> None:
    """Add louvred shutters, folded back against the wall on both sides of a window."""
    finish = paint(colour, dirt=0.25, roughness=0.5)
    leaf = w / 2 - 0.02
    for sign in (-1, 1):
        cx = x + sign * (w / 2 + leaf / 2 + 0.03)
        for dx in (-leaf / 2 + 0.03, leaf / 2 - 0.03):
            block(s, (0.06, 0.045, zb - za), (cx + dx, 0.03, (za + zb) / 2), finish)
        for z in (za + 0.04, (za + zb) / 2, zb - 0.04):
            block(s, (leaf, 0.045, 0.08), (cx, 0.03, z), finish)
        count = 16
        for k in range(count):
            z = za + 0.1 + (zb - za - 0.2) * (k + 0.5) / count
            with s.at(cx, 0.026, z, pitch=38):
                block(s, (leaf - 0.1, 0.012, (zb - za) / count * 0.95), (0, 0, 0), finish)


def town_house(h: House) -> Built:
    """Build a town house. A shop front for its ground floor is built separately, by ``square_shops``."""
    rng = random.Random(f"town house {h.seed}")
    s = Solid("town house")
    trim, tile = paint(h.trim, dirt=0.35, roughness=0.8), tile_material(f"roof {h.roof[0]:.2f}", h.roof)
    half, eaves, ridge = h.width / 2, h.eaves_m, h.eaves_m + h.depth * 0.42
    body = [(-REVEAL_M - 0.02, 0), (-h.depth, 0), (-h.depth, eaves), (-h.depth / 2, ridge), (-REVEAL_M - 0.02, eaves)]
    s.prism(body, (-half, half), h.wall, "YZ")
    for x in (-half, half):
        points = [(x, 0, 0), (x, -REVEAL_M - 0.02, 0), (x, -REVEAL_M - 0.02, eaves), (x, 0, eaves)]
        s.add(points, [(0, 1, 2, 3) if x > 0 else (3, 2, 1, 0)], h.wall)
    pitch = h.width / h.bays
    centres = [-half + pitch * (k + 0.5) for k in range(h.bays)]
    _ground_floor(s, h, centres, rng)
    for k in range(1, h.storeys):
        z0 = h.ground_m + (k - 1) * h.storey_m
        height = h.window[1] * (1.0 if k < h.storeys - 1 or h.storeys == 2 else 0.86)
        za = z0 + 0.75
        openings = [(x, h.window[0], za, za + height) for x in centres]
        wall_with_openings(s, h.width, z0, z0 + h.storey_m, openings, h.wall)
        for x, w, low, high in openings:
            sash(s, x, w, low, high, rng)
            s.box((w + 0.24, 0.16, 0.09), (x, 0.03, low - 0.05), trim, 0.012)
            s.box((w + 0.26, 0.09, 0.20), (x, 0.01, high + 0.11), trim, 0.012)
            if h.shutters:
                shutter_pair(s, x, w, low, high, h.shutters)
            elif k == 1:
                s.box((w + 0.44, 0.20, 0.08), (x, 0.06, high + 0.26), trim, 0.015)
            if h.balconies and k == 1:
                _balcony(s, x, w, low)
        if k > 1:
            s.box((h.width, 0.08, 0.12), (0, 0.03, z0 + 0.02), trim, 0.01)
    s.box((h.width, 0.22, 0.26), (0, 0.08, h.ground_m - 0.02), trim, 0.02)
    for drop, out, height in ((0.42, 0.08, 0.24), (0.20, 0.18, 0.16), (0.06, 0.30, 0.12)):
        s.box((h.width, out + 0.1, height), (0, out / 2 - 0.02, eaves - drop), trim, 0.015)
    if h.quoins:
        for sign in (-1, 1):
            for k in range(int((eaves - 0.6) / 0.36)):
                width = 0.42 if k % 2 else 0.30
                s.box((width, 0.05, 0.33), (sign * (half - width / 2), 0.02, 0.3 + 0.36 * k), trim, 0.012)
    _roof(s, h, tile, ridge, rng)
    return s.built()


def _ground_floor(s: Solid, h: House, centres: list[float], rng: random.Random) -> None:
    """Add windows and a street door to a house without a shop."""
    if h.door is None:
        wall_with_openings(s, h.width, 0.0, h.ground_m, [], h.wall)
        return
    at = centres[len(centres) // 2]
    openings = [(x, h.window[0], 1.0, 2.95) for x in centres if x != at]
    wall_with_openings(s, h.width, 0.0, h.ground_m, openings, h.wall)
    trim = paint(h.trim, dirt=0.35, roughness=0.8)
    for x, w, low, high in openings:
        sash(s, x, w, low, high, rng)
        s.box((w + 0.24, 0.16, 0.09), (x, 0.03, low - 0.05), trim, 0.012)
        s.box((w + 0.26, 0.09, 0.20), (x, 0.01, high + 0.11), trim, 0.012)
        if h.shutters:
            shutter_pair(s, x, w, low, high, h.shutters)
    s.box((1.5, 0.14, 2.95), (at, 0.02, 1.47), trim, 0.02)
    s.box((1.8, 0.30, 0.14), (at, 0.12, 3.0), trim, 0.03)
    s.box((1.06, 0.05, 2.1), (at, 0.085, 1.07), paint(h.door, dirt=0.12, roughness=0.25), 0.01)
    for dx in (-0.25, 0.25):
        for z, height in ((0.55, 0.7), (1.5, 0.85)):
            s.box((0.36, 0.03, height), (at + dx, 0.105, z), paint(h.door, dirt=0.12, roughness=0.25), 0.012)
    block(s, (1.0, 0.03, 0.48), (at, 0.085, 2.42), glass())
    s.lathe([(0.03, 0.0), (0.035, 0.02), (0.02, 0.05)], paint("yellow", roughness=0.3), (at + 0.42, 0.11, 1.05), "Y", 14)
    s.box((1.5, 0.5, 0.12), (at, 0.28, 0.06), paint("light grey", dirt=0.5, roughness=0.9), 0.015)


def _balcony(s: Solid, x: float, w: float, low: float) -> None:
    """Add a shallow iron balcony in front of a window."""
    iron = paint("black", dirt=0.15)
    s.box((w + 0.5, 0.40, 0.08), (x, 0.2, low - 0.12), paint("light grey", dirt=0.4, roughness=0.9), 0.015)
    for z in (low - 0.02, low + 0.80):
        for a, b in (((-1, 0.0), (-1, 0.36)), ((-1, 0.36), (1, 0.36)), ((1, 0.36), (1, 0.0))):
            s.rod((x + a[0] * (w / 2 + 0.2), a[1], z), (x + b[0] * (w / 2 + 0.2), b[1], z), 0.014, iron, sides=6)
    for k in range(14):
        u = x + (w + 0.4) * (k / 13 - 0.5)
        s.rod((u, 0.36, low - 0.02), (u, 0.36, low + 0.80), 0.008, iron, sides=4)


def _roof(s: Solid, h: House, tile: bpy.types.Material, ridge: float, rng: random.Random) -> None:
    half, eaves = h.width / 2, h.eaves_m
    run = h.depth / 2
    slope = (ridge - eaves) / run
    front = [(0.34, eaves - 0.34 * slope + 0.12), (-run, ridge + 0.12), (-run, ridge), (0.34, eaves - 0.34 * slope)]
    back = [
        (-run, ridge + 0.12),
        (-h.depth - 0.3, eaves - 0.3 * slope + 0.12),
        (-h.depth - 0.3, eaves - 0.3 * slope),
        (-run, ridge),
    ]
    for section in (front, back):
        s.prism(section, (-half - 0.02, half + 0.02), tile, "YZ")
    s.box((h.width, 0.22, 0.12), (0, -run, ridge + 0.12), tile, 0.03)
    gutter = paint("dark grey", dirt=0.2)
    s.tube([(-half, 0.42, eaves + 0.0), (half, 0.42, eaves + 0.0)], 0.06, gutter)
    s.rod((half - 0.18, 0.08, eaves - 0.2), (half - 0.18, 0.08, 0.0), 0.04, gutter, sides=8)
    brick = h.wall
    for sign in (-1, 1) if h.width > 9 else (rng.choice((-1, 1)),):
        x = sign * (half - 0.55)
        s.box((0.7, 1.1, ridge - eaves + 1.1), (x, -run + 0.3, (ridge + eaves) / 2 + 0.75), brick, 0.02)
        s.box((0.86, 1.26, 0.14), (x, -run + 0.3, ridge + 1.25), paint(h.trim, dirt=0.35, roughness=0.8), 0.02)
        for dy in (-0.28, 0.28):
            s.lathe([(0.13, 0.0), (0.11, 0.45), (0.13, 0.50)], plain("chimney pot", (0.30, 0.13, 0.07), 0.8),
                    (x, -run + 0.3 + dy, ridge + 1.32), steps=12)  # fmt: skip
    for k in range(h.dormers):
        x = -half + h.width * (k + 0.5) / h.dormers
        base = eaves + 0.9 * slope
        wood = paint("white", dirt=0.2, roughness=0.6)
        block(s, (1.35, 2.0, 1.6), (x, -1.9, base + 0.75), tile)
        s.box((1.3, 0.08, 1.5), (x, -0.92, base + 0.75), wood, 0.01)
        block(s, (0.95, 0.03, 1.1), (x, -0.875, base + 0.78), glass())
        block(s, (0.05, 0.05, 1.1), (x, -0.865, base + 0.78), wood)
        block(s, (0.95, 0.05, 0.05), (x, -0.865, base + 0.80), wood)
        with s.at(x):
            s.prism([(-0.85, base + 1.5), (0.85, base + 1.5), (0.0, base + 2.15)], (-3.4, -0.72), tile, "XZ")
