"""Site equipment: arrow board, light tower, generator, toilet, cabin, skip, compactor, wheelbarrow. Fronts face +y."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import concrete, glass, glow, granular, lens, paint, rubber, sheet, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write
from scope_studio.kit.works.materials import heap


def wheel(s: Solid, x: float, y: float, radius: float, width: float) -> None:
    """Add a small road wheel that stands on the ground, with its axle along x."""
    half = width / 2
    tyre = [
        (radius * 0.62, -half),
        (radius * 0.92, -half),
        (radius, -half * 0.7),
        (radius, half * 0.7),
        (radius * 0.92, half),
        (radius * 0.62, half),
    ]
    s.lathe(tyre, rubber(), (x, y, radius), "X", 28)
    s.lathe(
        [
            (radius * 0.25, -half * 1.02),
            (radius * 0.6, -half * 0.85),
            (radius * 0.6, half * 0.85),
            (radius * 0.25, half * 1.02),
        ],
        steel(),
        (x, y, radius),
        "X",
        20,
    )


def _trailer(s: Solid, width: float, length: float, colour: str) -> None:
    """Add a chassis along y with a draw bar towards -y, two wheels under mudguards, corner jacks and tail lamps."""
    body = paint(colour, dirt=0.35)
    for x in (-width * 0.36, width * 0.36):
        s.box((0.08, length, 0.10), (x, 0, 0.48), body, 0.01)
        s.rod((x, -length / 2, 0.48), (0, -length / 2 - 0.95, 0.45), 0.035, body)
    for y in (-length * 0.45, 0.0, length * 0.45):
        s.box((width * 0.76, 0.08, 0.08), (0, y, 0.48), body, 0.01)
    s.rod((0, -length / 2 - 0.9, 0.45), (0, -length / 2 - 1.25, 0.46), 0.04, steel(dark=True))
    s.rod((0, -length / 2 - 0.75, 0.75), (0, -length / 2 - 0.75, 0.14), 0.028, steel())
    s.lathe([(0.09, -0.03), (0.09, 0.03)], rubber(), (0, -length / 2 - 0.75, 0.09), "X", 16)
    for side in (-1, 1):
        wheel(s, side * (width / 2 - 0.05), 0.0, 0.31, 0.17)
        guard = [(0.38 * math.cos(math.radians(a)), 0.31 + 0.38 * math.sin(math.radians(a))) for a in range(10, 171, 20)]
        inner = [(u * 0.94, 0.31 + (v - 0.31) * 0.94) for u, v in guard[::-1]]
        x = side * (width / 2 - 0.05)
        s.prism([*guard, *inner], (x - 0.11, x + 0.11), paint("black"), "YZ")
        s.box((0.18, 0.03, 0.09), (side * width * 0.36, length / 2 + 0.06, 0.50), lens("red"), 0.008)
        for y in (-length * 0.46, length * 0.46):
            s.rod((side * width * 0.36, y, 0.55), (side * width * 0.36, y, 0.03), 0.025, steel())
            s.box((0.14, 0.14, 0.02), (side * width * 0.36, y, 0.012), steel(dark=True), 0.004)


def arrow_board(direction: str = "left", *, lit: bool = True) -> Built:
    """Build a trailer with a black board whose lamps show an arrow to the reader's left or right, facing +y.

    The board stands on red and white stripes.
    """
    s = Solid("arrow board")
    _trailer(s, 1.6, 1.9, "orange")
    s.box((0.95, 0.70, 0.40), (0, -0.30, 0.74), paint("orange", dirt=0.3), 0.03)
    for x in (-0.62, 0.62):
        s.box((0.08, 0.08, 2.5), (x, 0.72, 1.72), steel(), 0.008)
        s.rod((x, 0.70, 1.9), (x, -0.6, 0.55), 0.03, steel())
    s.box((2.3, 0.05, 1.35), (0, 0.80, 2.35), paint("dark grey", dirt=0.25), 0.015)
    s.box((2.2, 0.012, 1.25), (0, 0.829, 2.35), lens("black"), 0.004)
    for k in range(10):
        s.box((0.22, 0.03, 0.26), (-0.99 + 0.22 * k, 0.80, 1.45), sheet("red" if k % 2 == 0 else "white"), 0.002)
    sign = -1.0 if direction == "left" else 1.0
    shaft = [(0.75 - 0.215 * i, 0.0) for i in range(8)]
    head = [(-0.75 + 0.17 * i, side * 0.16 * i) for i in range(1, 4) for side in (-1, 1)]
    lamps = {(round(u, 3), round(v, 3)) for u, v in shaft + head}
    unlit = {(0.75 - 0.17 * i, side * 0.16 * i) for i in range(1, 4) for side in (-1, 1)}
    for u, v in sorted(lamps | unlit):
        bright = glow("amber", 6.0) if lit and (u, v) in lamps else lens("black")
        s.lathe([(0.072, 0.0), (0.072, 0.03), (0.066, 0.03)], paint("black"), (sign * u, 0.835, 2.35 + v), "Y", 18)
        s.lathe([(0.062, 0.012), (0.055, 0.030), (0.025, 0.042)], bright, (sign * u, 0.835, 2.35 + v), "Y", 18)
    for x in (-0.85, 0.85):
        s.lathe(
            [(0.10, 0.0), (0.10, 0.05), (0.07, 0.16), (0.02, 0.19)],
            glow("amber", 3.0) if lit else lens("amber"),
            (x, 0.78, 3.03),
            steps=18,
        )
    return s.built()


def light_tower(*, lit: bool = False) -> Built:
    """Build a mobile lighting mast, 7.5 m high: trailer with engine housing, telescopic mast, four floodlights."""
    s = Solid("light tower")
    _trailer(s, 1.5, 2.0, "yellow")
    s.box((1.05, 1.65, 0.95), (0, 0.0, 1.02), paint("yellow", dirt=0.34), 0.06)
    for side in (-1, 1):
        for k in range(7):
            s.box((0.01, 0.5, 0.02), (side * 0.527, 0.35, 0.80 + 0.05 * k), lens("black"), 0.002)
        s.box((0.012, 0.55, 0.70), (side * 0.527, -0.40, 1.0), paint("yellow", dirt=0.45), 0.01)
    s.rod((0.3, 0.5, 1.45), (0.3, 0.5, 1.75), 0.035, steel(dark=True))
    for low, high, w in ((0.6, 3.2, 0.15), (3.0, 5.3, 0.12), (5.1, 7.2, 0.09)):
        s.box((w, w, high - low), (0, -0.92, (low + high) / 2), steel(), 0.008)
    s.box((1.3, 0.09, 0.09), (0, -0.92, 7.2), steel(), 0.01)
    for x in (-0.52, 0.52):
        for dz in (-0.20, 0.20):
            with s.at(x, -0.86, 7.25 + dz, pitch=-32):
                s.box((0.42, 0.14, 0.30), (0, 0, 0), paint("dark grey"), 0.03)
                s.box((0.37, 0.01, 0.25), (0, 0.071, 0), glow("white", 8.0) if lit else lens("light grey"), 0.003)
    return s.built()


def generator(colour: str = "green") -> Built:
    """Build a silenced generator on skids, 2.2 x 1.0 x 1.3 m, with louvres, control panel and exhaust."""
    s = Solid("generator")
    body = paint(colour, dirt=0.34)
    for y in (-0.35, 0.35):
        s.box((2.3, 0.14, 0.14), (0, y, 0.07), steel(dark=True), 0.01)
    s.box((2.2, 1.0, 1.10), (0, 0, 0.69), body, 0.05)
    s.box((2.1, 0.9, 0.05), (0, 0, 1.26), body, 0.02)
    for side in (-1, 1):
        for x in (-0.78, 0.0, 0.78):
            s.box((0.66, 0.012, 0.92), (x, side * 0.503, 0.70), body, 0.006)
            s.box((0.03, 0.03, 0.12), (x + 0.26, side * 0.518, 0.72), paint("black"), 0.005)
        for k in range(9):
            s.box((0.46, 0.012, 0.022), (-0.78, side * 0.512, 0.45 + 0.055 * k), lens("black"), 0.002)
    for k in range(12):
        s.box((0.012, 0.76, 0.024), (1.104, 0, 0.36 + 0.06 * k), lens("black"), 0.002)
    s.box((0.44, 0.02, 0.30), (0.78, 0.508, 0.92), lens("dark grey"), 0.006)
    s.lathe([(0.02, 0.0), (0.018, 0.006)], glow("green", 4.0), (0.66, 0.52, 0.99), "Y", 12)
    s.lathe([(0.05, 0.0), (0.05, 0.02), (0.03, 0.025)], paint("red", dirt=0.1), (0.88, 0.518, 0.86), "Y", 16)
    s.tube([(-0.85, 0.2, 1.25), (-0.85, 0.2, 1.42), (-0.92, 0.2, 1.47)], 0.04, steel(dark=True), sides=12)
    s.tube([(-0.12, 0, 1.28), (-0.12, 0, 1.36), (0.12, 0, 1.36), (0.12, 0, 1.28)], 0.018, steel(dark=True))
    s.text("100 kVA", 0.09, (0.0, 0.5125, 1.0), sheet("white"))
    return s.built()


def portable_toilet(colour: str = "blue") -> Built:
    """Build a portable toilet, 1.1 x 1.1 x 2.3 m: white domed roof, ribbed walls, door with sign towards +y."""
    s = Solid("portable toilet")
    body, trim = paint(colour, dirt=0.30, roughness=0.45), paint("white", dirt=0.32)
    for x in (-0.38, 0.38):
        s.box((0.12, 1.14, 0.12), (x, 0, 0.06), timber(fresh=False), 0.008)
    s.box((1.12, 1.12, 0.06), (0, 0, 0.15), paint("dark grey", dirt=0.4), 0.01)
    s.box((1.04, 1.04, 1.98), (0, 0, 1.17), body, 0.02)
    for turn in (90, 180, 270):
        with s.at(turn=turn):
            for k in range(9):
                s.box((0.05, 0.03, 1.66), (-0.40 + 0.10 * k, 0.53, 1.05), body, 0.010)
            s.box((0.80, 0.012, 0.13), (0, 0.523, 2.02), lens("black"), 0.003)
    for x in (-0.5, 0.5):
        for y in (-0.5, 0.5):
            s.box((0.10, 0.10, 2.0), (x, y, 1.17), trim, 0.02)
    s.box((0.84, 0.03, 1.86), (0, 0.53, 1.13), body, 0.012)
    s.box((0.70, 0.02, 0.60), (0, 0.548, 0.62), body, 0.02)
    s.box((0.70, 0.02, 0.72), (0, 0.548, 1.40), body, 0.02)
    s.box((0.04, 0.05, 0.16), (-0.35, 0.565, 1.02), paint("black"), 0.01)
    s.box((0.07, 0.012, 0.05), (-0.35, 0.558, 1.20), sheet("green"), 0.002)
    s.box((0.36, 0.006, 0.26), (0, 0.5595, 1.50), sheet("white"), 0.002)
    s.text("TOILET", 0.065, (0, 0.5665, 1.50), sheet("black", dirt=0.05))
    roof = [(0.80, 2.14), (0.80, 2.19), (0.70, 2.27), (0.40, 2.35), (0.10, 2.37)]
    with s.at(turn=45):
        s.lathe(roof, trim, steps=4)
    s.rod((0.36, -0.36, 2.1), (0.36, -0.36, 2.55), 0.045, trim)
    return s.built()


def site_cabin(colour: str = "light grey", text: str = "SITE OFFICE") -> Built:
    """Build a steel site cabin, 6.0 x 2.4 x 2.7 m.

    It has corrugated walls, a door, two barred windows, steps, and a name board towards +y.
    """
    s = Solid("site cabin")
    wall, trim = paint(colour, dirt=0.30), paint("dark grey", dirt=0.3)
    for x in (-2.6, 0.0, 2.6):
        s.box((0.40, 2.3, 0.16), (x, 0, 0.08), timber(fresh=False), 0.01)
    s.box((6.0, 2.4, 0.16), (0, 0, 0.24), trim, 0.012)
    s.box((6.06, 2.46, 0.14), (0, 0, 2.68), trim, 0.02)
    s.box((5.9, 2.3, 0.03), (0, 0, 2.76), paint("light grey", dirt=0.6), 0.01)
    for turn, width, depth in ((0, 6.0, 1.2), (180, 6.0, 1.2), (90, 2.4, 3.0), (270, 2.4, 3.0)):
        with s.at(turn=turn):
            ribs, outline = round(width / 0.26), []
            for k in range(ribs):
                x = -width / 2 + 0.05 + (width - 0.1) * k / ribs
                step = (width - 0.1) / ribs
                outline += [
                    (x, depth - 0.03),
                    (x + step * 0.4, depth - 0.03),
                    (x + step * 0.5, depth - 0.062),
                    (x + step * 0.9, depth - 0.062),
                ]
            outline += [
                (width / 2 - 0.05, depth - 0.03),
                (width / 2 - 0.05, depth - 0.09),
                (-width / 2 + 0.05, depth - 0.09),
            ]
            s.prism(outline, (0.32, 2.61), wall, "XY")
            for x in (-width / 2 + 0.05, width / 2 - 0.05):
                s.box((0.10, 0.10, 2.3), (x, depth - 0.05, 1.47), trim, 0.01)
    for x in (-1.75, 1.85):
        s.box((1.35, 0.05, 1.0), (x, 1.18, 1.65), paint("white", dirt=0.25), 0.01)
        s.box((1.21, 0.02, 0.86), (x, 1.20, 1.65), glass(), 0.003)
        s.box((0.05, 0.03, 0.88), (x, 1.205, 1.65), paint("white", dirt=0.25), 0.004)
        for k in range(5):
            s.rod((x - 0.66, 1.235, 1.30 + 0.175 * k), (x + 0.66, 1.235, 1.30 + 0.175 * k), 0.010, trim, sides=6)
    s.box((0.98, 0.05, 2.06), (0.05, 1.185, 1.36), trim, 0.01)
    s.box((0.88, 0.03, 1.98), (0.05, 1.205, 1.34), paint("white", dirt=0.3), 0.008)
    s.box((0.34, 0.012, 0.42), (0.05, 1.222, 1.82), glass(), 0.003)
    s.box((0.14, 0.06, 0.03), (-0.28, 1.245, 1.28), steel(), 0.006)
    for k in range(2):
        s.box((1.1, 0.32, 0.04), (0.05, 1.66 - 0.30 * k, 0.13 + 0.14 * k), steel(dark=True), 0.006)
        for x in (-0.46, 0.56):
            s.box((0.05, 0.28, 0.13 + 0.14 * k), (x, 1.66 - 0.30 * k, (0.13 + 0.14 * k) / 2), steel(dark=True), 0.004)
    width = 0.30 + 0.13 * len(text)
    with s.at(1.85 if width < 2.2 else 0.0, 1.215, 2.37):
        board(s, min(width, 5.0), 0.30, "blue", back=False)
        write(s, text, 0.15, 0, 0, "white")
    s.box((0.62, 0.36, 0.44), (-2.4, -1.36, 1.9), paint("light grey", dirt=0.3), 0.02)
    s.lathe([(0.16, 0.0), (0.15, 0.01)], lens("black"), (-2.4, -1.555, 1.9), "Y", 20)
    return s.built()


def skip(colour: str = "yellow", *, full: bool = True) -> Built:
    """Build a builder's skip, 3.4 x 1.8 x 1.4 m, with lifting lugs and, when full, rubble and timber."""
    s = Solid(f"{colour} skip")
    body = paint(colour, dirt=0.55, roughness=0.5)
    side = [(-1.0, 0.10), (1.0, 0.10), (1.72, 0.85), (1.72, 1.35), (-1.72, 1.35), (-1.72, 0.85)]
    for y in (-0.88, 0.88):
        s.prism(side, (y - 0.02, y + 0.02), body, "XZ")
        for x in (-0.9, -0.3, 0.3, 0.9):
            s.box((0.09, 0.07, 1.15), (x, y * 1.04, 0.74), body, 0.01)
        s.box((3.5, 0.10, 0.09), (0, y * 1.02, 1.36), body, 0.012)
        for x in (-1.15, 1.15):
            s.lathe(
                [(0.05, -0.16), (0.05, 0.06), (0.085, 0.07), (0.085, 0.10)],
                steel(dark=True),
                (x, y * 1.08, 1.05),
                "Y",
                14,
            )
    for sx in (-1, 1):
        wall = [(sx * 1.0, 0.10), (sx * 1.72, 0.85), (sx * 1.72, 1.35)]
        inner = [(sx * (abs(u) - 0.04), v + 0.015) for u, v in wall[::-1]]
        s.prism([*wall, *inner], (-0.88, 0.88), body, "XZ")
        s.box((0.10, 1.86, 0.09), (sx * 1.72, 0, 1.36), body, 0.012)
    s.box((2.0, 1.76, 0.04), (0, 0, 0.12), body, 0.004)
    for y in (-0.6, 0.6):
        s.box((1.9, 0.16, 0.10), (0, y, 0.05), steel(dark=True), 0.01)
    if full:
        with s.at(0, 0, 0.95):
            heap(
                s,
                granular("rubble", (0.10, 0.085, 0.07), (0.36, 0.33, 0.29), 13.0),
                (1.66, 0.84),
                0.62,
                seed=3.0,
                square=True,
            )
        for x, y, turn, lift in ((-0.5, 0.1, 20, 12), (0.3, -0.2, -32, 8), (0.7, 0.3, 64, 16)):
            with s.at(x, y, 1.48, turn=turn, roll=lift):
                s.box((1.5, 0.11, 0.05), (0, 0, 0), timber(fresh=x > 0.5), 0.004)
        for k in range(9):
            with s.at(
                -1.2 + 0.31 * k,
                0.5 * math.sin(2.3 * k),
                1.42 + 0.07 * math.cos(k),
                turn=47 * k,
                roll=31 * k,
                pitch=17 * k,
            ):
                s.box((0.34, 0.22, 0.14), (0, 0, 0), concrete(), 0.03)
    return s.built()


