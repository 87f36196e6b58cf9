"""Goods in shop windows: bread, cakes, books, teapots, hams, bottles, lamps, dressed mannequins."""

from __future__ import annotations

import math
from random import Random

import bpy

from scope_studio.kit.core.finishes import PALETTE, steel
from scope_studio.kit.core.shading import Shader
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.core.volumes import Volume

Rgb = tuple[float, float, float]


def _goods_material(name: str, colour: Rgb, roughness: float = 0.5, glow: float = 0.16) -> bpy.types.Material:
    """Return a material for goods in a lit shop window. It is slightly emissive, so that they look brighter than the street."""
    material_name = f"ware {name}"
    existing = bpy.data.materials.get(material_name)
    if existing is not None:
        return existing
    s = Shader(material_name)
    tint = s.mix(s.ramp(s.noise(s.object_coords(), 18.0, 4.0), 0.35, 0.7, 0.0, 0.4), colour, tuple(c * 0.55 for c in colour))
    return s.surface(base_color=tint, roughness=roughness, emission_color=tint, emission_strength=glow)


def loaf(seed: int = 0) -> Built:
    """Build a crusty loaf of bread, 0.30 m along x."""
    s, rng = Solid("loaf of bread"), Random(f"loaf {seed}")
    v = Volume()
    half = rng.uniform(0.09, 0.13)
    v.capsule((-half, 0, 0.055), (half, 0, 0.055), 0.062, 0.062, flat=0.9)
    surface = v.merge(0.012, 2)
    s.add(surface[0].tolist(), surface[1], _goods_material("crust", (0.36, 0.165, 0.055), 0.7))
    for k in range(4):
        with s.at(-half + 2 * half * k / 3, 0, 0.113, turn=35):
            s.box((0.018, 0.085, 0.010), (0, 0, 0), _goods_material("crumb", (0.66, 0.46, 0.24), 0.8), 0.004)
    return s.built()


def cake(colour: str = "pink") -> Built:
    """Build a two-tier iced cake with cherries on a stand, 0.36 m high."""
    s = Solid(f"{colour} cake")
    china, icing = _goods_material("china", (0.62, 0.62, 0.60), 0.15), _goods_material(f"icing {colour}", PALETTE[colour], 0.45)
    s.lathe([(0.08, 0.0), (0.03, 0.02), (0.025, 0.08), (0.16, 0.10), (0.165, 0.11)], china, steps=24)
    s.lathe([(0.135, 0.11), (0.14, 0.12), (0.14, 0.20), (0.13, 0.215)], icing, steps=28)
    s.lathe([(0.085, 0.215), (0.09, 0.22), (0.09, 0.29), (0.08, 0.30)], icing, steps=24)
    cherry = _goods_material("cherry", (0.45, 0.012, 0.02), 0.15)
    for k in range(9):
        a = 2 * math.pi * k / 9
        s.lathe([(0.002, -0.014), (0.014, 0.0), (0.002, 0.014)], cherry, (0.112 * math.cos(a), 0.112 * math.sin(a), 0.225), steps=8)
    s.lathe([(0.002, -0.016), (0.016, 0.0), (0.002, 0.016)], cherry, (0, 0, 0.312), steps=8)
    return s.built()


def ham() -> Built:
    """Build a ham on a hook. The top of the hook is at the origin."""
    s = Solid("ham")
    s.tube([(0, 0, 0), (0, 0, -0.10), (0.02, 0, -0.13), (0, 0, -0.15)], 0.005, steel(), sides=6)
    v = Volume()
    v.capsule((0, 0, -0.16), (0, 0, -0.30), 0.030, 0.075)
    v.ellipsoid((0.01, 0, -0.40), (0.105, 0.085, 0.13))
    surface = v.merge(0.012, 3)
    s.add(surface[0].tolist(), surface[1], _goods_material("ham", (0.40, 0.085, 0.055), 0.35))
    return s.built()


def bottle(colour: str = "green") -> Built:
    """Build a chemist's round bottle with a label and a stopper, 0.34 m high."""
    s = Solid(f"{colour} bottle")
    glass = _goods_material(f"bottle {colour}", PALETTE[colour], 0.08, 0.25)
    s.lathe(
        [(0.065, 0.0), (0.075, 0.01), (0.075, 0.19), (0.05, 0.235), (0.026, 0.25), (0.026, 0.285), (0.034, 0.29)], glass, steps=20
    )
    s.lathe([(0.022, 0.29), (0.034, 0.31), (0.02, 0.34), (0.004, 0.345)], glass, steps=14)
    s.lathe([(0.0765, 0.05), (0.0765, 0.14)], _goods_material("label", (0.66, 0.62, 0.50), 0.6), steps=20)
    return s.built()


