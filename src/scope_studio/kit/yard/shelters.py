"""Small buildings and machines in a yard: gatehouse, barrier, shelters for bicycles and smokers, vending machine, charge point."""

from __future__ import annotations

import math
import random

from scope_studio.kit.core.finishes import concrete, glow, lens, paint, pane, rubber, sheet, steel
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.light.glow import glowing_face, lit_lens
from scope_studio.kit.signs.faces import board, write

GATEHOUSE_SIZE_M = (3.0, 2.4, 2.7)
"""Width, depth and height of the gatehouse in metres."""


def gatehouse(name: str = "SECURITY") -> Built:
    """Build a guard's cabin with windows on all sides. Its lit room has a desk, screens and a key cabinet."""
    s = Solid("gatehouse")
    width, depth, height = GATEHOUSE_SIZE_M
    w, d = width / 2, depth / 2
    finish, trim, clear = paint("light grey", dirt=0.28), paint("blue", dirt=0.25), pane(0.14)
    s.box((width + 0.5, depth + 0.5, 0.18), (0, 0, 0.09), concrete(light=False), 0.03)
    s.box((width, depth, 0.06), (0, 0, 0.21), plain("cabin floor", (0.10, 0.095, 0.09), 0.8), 0.0)
    for x in (-w, w):
        for y in (-d, d):
            s.box((0.12, 0.12, height), (x * 0.97, y * 0.97, 0.18 + height / 2), trim, 0.01)
    for turn, along, reach in ((0, width, d), (180, width, d), (90, depth, w), (-90, depth, w)):
        with s.at(turn=turn):
            s.box((along, 0.08, 0.95), (0, reach - 0.04, 0.18 + 0.475), finish, 0.0)
            s.box((along, 0.10, 0.28), (0, reach - 0.04, height + 0.02), finish, 0.0)
            s.box((along - 0.2, 0.012, 1.46), (0, reach - 0.05, 1.88), clear, 0.0)
            s.box((along, 0.12, 0.05), (0, reach - 0.03, 1.14), trim, 0.004)
            for x in (-along / 6, along / 6) if along > 2.6 else (0.0,):
                s.box((0.05, 0.06, 1.46), (x, reach - 0.05, 1.88), trim, 0.004)
    s.box((width + 0.9, depth + 0.9, 0.16), (0, 0, 0.18 + height + 0.06), trim, 0.03)
    s.box((width + 0.7, depth + 0.7, 0.05), (0, 0, 0.18 + height + 0.15), paint("light grey", dirt=0.5), 0.01)
    s.box((width - 0.2, depth - 0.2, 0.02), (0, 0, height + 0.10), plain("cabin ceiling", (0.6, 0.6, 0.57), 0.8), 0.0)
    s.box((1.2, 0.25, 0.04), (0, 0, height + 0.07), lit_lens("led", 4.0), 0.0)
    dark = plain("cabin desk", (0.14, 0.09, 0.05), 0.6)
    s.box((0.60, depth - 0.4, 0.05), (w - 0.42, 0, 0.98), dark, 0.008)
    for y in (-0.55, 0.05):
        s.box((0.04, 0.46, 0.30), (w - 0.30, y, 1.24), plain("cabin screen", (0.02, 0.02, 0.02), 0.4), 0.01)
        s.box((0.006, 0.42, 0.26), (w - 0.323, y, 1.24), glowing_face("blue", 0.9), 0.0)
    s.box((0.05, 0.5, 0.6), (-w + 0.12, -0.6, 0.85), paint("red", dirt=0.1), 0.01)
    for turn in (0, 180):
        with s.at(turn=turn), s.at(0, d + 0.46, height + 0.24):
            board(s, 1.5, 0.30, "blue", back=False)
            write(s, name, 0.17, 0, 0, "white")
    return s.built()


