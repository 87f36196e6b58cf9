"""Goods and small containers in a freight yard: pallets, steel drums, gas cages, tyres, tanks, bins, cartons."""

from __future__ import annotations

import math
import random

import bpy

from scope_studio.kit.core.finishes import cloth, lens, paint, rubber, sheet, steel, timber
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write

PALLET_HEIGHT_M = 0.144
"""Height of a pallet in metres."""


def add_pallet(s: Solid, *, fresh: bool = False) -> None:
    """Add a pallet, 1.2 x 1.0 m, on z = 0 of the current frame."""
    wood = timber(fresh=fresh)
    for k in range(3):
        s.box((1.2, 0.10, 0.022), (0, -0.44 + 0.44 * k, 0.011), wood, 0.003)
        for x in (-0.53, 0.0, 0.53):
            s.box((0.14, 0.10, 0.09), (x, -0.44 + 0.44 * k, 0.067), wood, 0.003)
    for k in range(7):
        s.box((0.10, 1.0, 0.022), (-0.55 + 0.1833 * k, 0, 0.133), wood, 0.003)
    for y in (-0.44, 0.0, 0.44):
        s.box((1.2, 0.10, 0.020), (0, y, 0.112), wood, 0.003)


def pallet_stack(count: int = 8, *, seed: int = 0) -> Built:
    """Build a slightly irregular stack of empty pallets."""
    s = Solid("pallet stack")
    rng = random.Random(f"stack {seed}")
    for k in range(count):
        with s.at(rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), PALLET_HEIGHT_M * k, turn=rng.uniform(-2, 2)):
            add_pallet(s, fresh=rng.random() < 0.25)
    return s.built()


