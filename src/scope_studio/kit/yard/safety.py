"""Safety equipment in a yard: bollards, wheel stops, chain-link fence, hydrant, spill kit, hose reel, notices, gate.

Fronts face +y.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from scope_studio.kit.core.finishes import concrete, glow, lens, paint, rubber, sheet, steel
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import INK_BY_BACKGROUND, board, disc, flat, stroke, write
from scope_studio.kit.signs.stands import add_posts

FENCE_PANEL_LENGTH_M = 3.0
"""Length of a chain-link panel in metres."""


def yard_bollard(colour: str = "yellow") -> Built:
    """Build a bollard, 1.0 m high: a steel tube set in concrete, with a black band and dirt near the ground."""
    s = Solid("bollard")
    finish = paint(colour, dirt=0.45)
    s.lathe([(0.084, -0.02), (0.084, 0.62)], finish, steps=24)
    s.lathe([(0.085, 0.62), (0.085, 0.78)], sheet("black", dirt=0.2), steps=24)
    s.lathe([(0.084, 0.78), (0.084, 0.97), (0.06, 1.02), (0.01, 1.035)], finish, steps=24)
    s.lathe([(0.16, 0.0), (0.15, 0.012)], concrete(light=False), steps=20)
    return s.built()


def wheel_stop(colour: str = "yellow") -> Built:
    """Build a low rubber kerb for the closed end of a parking bay, 1.65 m along x, with painted chevrons."""
    s = Solid("wheel stop")
    s.prism([(-0.075, 0.0), (0.075, 0.0), (0.05, 0.10), (-0.05, 0.10)], (-0.825, 0.825), rubber(), "YZ")
    for k in range(4):
        x = -0.62 + 0.413 * k
        s.prism(
            [(-0.079, 0.0), (0.079, 0.0), (0.053, 0.103), (-0.053, 0.103)], (x - 0.09, x + 0.09), sheet(colour, dirt=0.45), "YZ"
        )
    return s.built()


def bay_plate(number: str, *, background: str = "blue") -> Built:
    """Build a plate with the number of a parking bay, on a low post. Both sides show the number."""
    s = Solid("bay plate")
    s.box((0.05, 0.05, 0.55), (0, 0, 0.275), steel(), 0.005)
    for turn in (0, 180):
        with s.at(0, 0, 0.66, turn=turn), s.at(0, 0.028, 0):
            board(s, 0.46, 0.30, background, back=False)
            write(s, number, 0.19, 0, 0, INK_BY_BACKGROUND.get(background, "black"))
    return s.built()


def chain_link(length: float = FENCE_PANEL_LENGTH_M, height: float = 2.4, *, hole: bool = False) -> Built:
    """Build a chain-link panel along x with a post at each end and three barbed strands on top.

    With ``hole``, the mesh is cut and bent open.
    """
    s = Solid("chain-link panel")
    wire, pitch = steel(), 0.085
    half = length / 2
    for x in (-half, half):
        s.box(
            (0.075, 0.075, height + 0.05), (x, 0, (height + 0.05) / 2), concrete(light=False) if hole else steel(dark=True), 0.006
        )
        s.rod((x, 0, height), (x, 0.30, height + 0.35), 0.022, steel(dark=True), sides=6)
    for k in range(3):
        z, y = height + 0.10 + 0.11 * k, 0.09 + 0.095 * k
        s.tube([(-half, y, z), (0, y, z - 0.02), (half, y, z)], 0.004, wire, sides=4)
    for z in (0.12, height * 0.5, height - 0.04):
        if not (hole and z < height * 0.6):
            s.tube([(-half, 0, z), (half, 0, z)], 0.004, wire, sides=4)
    top, low = height - 0.04, 0.04
    count = int((length + top) / (pitch * 1.414))
    for sign in (-1, 1):
        for k in range(count):
            c = -half - (top - low) + (k + 0.5) * (length + top - low) / count
            a, b = max(-half, c), min(half, c + top - low)
            ends = [(sign * x, 0.0, low + (x - c)) for x in (a, b)]
            if b - a < 0.05:
                continue
            if hole:
                for (x0, _, z0), (x1, _, z1) in _outside_hole(ends):
                    s.tube([(x0, 0, z0), (x1, 0, z1)], 0.0026, wire, sides=4)
            else:
                s.tube(ends, 0.0026, wire, sides=4)
    if hole:
        for k in range(9):
            z = 0.10 + 0.13 * k
            s.tube([(0.45, 0, z), (0.62, 0.10, z + 0.03), (0.80, 0.26, z - 0.02)], 0.0035, wire, sides=4)
            s.tube([(0.45, 0, z + 0.06), (0.66, 0.16, z - 0.02), (0.84, 0.30, z + 0.04)], 0.0035, wire, sides=4)
    return s.built()


def _outside_hole(
    ends: Sequence[tuple[float, float, float]],
) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Return the parts of a wire that are outside the hole, an arch 1.0 m wide and 1.25 m high."""
    (x0, _, z0), (x1, _, z1) = ends
    pieces, steps, start = [], 48, None
    points = [(x0 + (x1 - x0) * t / steps, 0.0, z0 + (z1 - z0) * t / steps) for t in range(steps + 1)]
    for point in points:
        inside = (point[0] / 0.5) ** 2 + (max(0.0, point[2]) / 1.25) ** 2 < 1.0
        if not inside and start is None:
            start = point
        if inside and start is not None:
            pieces.append((start, point))
            start = None
    if start is not None and start != points[-1]:
        pieces.append((start, points[-1]))
    return pieces


