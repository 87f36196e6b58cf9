"""Roadside furniture: lamp posts, guardrail, noise barrier, camera mast, emergency phone, cabinets, drains, chevrons.

Objects that follow a road (guardrail, noise barrier) run along y, and the side towards the traffic faces +x.
"""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import concrete, glass, glow, lens, paint, rubber, sheet, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board


def lamp_post(height: float = 10.0, arms: int = 1, *, lit: bool = False) -> Built:
    """Build a galvanised lamp post with a flat LED lantern on each arm. The first arm points towards +y, the second towards -y."""
    s = Solid("lamp post")
    s.lathe([(0.20, 0.0), (0.20, 0.02)], steel(dark=True), steps=8)
    s.lathe([(0.105, 0.02), (0.105, 1.35), (0.085, 1.42), (0.055, height - 0.9), (0.05, height - 0.85)], steel(), steps=20)
    s.box((0.11, 0.02, 0.55), (0, 0.098, 0.85), paint("light grey", dirt=0.3), 0.008)
    s.box((0.10, 0.012, 0.14), (0.0, 0.098, 1.75), sheet("yellow"), 0.002)
    for sign in (1, -1)[:arms]:
        path = [
            (0.0, sign * (0.9 - 0.9 * math.cos(a)), height - 0.9 + 0.75 * math.sin(a)) for a in (k * math.pi / 14 for k in range(8))
        ]
        path.append((0.0, sign * 1.35, height - 0.11))
        s.tube(path, 0.036, steel(), sides=12)
        with s.at(0, sign * 1.62, height - 0.09, pitch=sign * 4.0):
            s.box((0.30, 0.72, 0.055), (0, 0, 0), paint("light grey", dirt=0.2), 0.02)
            s.box((0.20, 0.30, 0.05), (0, -sign * 0.12, 0.05), paint("light grey", dirt=0.2), 0.02)
            s.box((0.24, 0.50, 0.012), (0, sign * 0.06, -0.031), glow("cream", 6.0) if lit else glass(), 0.004)
    return s.built()


def guardrail(length: float = 4.0, *, double: bool = False) -> Built:
    """Build a W-beam safety barrier along y, 0.75 m high, on posts every 2 m.

    The beam faces +x. ``double`` adds a second beam that faces -x.
    """
    s = Solid("guardrail")
    wave = [
        (0.0, -0.155),
        (0.02, -0.150),
        (0.075, -0.105),
        (0.083, -0.08),
        (0.075, -0.055),
        (0.015, -0.02),
        (0.005, 0.0),
    ]
    wave += [(d, -z) for d, z in wave[-2::-1]]
    bays = max(1, round(length / 2.0))
    step = length / bays
    for side in (1, -1) if double else (1,):
        n = len(wave)
        points = [(side * (0.13 + d - t), y, 0.60 + z) for y in (-length / 2, length / 2) for t in (0.0, 0.004) for d, z in wave]
        outer = [(k, k + 1, 2 * n + k + 1, 2 * n + k) for k in range(n - 1)]
        inner = [(n + k + 1, n + k, 3 * n + k, 3 * n + k + 1) for k in range(n - 1)]
        rims = [(0, 2 * n, 3 * n, n), (n - 1, 2 * n - 1, 4 * n - 1, 3 * n - 1)]
        faces = [*outer, *inner, *rims]
        s.add(points, faces if side < 0 else [f[::-1] for f in faces], steel())
        for i in range(bays):
            y = -length / 2 + (i + 0.5) * step
            s.box((0.07, 0.10, 0.30), (side * 0.10, y, 0.60), steel(), 0.006)
            s.lathe([(0.014, 0.0), (0.012, 0.012)], steel(dark=True), (side * 0.137, y, 0.60), "X", 8)
            if i % 3 == 1:
                s.box((0.05, 0.006, 0.06), (side * 0.17, y, 0.79), sheet("amber"), 0.002)
                s.box((0.006, 0.03, 0.14), (side * 0.145, y, 0.75), steel(), 0.001)
    for i in range(bays):
        y = -length / 2 + (i + 0.5) * step
        s.box((0.10, 0.012, 0.78), (0, y - 0.03, 0.37), steel(), 0.002)
        s.box((0.012, 0.06, 0.78), (-0.05, y, 0.37), steel(), 0.002)
        s.box((0.012, 0.06, 0.78), (0.05, y, 0.37), steel(), 0.002)
    return s.built()


