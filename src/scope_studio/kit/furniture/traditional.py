"""Traditional British street furniture: pillar boxes, telephone kiosks, lamp standards, planters, traffic signals, fingerposts."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from scope_studio.kit.core.finishes import clear_glass, glow, lens, paint, sheet, steel, timber
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.furniture.clocks import dial
from scope_studio.kit.furniture.shop_displays import blooms
from scope_studio.kit.signs.faces import write


def post_box() -> Built:
    """Build a cast-iron pillar box, 1.65 m high, with its slot and collection plate towards +y."""
    s = Solid("post box")
    red, black = paint("red", dirt=0.14, roughness=0.24), paint("black", dirt=0.3)
    s.lathe([(0.275, 0.0), (0.275, 0.22), (0.255, 0.25)], black, steps=36)
    s.lathe([(0.245, 0.24), (0.245, 1.38), (0.285, 1.42), (0.295, 1.47), (0.285, 1.51)], red, steps=36)
    s.lathe([(0.285, 1.50), (0.27, 1.55), (0.19, 1.61), (0.08, 1.64), (0.01, 1.645)], red, steps=36)
    s.lathe([(0.262, 1.34), (0.262, 1.37)], red, steps=36)
    s.box((0.30, 0.06, 0.15), (0, 0.235, 1.25), red, 0.02)
    s.box((0.23, 0.02, 0.045), (0, 0.262, 1.25), lens("black"), 0.004)
    s.box((0.30, 0.03, 0.68), (0, 0.232, 0.72), red, 0.012)
    s.box((0.17, 0.012, 0.22), (0, 0.252, 0.90), sheet("white"), 0.003)
    for k, line in enumerate(("COLLECTION", "MON TO FRI", "5.30 PM")):
        with s.at(0, 0.258, 0.965 - 0.055 * k):
            write(s, line, 0.017 if k < 2 else 0.03, 0, -0.012 if k == 2 else 0, "black", lift=0.001)
    with s.at(0, 0.266, 1.115):
        write(s, "POST", 0.055, 0, 0, "cream", lift=0.0)
    return s.built()


def phone_box() -> Built:
    """Build a telephone kiosk, 0.92 m square and 2.45 m high, with glazed sides, a domed roof, and an opal fascia on each side."""
    s = Solid("phone box")
    red = paint("red", dirt=0.14, roughness=0.24)
    s.box((0.96, 0.96, 0.10), (0, 0, 0.05), paint("dark grey"), 0.01)
    for x in (-0.41, 0.41):
        for y in (-0.41, 0.41):
            s.box((0.12, 0.12, 2.1), (x, y, 1.15), red, 0.015)
    s.box((0.94, 0.94, 0.28), (0, 0, 2.20), red, 0.02)
    s.box((0.99, 0.99, 0.06), (0, 0, 2.36), red, 0.02)
    s.lathe([(0.60, 0.0), (0.50, 0.08), (0.28, 0.14), (0.02, 0.16)], red, (0, 0, 2.37), steps=4 * 8)
    for k in range(4):
        with s.at(turn=90 * k):
            s.box((0.72, 0.015, 0.15), (0, 0.475, 2.20), glow("cream", 0.9), 0.004)
            with s.at(0, 0.483, 2.20):
                write(s, "TELEPHONE", 0.07, 0, 0, "black", lift=0.001)
            s.box((0.72, 0.06, 0.32), (0, 0.42, 0.26), red, 0.01)
            for z in [0.42 + 0.205 * j for j in range(9)]:
                s.box((0.72, 0.035, 0.03), (0, 0.43, z), red, 0.004)
            for x in (-0.22, 0.22):
                s.box((0.03, 0.035, 1.66), (x, 0.43, 1.24), red, 0.004)
            s.add([(-0.36, 0.43, 0.42), (0.36, 0.43, 0.42), (0.36, 0.43, 2.06), (-0.36, 0.43, 2.06)], [(1, 0, 3, 2)], clear_glass())
    s.box((0.40, 0.16, 0.50), (0, -0.30, 1.35), paint("black"), 0.02)
    s.rod((-0.10, -0.20, 1.42), (0.10, -0.20, 1.42), 0.025, paint("dark grey"))
    return s.built()


def street_lamp(height_m: float = 5.2, *, lit: bool = False) -> Built:
    """Build a fluted lamp standard with a four-sided lantern and, at 3.3 m, two arms along x for hanging baskets."""
    s = Solid("street lamp")
    iron = paint("dark green", dirt=0.15)
    s.lathe([(0.22, 0.0), (0.22, 0.10), (0.17, 0.16), (0.14, 0.75), (0.17, 0.80), (0.10, 0.90), (0.075, 1.05)], iron, steps=20)
    s.lathe(
        [(0.075, 1.05), (0.052, height_m - 0.75), (0.085, height_m - 0.72), (0.05, height_m - 0.66), (0.04, height_m - 0.5)],
        iron,
        steps=16,
    )
    s.rod((-0.62, 0, 3.3), (0.62, 0, 3.3), 0.018, iron)
    for sign in (-1, 1):
        s.tube([(sign * 0.06, 0, 2.95), (sign * 0.30, 0, 3.02), (sign * 0.50, 0, 3.28)], 0.013, iron)
        s.lathe([(0.005, 3.27), (0.032, 3.3), (0.005, 3.33)], iron, (sign * 0.63, 0, 0), steps=10)
    base, top = height_m - 0.52, height_m - 0.10
    pane = glow("cream", 2.2) if lit else plain("lantern glass", (0.50, 0.50, 0.46), 0.15)
    low, high = 0.13, 0.21
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    points = [(u * r, v * r, z) for r, z in ((low, base), (high, top)) for u, v in corners]
    s.add(points, [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)], pane)
    for u, v in corners:
        s.rod((u * low, v * low, base), (u * high, v * high, top), 0.013, iron, sides=6)
    s.box((0.30, 0.30, 0.03), (0, 0, base - 0.01), iron, 0.008)
    s.add(
        [(u * 0.26, v * 0.26, top) for u, v in corners] + [(u * 0.07, v * 0.07, top + 0.20) for u, v in corners],
        [*((k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)), (4, 5, 6, 7), (3, 2, 1, 0)],
        iron,
    )
    s.lathe([(0.03, top + 0.18), (0.045, top + 0.24), (0.005, top + 0.34)], iron, steps=10)
    return s.built()


def hanging_basket(colours: Sequence[str], *, seed: int = 0) -> Built:
    """Build a basket of trailing flowers. It hangs 0.45 m below its hook, which is at the origin."""
    s = Solid("hanging basket")
    for k in range(3):
        a = 2 * math.pi * k / 3
        s.rod((0, 0, 0), (0.2 * math.cos(a), 0.2 * math.sin(a), -0.42), 0.004, steel(), sides=4)
    moss = plain("basket moss", (0.045, 0.060, 0.022), 0.95)
    s.lathe([(0.02, -0.66), (0.12, -0.63), (0.20, -0.53), (0.22, -0.43), (0.16, -0.42)], moss, steps=16)
    blooms(s, colours, 0.30, -0.58, -0.26, 80, seed, trailing=True)
    return s.built()


def planter(colours: Sequence[str], *, seed: int = 0, width_m: float = 1.1) -> Built:
    """Build a timber flower trough that extends along x."""
    s = Solid("planter")
    for z in (0.08, 0.20, 0.32, 0.44):
        for y in (-0.24, 0.24):
            s.box((width_m, 0.035, 0.11), (0, y, z + 0.02), timber(fresh=False), 0.008)
        for x in (-width_m / 2 + 0.02, width_m / 2 - 0.02):
            s.box((0.035, 0.48, 0.11), (x, 0, z + 0.02), timber(fresh=False), 0.008)
    s.box((width_m - 0.06, 0.46, 0.05), (0, 0, 0.45), plain("potting soil", (0.022, 0.016, 0.011), 0.95), 0.01)
    for k in range(max(2, round(width_m / 0.4))):
        x = -width_m / 2 + width_m * (k + 0.5) / max(2, round(width_m / 0.4))
        with s.at(x, 0, 0):
            blooms(s, colours, 0.25, 0.46, 0.74, 34, seed + k)
    return s.built()


def parking_meter(title: str = "PAY HERE") -> Built:
    """Build a pay-and-display machine, 1.7 m high, facing +y, with a "P" sign above it."""
    s = Solid("parking meter")
    body = paint("dark grey", dirt=0.2)
    s.box((0.30, 0.26, 1.45), (0, 0, 0.72), body, 0.02)
    s.box((0.36, 0.30, 0.22), (0, 0, 1.56), paint("blue", dirt=0.12), 0.03)
    with s.at(0, 0.151, 1.58):
        write(s, title, 0.042, 0, 0, "white", lift=0.001)
    s.box((0.20, 0.012, 0.12), (0, 0.132, 1.30), lens("black"), 0.004)
    for k in range(6):
        s.box((0.035, 0.014, 0.025), (-0.055 + 0.055 * (k % 3), 0.134, 1.16 - 0.04 * (k // 3)), paint("yellow", dirt=0.05), 0.003)
    s.box((0.14, 0.02, 0.07), (0, 0.132, 0.85), steel(), 0.006)
    s.lathe([(0.012, 0.0), (0.012, 0.36)], steel(), (0, 0, 1.66), steps=8)
    s.box((0.22, 0.010, 0.22), (0, 0, 2.02), sheet("blue"), 0.003)
    with s.at(0, 0.006, 2.02):
        write(s, "P", 0.14, 0, 0, "white", lift=0.001)
    return s.built()


def traffic_signal(state: str) -> Built:
    """Build a signal on a post, facing +y. ``state`` is "red", "amber" or "green"."""
    s = Solid("traffic light")
    s.lathe([(0.16, 0.0), (0.16, 0.02), (0.057, 0.03), (0.057, 3.35), (0.03, 3.38)], paint("light grey", dirt=0.25), steps=18)
    black = paint("black", dirt=0.12)
    s.box((0.30, 0.16, 0.92), (0, 0.15, 2.88), black, 0.03)
    s.box((0.52, 0.012, 1.14), (0, 0.10, 2.88), black, 0.004)
    for k, colour in enumerate(("red", "amber", "green")):
        z = 3.17 - 0.29 * k
        lamp = glow(colour, 7.0) if colour == state else lens(colour if colour == "red" else "black")
        s.lathe([(0.10, 0.0), (0.085, 0.022), (0.04, 0.034), (0.002, 0.036)], lamp, (0, 0.228, z), "Y", 24)
        hood = [(0.118 * math.cos(a), 0.118 * math.sin(a)) for a in (math.radians(20 + 14 * j) for j in range(11))]
        for (u0, v0), (u1, v1) in itertools.pairwise(hood):
            s.add([(u0, 0.22, z + v0), (u1, 0.22, z + v1), (u1, 0.40, z + v1), (u0, 0.40, z + v0)], [(0, 1, 2, 3)], black)
    s.box((0.13, 0.10, 0.22), (0.0, 0.09, 1.15), paint("yellow", dirt=0.2), 0.02)
    s.lathe([(0.022, 0.0), (0.018, 0.012)], glow("red", 3.0), (0, 0.14, 1.17), "Y", 14)
    return s.built()


def belisha_beacon(*, lit: bool = True) -> Built:
    """Build the beacon of a zebra crossing, 3.1 m high: a black and white post with an amber globe."""
    s = Solid("belisha beacon")
    black, white = paint("black", dirt=0.15), paint("white", dirt=0.2)
    s.lathe([(0.12, 0.0), (0.12, 0.02)], steel(dark=True), steps=14)
    for k in range(9):
        s.lathe([(0.05, 0.02 + 0.30 * k), (0.05, 0.32 + 0.30 * k)], black if k % 2 == 0 else white, steps=18)
    s.lathe([(0.035, 2.72), (0.035, 2.80), (0.06, 2.82)], black, steps=14)
    ball = [(0.15 * math.cos(a) + 0.001, 2.96 + 0.15 * math.sin(a)) for a in (math.pi * (k / 12 - 0.5) for k in range(13))]
    s.lathe(ball, glow("amber", 2.6) if lit else lens("amber"), steps=24)
    return s.built()


def bracket_clock(hour: int, minute: int, *, radius_m: float = 0.42) -> Built:
    """Build a drum clock on a bracket that extends towards +y, with faces towards +x and -x."""
    s = Solid("clock")
    iron = paint("black", dirt=0.15)
    reach = radius_m + 0.28
    s.rod((0, 0, 0), (0, reach, 0), 0.022, iron)
    s.tube([(0, 0.02, 0.5), (0, reach * 0.6, 0.46), (0, reach, radius_m - 0.02)], 0.016, iron)
    with s.at(0, reach, 0):
        s.lathe([(radius_m - 0.02, -0.11), (radius_m, -0.09), (radius_m, 0.09), (radius_m - 0.02, 0.11)], iron, (0, 0, 0), "X", 40)
        for side in (-1, 1):
            with s.at(side * 0.112, 0, 0, turn=-90 * side):
                dial(s, radius_m * 0.92, hour, minute)
    return s.built()


def fingerpost(arms: Sequence[tuple[str, float]], *, colour: str = "dark green") -> Built:
    """Build a signpost, 3.1 m high, with one arm for each pair (place, bearing in degrees). The arms are lettered on both sides."""
    s = Solid("signpost")
    iron = paint(colour, dirt=0.15)
    s.lathe([(0.10, 0.0), (0.10, 0.05), (0.05, 0.12), (0.045, 2.95), (0.07, 3.0), (0.07, 3.05), (0.01, 3.14)], iron, steps=16)
    for k, (place, bearing) in enumerate(arms):
        width = extent(place, 0.085) + 0.30
        with s.at(0, 0, 2.84 - 0.20 * k, turn=90 - bearing):
            outline = [(0.05, -0.085), (width, -0.085), (width + 0.09, 0.0), (width, 0.085), (0.05, 0.085)]
            s.prism(outline, (-0.014, 0.014), iron, "XZ")
            for turn in (0, 180):
                with s.at(turn=turn), s.at(0, 0.015, 0):
                    write(s, place, 0.085, (0.05 + width / 2) * (-1 if turn == 0 else 1), 0, "white", lift=0.001)
    return s.built()