def book(colour: str = "red", *, seed: int = 0) -> Built:
    """Build an upright book that leans back, about 0.26 m high, with its front cover towards +y."""
    s, rng = Solid(f"{colour} book"), Random(f"book {seed}")
    cover, page = _goods_material(f"book {colour}", PALETTE[colour], 0.4), _goods_material("pages", (0.66, 0.63, 0.54), 0.8)
    height, width = rng.uniform(0.23, 0.28), rng.uniform(0.155, 0.19)
    with s.at(0, 0, 0, pitch=14):
        s.box((width, 0.006, height), (0, 0.016, height / 2), cover, 0.002)
        s.box((width, 0.006, height), (0, -0.016, height / 2), cover, 0.002)
        s.box((width - 0.01, 0.026, height - 0.012), (0.003, 0, height / 2), page, 0.001)
        s.box((width * 0.7, 0.002, height * 0.14), (0, 0.0195, height * 0.74), page, 0.0)
        s.box(
            (width * 0.5, 0.002, height * 0.30),
            (0, 0.0195, height * 0.36),
            _goods_material("book plate", (0.55, 0.40, 0.10), 0.4),
            0.0,
        )
    return s.built()


def teapot(colour: str = "blue") -> Built:
    """Build a round teapot, 0.2 m high, with its spout towards +x."""
    s = Solid(f"{colour} teapot")
    china = _goods_material(f"teapot {colour}", PALETTE[colour], 0.1)
    s.lathe([(0.06, 0.0), (0.095, 0.03), (0.105, 0.08), (0.085, 0.13), (0.05, 0.15)], china, steps=24)
    s.lathe([(0.055, 0.15), (0.035, 0.17), (0.012, 0.175), (0.018, 0.19), (0.004, 0.20)], china, steps=18)
    s.tube([(0.09, 0, 0.06), (0.14, 0, 0.08), (0.165, 0, 0.14)], 0.020, china, radius_b=0.011)
    s.tube([(-0.085, 0, 0.12), (-0.14, 0, 0.125), (-0.155, 0, 0.08), (-0.10, 0, 0.045)], 0.011, china)
    return s.built()


def table_lamp(colour: str = "cream", *, lit: bool = True) -> Built:
    """Build a table lamp with a turned foot and a cloth shade, 0.5 m high."""
    s = Solid(f"{colour} lamp")
    foot = _goods_material("lamp foot", (0.30, 0.16, 0.06), 0.3)
    s.lathe([(0.08, 0.0), (0.08, 0.02), (0.02, 0.04), (0.045, 0.12), (0.03, 0.20), (0.012, 0.24), (0.012, 0.32)], foot, steps=20)
    shade = _goods_material(f"lamp shade {colour} {lit}", PALETTE[colour], 0.8, 1.6 if lit else 0.1)
    s.lathe([(0.16, 0.28), (0.10, 0.50), (0.09, 0.50), (0.15, 0.285)], shade, steps=28)
    return s.built()


def mannequin(colour: str = "red", *, dress: bool = True) -> Built:
    """Build a headless mannequin on a stand, 1.5 m high. It wears a dress, or a coat if ``dress`` is false."""
    s = Solid(f"mannequin in {colour}")
    s.lathe([(0.17, 0.0), (0.17, 0.02), (0.02, 0.03), (0.016, 0.75)], _goods_material("stand", (0.25, 0.15, 0.07), 0.3), steps=20)
    v = Volume()
    v.ellipsoid((0, 0, 1.22), (0.165, 0.105, 0.17))
    v.ellipsoid((0, 0, 1.02), (0.135, 0.095, 0.16))
    v.ellipsoid((0, 0, 0.86), (0.170, 0.120, 0.15))
    v.capsule((0, 0, 1.34), (0, 0, 1.45), 0.060, 0.048)
    for side in (-1, 1):
        v.capsule((side * 0.15, 0, 1.32), (side * 0.20, 0.02, 1.05), 0.055, 0.042)
        if not dress:
            v.capsule((side * 0.20, 0.02, 1.05), (side * 0.19, 0.09, 0.82), 0.042, 0.036)
    surface = v.merge(0.016, 3)
    s.add(surface[0].tolist(), surface[1], _goods_material(f"garment {colour}", PALETTE[colour], 0.85))
    n, rows = 28, []
    flare = (0.165, 0.24, 0.33) if dress else (0.165, 0.185, 0.21)
    for i, r in enumerate(flare):
        z = 0.90 - 0.22 * i * (1.0 if dress else 0.8)
        rows += [
            ((r + 0.016 * i * math.sin(9 * t)) * math.cos(t), (r * 0.75 + 0.016 * i * math.sin(9 * t)) * math.sin(t), z)
            for t in (2 * math.pi * k / n for k in range(n))
        ]
    faces = [(i * n + (k + 1) % n, i * n + k, (i + 1) * n + k, (i + 1) * n + (k + 1) % n) for i in range(2) for k in range(n)]
    s.add(rows, [f[::-1] for f in faces], _goods_material(f"garment {colour}", PALETTE[colour], 0.85))
    s.lathe(
        [(0.05, 1.44), (0.048, 1.47), (0.02, 1.49), (0.002, 1.50)], _goods_material("neck cap", (0.30, 0.18, 0.08), 0.3), steps=16
    )
    return s.built()