def noise_barrier(length: float = 4.0, height: float = 3.0, *, material: str = "timber") -> Built:
    """Build a noise barrier along y, with steel posts every 4 m on a concrete plinth. ``material`` is "timber" or "concrete"."""
    s = Solid("noise barrier")
    bays = max(1, round(length / 4.0))
    step = length / bays
    for i in range(bays + 1):
        y = -length / 2 + i * step
        s.box((0.20, 0.16, height + 0.08), (0, y, (height + 0.08) / 2), steel(), 0.008)
    s.box((0.16, length, 0.40), (0, 0, 0.20), concrete(), 0.01)
    if material == "concrete":
        rows = round((height - 0.4) / 0.65)
        for r in range(rows):
            tall = (height - 0.4) / rows
            s.box((0.13, length, tall - 0.012), (0, 0, 0.4 + (r + 0.5) * tall), concrete(), 0.012)
        return s.built()
    boards = round(length / 0.145)
    with s.at(0, 0, 0, turn=90):
        for k in range(boards):
            x = -length / 2 + (k + 0.5) * length / boards
            s.box(
                (length / boards - 0.008, 0.03, height - 0.42),
                (x, -0.05 - 0.004 * (k % 2), 0.40 + (height - 0.42) / 2),
                timber(fresh=k % 7 == 3),
                0.003,
            )
        for z in (0.7, height / 2 + 0.2, height - 0.3):
            s.box((length, 0.05, 0.12), (0, 0.0, z), timber(fresh=False), 0.006)
        s.box((length, 0.20, 0.035), (0, -0.02, height), timber(fresh=False), 0.008)
    return s.built()


def cctv_pole(height: float = 8.0) -> Built:
    """Build a camera mast with a dome camera on a bracket towards +y, a fixed bullet camera and an equipment box."""
    s = Solid("camera pole")
    s.lathe([(0.24, 0.0), (0.24, 0.025)], steel(dark=True), steps=8)
    s.lathe([(0.12, 0.025), (0.115, 1.2), (0.075, height), (0.05, height + 0.03)], steel(), steps=20)
    s.box((0.34, 0.22, 0.55), (0, -0.20, 1.6), paint("light grey", dirt=0.3), 0.02)
    s.rod((0, 0, height - 0.25), (0, 0.60, height - 0.15), 0.028, paint("light grey"))
    s.lathe(
        [(0.05, 0.18), (0.10, 0.16), (0.11, 0.02), (0.11, 0.0)][::-1],
        paint("white", dirt=0.15),
        (0, 0.60, height - 0.34),
        steps=24,
    )
    dome = [(0.098 * math.cos(a), -0.098 * math.sin(a)) for a in (k * math.pi / 16 for k in range(8, -1, -1))]
    s.lathe(dome, lens("black"), (0, 0.60, height - 0.34), steps=24)
    with s.at(0.12, 0.10, height - 0.75, turn=-38, pitch=-14):
        s.box((0.13, 0.36, 0.12), (0, 0.18, 0), paint("white", dirt=0.15), 0.02)
        s.box((0.15, 0.44, 0.012), (0, 0.19, 0.072), paint("white", dirt=0.15), 0.004)
        s.lathe([(0.045, 0.36), (0.042, 0.366)], lens("black"), axis="Y", steps=20)
    return s.built()


def emergency_phone(number: str = "174") -> Built:
    """Build an orange roadside telephone with "SOS" on its faces and a number that identifies it."""
    s = Solid("emergency phone")
    orange = paint("orange", dirt=0.22, roughness=0.35)
    s.box((0.50, 0.44, 0.06), (0, 0, 0.03), concrete(), 0.01)
    s.box((0.20, 0.16, 1.0), (0, 0, 0.5), orange, 0.02)
    s.box((0.42, 0.34, 0.72), (0, 0, 1.30), orange, 0.035)
    s.box((0.46, 0.38, 0.05), (0, 0, 1.68), paint("dark grey"), 0.015)
    for facing, (x, y) in {"+Y": (0, 0.1735), "-Y": (0, -0.1735), "+X": (0.2135, 0), "-X": (-0.2135, 0)}.items():
        s.text("SOS", 0.125, (x, y, 1.52), sheet("white"), facing=facing)
    s.box((0.30, 0.012, 0.24), (0, 0.172, 1.27), paint("dark grey"), 0.006)
    for i in range(5):
        s.box((0.11, 0.006, 0.007), (-0.06, 0.179, 1.32 - 0.018 * i), lens("black"), 0.001)
    s.lathe([(0.035, 0.0), (0.030, 0.014)], paint("red", dirt=0.05), (0.085, 0.178, 1.27), "Y", 20)
    s.text(number, 0.055, (0, 0.1735, 1.06), sheet("white"))
    return s.built()


