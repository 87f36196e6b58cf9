"""Building materials and small tools on a construction site: heaps, pipes, kerbs, bags, cable drums, hand tools, cans."""

from __future__ import annotations

import math

import bpy
from mathutils import noise

from scope_studio.kit.core.finishes import cloth, concrete, granular, lens, paint, rubber, sheet, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def heap(
    s: Solid,
    material: bpy.types.Material,
    radii: tuple[float, float],
    height: float,
    *,
    seed: float,
    square: bool = False,
) -> None:
    """Add an irregular mound on z = 0. It is elliptical or, with ``square``, rectangular. ``radii`` are its half sizes."""
    rings, steps = 22, 56
    points = [(0.0, 0.0, height * (0.97 if not square else 1.0))]
    for i in range(1, rings + 1):
        t = i / rings
        for k in range(steps):
            a = 2 * math.pi * k / steps
            c, d = math.cos(a), math.sin(a)
            stretch = 1.0 / max(abs(c), abs(d)) if square else 1.0 + 0.16 * noise.noise((c * 1.1 + seed, d * 1.1, seed))
            x, y = radii[0] * t * c * stretch, radii[1] * t * d * stretch
            fall = 1.0 - 0.62 * t**2.2 if square else max(0.0, 1.0 - t) ** 0.92 * (1.0 - 0.10 * t)
            rough = noise.noise((x * 2.2 + seed, y * 2.2, 0)) * 0.14 + noise.noise((x * 7, y * 7 + seed, 0)) * 0.05
            z = height * (fall + rough * (1.0 if square else min(1.0, 5 * (1 - t) + 0.05)))
            points.append((x, y, z if square else max(-0.01, z)))
    faces: list[tuple[int, ...]] = [(0, 1 + k, 1 + (k + 1) % steps) for k in range(steps)]
    for i in range(rings - 1):
        a, b = 1 + i * steps, 1 + (i + 1) * steps
        faces += [(a + k, b + k, b + (k + 1) % steps, a + (k + 1) % steps) for k in range(steps)]
    s.add(points, faces, material)


def sand_pile(radius: float = 1.6) -> Built:
    """Build a heap of building sand with lumps."""
    s = Solid("sand pile")
    heap(
        s,
        granular("sand", (0.30, 0.20, 0.095), (0.52, 0.38, 0.20), 160.0),
        (radius, radius * 0.85),
        radius * 0.56,
        seed=2.0,
    )
    return s.built()


def gravel_pile(radius: float = 1.8) -> Built:
    """Build a heap of crushed stone with loose stones around it."""
    s = Solid("gravel pile")
    stone = granular("gravel", (0.11, 0.11, 0.115), (0.40, 0.39, 0.38), 34.0)
    heap(s, stone, (radius, radius * 0.9), radius * 0.52, seed=7.0)
    for k in range(60):
        a, r = 2.4 * k, radius * (0.55 + 0.55 * math.sqrt((k * 0.618) % 1.0))
        with s.at(
            r * math.cos(a),
            r * 0.9 * math.sin(a),
            max(0.01, radius * 0.5 * (1 - r / radius)) + 0.012,
            turn=77 * k,
            roll=35 * k,
        ):
            s.box((0.06, 0.045, 0.035), (0, 0, 0), stone, 0.012)
    return s.built()


def _pallet(s: Solid) -> None:
    for z in (0.012, 0.13):
        for k in range(5 if z > 0.1 else 3):
            count = 5 if z > 0.1 else 3
            s.box((1.2, 0.12, 0.022), (0, -0.44 + 0.88 * k / (count - 1), z), timber(fresh=False), 0.003)
    for x in (-0.53, 0.0, 0.53):
        for y in (-0.43, 0.0, 0.43):
            s.box((0.14, 0.10, 0.09), (x, y, 0.07), timber(fresh=False), 0.003)


def pallet_of_kerbs() -> Built:
    """Build concrete kerb stones strapped to a pallet."""
    s = Solid("pallet of kerbs")
    _pallet(s)
    for layer in range(3):
        for k in range(6):
            y = -0.41 + 0.164 * k
            x = 0.02 * math.sin(5.1 * k + 2 * layer)
            profile = [(y - 0.075, 0.0), (y + 0.075, 0.0), (y + 0.075, 0.20), (y + 0.04, 0.25), (y - 0.075, 0.25)]
            s.prism([(u, v + 0.143 + 0.252 * layer) for u, v in profile], (x - 0.457, x + 0.457), concrete(), "YZ")
    for x in (-0.25, 0.25):
        s.tube(
            [(x, -0.50, 0.145), (x, -0.50, 0.905), (x, 0.50, 0.905), (x, 0.50, 0.145)],
            0.006,
            paint("black"),
            sides=4,
            closed=True,
        )
    return s.built()


