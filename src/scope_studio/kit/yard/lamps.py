"""Lamps of yards and buildings: masts, wall packs and strips. Most of their light is added separately, by ``dusk.lamplight``."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import concrete, glass, lens, paint, sheet, steel
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.light import dusk
from scope_studio.kit.light.glow import lit_lens


def mast(height: float = 10.0, *, kind: str = "led", heads: int = 2, lit: bool = True, number: str = "") -> Built:
    """Build a tapered steel column with its number on a plate, and one or two floodlights on a cross arm.

    The first floodlight points towards +y, the second towards -y.
    """
    s = Solid("lamp mast")
    s.lathe([(0.34, 0.0), (0.34, 0.10), (0.30, 0.14)], concrete(light=False), steps=20)
    s.lathe([(0.20, 0.14), (0.20, 0.165)], steel(dark=True), steps=8)
    s.lathe([(0.115, 0.16), (0.11, 1.4), (0.055, height), (0.04, height + 0.04)], steel(), steps=20)
    s.box((0.13, 0.02, 0.55), (0, 0.112, 0.95), paint("light grey", dirt=0.3), 0.008)
    if number:
        s.box((0.20, 0.012, 0.16), (0, 0.107, 1.95), sheet("yellow"), 0.002)
        s.text(number, 0.085, (0, 0.1145, 1.95), sheet("black", dirt=0.05))
    for sign in (1, -1)[:heads]:
        s.tube([(0, 0, height - 0.25), (0, sign * 0.35, height - 0.05), (0, sign * 0.75, height)], 0.035, steel(), sides=10)
        with s.at(0, sign * 1.05, height, pitch=-sign * 8.0):
            s.box((0.46, 0.66, 0.10), (0, 0, 0.03), paint("dark grey", dirt=0.2), 0.025)
            for k in range(6):
                s.box((0.40, 0.02, 0.06), (0, -0.25 + 0.10 * k, 0.10), paint("dark grey", dirt=0.2), 0.004)
            s.box((0.38, 0.52, 0.014), (0, 0, -0.024), lit_lens(kind, 7.0) if lit else glass(), 0.004)
    return s.built()


def mast_light(
    x: float, y: float, bearing_deg: float, height: float = 10.0, *, kind: str = "led", heads: int = 2, power_w: float = 650.0
) -> None:
    """Add the light of the lamps on a mast that is placed at (x, y)."""
    rgb = dusk.SODIUM if kind == "sodium" else dusk.LED
    b = math.radians(bearing_deg)
    for sign in (1, -1)[:heads]:
        dx, dy = sign * math.sin(b), sign * math.cos(b)
        dusk.lamplight((x + 1.05 * dx, y + 1.05 * dy, height - 0.10), power_w, rgb, size_m=0.5, aim=(dx * 0.14, dy * 0.14, -1.0))


def wall_pack(*, kind: str = "sodium", lit: bool = True) -> Built:
    """Build a prismatic wall lamp, 0.4 m wide, with its back at y = 0 and its centre at z = 0."""
    s = Solid("wall lamp")
    s.box((0.40, 0.05, 0.26), (0, 0.025, 0), paint("dark grey", dirt=0.2), 0.01)
    s.prism([(0.04, 0.13), (0.24, 0.11), (0.26, 0.04), (0.04, 0.04)], (-0.20, 0.20), paint("dark grey", dirt=0.2), "YZ")
    s.prism(
        [(0.045, 0.04), (0.25, 0.04), (0.20, -0.09), (0.045, -0.12)],
        (-0.18, 0.18),
        lit_lens(kind, 5.0) if lit else lens("light grey"),
        "YZ",
    )
    return s.built()


def strip(length: float = 1.5, *, kind: str = "led", strength: float = 5.0) -> Built:
    """Build a weatherproof tube lamp along x that hangs below z = 0."""
    s = Solid("strip lamp")
    s.box((length, 0.13, 0.05), (0, 0, -0.025), paint("light grey", dirt=0.2), 0.01)
    s.box((length - 0.06, 0.10, 0.05), (0, 0, -0.07), lit_lens(kind, strength), 0.02)
    return s.built()


def floodlight() -> Built:
    """Build a floodlight on a short arm, tilted down. The wall is the plane y = 0, and the lamp is centred on z = 0."""
    s = Solid("floodlight")
    s.tube([(0, 0, 0.10), (0, 0.45, 0.16), (0, 0.62, 0.06)], 0.025, steel(), sides=8)
    with s.at(0, 0.70, -0.04, pitch=-38):
        s.box((0.52, 0.12, 0.34), (0, 0, 0), paint("dark grey", dirt=0.2), 0.02)
        for k in range(5):
            s.box((0.02, 0.10, 0.30), (-0.20 + 0.10 * k, -0.09, 0), paint("dark grey", dirt=0.2), 0.003)
        s.box((0.46, 0.012, 0.28), (0, 0.064, 0), lit_lens("led", 7.0), 0.004)
    return s.built()