def cabinet(*, is_open: bool = False, colour: str = "light grey") -> Built:
    """Build a roadside equipment cabinet, 1.2 x 0.4 x 1.3 m, with doors towards +y. If open, it shows shelves of equipment."""
    s = Solid("roadside cabinet")
    body = paint(colour, dirt=0.36)
    s.box((1.30, 0.48, 0.10), (0, 0, 0.05), concrete(light=False), 0.01)
    if is_open:
        for x in (-0.59, 0.59):
            s.box((0.02, 0.40, 1.22), (x, 0, 0.71), body, 0.004)
        s.box((1.2, 0.02, 1.22), (0, -0.19, 0.71), body, 0.004)
        s.box((1.2, 0.40, 0.02), (0, 0, 0.11), body, 0.004)
        for k, z in enumerate((0.45, 0.78, 1.05)):
            s.box((1.14, 0.30, 0.015), (0, -0.03, z - 0.11), steel(), 0.003)
            for i in range(5):
                s.box(
                    (0.18, 0.24, 0.17),
                    (-0.44 + 0.22 * i, -0.04, z),
                    paint(("dark grey", "black", "beige")[(i + k) % 3]),
                    0.006,
                )
                s.lathe([(0.008, 0.0), (0.007, 0.004)], glow("green", 4.0), (-0.48 + 0.22 * i, 0.082, z + 0.05), "Y", 8)
    else:
        s.box((1.2, 0.40, 1.22), (0, 0, 0.71), body, 0.012)
    s.box((1.26, 0.46, 0.05), (0, 0, 1.34), body, 0.015)
    for side in (-1, 1):
        with s.at(side * 0.59, 0.205, 0.71, turn=side * 108.0 if is_open else 0.0):
            s.box((0.58, 0.02, 1.16), (-side * 0.30, 0.004, 0), body, 0.004)
            for i in range(6):
                s.box((0.34, 0.008, 0.012), (-side * 0.30, 0.016, 0.46 - 0.03 * i), lens("black"), 0.002)
            s.box((0.03, 0.03, 0.12), (-side * 0.54, 0.022, 0.0), paint("black"), 0.006)
    s.prism(
        [(-0.08, 0.90), (0.08, 0.90), (0.0, 1.04)],
        (0.2205, 0.2225) if not is_open else (-0.2025, -0.2005),
        sheet("yellow"),
        "XZ",
    )
    return s.built()


def drain() -> Built:
    """Build a cast-iron gully grate, 0.5 x 0.5 m, in a frame that is 15 mm above the road."""
    s = Solid("drain")
    s.box((0.56, 0.56, 0.01), (0, 0, 0.004), lens("black"), 0.0)
    iron = steel(dark=True)
    for sign in (-1, 1):
        s.box((0.56, 0.05, 0.016), (0, sign * 0.255, 0.008), iron, 0.003)
        s.box((0.05, 0.46, 0.016), (sign * 0.255, 0, 0.008), iron, 0.003)
    for i in range(9):
        s.box((0.024, 0.46, 0.015), (-0.2 + 0.05 * i, 0, 0.0075), iron, 0.003)
    s.box((0.46, 0.03, 0.015), (0, 0, 0.0075), iron, 0.003)
    return s.built()


def chevron_board(width: float = 1.6, *, direction: str = "right") -> Built:
    """Build a black board on two posts, facing +y, with white chevrons that point to the right or left as seen by a driver."""
    s = Solid("chevron board")
    height = 0.55
    with s.at(0, 0, 0.75 + height / 2):
        board(s, width, height, "black", edge=0.02)
        count = max(1, round(width / 0.5))
        pitch = (width - 0.08) / count
        sign = -1.0 if direction == "right" else 1.0
        for k in range(count):
            u = -width / 2 + 0.04 + (k + 0.5) * pitch
            tip, wing, thick, half = 0.10, -0.14, 0.15, height / 2 - 0.035
            shape = [
                (wing, half),
                (wing + thick, half),
                (tip + thick, 0),
                (wing + thick, -half),
                (wing, -half),
                (tip, 0),
            ]
            s.prism([(sign * (u + d - 0.06), v) for d, v in shape], (0.0, 0.0035), sheet("white"), "XZ")
    for x in (-width * 0.32, width * 0.32):
        s.lathe([(0.038, 0.0), (0.038, 1.26)], steel(), (x, -0.085, 0), steps=14)
    return s.built()


def bollard(*, colour: str = "black") -> Built:
    """Build a cast street bollard, 1.0 m high, with a reflective band."""
    s = Solid("bollard")
    body = paint(colour, dirt=0.3)
    s.lathe(
        [(0.11, 0.0), (0.11, 0.06), (0.085, 0.09), (0.072, 0.80), (0.085, 0.82), (0.085, 0.85), (0.068, 0.87)],
        body,
        steps=24,
    )
    s.lathe([(0.068, 0.87), (0.082, 0.92), (0.075, 0.97), (0.045, 1.0), (0.01, 1.005)], body, steps=24)
    s.lathe([(0.0785, 0.68), (0.0768, 0.76)], sheet("white"), steps=24)
    s.lathe([(0.14, 0.0), (0.14, 0.012)], rubber(), steps=24)
    return s.built()
