"""An articulated tram that faces +y, the shelter and signs of a tram stop, and poles for the overhead wire."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core.finishes import clear_glass, glow, lens, paint, sheet, steel
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.shapes import block
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write
from scope_studio.kit.vehicles import paintwork

LENGTH_M = 19.6
HALF_WIDTH_M = 1.2
RAKE = 0.20
"""Slope of the front: metres backwards per metre of height."""

SECTION = [
    (0.0, 0.32),
    (1.02, 0.32),
    (1.17, 0.45),
    (1.20, 0.95),
    (1.20, 2.35),
    (1.13, 2.85),
    (0.96, 3.12),
    (0.55, 3.22),
    (0.0, 3.24),
]
"""Right half of the body's cross-section: (x, z) in metres, from the centre of the floor to the centre of the roof."""


def _ring(y: float, narrow: float = 1.0, *, front: bool = False) -> list[tuple[float, float, float]]:
    """Return a cross-section of the body at ``y``, narrowed by a factor. With ``front``, it is slanted like the front."""
    half = [(x * narrow, z) for x, z in SECTION]
    outline = [*half, *[(-x, z) for x, z in half[-2:0:-1]]]
    lean = math.copysign(RAKE, y) if front else 0.0
    return [(x, y - lean * (z - 0.32), z) for x, z in outline]


def _hull(s: Solid, stations: list[tuple[float, float, bool]], material: bpy.types.Material) -> None:
    """Add a closed hull through the cross-sections at ``stations``, which are arguments of ``_ring``."""
    rings = [_ring(*station[:2], front=station[2]) for station in stations]
    n = len(rings[0])
    points = [p for ring in rings for p in ring]
    up = stations[-1][0] > stations[0][0]
    faces: list[tuple[int, ...]] = []
    for i in range(len(rings) - 1):
        for k in range(n):
            quad = (i * n + k, i * n + (k + 1) % n, (i + 1) * n + (k + 1) % n, (i + 1) * n + k)
            faces.append(quad[::-1] if up else quad)
    first, last = tuple(range(n)), tuple(range((len(rings) - 1) * n, len(rings) * n))
    faces += [first, last[::-1]] if up else [first[::-1], last]
    s.add(points, faces, material)


def _end(s: Solid, sign: int, colour: str, line: str, destination: str, number: str, lit: bool) -> None:
    """Add the windscreen, display, lamps and coupler cover of one end, on its slanted front plane."""
    y = LENGTH_M / 2
    black, dark = plain("tram black", (0.010, 0.010, 0.011), 0.3), plain("tram glass", (0.012, 0.015, 0.017), 0.03)
    with s.at(turn=0.0 if sign > 0 else 180.0), s.at(0, y, 0.32, pitch=math.degrees(math.atan(RAKE))):
        k = math.hypot(1.0, RAKE)
        w = 0.86
        s.prism(
            [
                (-w, 0.62 * k),
                (w, 0.62 * k),
                (w * 0.98, 2.05 * k),
                (w * 0.80, 2.72 * k),
                (-w * 0.80, 2.72 * k),
                (-w * 0.98, 2.05 * k),
            ],
            (-0.02, 0.012),
            black,
            "XZ",
        )
        s.prism(
            [(-w + 0.05, 0.70 * k), (w - 0.05, 0.70 * k), (w * 0.98 - 0.05, 2.02 * k), (-w * 0.98 + 0.05, 2.02 * k)],
            (0.0, 0.018),
            dark,
            "XZ",
        )
        s.box((1.50, 0.02, 0.40), (0, 0.014, 2.33 * k), plain("tram display", (0.004, 0.004, 0.005), 0.2), 0.01)
        cap = min(0.17, 1.0 / extent(destination, 1.0))
        s.text(line, 0.25, (0.58, 0.0265, 2.33 * k), _led())
        s.text(destination, cap, (-0.14, 0.0265, 2.33 * k), _led())
        for x in (-0.62, 0.62):
            s.box((0.30, 0.03, 0.13), (x, 0.01, 0.40), black, 0.02)
            for dx, lamp in ((-0.07, glow("white", 1.4) if lit and sign > 0 else lens("white")), (0.07, lens("red"))):
                s.lathe([(0.05, 0.0), (0.048, 0.02), (0.03, 0.028)], lamp, (x + math.copysign(dx, x) * 1.0, 0.02, 0.40), "Y", 16)
        s.text(number, 0.12, (0, 0.016, 0.44), paint("white" if colour != "white" else "black", dirt=0.0))
        s.box((1.2, 0.10, 0.20), (0, 0.0, 0.06), black, 0.03)
        s.rod((-0.5, 0.025, 0.78 * k), (0.15, 0.025, 1.55 * k), 0.012, black, sides=6)


