"""Common street furniture: bench, litter bin, bus shelter."""

from __future__ import annotations

from scope_studio.kit.core.finishes import clear_glass, lens, paint, sheet, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write


def litter_bin(*, colour: str = "dark green") -> Built:
    """Build a litter bin, 1.1 m high: a slatted drum with a hooded top."""
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
    """Build a timber slat bench, 1.8 m long, on cast ends. People on it face +y."""
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
    """Build a glazed bus shelter, 4.0 x 1.5 m, open towards +y, with a seat, a stop sign, and a name board on the roof edge."""
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
