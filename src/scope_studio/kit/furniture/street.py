"""Street furniture: bench, bin, bus shelter, bicycle."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import clear_glass, lens, paint, rubber, sheet, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write


def bin(*, colour: str = "dark green") -> Built:  # noqa: A001
    """Litter bin: a slatted drum with a hooded top, 1.1 m."""
    s = Solid("litter bin")
    body = paint(colour, dirt=0.3)
    s.lathe(
        [(0.27, 0.0), (0.27, 0.05), (0.25, 0.06), (0.26, 0.80), (0.28, 0.82), (0.28, 0.86), (0.20, 0.86)],
        body,
        steps=32,
    )
    for k in range(16):
        with s.at(turn=360 * k / 16):
            s.box((0.055, 0.02, 0.68), (0, 0.262, 0.43), body, 0.005)
    for k in range(4):
        with s.at(turn=90 * k + 45):
            s.box((0.03, 0.03, 0.20), (0, 0.24, 0.94), body, 0.004)
    s.lathe([(0.20, 0.855), (0.19, 0.86)], lens("black"), steps=32)
    s.lathe([(0.29, 1.02), (0.30, 1.04), (0.26, 1.09), (0.12, 1.13), (0.02, 1.14)], body, steps=32)
    s.text("LITTER", 0.05, (0, 0.2755, 0.62), sheet("white"))
    return s.built()


def bench() -> Built:
    """Timber slat bench, 1.8 m, on cast ends; sitters look towards +y."""
    s = Solid("bench")
    iron = paint("black", dirt=0.25)
    for x in (-0.78, 0.78):
        s.tube([(x, 0.24, 0.0), (x, 0.23, 0.40), (x, 0.20, 0.43), (x, -0.16, 0.41), (x, -0.28, 0.86)], 0.022, iron)
        s.tube([(x, -0.30, 0.0), (x, -0.17, 0.40)], 0.022, iron)
        s.tube([(x, 0.22, 0.42), (x, 0.24, 0.60), (x, 0.18, 0.64), (x, -0.22, 0.63)], 0.018, iron)
        for y in (0.24, -0.30):
            s.box((0.07, 0.09, 0.015), (x, y, 0.008), iron, 0.003)
    for k in range(4):
        s.box((1.8, 0.085, 0.034), (0, 0.19 - 0.105 * k, 0.455 - 0.004 * k), timber(), 0.008)
    for k in range(3):
        with s.at(0, -0.185 - 0.030 * k, 0.57 + 0.115 * k, pitch=16):
            s.box((1.8, 0.032, 0.085), (0, 0, 0), timber(), 0.008)
    return s.built()


def bus_shelter(name: str = "MARKET STREET", *, route: str = "7") -> Built:
    """Glazed bus shelter, 4.0 x 1.5 m, open towards +y, with a name board on the roof edge, a seat and a stop flag."""
    s = Solid("bus shelter")
    metal = paint("dark grey", dirt=0.25)
    pane = clear_glass()
    for x in (-1.95, -0.65, 0.65, 1.95):
        s.box((0.07, 0.07, 2.35), (x, -0.65, 1.175), metal, 0.006)
    for x in (-1.95, 1.95):
        s.box((0.07, 0.07, 2.35), (x, 0.45, 1.175), metal, 0.006)
        s.box((0.012, 0.98, 1.75), (x, -0.10, 1.25), pane, 0.0)
        for z in (0.36, 2.14):
            s.box((0.04, 1.03, 0.04), (x, -0.10, z), metal, 0.004)
        s.box((0.016, 0.98, 0.08), (x, -0.10, 1.45), sheet("white"), 0.0)
    for cx in (-1.3, 0.0, 1.3):
        s.box((1.22, 0.012, 1.75), (cx, -0.65, 1.25), pane, 0.0)
        s.box((1.22, 0.016, 0.08), (cx, -0.65, 1.45), sheet("white"), 0.0)
        for z in (0.36, 2.14):
            s.box((1.23, 0.04, 0.04), (cx, -0.65, z), metal, 0.004)
    s.box((4.2, 1.65, 0.10), (0, -0.05, 2.40), metal, 0.03)
    s.box((4.1, 1.55, 0.03), (0, -0.05, 2.455), paint("light grey", dirt=0.4), 0.01)
    s.box((4.2, 0.04, 0.26), (0, 0.79, 2.38), sheet("green"), 0.006)
    s.text(name, 0.13, (0, 0.8145, 2.38), sheet("white"))
    s.box((2.3, 0.32, 0.05), (-0.5, -0.42, 0.50), paint("red", dirt=0.2), 0.015)
    for x in (-1.45, 0.45):
        s.box((0.05, 0.26, 0.48), (x, -0.42, 0.24), metal, 0.006)
    with s.at(1.30, -0.625, 1.35):
        board(s, 0.70, 1.0, "white", border="blue", edge=0.02, back=False)
        write(s, "TIMETABLE", 0.05, 0, 0.40, "blue")
        for k in range(14):
            s.box((0.52 - 0.12 * (k % 3 == 1), 0.001, 0.010), (0.0, 0.003, 0.30 - 0.05 * k), sheet("black"), 0.0)
    s.rod((2.45, 0.55, 0.0), (2.45, 0.55, 2.75), 0.035, metal)
    for side in (0, 180):
        with s.at(2.45, 0.55, 2.50, turn=side - 90):
            s.box((0.44, 0.012, 0.50), (-0.26 if side == 0 else 0.26, 0.006, 0), sheet("yellow"), 0.002)
            u = 0.26 if side == 0 else -0.26
            write(s, "BUS", 0.095, u, 0.14, "black", lift=0.0155)
            write(s, route, 0.16, u, -0.08, "black", lift=0.0155)
    return s.built()


def bicycle(colour: str = "blue") -> Built:
    """City bicycle heading +y, on its kick stand: wheels with spokes, mudguards, basket-free bars, saddle, lamps."""
    s = Solid(f"{colour} bicycle")
    frame_paint, black, chrome = paint(colour, dirt=0.12, roughness=0.25), paint("black", dirt=0.1), steel()
    r, rear, front = 0.345, (0.0, -0.52, 0.345), (0.0, 0.54, 0.345)
    for hub in (rear, front):
        ring = [
            (0.0, hub[1] + r * 0.965 * math.cos(a), r + r * 0.965 * math.sin(a)) for a in (2 * math.pi * k / 40 for k in range(40))
        ]
        s.tube(ring, 0.019, rubber(), sides=8, closed=True)
        rim = [
            (0.0, hub[1] + r * 0.89 * math.cos(a), r + r * 0.89 * math.sin(a)) for a in (2 * math.pi * k / 40 for k in range(40))
        ]
        s.tube(rim, 0.011, chrome, sides=6, closed=True)
        s.rod((-0.05, hub[1], r), (0.05, hub[1], r), 0.018, chrome)
        for k in range(28):
            a = 2 * math.pi * k / 28
            b = a + (0.6 if k % 2 else -0.6)
            x = 0.028 if k % 4 < 2 else -0.028
            s.tube(
                [
                    (x, hub[1] + 0.02 * math.cos(b), r + 0.02 * math.sin(b)),
                    (0, hub[1] + 0.30 * math.cos(a), r + 0.30 * math.sin(a)),
                ],
                0.0012,
                chrome,
                sides=4,
            )
        low, high = (20, 200) if hub is rear else (40, 170)
        guard = [
            (0.0, hub[1] + 0.372 * math.cos(math.radians(a)), r + 0.372 * math.sin(math.radians(a)))
            for a in range(low, high + 1, 10)
        ]
        for dx in (-0.014, 0.0, 0.014):
            s.tube([(dx, y, z) for _, y, z in guard], 0.010, black, sides=6)
    crank, seat, head_low, head_top = (0, -0.08, 0.29), (0, -0.24, 0.80), (0, 0.40, 0.70), (0, 0.36, 0.86)
    for a, b, thick in (
        (crank, seat, 0.018),
        (crank, head_low, 0.021),
        (seat, head_top, 0.018),
        (head_low, head_top, 0.024),
    ):
        s.rod(a, b, thick, frame_paint, sides=12)
    for x in (-0.05, 0.05):
        s.rod((x * 0.5, *crank[1:]), (x, *rear[1:]), 0.011, frame_paint)
        s.rod((x * 0.4, seat[1] + 0.02, seat[2] - 0.06), (x, *rear[1:]), 0.009, frame_paint)
        s.tube([(x * 0.9, head_low[1], head_low[2] - 0.01), (x, 0.47, 0.52), (x, *front[1:])], 0.012, frame_paint)
        s.rod((x * 2, -0.62, 0.76), (x, -0.52, 0.345), 0.005, chrome)
    s.rod(seat, (0, -0.275, 0.94), 0.013, chrome)
    s.prism(
        [(-0.085, -0.40), (0.085, -0.40), (0.07, -0.27), (0.025, -0.13), (-0.025, -0.13), (-0.07, -0.27)],
        (0.935, 0.985),
        black,
        "XY",
    )
    s.tube(
        [
            (-0.29, 0.20, 1.04),
            (-0.24, 0.34, 1.06),
            (-0.06, 0.39, 1.03),
            (0.06, 0.39, 1.03),
            (0.24, 0.34, 1.06),
            (0.29, 0.20, 1.04),
        ],
        0.011,
        chrome,
        sides=10,
    )
    s.rod(head_top, (0, 0.385, 1.03), 0.013, chrome)
    for x in (-0.30, 0.30):
        s.rod((x * 0.97, 0.17, 1.037), (x * 0.92, 0.27, 1.052), 0.016, black)
    s.lathe([(0.02, -0.004), (0.085, -0.002), (0.085, 0.002)], chrome, (0.055, crank[1], crank[2]), "X", 28)
    s.tube([(0.055, -0.08, 0.372), (0.055, -0.52, 0.385)], 0.005, black, sides=4)
    s.tube([(0.055, -0.08, 0.208), (0.055, -0.52, 0.305)], 0.005, black, sides=4)
    for sx, dy, dz in ((1, 0.12, -0.11), (-1, -0.12, 0.11)):
        s.rod((sx * 0.07, *crank[1:]), (sx * 0.085, crank[1] + dy, crank[2] + dz), 0.010, chrome)
        s.box((0.09, 0.075, 0.022), (sx * 0.14, crank[1] + dy, crank[2] + dz), black, 0.005)
    s.box((0.12, 0.36, 0.016), (0, -0.58, 0.765), black, 0.004)
    s.box((0.05, 0.03, 0.05), (0, -0.775, 0.72), lens("red"), 0.01)
    s.lathe([(0.012, -0.05), (0.035, 0.0), (0.033, 0.008)], lens("white"), (0, 0.47, 0.92), "Y", 16)
    s.rod((-0.03, -0.30, 0.30), (-0.17, -0.34, 0.0), 0.008, chrome)
    return s.built()