def pipe_stack(colour: str = "orange", *, length: float = 6.0) -> Built:
    """Build a pyramid of ten drain pipes along y between timber stakes."""
    s = Solid("pipe stack")
    r, finish = 0.16, paint(colour, dirt=0.30, roughness=0.35)
    for row in range(4):
        for k in range(4 - row):
            x = (k - (3 - row) / 2) * 2.02 * r
            z = 0.08 + r + row * r * math.sqrt(3)
            shift = 0.05 * math.sin(7 * k + 3 * row)
            a, b = -length / 2 + shift, length / 2 + shift
            s.lathe(
                [
                    (r * 0.90, a + 0.30),
                    (r * 0.90, a),
                    (r, a),
                    (r, b - 0.16),
                    (r * 1.09, b - 0.15),
                    (r * 1.09, b),
                    (r * 0.95, b),
                    (r * 0.95, b - 0.30),
                ],
                finish,
                (x, 0, z),
                "Y",
                28,
            )
            for y in (a + 0.25, b - 0.25):
                s.lathe([(r * 0.88, y), (r * 0.89, y + 0.004)], lens("black"), (x, 0, z), "Y", 20)
    for y in (-length * 0.32, length * 0.32):
        s.box((1.7, 0.09, 0.08), (0, y, 0.04), timber(fresh=False), 0.005)
        for x in (-0.72, 0.72):
            s.box((0.07, 0.07, 0.55), (x, y, 0.30), timber(), 0.004)
    return s.built()


def cement_bags() -> Built:
    """Build paper bags of cement on a pallet, plump and slightly skewed, with an incomplete top layer."""
    s = Solid("cement bags")
    _pallet(s)
    paper = cloth("light grey", 0.85)
    for layer in range(5):
        for k in range(6 if layer < 4 else 4):
            x, y = -0.39 + 0.39 * (k % 3), -0.24 + 0.48 * (k // 3)
            with s.at(x, y, 0.145 + 0.115 * layer, turn=4 * math.sin(9 * k + 5 * layer)):
                _bag(s, paper)
                s.box((0.22, 0.30, 0.002), (0, 0, 0.1155), sheet("blue" if k % 2 else "green", dirt=0.4), 0.0)
    return s.built()


def _bag(s: Solid, material: bpy.types.Material) -> None:
    """Add a full bag of cement, 0.38 x 0.47 x 0.115 m."""
    n, m = 12, 14
    points = []
    for side in (1, -1):
        for j in range(m + 1):
            for i in range(n + 1):
                u, v = 2 * i / n - 1, 2 * j / m - 1
                bulge = ((1 - u**6) * (1 - v**8)) ** 0.35
                points.append((0.19 * u, 0.235 * v, 0.0575 + side * 0.0575 * bulge + 0.004 * noise.noise((u * 3, v * 3, side))))
    row, sheet_size = n + 1, (n + 1) * (m + 1)
    top = [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i) for j in range(m) for i in range(n)]
    s.add(points, [*top, *(tuple(sheet_size + q for q in f[::-1]) for f in top)], material)


def cable_drum(diameter: float = 1.4) -> Built:
    """Build a timber cable drum with black cable. Its axis is along x."""
    s = Solid("cable drum")
    r, half = diameter / 2, diameter * 0.34
    for side in (-1, 1):
        x = side * half
        s.lathe([(r, -0.03), (r, 0.03)], timber(fresh=False), (x, 0, r), "X", 40)
        s.lathe([(r * 0.16, -0.05), (r * 0.16, 0.05)], steel(dark=True), (x, 0, r), "X", 20)
        for k in range(3):
            with s.at(x + side * 0.036, 0, r, pitch=60 * k):
                s.box((0.014, 0.10, 1.9 * r), (0, 0, 0), timber(), 0.003)
        for k in range(8):
            a = 2 * math.pi * k / 8
            s.lathe(
                [(0.016, -0.05), (0.016, 0.05)],
                steel(),
                (x, r * 0.55 * math.cos(a), r + r * 0.55 * math.sin(a)),
                "X",
                8,
            )
    profile: list[tuple[float, float]] = []
    turns = 16
    for k in range(turns):
        x = -half + 0.04 + (2 * half - 0.08) * (k + 0.5) / turns
        profile += [(r * 0.74, x - half / turns * 0.9), (r * 0.78, x), (r * 0.74, x + half / turns * 0.9)]
    s.lathe(profile, paint("black", dirt=0.2), (0, 0, r), "X", 36)
    for y in (-r * 0.5, r * 0.5):
        s.prism(
            [(y - 0.12, 0.0), (y + 0.12, 0.0), (y + math.copysign(0.10, y), 0.14)],
            (-half - 0.1, half + 0.1),
            timber(),
            "YZ",
        )
    return s.built()


