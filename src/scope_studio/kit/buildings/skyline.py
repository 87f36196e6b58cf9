"""Buildings on an evening horizon: sheds, blocks of flats, silos, a chimney with warning lights, and distant lights."""

from __future__ import annotations

import math
import random

import bpy

from scope_studio.kit.buildings.wall_materials import cladding_material
from scope_studio.kit.core.finishes import concrete, glow, paint, steel
from scope_studio.kit.core.mesh import from_data
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.light.glow import glowing_face

Rgb = tuple[float, float, float]


def lit_glass(tint: str, strength: float = 0.8) -> bpy.types.Material:
    """Return the material of a distant, unevenly lit window ("warm", "cool" or "dim")."""
    name = f"lit window {tint} {strength:g}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    rgb = {"warm": (1.0, 0.72, 0.40), "cool": (0.78, 0.88, 1.0), "dim": (0.45, 0.30, 0.17)}[tint]
    s = Shader(name)
    p = s.object_coords()
    blotch = s.ramp(s.noise(p, 1.1, 3.0), 0.35, 0.65, 0.45, 1.1)
    return s.surface(
        base_color=(0.02, 0.02, 0.02), roughness=0.1, emission_color=rgb, emission_strength=s.math("MULTIPLY", blotch, strength)
    )


def _panes(
    s: Solid,
    front_width: float,
    y: float,
    rows: list[float],
    rng: random.Random,
    lit: float,
    pane_width: float,
    pane_height: float,
    pitch: float,
) -> None:
    """Add rows of windows to the wall at ``y``, which faces +y. A random fraction ``lit`` of them is lit."""
    dark = plain("evening glass", (0.020, 0.026, 0.036), 0.06)
    frame = plain("far frame", (0.10, 0.105, 0.11), 0.6)
    count = int((front_width - 1.0) / pitch)
    for z in rows:
        for k in range(count):
            x = -front_width / 2 + 0.5 + pitch * (k + 0.5) + (front_width - 1.0 - pitch * count) / 2
            glass = lit_glass(rng.choice(["warm", "warm", "cool", "dim"])) if rng.random() < lit else dark
            s.box((pane_width + 0.16, 0.10, pane_height + 0.16), (x, y, z), frame, 0.0)
            s.box((pane_width, 0.12, pane_height), (x, y + 0.012, z), glass, 0.0)
            s.box((0.06, 0.13, pane_height), (x, y + 0.014, z), frame, 0.0)


def industrial(
    *,
    width: float,
    depth: float,
    height: float,
    colour: Rgb,
    lettering: str = "",
    lit: float = 0.4,
    cap: float = 1.1,
    seed: int = 0,
    doors: int = 2,
) -> Built:
    """Build an industrial shed with roller doors, a strip of windows and its name in lit letters on its front (+y)."""
    s = Solid("industrial shed")
    rng = random.Random(f"shed {seed}")
    tag = f"{colour[0]:.2f} {colour[1]:.2f} {colour[2]:.2f}"
    finish, trim = cladding_material(f"far cladding {tag}", colour, 0.3), plain("far trim", (0.06, 0.07, 0.085), 0.5)
    w, d, h = width / 2, depth / 2, height
    s.box((width, depth, h - 0.9), (0, 0, 0.9 + (h - 0.9) / 2), finish, 0.0)
    s.box((width + 0.1, depth + 0.1, 0.95), (0, 0, 0.47), concrete(light=False), 0.0)
    ridge = h + depth * 0.07
    roof = [
        (-w - 0.2, -d - 0.2, h),
        (w + 0.2, -d - 0.2, h),
        (w + 0.2, 0, ridge),
        (-w - 0.2, 0, ridge),
        (w + 0.2, d + 0.2, h),
        (-w - 0.2, d + 0.2, h),
    ]
    s.add(roof, [(0, 1, 2, 3), (3, 2, 4, 5), (0, 3, 5), (1, 4, 2)], cladding_material("far roof", (0.16, 0.17, 0.18), 0.33))
    for y in (-d - 0.1, d + 0.1):
        s.box((width + 0.4, 0.2, 0.5), (0, y, h - 0.1), trim, 0.0)
    shutter = paint("light grey", dirt=0.4)
    for k in range(doors):
        x = -w + 4.0 + 6.5 * k
        s.box((4.0, 0.16, 4.4), (x, d + 0.04, 2.2), shutter, 0.0)
        for z in range(16):
            s.box((4.0, 0.18, 0.03), (x, d + 0.045, 0.3 + 0.26 * z), trim, 0.0)
        s.box((0.34, 0.3, 0.2), (x + 2.6, d + 0.15, 4.6), glow("amber" if k % 2 else "cream", 4.0), 0.02)
    office = width - 8.0 - 6.5 * doors
    if office > 4:
        with s.at(w - office / 2 - 0.5, 0, 0):
            _panes(s, office, d + 0.02, [1.9, 4.6] if h > 6.4 else [1.9], rng, lit, 1.5, 1.2, 2.2)
    for turn, along, reach in ((90, depth, w), (-90, depth, w), (180, width, d)):
        with s.at(turn=turn):
            _panes(s, along, reach + 0.02, [h - 1.6], rng, lit * 0.8, 2.4, 0.9, 4.8)
    if lettering:
        s.text(lettering, cap, (0, d + 0.14, h - 1.35), glowing_face("white", 1.1), facing="+Y")
    return s.built()