def hydrant() -> Built:
    """Build a red pillar hydrant, 0.85 m high, with capped outlets."""
    s = Solid("fire hydrant")
    red = paint("red", dirt=0.25)
    s.lathe(
        [
            (0.17, 0.0),
            (0.17, 0.05),
            (0.115, 0.07),
            (0.11, 0.58),
            (0.145, 0.60),
            (0.145, 0.64),
            (0.12, 0.66),
            (0.11, 0.74),
            (0.05, 0.80),
            (0.035, 0.85),
        ],
        red,
        steps=24,
    )
    for turn in (0, 90, -90):
        with s.at(0, 0, 0.46, turn=turn):
            s.lathe(
                [(0.062, 0.09), (0.062, 0.15), (0.078, 0.155), (0.078, 0.20), (0.025, 0.205), (0.025, 0.235)],
                red,
                axis="Y",
                steps=16,
            )
    return s.built()


def spill_kit() -> Built:
    """Build a spill kit: a yellow, lettered chest on wheels with a black lid."""
    s = Solid("spill kit")
    finish = paint("yellow", dirt=0.25)
    s.box((0.95, 0.60, 0.80), (0, 0, 0.48), finish, 0.04)
    s.box((0.99, 0.64, 0.10), (0, 0, 0.92), paint("black", dirt=0.2), 0.035)
    for x in (-0.36, 0.36):
        s.lathe([(0.09, -0.03), (0.09, 0.03)], rubber(), (x, 0.22, 0.09), "X", 16)
        s.lathe([(0.09, -0.03), (0.09, 0.03)], rubber(), (x, -0.22, 0.09), "X", 16)
    s.text("SPILL KIT", 0.13, (0, 0.305, 0.62), sheet("black", dirt=0.05))
    s.text("OIL ONLY", 0.07, (0, 0.305, 0.42), sheet("black", dirt=0.05))
    return s.built()


def hose_reel() -> Built:
    """Build a red hose reel on a wall bracket. The wall is the plane y = 0, and the axle is at z = 0."""
    s = Solid("hose reel")
    red = paint("red", dirt=0.2)
    s.box((0.12, 0.18, 0.5), (0, 0.09, 0), steel(dark=True), 0.01)
    for y in (0.16, 0.36):
        s.lathe([(0.33, y - 0.012), (0.33, y + 0.012)], red, axis="Y", steps=32)
    profile = []
    for k in range(6):
        y = 0.185 + 0.026 * k
        profile += [(0.22, y), (0.24, y + 0.013), (0.22, y + 0.026)]
    s.lathe(profile, rubber(), axis="Y", steps=32)
    s.lathe([(0.07, 0.36), (0.06, 0.40)], steel(), axis="Y", steps=16)
    s.tube([(0.22, 0.26, -0.05), (0.24, 0.28, -0.45), (0.15, 0.28, -0.62), (0.05, 0.28, -0.50)], 0.014, rubber())
    return s.built()