def _led() -> bpy.types.Material:
    """Return the emissive material of a destination display."""
    existing = bpy.data.materials.get("tram led")
    return existing or Shader("tram led").surface(
        base_color=(1.0, 0.55, 0.06), emission_color=(1.0, 0.50, 0.04), emission_strength=1.5
    )


def tram(
    colour: str, *, line: str, destination: str, number: str, company: str, second_colour: str = "cream", lit: bool = True
) -> Built:
    """Build a three-part low-floor tram, 19.6 m long, with two colours, a pantograph, and lettering on its ends and sides."""
    s = Solid(f"{colour} tram")
    finish = paintwork.paint("tram body", colour, dirt_top_m=1.3, dirt=0.4)
    band, dark = paint(second_colour, dirt=0.05, roughness=0.25), plain("tram glass", (0.012, 0.015, 0.017), 0.03)
    half, joint = LENGTH_M / 2, 2.7
    for sign in (-1, 1):
        _hull(s, [(sign * (joint + 0.3), 1.0, False), (sign * (half - 1.9), 1.0, False), (sign * (half - 0.6), 0.93, True),
                  (sign * half, 0.78, True)], finish)  # fmt: skip
        _end(s, sign, colour, line, destination, number, lit)
        _bellows(s, sign * joint)
    _hull(s, [(-joint + 0.3, 1.0, False), (joint - 0.3, 1.0, False)], finish)
    black = plain("tram black", (0.010, 0.010, 0.011), 0.3)
    for side in (-1, 1):
        x = side * (HALF_WIDTH_M + 0.004)
        for y0, y1 in ((-half + 1.9, -joint - 0.4), (-joint + 0.4, joint - 0.4), (joint + 0.4, half - 1.9)):
            mid, long = (y0 + y1) / 2, y1 - y0
            block(s, (0.012, long, 1.20), (x, mid, 1.78), black)
            block(s, (0.014, long, 0.34), (x, mid, 0.90), band)
            block(s, (0.014, long, 0.16), (x, mid, 2.50), band)
            panes = max(2, round(long / 1.3))
            for k in range(panes):
                cy = y0 + long * (k + 0.5) / panes
                block(s, (0.016, long / panes - 0.07, 1.08), (x, cy, 1.78), dark)
            for cy in [mid] if long < 5 else [y0 + long * 0.25, y0 + long * 0.75]:
                block(s, (0.02, 1.34, 2.16), (x, cy, 1.48), black)
                for dy in (-0.33, 0.33):
                    block(s, (0.026, 0.60, 1.95), (x, cy + dy, 1.50), dark)
                    block(s, (0.03, 0.03, 0.7), (x, cy + dy * 0.25, 1.35), steel())
        s.text(
            company,
            0.20,
            (side * (HALF_WIDTH_M + 0.0125), 0.0, 0.90),
            paint("dark green", dirt=0.0),
            facing="+X" if side > 0 else "-X",
        )
        for y in (-half + 3.2, half - 3.2):
            s.text(
                number, 0.16, (side * (HALF_WIDTH_M + 0.014), y, 0.60), paint("white", dirt=0.0), facing="+X" if side > 0 else "-X"
            )
        for y in (-half + 4.0, 0.0, half - 4.0):
            for dy in (-0.75, 0.75):
                s.lathe([(0.30, -0.06), (0.30, 0.06)], steel(dark=True), (side * 0.76, y + dy, 0.30), "X", 24)
            block(s, (0.05, 2.6, 0.42), (side * 1.15, y, 0.36), black)
    for y in (-half + 5.0, half - 5.0, 0.0):
        s.box((1.5, 3.0 if y else 3.2, 0.28), (0, y, 3.34), paint("light grey", dirt=0.4), 0.06)
    for x in (-0.5, 0.5):
        s.tube([(x, -0.9, 3.45), (x * 0.8, 0.6, 4.25), (x * 0.9, -0.3, 5.28)], 0.025, steel(dark=True), sides=6)
    s.rod((-0.8, -0.3, 5.30), (0.8, -0.3, 5.30), 0.03, steel(dark=True))
    return s.built()


def _bellows(s: Solid, y: float) -> None:
    """Add the bellows between two parts of the tram."""
    rubber = plain("tram bellows", (0.03, 0.03, 0.032), 0.9)
    for k in range(5):
        at = y - 0.32 + 0.16 * k
        _hull(s, [(at - 0.07, 0.94, False), (at, 0.985, False), (at + 0.07, 0.94, False)], rubber)