def standing_shovel() -> Built:
    """Build a shovel that stands upright in the ground, leaning slightly."""
    s = Solid("shovel")
    with s.at(0, 0, 0, pitch=-9, roll=4):
        s.prism(
            [(-0.12, 0.30), (0.12, 0.30), (0.125, 0.08), (0.06, 0.0), (0.0, -0.05), (-0.06, 0.0), (-0.125, 0.08)],
            (-0.004, 0.004),
            steel(dark=True),
            "XZ",
        )
        s.rod((0, 0, 0.20), (0, 0, 0.46), 0.022, steel(dark=True))
        s.rod((0, 0, 0.40), (0, 0, 1.30), 0.017, timber())
        s.tube([(-0.055, 0, 1.40), (0.055, 0, 1.40), (0.03, 0, 1.30), (-0.03, 0, 1.30)], 0.014, paint("black"), closed=True)
    return s.built()


def broom() -> Built:
    """Build a broom that stands on its bristles and leans against an object behind it (-y)."""
    s = Solid("broom")
    with s.at(0, 0, 0, pitch=12):
        s.box((0.46, 0.07, 0.07), (0, 0, 0.04), paint("dark red", roughness=0.9), 0.015)
        s.box((0.46, 0.06, 0.045), (0, 0, 0.095), timber(), 0.006)
        s.rod((0, 0, 0.10), (0, 0, 1.50), 0.014, timber())
    return s.built()


def fuel_can(colour: str = "red") -> Built:
    """Build a 20-litre fuel can with pressed sides and a triple handle."""
    s = Solid(f"{colour} fuel can")
    finish = paint(colour, dirt=0.35)
    s.box((0.345, 0.165, 0.44), (0, 0, 0.22), finish, 0.035)
    for side in (-1, 1):
        for a, b in (((-0.12, 0.09), (0.12, 0.35)), ((-0.12, 0.35), (0.12, 0.09))):
            s.rod((a[0], side * 0.080, a[1]), (b[0], side * 0.080, b[1]), 0.010, finish)
    for y in (-0.05, 0.0, 0.05):
        s.tube([(-0.10, y, 0.43), (-0.08, y, 0.475), (0.04, y, 0.475), (0.06, y, 0.43)], 0.010, finish)
    s.lathe([(0.034, 0.0), (0.034, 0.05), (0.02, 0.06)], paint("black"), (0.125, 0, 0.43), steps=16)
    return s.built()


def fire_extinguisher() -> Built:
    """Build a red extinguisher, 0.55 m high, with its hose and label towards +y."""
    s = Solid("fire extinguisher")
    red = paint("red", dirt=0.15, roughness=0.25)
    s.lathe([(0.078, 0.0), (0.082, 0.02), (0.082, 0.40), (0.07, 0.445), (0.035, 0.465), (0.025, 0.49)], red, steps=28)
    s.lathe([(0.0826, 0.14), (0.0826, 0.30)], sheet("white"), steps=28)
    s.text("FIRE", 0.04, (0, 0.0865, 0.23), sheet("red"))
    s.box((0.03, 0.12, 0.02), (0, 0.03, 0.515), paint("black"), 0.006)
    s.box((0.025, 0.14, 0.014), (0, 0.04, 0.55), steel(), 0.004)
    s.tube([(0.02, 0.0, 0.50), (0.09, 0.0, 0.47), (0.11, 0.0, 0.36), (0.10, 0.01, 0.16)], 0.011, rubber())
    s.rod((0.10, 0.01, 0.16), (0.10, 0.012, 0.08), 0.013, paint("black"), radius_b=0.026)
    return s.built()


def toolbox(colour: str = "red") -> Built:
    """Build a cantilever steel toolbox, 0.5 m long, with a tube handle."""
    s = Solid(f"{colour} toolbox")
    finish = paint(colour, dirt=0.35)
    s.box((0.50, 0.22, 0.20), (0, 0, 0.10), finish, 0.010)
    s.prism(
        [(-0.11, 0.20), (0.11, 0.20), (0.10, 0.27), (0.04, 0.30), (-0.04, 0.30), (-0.10, 0.27)],
        (-0.25, 0.25),
        finish,
        "YZ",
    )
    s.tube([(-0.16, 0, 0.30), (-0.15, 0, 0.36), (0.15, 0, 0.36), (0.16, 0, 0.30)], 0.011, steel())
    for x in (-0.15, 0.15):
        s.box((0.04, 0.014, 0.07), (x, 0.113, 0.19), steel(), 0.004)
    return s.built()