def notice(
    lines: Sequence[str], *, background: str = "white", cap: float = 0.10, header: str | None = None, symbol: str | None = None,
    post_height: float | None = None,
) -> Built:  # fmt: skip
    """Build a rectangular notice on a wall or on posts.

    A notice on a wall has its back at y = 0 and its centre at z = 0. A notice on posts has its lower edge at ``post_height``.

    Args:
        header: Colour of a band at the top: "red", "yellow", "blue" or "green".
        symbol: Pictogram on the band: "warning", "forbidden", "flt", "camera", "people" or "bolt".
    """
    s = Solid("notice")
    width = max(extent(t, cap) for t in lines) + 2.2 * cap
    text_h = cap * (0.9 + 1.65 * len(lines))
    head = 0.0 if header is None else max(0.62 * width if symbol and width < 0.9 else 0.36, 3.2 * cap)
    height = text_h + head
    middle = 0.03 if post_height is None else 0.0
    z = 0.0 if post_height is None else post_height + height / 2
    with s.at(0, middle, z):
        board(s, width, height, background, back=post_height is not None)
        if header is not None:
            edge = 0.012
            v0, v1 = height / 2 - head, height / 2 - edge
            flat(
                s,
                [(-width / 2 + edge, v0), (width / 2 - edge, v0), (width / 2 - edge, v1), (-width / 2 + edge, v1)],
                sheet(header),
                0.003,
            )
            if symbol:
                _symbol(s, symbol, (v0 + v1) / 2, (v1 - v0) * 0.42)
        for i, line in enumerate(lines):
            v = height / 2 - head - text_h / 2 + ((len(lines) - 1) / 2 - i) * 1.65 * cap
            write(s, line, cap, 0, v, INK_BY_BACKGROUND.get(background, "black"))
    if post_height is not None:
        add_posts(s, width * 0.3 if width > 0.8 else 0.0, post_height + height - 0.05, 0.035, -0.075)
    return s.built()


def _symbol(s: Solid, kind: str, v: float, k: float) -> None:
    """Add a pictogram of half height ``k`` centred at height ``v``."""
    black, white, red = sheet("black", dirt=0.05), sheet("white"), sheet("red")

    def add_shape(points: Sequence[tuple[float, float]], ink, lift: float = 0.006) -> None:
        flat(s, [(x * k, v + y * k) for x, y in points], ink, lift)

    if kind in ("warning", "flt", "bolt"):
        add_shape([(-1.05, -0.9), (1.05, -0.9), (0.0, 0.95)], black, 0.005)
        add_shape([(-0.84, -0.78), (0.84, -0.78), (0.0, 0.70)], sheet("yellow"), 0.007)
        if kind == "warning":
            add_shape([(-0.09, 0.30), (-0.05, -0.30), (0.05, -0.30), (0.09, 0.30)], black, 0.009)
            disc(s, 0, v - 0.52 * k, 0.10 * k, black, 0.009)
        elif kind == "bolt":
            add_shape([(0.10, 0.40), (-0.22, -0.20), (-0.02, -0.18), (-0.10, -0.62), (0.24, -0.02), (0.04, -0.04)], black, 0.009)
        else:
            add_shape([(-0.42, -0.55), (0.20, -0.55), (0.20, -0.25), (-0.10, -0.20), (-0.16, 0.02), (-0.42, 0.02)], black, 0.009)
            add_shape([(0.22, -0.66), (0.28, -0.66), (0.28, 0.12), (0.22, 0.12)], black, 0.009)
            add_shape([(0.28, -0.66), (0.60, -0.66), (0.60, -0.60), (0.28, -0.60)], black, 0.009)
            for x in (-0.28, 0.08):
                disc(s, x * k, v - 0.60 * k, 0.11 * k, black, 0.009)
    elif kind in ("forbidden", "people"):
        disc(s, 0, v, 0.95 * k, red, 0.005, 40)
        disc(s, 0, v, 0.74 * k, white, 0.007, 40)
        disc(s, 0, v + 0.42 * k, 0.13 * k, black, 0.009)
        stroke(s, [(0, v + 0.2 * k), (0, v - 0.1 * k)], 0.22 * k, black, 0.009)
        stroke(s, [(-0.02 * k, v - 0.1 * k), (-0.2 * k, v - 0.52 * k)], 0.13 * k, black, 0.009)
        stroke(s, [(0.02 * k, v - 0.1 * k), (0.2 * k, v - 0.52 * k)], 0.13 * k, black, 0.009)
        stroke(s, [(-0.56 * k, v + 0.56 * k), (0.56 * k, v - 0.56 * k)], 0.17 * k, red, 0.011)
    elif kind == "camera":
        add_shape([(-0.75, 0.10), (0.35, 0.45), (0.50, -0.02), (-0.60, -0.38)], black)
        add_shape([(0.50, 0.38), (0.72, 0.45), (0.82, 0.14), (0.62, 0.06)], black)
        add_shape([(-0.80, -0.75), (-0.62, -0.75), (-0.30, -0.22), (-0.46, -0.18)], black)


