"""Large units on a construction site: portable toilet, cabin, skip. Fronts face +y."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import concrete, glass, granular, lens, paint, sheet, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write
from scope_studio.kit.works.materials import heap


def portable_toilet(colour: str = "blue") -> Built:
    """Build a portable toilet, 1.1 x 1.1 x 2.3 m, with a white domed roof, ribbed walls, and a door with a sign towards +y."""
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
    """Build a builder's skip, 3.4 x 1.8 x 1.4 m, with lifting lugs. If full, it contains rubble and timber."""
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