def plate_compactor() -> Built:
    """Build a vibrating plate with engine and water tank, and a handle towards -y."""
    s = Solid("plate compactor")
    yellow = paint("yellow", dirt=0.45)
    s.prism(
        [
            (-0.30, 0.10),
            (-0.24, 0.02),
            (0.24, 0.02),
            (0.32, 0.12),
            (0.30, 0.13),
            (0.23, 0.05),
            (-0.23, 0.05),
            (-0.29, 0.11),
        ],
        (-0.22, 0.22),
        steel(dark=True),
        "YZ",
    )
    s.box((0.36, 0.40, 0.10), (0, 0, 0.13), yellow, 0.02)
    s.box((0.30, 0.30, 0.26), (0, -0.02, 0.33), paint("black", dirt=0.4), 0.04)
    s.box((0.20, 0.12, 0.14), (0.06, 0.08, 0.50), paint("red", dirt=0.3), 0.02)
    s.lathe([(0.06, 0.0), (0.06, 0.05)], steel(), (-0.10, 0.02, 0.46), steps=16)
    s.box((0.34, 0.14, 0.26), (0, 0.20, 0.42), yellow, 0.04)
    for x in (-0.17, 0.17):
        s.tube([(x, -0.12, 0.18), (x, -0.30, 0.45), (x, -0.72, 0.95), (x, -0.80, 0.97)], 0.016, yellow)
    s.rod((-0.17, -0.80, 0.97), (0.17, -0.80, 0.97), 0.018, rubber())
    return s.built()