def assembly_point(letter: str = "A") -> Built:
    """Build a green fire assembly point sign on a post, with four arrows, a pictogram of people, and its letter."""
    s = Solid("assembly point sign")
    with s.at(0, 0, 2.05):
        board(s, 0.80, 1.10, "green")
        white = sheet("white")
        for a in (45, 135, 225, 315):
            c, d = math.cos(math.radians(a)), math.sin(math.radians(a))
            stroke(s, [(0.30 * c, 0.16 + 0.30 * d), (0.17 * c, 0.16 + 0.17 * d)], 0.05, white)
            disc(s, 0.15 * c, 0.16 + 0.15 * d, 0.05, white)
        for x in (-0.07, 0.0, 0.07):
            disc(s, x, 0.22, 0.022, white)
            stroke(s, [(x, 0.18), (x, 0.11)], 0.035, white)
        write(s, "ASSEMBLY POINT", 0.072, 0, -0.20, "white")
        write(s, letter, 0.22, 0, -0.38, "white")
    add_posts(s, 0.0, 2.5, 0.038, -0.075)
    return s.built()


def alarm_beacon(colour: str = "amber", *, lit: bool = True) -> Built:
    """Build an alarm beacon on a wall, for example above a door. The wall is the plane y = 0."""
    s = Solid("beacon")
    s.box((0.14, 0.10, 0.10), (0, 0.05, 0), paint("dark grey"), 0.01)
    s.lathe(
        [(0.07, 0.05), (0.075, 0.16), (0.05, 0.21), (0.01, 0.22)],
        glow(colour, 6.0) if lit else lens(colour),
        (0, 0.06, 0),
        steps=18,
    )
    return s.built()


def sliding_gate(length: float = 8.0, height: float = 2.2) -> Built:
    """Build a barred steel sliding gate along x on a low track, with a sign at its centre."""
    s = Solid("sliding gate")
    finish, half = paint("dark green", dirt=0.35), length / 2
    s.box((length, 0.14, 0.14), (0, 0, 0.17), finish, 0.01)
    s.box((length, 0.08, 0.08), (0, 0, height), finish, 0.01)
    for k in range(round(length / 0.14) + 1):
        x = -half + length * k / round(length / 0.14)
        s.box((0.025, 0.025, height - 0.2), (x, 0, height / 2 + 0.08), finish, 0.0)
        s.lathe([(0.012, height), (0.002, height + 0.14)], finish, (x, 0, 0), steps=6)
    for x in (-half * 0.7, half * 0.7):
        s.lathe([(0.10, -0.03), (0.10, 0.03)], steel(dark=True), (x, 0, 0.10), "Y", 18)
    s.box((length + 0.5, 0.06, 0.03), (0, 0, 0.015), steel(), 0.0)
    for turn in (0, 180):
        with s.at(0, 0, 1.35, turn=turn), s.at(0, 0.03, 0):
            board(s, 1.9, 0.62, "blue", back=False)
            write(s, "GATE LOCKED", 0.15, 0, 0.13, "white")
            write(s, "22:00 TO 05:00", 0.13, 0, -0.13, "white")
    return s.built()