def flats(
    *, width: float = 22.0, depth: float = 12.0, floors: int = 5, colour: Rgb = (0.20, 0.14, 0.11), lit: float = 0.45, seed: int = 0
) -> Built:
    """Build a block of flats with windows on all four sides."""
    s = Solid("block of flats")
    rng = random.Random(f"flats {seed}")
    height = 2.9 * floors + 0.8
    s.box((width, depth, height), (0, 0, height / 2), plain(f"flats wall {colour[0]:.2f}", colour, 0.9), 0.0)
    s.box((width + 0.3, depth + 0.3, 0.4), (0, 0, height), concrete(light=False), 0.0)
    s.box((4, 4, 2.2), (width * 0.2, 0, height + 1.1), plain("flats plant", (0.14, 0.14, 0.145), 0.8), 0.0)
    for turn, along, reach in ((0, width, depth / 2), (90, depth, width / 2), (180, width, depth / 2), (-90, depth, width / 2)):
        with s.at(turn=turn):
            _panes(s, along, reach, [1.7 + 2.9 * k for k in range(floors)], rng, lit, 1.3, 1.35, 2.6)
    return s.built()


def chimney(height: float = 46.0) -> Built:
    """Build a tapered concrete stack with bands near the top and red aircraft warning lights on two levels."""
    s = Solid("chimney")
    body, red = concrete(), paint("dark red", dirt=0.4)
    s.lathe([(2.2, 0.0), (1.35, height * 0.82)], body, steps=28)
    s.lathe([(1.35, height * 0.82), (1.28, height * 0.87)], red, steps=28)
    s.lathe([(1.28, height * 0.87), (1.22, height * 0.93)], body, steps=28)
    s.lathe([(1.22, height * 0.93), (1.15, height)], red, steps=28)
    for z, r in ((height * 0.55, 1.72), (height - 0.3, 1.20)):
        s.lathe([(r + 0.5, z - 0.7), (r + 0.5, z - 0.6)], steel(dark=True), steps=28)
        for k in range(4):
            a = math.pi * k / 2 + 0.5
            s.lathe(
                [(0.20, 0.0), (0.22, 0.25), (0.10, 0.42)],
                glow("red", 16.0),
                ((r + 0.35) * math.cos(a), (r + 0.35) * math.sin(a), z - 0.6),
                steps=12,
            )
    return s.built()


def silos(count: int = 3, *, height: float = 17.0, lettering: str = "") -> Built:
    """Build steel silos in a row along x, with a gantry on top, an elevator leg and a red light."""
    s = Solid("silos")
    finish = steel()
    for k in range(count):
        x = (k - (count - 1) / 2) * 5.4
        rings = [(2.5 + 0.02 * (i % 2), 3.0 + (height - 5.2) * i / 12) for i in range(13)]
        s.lathe([(0.5, 1.2), (2.5, 3.0), *rings, (2.5, height - 2.2), (0.5, height - 0.8)], finish, (x, 0, 0), steps=32)
        for a in range(6):
            c, d = math.cos(a * math.pi / 3), math.sin(a * math.pi / 3)
            s.rod((x + 2.4 * c, 2.4 * d, 0), (x + 2.4 * c, 2.4 * d, 3.2), 0.10, steel(dark=True))
    span = 5.4 * count
    s.box((span + 3, 1.2, 0.12), (0, 0, height - 0.4), steel(dark=True), 0.0)
    for y in (-0.55, 0.55):
        s.box((span + 3, 0.05, 0.05), (0, y, height + 0.6), steel(dark=True), 0.0)
    s.box((1.2, 1.2, height + 3.5), (span / 2 + 1.4, 0, (height + 3.5) / 2), steel(dark=True), 0.0)
    s.lathe([(0.20, 0.0), (0.22, 0.25), (0.10, 0.42)], glow("red", 16.0), (span / 2 + 1.4, 0, height + 3.5), steps=12)
    if lettering:
        s.text(lettering, 1.1, (0, 2.62, height * 0.62), paint("blue", dirt=0.2), facing="+Y")
    return s.built()


def distant_lights(points: list[tuple[float, float, float]], *, seed: int = 0) -> Built:
    """Build the distant lights of a town: one small emissive block at each point."""
    rng = random.Random(f"glimmer {seed}")
    parts = []
    for k, (rgb, strength) in enumerate((((1.0, 0.58, 0.22), 3.5), ((1.0, 0.82, 0.58), 3.0), ((0.85, 0.92, 1.0), 3.0))):
        corners: list[tuple[float, float, float]] = []
        faces: list[tuple[int, ...]] = []
        for x, y, z in points[k::3]:
            r = rng.uniform(0.35, 0.7) * (0.6 + math.hypot(x, y) / 900)
            base = len(corners)
            corners += [(x + sx * r, y + sy * r, z + sz * r) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
            faces += [
                tuple(base + i for i in f)
                for f in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
            ]
        parts.append(
            from_data(
                "glimmer",
                corners,
                faces,
                Shader(f"glimmer {k}").surface(base_color=rgb, emission_color=rgb, emission_strength=strength),
            )
        )
    return Built.of("glimmer", parts)