def wheelbarrow(colour: str = "green", *, load: bool = True) -> Built:
    """Build a builder's wheelbarrow with its wheel towards +y, optionally with sand."""
    s = Solid("wheelbarrow")
    body = paint(colour, dirt=0.45)
    low, high = (
        [(-0.20, -0.22), (0.20, -0.22), (0.15, 0.22), (-0.15, 0.22)],
        [(-0.33, -0.44), (0.33, -0.44), (0.28, 0.50), (-0.28, 0.50)],
    )
    outer = [(x, y, 0.34) for x, y in low] + [(x, y, 0.64) for x, y in high]
    inner = [(x * 0.94, y * 0.96, 0.35) for x, y in low] + [(x * 0.96, y * 0.97, 0.64) for x, y in high]
    shell = [(0, 3, 2, 1), *((k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4))]
    lining = [tuple(8 + i for i in f[::-1]) for f in shell]
    rim = [(4 + k, 4 + (k + 1) % 4, 12 + (k + 1) % 4, 12 + k) for k in range(4)]
    s.add(outer + inner, [*shell, *lining, *rim], body)
    s.tube([(x, y, 0.64) for x, y in high], 0.012, body, closed=True)
    for sx in (-1, 1):
        s.tube(
            [(sx * 0.07, 0.66, 0.20), (sx * 0.17, 0.20, 0.31), (sx * 0.24, -0.45, 0.44), (sx * 0.27, -0.88, 0.60)],
            0.016,
            steel(dark=True),
        )
        s.rod((sx * 0.265, -0.76, 0.55), (sx * 0.272, -0.90, 0.61), 0.021, rubber())
        s.tube(
            [(sx * 0.23, -0.30, 0.40), (sx * 0.25, -0.34, 0.02), (sx * 0.25, -0.24, 0.02), (sx * 0.19, 0.02, 0.33)],
            0.013,
            steel(dark=True),
        )
    wheel(s, 0.0, 0.66, 0.19, 0.09)
    if load:
        with s.at(0, 0.02, 0.50):
            heap(
                s,
                granular("sand", (0.30, 0.20, 0.095), (0.52, 0.38, 0.20), 160.0),
                (0.28, 0.40),
                0.20,
                seed=1.0,
                square=True,
            )
    return s.built()