def shelter(name: str) -> Built:
    """Build a glazed tram shelter, 4.4 x 1.5 m, open towards +y, with a bench.

    The name on the roof edge is readable from both sides.
    """
    s = Solid("tram shelter")
    metal, pane = paint("dark grey", dirt=0.2), clear_glass()
    for x in (-2.1, -0.7, 0.7, 2.1):
        s.box((0.08, 0.08, 2.4), (x, -0.65, 1.2), metal, 0.01)
    for x in (-2.1, 2.1):
        s.box((0.012, 1.0, 1.8), (x, -0.12, 1.25), pane, 0.0)
        s.box((0.06, 0.06, 2.4), (x, 0.42, 1.2), metal, 0.01)
        s.box((0.016, 1.0, 0.08), (x, -0.12, 1.45), sheet("white"), 0.0)
    for x in (-1.4, 0.0, 1.4):
        s.box((1.3, 0.012, 1.8), (x, -0.65, 1.25), pane, 0.0)
        s.box((1.3, 0.016, 0.08), (x, -0.65, 1.45), sheet("white"), 0.0)
    s.box((4.6, 1.8, 0.14), (0, -0.05, 2.46), metal, 0.04)
    s.box((4.4, 1.6, 0.03), (0, -0.05, 2.545), paint("light grey", dirt=0.4), 0.01)
    for turn in (0.0, 180.0):
        with s.at(0, -0.05, 2.62, turn=turn):
            s.box((3.4, 0.03, 0.30), (0, 0.86, 0.0), paint("blue", dirt=0.1), 0.006)
            s.text(name, min(0.17, 2.9 / extent(name, 1.0)), (0, 0.877, 0.0), paint("white", dirt=0.0))
    s.box((2.4, 0.34, 0.05), (-0.7, -0.40, 0.46), paint("dark red", dirt=0.15), 0.015)
    for x in (-1.7, 0.3):
        s.box((0.05, 0.28, 0.44), (x, -0.40, 0.22), metal, 0.006)
    return s.built()


def stop_flag(line: str, *, direction: str = "") -> Built:
    """Build a tram stop's post, 3.0 m high, with a yellow flag readable from both sides (+y and -y)."""
    s = Solid("tram stop sign")
    s.rod((0, 0, 0), (0, 0, 3.0), 0.035, paint("dark grey", dirt=0.2))
    for side in (0.0, 180.0):
        with s.at(turn=side), s.at(0.0, 0.045, 2.62):
            board(s, 0.52, 0.66, "yellow", border="black", edge=0.02, back=False)
            write(s, "TRAM", 0.105, 0, 0.20, "black")
            write(s, line, 0.22, 0, -0.04, "black")
            if direction:
                write(s, direction, 0.055, 0, -0.25, "black")
    return s.built()


def timetable(line: str, rows: list[tuple[str, str]], *, cap: float = 0.045) -> Built:
    """Build a framed timetable on two legs, 0.9 x 1.2 m, facing +y, with a heading and rows of (hour, minutes)."""
    s = Solid("timetable")
    metal = paint("dark grey", dirt=0.2)
    for x in (-0.42, 0.42):
        s.box((0.05, 0.05, 2.05), (x, -0.02, 1.02), metal, 0.008)
    with s.at(0, 0.01, 1.42):
        s.box((0.92, 0.05, 1.22), (0, 0, 0), metal, 0.01)
        s.box((0.86, 0.012, 1.16), (0, 0.022, 0), sheet("white", dirt=0.05), 0.0)
        s.box((0.86, 0.008, 0.20), (0, 0.027, 0.47), paint("blue", dirt=0.0), 0.0)
        ink = paint("black", dirt=0.0)
        s.text(line, 0.085, (0, 0.0325, 0.47), paint("white", dirt=0.0))
        for k, (hour, minutes) in enumerate(rows):
            z = 0.29 - 0.80 * k / max(1, len(rows) - 1)
            s.text(hour, cap, (0.36, 0.0295, z), ink, align="LEFT")
            s.text(minutes, cap, (0.20, 0.0295, z), ink, align="LEFT")
    return s.built()


def overhead_pole(height: float = 6.6, *, reaches: tuple[float, ...] = (2.4, 5.8), wire_m: float = 5.42) -> Built:
    """Build a tapered steel pole with a bracket towards +y that carries a contact wire at each distance in ``reaches``."""
    s = Solid("tram pole")
    body = paint("dark green", dirt=0.2)
    s.lathe(
        [(0.20, 0.0), (0.20, 0.06), (0.13, 0.10), (0.12, 1.2), (0.14, 1.25), (0.11, 1.32), (0.075, height), (0.03, height + 0.15)],
        body,
        steps=20,
    )
    far = max(reaches) + 0.3
    s.rod((0, 0, wire_m + 0.45), (0, far, wire_m + 0.55), 0.035, body)
    s.rod((0, 0, height - 0.1), (0, far * 0.8, wire_m + 0.56), 0.012, steel(), sides=5)
    for y in reaches:
        s.rod((0, y, wire_m + 0.5), (0, y - 0.5, wire_m + 0.06), 0.016, steel(), sides=5)
        s.lathe([(0.03, 0.0), (0.05, 0.05), (0.03, 0.10)], paint("brown"), (0, y, wire_m + 0.40), steps=10)
        s.rod((0, y, wire_m + 0.45), (0, y, wire_m), 0.008, steel(), sides=4)
    return s.built()