def barrier_arm(length: float = 4.2, *, raised: bool = False) -> Built:
    """Build a barrier with a cabinet at the origin and a red and white arm along +x.

    The arm is horizontal at a height of 1.0 m, or raised by 78 degrees.
    """
    s = Solid("barrier arm")
    s.box((0.60, 0.60, 0.10), (0, 0, 0.05), concrete(light=False), 0.02)
    s.box((0.38, 0.42, 1.10), (0, 0, 0.62), paint("yellow", dirt=0.3), 0.03)
    s.box((0.42, 0.46, 0.06), (0, 0, 1.19), paint("dark grey", dirt=0.3), 0.02)
    s.box((0.10, 0.012, 0.14), (0.08, 0.216, 0.85), paint("dark grey"), 0.004)
    with s.at(0, 0.27, 1.0, roll=-78.0 if raised else 0.0):
        s.box((0.30, 0.10, 0.20), (0, 0, 0), paint("dark grey", dirt=0.3), 0.02)
        count = round(length / 0.5)
        for k in range(count):
            s.box(
                (length / count, 0.05, 0.11),
                (0.15 + length * (k + 0.5) / count, 0, 0),
                sheet("red" if k % 2 == 0 else "white", dirt=0.15),
                0.004,
            )
        for k in range(count // 2):
            s.box((0.05, 0.06, 0.04), (0.6 + k * 1.0, 0, 0.075), glow("red", 5.0), 0.006)
        s.box((0.5, 0.12, 0.24), (-0.35, 0, 0), paint("dark grey", dirt=0.3), 0.02)
        if not raised:
            with s.at(length * 0.55, 0.032, 0.0):
                s.lathe([(0.24, 0.0), (0.24, 0.008)], sheet("red"), axis="Y", steps=32)
                s.box((0.36, 0.004, 0.08), (0, 0.011, 0), sheet("white"), 0.0)
    return s.built()


def traffic_head(state: str = "red") -> Built:
    """Build a small red and green lane signal on a post, to be placed next to a barrier."""
    s = Solid("lane signal")
    s.rod((0, 0, 0), (0, 0, 2.1), 0.04, steel())
    s.box((0.22, 0.14, 0.44), (0, 0.02, 2.3), paint("black", dirt=0.1), 0.02)
    for colour, z, strength in (("red", 2.40, 6.0), ("green", 2.20, 14.0)):
        s.lathe(
            [(0.075, 0.09), (0.07, 0.105), (0.03, 0.115)],
            glow(colour, strength) if state == colour else lens(f"dark {colour}"),
            (0, 0, z),
            "Y",
            20,
        )
    return s.built()


def cycle_shelter(length: float = 5.0) -> Built:
    """Build a curved-roof cycle shelter open towards +y, with clear roof panels and a lamp inside."""
    s = Solid("cycle shelter")
    metal, clear = paint("dark green", dirt=0.3), pane(0.22)
    half = length / 2
    arc = [(-1.0 + 2.3 * t, 2.05 + 0.42 * math.sin(math.pi * (0.12 + 0.75 * t))) for t in (k / 8 for k in range(9))]
    for x in (-half, 0.0, half):
        s.tube([(x, -1.0, 0), (x, -1.0, 2.05), *((x, y, z) for y, z in arc)], 0.035, metal)
    for k in range(8):
        (y0, z0), (y1, z1) = arc[k], arc[k + 1]
        s.add([(-half, y0, z0 + 0.04), (half, y0, z0 + 0.04), (half, y1, z1 + 0.04), (-half, y1, z1 + 0.04)], [(0, 1, 2, 3)], clear)
    for y, z in (arc[0], arc[4], arc[8]):
        s.rod((-half, y, z), (half, y, z), 0.025, metal)
    s.box((length, 0.012, 1.5), (0, -1.0, 1.15), clear, 0.0)
    s.box((1.4, 0.10, 0.06), (0, 0.1, 2.36), lit_lens("led", 5.0), 0.01)
    with s.at(0, 1.33, 2.30):
        board(s, 1.4, 0.26, "green", back=False)
        write(s, "CYCLE PARK", 0.13, 0, 0, "white")
    return s.built()


def smoking_shelter() -> Built:
    """Build a small glazed smoking shelter open towards +y, with a bench, an ash bin and a sign."""
    s = Solid("smoking shelter")
    metal, clear = paint("dark grey", dirt=0.3), pane(0.25)
    for x in (-1.3, 1.3):
        for y in (-0.7, 0.7):
            s.box((0.07, 0.07, 2.2), (x, y, 1.1), metal, 0.006)
        s.box((0.012, 1.3, 1.7), (x, 0, 1.15), clear, 0.0)
    s.box((2.6, 0.012, 1.7), (0, -0.7, 1.15), clear, 0.0)
    s.box((2.9, 1.7, 0.08), (0, 0, 2.25), metal, 0.02)
    s.box((2.2, 0.36, 0.05), (0, -0.42, 0.48), paint("brown", dirt=0.3), 0.01)
    for x in (-0.9, 0.9):
        s.box((0.05, 0.30, 0.46), (x, -0.42, 0.23), metal, 0.006)
    s.box((0.22, 0.12, 0.42), (1.05, 0.62, 1.05), paint("black", dirt=0.2), 0.01)
    s.box((1.0, 0.08, 0.05), (0, 0.2, 2.19), lit_lens("warm", 4.0), 0.01)
    with s.at(0, 0.87, 2.28):
        board(s, 1.7, 0.24, "white", back=False)
        write(s, "SMOKING AREA", 0.12, 0, 0, "black")
    return s.built()


def vending_machine(name: str = "FIZZ", colour: str = "red") -> Built:
    """Build a drinks machine, 0.95 x 0.8 x 1.85 m, with a lit window with bottles, a keypad, and a lit panel with its name."""
    s = Solid("vending machine")
    rng = random.Random("vending")
    finish = paint(colour, dirt=0.15)
    s.box((0.95, 0.80, 1.83), (0, 0, 0.935), finish, 0.02)
    s.box((0.90, 0.02, 0.30), (0, 0.402, 1.64), glowing_face("white", 1.6), 0.004)
    s.text(name, 0.17, (0, 0.414, 1.64), paint(colour, dirt=0.0))
    s.box((0.60, 0.02, 1.05), (0.12, 0.40, 0.92), glowing_face("white", 1.1), 0.0)
    for row in range(5):
        for k in range(6):
            tint = rng.choice(["red", "orange", "green", "blue", "yellow", "purple"])
            s.lathe(
                [(0.032, 0.0), (0.032, 0.10), (0.014, 0.13), (0.014, 0.15)],
                paint(tint, dirt=0.0),
                (-0.13 + 0.10 * k, 0.425, 0.44 + 0.20 * row),
                steps=10,
            )
        s.box((0.60, 0.05, 0.015), (0.12, 0.43, 0.43 + 0.20 * row), steel(), 0.0)
    s.box((0.18, 0.02, 0.26), (-0.33, 0.405, 1.15), paint("black"), 0.006)
    s.box((0.12, 0.006, 0.05), (-0.33, 0.418, 1.23), glowing_face("green", 2.0), 0.0)
    s.box((0.60, 0.03, 0.18), (0.12, 0.40, 0.25), lens("black"), 0.006)
    return s.built()


def charge_point(state: str = "green", *, number: str = "") -> Built:
    """Build an electric charge post, 1.5 m high, with a cable, its number, and a status lamp.

    The lamp is "green" (free), "red" (busy) or "unlit".
    """
    s = Solid("charging point")
    s.box((0.40, 0.34, 0.06), (0, 0, 0.03), concrete(light=False), 0.01)
    s.box((0.30, 0.20, 1.34), (0, 0, 0.70), paint("white", dirt=0.2), 0.03)
    s.box((0.305, 0.21, 0.16), (0, 0, 1.44), paint("dark grey", dirt=0.15), 0.03)
    lamp = lens("dark grey") if state == "unlit" else glow(state, 14.0 if state == "green" else 7.0)
    for side in (1, -1):
        s.box((0.24, 0.012, 0.05), (0, side * 0.106, 1.44), lamp, 0.004)
        s.box((0.20, 0.012, 0.20), (0, side * 0.101, 1.16), lens("black"), 0.006)
    s.text("EV", 0.10, (0, 0.103, 0.88), sheet("green"))
    if number:
        s.text(number, 0.09, (0, 0.103, 0.68), sheet("black", dirt=0.05))
    s.lathe([(0.05, 0.0), (0.045, 0.06)], rubber(), (0.17, 0.0, 0.95), "X", 14)
    s.tube([(0.20, 0.0, 0.95), (0.28, 0.04, 0.70), (0.26, 0.08, 0.35), (0.20, 0.14, 0.50), (0.17, 0.10, 0.90)], 0.016, rubber())
    return s.built()
