"""Terraced buildings of an old street: sash windows above a shop or a house front, pitched roofs, chimneys, gutters.

A building faces +y. Its front wall is on y = 0, its back wall is on y = -``DEPTH_M``, and neighbouring buildings adjoin along x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

import bpy

from scope_studio.kit.buildings.wet_masonry import roofing, trim, wall
from scope_studio.kit.core.finishes import paint
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.shapes import arc
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

GROUND_FLOOR_M = 3.55
"""Height in metres of the ground floor."""
STOREY_M = 2.95
"""Height in metres of each upper floor."""
DEPTH_M = 9.0
"""Depth in metres of a building."""
WHITE = (0.66, 0.655, 0.62)


@dataclass(frozen=True)
class TerracedBuilding:
    """Parameters of one building in a row.

    ``wall`` contains the arguments of ``wet_masonry.wall``: kind and colour. ``columns`` is the number of windows on each upper
    floor, and ``bars`` the number of vertical glazing bars in each. ``lit`` lists the (floor, column) of lit windows. With
    ``shop``, the front has a gap on the ground floor for a shop front; without it, windows and a door opening.
    """

    width_m: float
    wall: tuple[str, str]
    storeys: int = 2
    columns: int = 2
    roof: str = "slate"
    parapet: bool = False
    bay: bool = False
    bars: int = 1
    lit: frozenset[tuple[int, int]] = frozenset()
    shop: bool = True
    stone: tuple[float, float, float] = WHITE
    seed: int = 0

    @property
    def eaves_m(self) -> float:
        """Height of the eaves in metres."""
        return GROUND_FLOOR_M + STOREY_M * (self.storeys - 1) + 0.15


def terraced_building(spec: TerracedBuilding) -> Built:
    """Build a terraced building as one mesh."""
    s = Solid(f"{spec.wall[1]} {spec.wall[0]} building")
    rng = Random(f"terrace {spec.seed} {spec.width_m}")
    face = wall(*spec.wall)
    low = GROUND_FLOOR_M - 0.1 if spec.shop else 0.0
    holes = _upper_holes(spec)
    if not spec.shop:
        holes += _ground_floor_holes(spec)
    _front_wall(s, spec.width_m, low, spec.eaves_m + (0.75 if spec.parapet else 0.0), holes, face)
    _shell(s, spec, face)
    for x, z, w, h, floor, column in holes:
        if floor >= 0:
            _sash(s, x, z, w, h, spec, rng, lit=(floor, column) in spec.lit)
        else:
            _front_door(s, x, w, h)
    _roof(s, spec)
    _chimney(s, spec, rng)
    _rainwater(s, spec)
    if spec.wall[0] != "brick" or spec.bars == 2:
        for z in (GROUND_FLOOR_M + STOREY_M * k - 0.05 for k in range(1, spec.storeys)):
            if z < spec.eaves_m - 1:
                s.box((spec.width_m, 0.05, 0.14), (0, 0.025, z), trim(spec.stone), 0.012)
    return s.built()


Hole = tuple[float, float, float, float, int, int]
"""Hole in a wall: x of its centre, z of its lower edge, width, height, floor (0 = ground floor, -1 = door opening), column."""


def _upper_holes(spec: TerracedBuilding) -> list[Hole]:
    """Return the window holes of the upper floors."""
    holes: list[Hole] = []
    pitch = spec.width_m / spec.columns
    for floor in range(1, spec.storeys):
        height = 1.75 if floor == 1 else 1.35
        base = GROUND_FLOOR_M + STOREY_M * (floor - 1) + 0.72
        holes += [
            (pitch * (k + 0.5) - spec.width_m / 2, base, min(1.2, pitch * 0.5), height, floor, k) for k in range(spec.columns)
        ]
    return holes


def _ground_floor_holes(spec: TerracedBuilding) -> list[Hole]:
    """Return the window and door holes of a ground floor without a shop."""
    pitch = spec.width_m / spec.columns
    holes: list[Hole] = []
    for k in range(spec.columns):
        x = pitch * (k + 0.5) - spec.width_m / 2
        holes.append((x, 0.0, 1.0, 2.25, -1, k) if k == spec.columns - 1 else (x, 0.85, min(1.2, pitch * 0.5), 1.75, 0, k))
    return holes


def _front_wall(s: Solid, width: float, low: float, high: float, holes: list[Hole], face: bpy.types.Material) -> None:
    """Add the front wall as a grid of quads with holes. The reveals of the holes are 0.13 m deep."""
    xs = sorted({-width / 2, width / 2, *(x - w / 2 for x, _, w, *_ in holes), *(x + w / 2 for x, _, w, *_ in holes)})
    zs = sorted({low, high, *(z for _, z, *_ in holes), *(z + h for _, z, _, h, *_ in holes)})
    zs = [z for z in zs if low <= z <= high]
    points = [(x, 0.0, z) for z in zs for x in xs]
    n = len(xs)
    faces = []
    for i in range(len(zs) - 1):
        for j in range(n - 1):
            mx, mz = (xs[j] + xs[j + 1]) / 2, (zs[i] + zs[i + 1]) / 2
            if not any(abs(mx - x) < w / 2 and z < mz < z + h for x, z, w, h, *_ in holes):
                faces.append((i * n + j + 1, i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1))
    s.add(points, faces, face)
    for x, z, w, h, *_ in holes:
        ring = [(x - w / 2, z), (x + w / 2, z), (x + w / 2, z + h), (x - w / 2, z + h)]
        corners = [(u, d, v) for d in (0.0, -0.13) for u, v in ring]
        s.add(corners, [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)], face)


def _shell(s: Solid, spec: TerracedBuilding, face: bpy.types.Material) -> None:
    """Add side walls with their gables, and the back wall."""
    w, d, h = spec.width_m / 2, DEPTH_M, spec.eaves_m
    top = h + (0.75 if spec.parapet else 0.0)
    ridge = h + _roof_rise(spec)
    for x in (-w, w):
        outline = [(x, 0, 0), (x, -d, 0), (x, -d, h), (x, -d / 2, ridge), (x, -0.3, h + 0.1), (x, -0.3, top), (x, 0, top)]
        s.add(outline, [tuple(range(7)) if x < 0 else tuple(range(7))[::-1]], face)
    s.add([(-w, -d, 0), (w, -d, 0), (w, -d, h), (-w, -d, h)], [(0, 1, 2, 3)], face)
    if spec.parapet:
        s.add([(-w, -0.3, h - 0.2), (w, -0.3, h - 0.2), (w, -0.3, top), (-w, -0.3, top)], [(0, 1, 2, 3)], face)
        s.box((spec.width_m, 0.42, 0.09), (0, -0.13, top + 0.04), trim(spec.stone), 0.015)
        s.box((spec.width_m, 0.16, 0.22), (0, 0.06, h - 0.05), trim(spec.stone), 0.03)
        s.box((spec.width_m, 0.09, 0.12), (0, 0.03, h - 0.22), trim(spec.stone), 0.02)


def _roof_rise(spec: TerracedBuilding) -> float:
    """Return the height of the ridge above the eaves in metres."""
    return DEPTH_M / 2 * (0.80 if spec.roof == "clay" else 0.68)


def _sash(s: Solid, x: float, z: float, w: float, h: float, spec: TerracedBuilding, rng: Random, *, lit: bool) -> None:
    """Add a sash window in its hole, with frame, glazing bars, curtains or a blind, sill and lintel."""
    joinery = trim((0.66, 0.66, 0.63))
    back = -0.115
    pane = lit_pane() if lit else dark_pane()
    s.add(
        [
            (x - w / 2, back - 0.01, z),
            (x + w / 2, back - 0.01, z),
            (x + w / 2, back - 0.01, z + h),
            (x - w / 2, back - 0.01, z + h),
        ],
        [(1, 0, 3, 2)],
        pane,
    )
    _curtains(s, x, z, w, h, back, rng, lit=lit)
    for side in (-1, 1):
        s.box((0.07, 0.07, h), (x + side * (w / 2 - 0.035), back + 0.03, z + h / 2), joinery, 0.006)
    for v, depth in ((0.035, 0.09), (h - 0.035, 0.07), (h * 0.52, 0.06)):
        s.box((w, 0.07, depth), (x, back + 0.03, z + v), joinery, 0.006)
    for k in range(1, spec.bars + 1):
        s.box((0.022, 0.03, h), (x - w / 2 + w * k / (spec.bars + 1), back + 0.02, z + h / 2), joinery, 0.003)
    if spec.bars > 1:
        for v in (0.27, 0.77):
            s.box((w, 0.03, 0.022), (x, back + 0.02, z + h * v), joinery, 0.003)
    stone = trim(spec.stone)
    s.box((w + 0.22, 0.30, 0.10), (x, -0.02, z - 0.05), stone, 0.015)
    if spec.wall[0] == "brick":
        lintel = [
            (x - w / 2 - 0.10, z + h),
            (x + w / 2 + 0.10, z + h),
            (x + w / 2 + 0.16, z + h + 0.24),
            (x - w / 2 - 0.16, z + h + 0.24),
        ]
        s.prism(lintel, (-0.02, 0.018), stone, "XZ")
        s.prism(
            [(x - 0.07, z + h - 0.02), (x + 0.07, z + h - 0.02), (x + 0.10, z + h + 0.28), (x - 0.10, z + h + 0.28)],
            (-0.02, 0.045),
            stone,
        )
    else:
        for side in (-1, 1):
            s.box((0.12, 0.045, h + 0.1), (x + side * (w / 2 + 0.06), 0.02, z + h / 2), stone, 0.01)
        s.box((w + 0.30, 0.06, 0.16), (x, 0.03, z + h + 0.08), stone, 0.012)


def _curtains(s: Solid, x: float, z: float, w: float, h: float, back: float, rng: Random, *, lit: bool) -> None:
    """Add curtains or a blind behind a window, or neither, at random."""
    kind = rng.random()
    cloth = plain(
        f"curtain {rng.randrange(4)} {lit}",
        rng.choice([(0.5, 0.46, 0.38), (0.32, 0.09, 0.07), (0.16, 0.2, 0.26), (0.42, 0.40, 0.36)]),
        0.9,
    )
    if kind < 0.5:
        for side in (-1, 1):
            for k in range(3):
                s.box(
                    (0.075, 0.012, h),
                    (x + side * (w / 2 - 0.09 - 0.07 * k), back - 0.003 + 0.002 * (k % 2), z + h / 2),
                    cloth,
                    0.004,
                )
    elif kind < 0.75:
        drop = h * rng.uniform(0.25, 0.7)
        s.box((w - 0.1, 0.008, drop), (x, back - 0.002, z + h - drop / 2), plain("roller blind", (0.52, 0.50, 0.44), 0.9), 0.002)


def _front_door(s: Solid, x: float, w: float, h: float) -> None:
    """Add the surround and fanlight of a house door. The scene places the door itself."""
    frame = trim()
    s.add([(x - w / 2, -0.12, 0), (x + w / 2, -0.12, 0), (x + w / 2, -0.12, h), (x - w / 2, -0.12, h)], [(1, 0, 3, 2)], dark_pane())
    for side in (-1, 1):
        s.box((0.16, 0.10, h + 0.1), (x + side * (w / 2 + 0.05), 0.03, h / 2 + 0.05), frame, 0.015)
    s.box((w + 0.5, 0.26, 0.16), (x, 0.10, h + 0.18), frame, 0.02)
    s.box((w, 0.08, 0.06), (x, -0.06, 2.02), frame, 0.008)
    s.box((w + 0.3, 0.35, 0.14), (x, 0.14, 0.05), plain("doorstep", (0.22, 0.21, 0.19), 0.5), 0.02)


def dark_pane() -> bpy.types.Material:
    """Return the material of an unlit window: a dark, reflective surface."""
    return plain("unlit pane", (0.016, 0.018, 0.020), 0.03)


def lit_pane() -> bpy.types.Material:
    """Return the material of a lit window, with uneven warm lamplight."""
    existing = bpy.data.materials.get("lit pane")
    if existing is not None:
        return existing
    s = Shader("lit pane")
    glow = s.ramp(s.noise(s.object_coords(), 1.3, 3.0), 0.3, 0.7, 0.55, 1.25)
    warm = s.mix(s.ramp(s.noise(s.object_coords(), 5.0, 2.0), 0.4, 0.6), (1.0, 0.62, 0.26), (1.0, 0.74, 0.42))
    return s.surface(base_color=(0.2, 0.14, 0.08), roughness=0.05, emission_color=warm, emission_strength=glow)


def _roof(s: Solid, spec: TerracedBuilding) -> None:
    cover = roofing(spec.roof)
    w, d, h, rise = spec.width_m / 2, DEPTH_M, spec.eaves_m, _roof_rise(spec)
    front = -0.32 if spec.parapet else 0.28
    slope = rise / (d / 2)
    z0 = h - slope * front
    for y0, y1, za in ((front, -d / 2, z0), (-d - 0.28, -d / 2, h - slope * 0.28)):
        quad = [(-w, y0, za), (w, y0, za), (w, y1, h + rise), (-w, y1, h + rise)]
        under = [(a, b, c - 0.11) for a, b, c in quad]
        faces = [(0, 1, 2, 3), (7, 6, 5, 4), (0, 4, 5, 1), (1, 5, 6, 2), (3, 2, 6, 7), (0, 3, 7, 4)]
        lifted = [(a, b, c + 0.10) for a, b, c in quad]
        order = faces if y0 > y1 else [f[::-1] for f in faces]
        s.add([*lifted, *[(a, b, c + 0.10) for a, b, c in under]], [f[::-1] for f in order], cover)
    ridge = arc((0.0, 0.0), 0.13, 0, 180, 6)
    with s.at(0, -d / 2, h + rise + 0.06, turn=90):
        s.prism(
            ridge,
            (-w, w),
            plain("ridge tile", (0.16, 0.06, 0.038), 0.6)
            if spec.roof == "clay"
            else plain("ridge slate", (0.05, 0.054, 0.06), 0.5),
        )


def _chimney(s: Solid, spec: TerracedBuilding, rng: Random) -> None:
    side = rng.choice((-1, 1))
    x, y = side * (spec.width_m / 2 - 0.35), -DEPTH_M / 2 + rng.choice((-0.6, 0.5))
    top = spec.eaves_m + _roof_rise(spec) + 1.25
    stack = wall("brick", "brown" if spec.wall[0] != "brick" else spec.wall[1])
    s.box((0.62, 1.15, 2.6), (x, y, top - 1.3), stack, 0.01)
    s.box((0.74, 1.27, 0.12), (x, y, top - 0.10), stack, 0.02)
    s.box((0.66, 1.19, 0.06), (x, y, top + 0.02), plain("flaunching", (0.18, 0.175, 0.165), 0.8), 0.02)
    pot = plain("chimney pot", (0.30, 0.125, 0.065), 0.65)
    for k in range(rng.randrange(2, 5)):
        py = y - 0.42 + 0.28 * k
        s.lathe(
            [(0.115, 0.0), (0.10, 0.06), (0.085, 0.30), (0.105, 0.34), (0.105, 0.40), (0.08, 0.40)],
            pot,
            (x, py, top + 0.03),
            steps=14,
        )
    if rng.random() < 0.5:
        metal = plain("aerial", (0.35, 0.36, 0.37), 0.4, 0.6)
        s.rod((x + 0.3, y, top - 0.6), (x + 0.3, y, top + 1.5), 0.016, metal, sides=6)
        s.rod((x + 0.3, y - 0.1, top + 1.35), (x + 0.3, y + 1.1, top + 1.45), 0.010, metal, sides=6)
        for k in range(8):
            yk = y + 0.1 + 0.13 * k
            s.rod(
                (x + 0.3 - 0.18 + 0.01 * k, yk, top + 1.37 + 0.01 * k),
                (x + 0.3 + 0.18 - 0.01 * k, yk, top + 1.37 + 0.01 * k),
                0.005,
                metal,
                sides=4,
            )


def _rainwater(s: Solid, spec: TerracedBuilding) -> None:
    """Add a gutter along the eaves, and a downpipe at one end of the front."""
    black = paint("black", dirt=0.25)
    w, h = spec.width_m / 2, spec.eaves_m
    if not spec.parapet:
        z = h - 0.22
        outline = [(0.065 * math.cos(a), 0.065 * math.sin(a)) for a in (math.pi + math.pi * k / 6 for k in range(7))]
        with s.at(0, 0.33, z + 0.05, turn=90):
            s.prism(outline, (-w, w), black)
        s.box((spec.width_m, 0.03, 0.18), (0, 0.24, z + 0.02), trim((0.60, 0.60, 0.57)), 0.004)
        s.box((spec.width_m, 0.24, 0.02), (0, 0.12, z - 0.06), trim((0.60, 0.60, 0.57)), 0.004)
    x = w - 0.12
    top = (x, 0.31, h - 0.2) if not spec.parapet else (x, 0.10, h + 0.1)
    s.tube([top, (x, 0.09, h - 0.55), (x, 0.09, 3.7 if spec.shop else 0.05)], 0.036, black, sides=8)
    for k in range(int((h - 4) / 1.8) + 1):
        s.box((0.13, 0.06, 0.05), (x, 0.05, 4.3 + 1.8 * k), black, 0.008)
    if not spec.parapet:
        return
    s.box((0.26, 0.20, 0.26), (x, 0.11, h + 0.02), black, 0.03)