def pallet_load(kind: str = "cartons", *, label: str | None = None, seed: int = 0, wrapped: bool = True) -> Built:
    """Build a pallet loaded with "cartons", "sacks" or "crates".

    ``label`` is the text on a sheet that faces +y. ``wrapped`` adds stretch film.
    """
    s = Solid(f"pallet of {kind}")
    rng = random.Random(f"load {kind} {seed}")
    add_pallet(s)
    top = PALLET_HEIGHT_M
    if kind == "cartons":
        tones = [
            plain(f"stock carton {k}", c, 0.85)
            for k, c in enumerate(((0.36, 0.235, 0.125), (0.31, 0.20, 0.105), (0.40, 0.27, 0.15)))
        ]
        for layer in range(4):
            for i in range(3):
                for j in range(2):
                    if layer == 3 and not wrapped and rng.random() < 0.3:
                        continue
                    s.box(
                        (0.39, 0.48, 0.30),
                        (-0.39 + 0.39 * i + rng.uniform(-0.006, 0.006), -0.24 + 0.48 * j, top + 0.152 + 0.303 * layer),
                        rng.choice(tones),
                        0.008,
                    )
        top += 1.22
    elif kind == "sacks":
        white = cloth("light grey", 0.85)
        for layer in range(5):
            for k in range(4):
                with s.at(-0.30 + 0.60 * (k % 2), -0.25 + 0.5 * (k // 2), top + 0.09 + 0.165 * layer, turn=rng.uniform(-4, 4)):
                    s.box((0.58, 0.48, 0.165), (0, 0, 0), white, 0.06)
        top += 0.84
    else:
        for layer in range(4):
            for k in range(4):
                x, y, z = -0.30 + 0.60 * (k % 2), -0.25 + 0.5 * (k // 2), top + 0.135 + 0.27 * layer
                finish = paint(rng.choice(["blue", "blue", "green"]), dirt=0.2)
                s.box((0.58, 0.48, 0.26), (x, y, z), finish, 0.02)
                s.box((0.50, 0.485, 0.05), (x, y, z + 0.04), lens("black"), 0.0)
                s.box((0.585, 0.12, 0.05), (x, y, z + 0.07), lens("black"), 0.0)
        top += 1.09
    if wrapped:
        s.box((1.21, 1.0, top - PALLET_HEIGHT_M + 0.01), (0, 0, (top + PALLET_HEIGHT_M) / 2), _film(), 0.03)
    if label:
        s.box((0.42, 0.006, 0.30), (0.15, 0.508, top - 0.38), sheet("white"), 0.0)
        s.text(label, 0.075, (0.15, 0.512, top - 0.38), sheet("black", dirt=0.05))
    return s.built()


def _film() -> bpy.types.Material:
    """Return the material of clear stretch film with bright creases."""
    existing = bpy.data.materials.get("stretch film")
    if existing is not None:
        return existing
    s = Shader("stretch film")
    crease = s.noise(s.scaled(s.object_coords(), (3.0, 3.0, 14.0)), 1.5, 4.0, 0.6, 0.8)
    return s.surface(base_color=(0.75, 0.78, 0.80), roughness=0.22, alpha=s.ramp(crease, 0.42, 0.68, 0.10, 0.42))


def steel_drum(colour: str = "blue", *, label: bool = True) -> Built:
    """Build a 200-litre steel drum with rolling hoops, bungs and a hazard label."""
    s = Solid(f"{colour} drum")
    finish = paint(colour, dirt=0.40)
    profile = [(0.286, 0.0), (0.292, 0.02), (0.285, 0.03)]
    for z in (0.30, 0.58):
        profile += [(0.285, z - 0.02), (0.295, z - 0.008), (0.295, z + 0.008), (0.285, z + 0.02)]
    profile += [(0.285, 0.85), (0.292, 0.862), (0.292, 0.88), (0.280, 0.88), (0.278, 0.868)]
    s.lathe(profile, finish, steps=32)
    for x, y, r in ((0.16, 0.08, 0.035), (-0.17, -0.06, 0.022)):
        s.lathe([(r, 0.868), (r, 0.884)], steel(), (x, y, 0), steps=14)
    if label:
        with s.at(0, 0.287, 0.44, roll=45):
            s.box((0.16, 0.004, 0.16), (0, 0, 0), sheet("amber"), 0.0)
    return s.built()


def gas_cage() -> Built:
    """Build a mesh cage with eight gas cylinders and its warning sign, 1.9 x 1.0 x 1.9 m, with doors towards +y."""
    s = Solid("gas cage")
    frame = steel()
    for x in (-0.95, 0.95):
        for y in (-0.5, 0.5):
            s.box((0.05, 0.05, 1.9), (x, y, 0.95), frame, 0.005)
    for z in (0.06, 1.0, 1.88):
        for y in (-0.5, 0.5):
            s.box((1.9, 0.04, 0.04), (0, y, z), frame, 0.004)
        for x in (-0.95, 0.95):
            s.box((0.04, 1.0, 0.04), (x, 0, z), frame, 0.004)
    s.box((1.9, 1.0, 0.04), (0, 0, 0.05), steel(dark=True), 0.0)
    s.box((2.0, 1.1, 0.03), (0, 0, 1.92), steel(dark=True), 0.0)
    for side in (-0.5, 0.5):
        for k in range(1, 19):
            s.rod((-0.95 + 0.1 * k, side, 0.06), (-0.95 + 0.1 * k, side, 1.88), 0.003, frame, sides=4)
        for k in range(1, 19):
            s.rod((-0.95, side, 0.06 + 0.1 * k), (0.95, side, 0.06 + 0.1 * k), 0.003, frame, sides=4)
    for k in range(8):
        x, y = -0.66 + 0.44 * (k % 4), -0.2 + 0.42 * (k // 4)
        finish = paint(("dark red", "dark red", "green", "grey")[k % 4], dirt=0.3)
        s.lathe(
            [(0.11, 0.07), (0.115, 0.09), (0.115, 1.20), (0.09, 1.32), (0.035, 1.38), (0.03, 1.45)], finish, (x, y, 0), steps=20
        )
        s.lathe([(0.055, 1.40), (0.055, 1.54)], finish, (x, y, 0), steps=14)
    with s.at(0, 0.53, 1.45):
        board(s, 0.9, 0.46, "yellow", back=False)
        write(s, "DANGER", 0.10, 0, 0.10, "black")
        write(s, "HIGHLY FLAMMABLE", 0.06, 0, -0.09, "black")
    return s.built()


def tyre_stack(count: int = 5, *, seed: int = 0) -> Built:
    """Build a pile of lorry tyres."""
    s = Solid("tyre stack")
    rng = random.Random(f"tyres {seed}")
    for k in range(count):
        x, y, z = rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0.29 * k
        s.lathe(
            [
                (0.29, z + 0.03),
                (0.34, z),
                (0.47, z),
                (0.515, z + 0.05),
                (0.52, z + 0.24),
                (0.47, z + 0.285),
                (0.34, z + 0.285),
                (0.29, z + 0.25),
            ],
            rubber(),
            (x, y, 0),
            steps=36,
        )
        s.lathe([(0.285, z + 0.04), (0.28, z + 0.14), (0.285, z + 0.24)], lens("black"), (x, y, 0), steps=24)
        for a in range(36):
            with s.at(x, y, z + 0.145, turn=10 * a):
                s.box((0.02, 0.05, 0.17), (0.522, 0, 0), rubber(), 0.004)
    return s.built()


def tank(label: str = "LOAD 7") -> Built:
    """Build a 1000-litre liquid container: a white tank in a tube cage on a pallet, with its tap and label towards +y."""
    s = Solid("intermediate bulk container")
    milk = plain("milky plastic", (0.62, 0.64, 0.60), 0.35)
    add_pallet(s)
    s.box((1.10, 0.92, 0.95), (0, 0, 0.65), milk, 0.08)
    s.lathe([(0.11, 1.12), (0.11, 1.16)], paint("black"), steps=20)
    cage = steel()
    for z in (0.20, 0.44, 0.68, 0.92, 1.13):
        s.tube([(-0.58, -0.48, z), (0.58, -0.48, z), (0.58, 0.48, z), (-0.58, 0.48, z)], 0.011, cage, sides=6, closed=True)
    for k in range(6):
        for y in (-0.48, 0.48):
            s.rod((-0.48 + 0.192 * k, y, 0.15), (-0.48 + 0.192 * k, y, 1.13), 0.010, cage, sides=6)
        for x in (-0.58, 0.58):
            s.rod((x, -0.40 + 0.16 * k, 0.15), (x, -0.40 + 0.16 * k, 1.13), 0.010, cage, sides=6)
    s.box((0.40, 0.006, 0.24), (0, 0.496, 0.80), sheet("white"), 0.0)
    s.text(label, 0.07, (0, 0.5, 0.80), sheet("black", dirt=0.05))
    s.rod((0, 0.44, 0.22), (0, 0.56, 0.22), 0.04, paint("red"))
    return s.built()


def wheelie_bin(colour: str = "green", *, is_open: bool = False, label: str | None = None) -> Built:
    """Build an 1100-litre wheeled bin with its lid shut or folded back."""
    s = Solid(f"{colour} wheelie bin")
    finish = paint(colour, dirt=0.38, roughness=0.45)
    low, high = (
        [(-0.50, -0.36), (0.50, -0.36), (0.50, 0.36), (-0.50, 0.36)],
        [(-0.65, -0.50), (0.65, -0.50), (0.65, 0.50), (-0.65, 0.50)],
    )
    points = [(x, y, 0.22) for x, y in low] + [(x, y, 1.16) for x, y in high]
    inner = [(x * 0.94, y * 0.94, 0.26) for x, y in low] + [(x * 0.95, y * 0.95, 1.16) for x, y in high]
    faces = [(3, 2, 1, 0), *((k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4))]
    s.add(points, faces, finish)
    s.add(
        [*inner, *points],
        [*(tuple(f[::-1]) for f in faces), *((4 + k, 4 + (k + 1) % 4, 12 + (k + 1) % 4, 12 + k) for k in range(4))],
        finish,
    )
    for k in range(5):
        s.box((0.05, 0.05, 0.7), (-0.44 + 0.22 * k, 0.452, 0.68), finish, 0.012)
    for sx in (-1, 1):
        s.rod((sx * 0.64, 0, 0.95), (sx * 0.76, 0, 0.95), 0.03, finish)
        for sy in (-1, 1):
            s.lathe([(0.10, -0.03), (0.10, 0.03)], rubber(), (sx * 0.42, sy * 0.30, 0.10), "X", 20)
            s.box((0.08, 0.10, 0.12), (sx * 0.42, sy * 0.30, 0.18), steel(), 0.01)
    with s.at(0, -0.52, 1.17, pitch=105 if is_open else 0):
        arc = [
            (0.0, 0.0),
            (0.25, 0.10),
            (0.55, 0.16),
            (0.85, 0.12),
            (1.04, 0.02),
            (1.04, -0.02),
            (0.85, 0.07),
            (0.55, 0.11),
            (0.25, 0.05),
            (0.0, -0.04),
        ]
        s.prism(arc, (-0.68, 0.68), finish, "YZ")
    if label:
        s.box((0.70, 0.006, 0.16), (0, 0.487, 0.80), sheet("white"), 0.0)
        s.text(label, 0.07, (0, 0.492, 0.80), sheet("black", dirt=0.05))
    return s.built()


def carton(*, seed: int = 0, is_open: bool = False) -> Built:
    """Build a cardboard box, about 0.5 m wide, taped shut or with its flaps up."""
    s = Solid("cardboard box")
    rng = random.Random(f"carton {seed}")
    finish = plain(f"loose carton {seed % 2}", ((0.36, 0.235, 0.125), (0.42, 0.29, 0.17))[seed % 2], 0.85)
    w, d, h = rng.uniform(0.40, 0.55), rng.uniform(0.34, 0.45), rng.uniform(0.28, 0.42)
    s.box((w, d, h), (0, 0, h / 2), finish, 0.006)
    s.box((0.06, d + 0.003, h + 0.003), (0, 0, h / 2), plain("carton tape", (0.46, 0.34, 0.20), 0.35), 0.0)
    if is_open:
        s.box((w - 0.03, d - 0.03, 0.004), (0, 0, h + 0.001), lens("black"), 0.0)
        for side in (-1, 1):
            with s.at(0, side * d / 2, h, pitch=side * 35):
                s.box((w, 0.006, 0.16), (0, 0, 0.08), finish, 0.0)
    return s.built()


def ladder(length: float = 3.6) -> Built:
    """Build an aluminium ladder that leans against an object behind it (-y). Its foot is at y = 0.75 and its top at y = -0.05."""
    s = Solid("ladder")
    pale = plain("ladder alloy", (0.50, 0.51, 0.52), 0.35, 0.7)
    foot, head = 0.75, -0.05
    height = math.sqrt(length**2 - (foot - head) ** 2)
    for x in (-0.20, 0.20):
        s.rod((x, foot, 0.02), (x, head, height), 0.028, pale, sides=6)
        s.box((0.05, 0.08, 0.04), (x, foot, 0.02), rubber(), 0.005)
    for k in range(1, int(length / 0.28)):
        t = k * 0.28 / length
        s.rod((-0.20, foot + (head - foot) * t, height * t), (0.20, foot + (head - foot) * t, height * t), 0.014, pale, sides=6)
    return s.built()
