"""Mesh fence panels and a site gate. They extend along x, and their fronts face +y."""

from __future__ import annotations

import math
from collections.abc import Sequence

from scope_studio.kit.core.finishes import concrete, paint, sheet, steel
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.works.barriers import striped_plank

FENCE_PANEL_SIZE_M = (3.45, 2.0)
"""Width and height of a temporary mesh fence panel in metres."""


def wire_mesh(s: Solid, width: float, low: float, high: float, cx: float = 0.0, *, pitch: float = 0.11) -> None:
    """Add a wire mesh in the plane y = 0. Vertical wires are closer together than horizontal wires."""
    count = round(width / pitch)
    for i in range(1, count):
        x = cx - width / 2 + width * i / count
        s.tube([(x, 0.003, low), (x, 0.003, high)], 0.0024, steel(), sides=4)
    rows = round((high - low) / 0.24)
    for i in range(1, rows):
        z = low + (high - low) * i / rows
        s.tube([(cx - width / 2, -0.002, z), (cx + width / 2, -0.002, z)], 0.0028, steel(), sides=4)


def frame(s: Solid, width: float, low: float, high: float, cx: float = 0.0, radius: float = 0.02) -> None:
    """Add a rectangular tube frame with a middle rail."""
    a, b = cx - width / 2, cx + width / 2
    s.tube([(a, 0, low), (b, 0, low), (b, 0, high), (a, 0, high)], radius, steel(), closed=True)
    s.rod((a, 0, (low + high) / 2), (b, 0, (low + high) / 2), radius * 0.8, steel())


def mesh_fence_panel(plate: Sequence[str] = ()) -> Built:
    """Build a temporary site fence panel on block feet. ``plate`` contains the lines of a small sign on it."""
    s = Solid("mesh fence panel")
    width, height = FENCE_PANEL_SIZE_M
    frame(s, width - 0.04, 0.16, height)
    wire_mesh(s, width - 0.06, 0.16, height)
    for x in (-width / 2 + 0.02, width / 2 - 0.02):
        s.rod((x, 0, 0.04), (x, 0, 0.16), 0.019, steel())
        s.prism([(-0.36, 0.0), (0.36, 0.0), (0.33, 0.13), (-0.33, 0.13)], (x - 0.11, x + 0.11), concrete(light=False), "YZ")
        s.box((0.09, 0.05, 0.05), (x, 0.0, 1.55), steel(dark=True), 0.01)
    if plate:
        s.box((0.72, 0.006, 0.16 + 0.12 * len(plate)), (0, 0.026, 1.25), sheet("yellow"), 0.001)
        for i, line in enumerate(plate):
            s.text(line, 0.07, (0, 0.0315, 1.25 + 0.06 * (len(plate) - 1) - 0.12 * i), paint("black", dirt=0.0))
    return s.built()


def gate(is_open: bool = False) -> Built:
    """Build a double site gate, 6.2 m between posts and 2.2 m high.

    If closed, the leaves are along x; with ``is_open``, they are swung open towards -y.
    """
    s = Solid("site gate")
    leaf = 3.0
    for sign in (-1, 1):
        s.box((0.14, 0.14, 2.4), (sign * 3.1, 0, 1.2), steel(), 0.01)
        s.lathe([(0.085, 2.4), (0.06, 2.43)], steel(dark=True), (sign * 3.1, 0, 0), steps=4)
        s.box((0.5, 0.5, 0.10), (sign * 3.1, 0, 0.05), concrete(light=False), 0.02)
        with s.at(sign * 3.02, 0, 0, turn=sign * (86.0 if is_open else 0.6)):
            frame(s, leaf, 0.16, 2.2, -sign * leaf / 2, 0.026)
            wire_mesh(s, leaf - 0.04, 0.18, 2.18, -sign * leaf / 2)
            s.rod((-sign * 0.02, 0, 0.18), (-sign * (leaf - 0.02), 0, 2.18), 0.014, steel())
            striped_plank(s, leaf - 0.1, 0.16, -leaf + 0.05 if sign > 0 else 0.05, 0.035, 1.18, 12, 0.012)
            s.rod((-sign * (leaf - 0.08), 0, 0.02), (-sign * (leaf - 0.08), 0, 0.9), 0.013, steel(dark=True))
            s.box((0.9, 0.008, 0.34), (-sign * leaf / 2, 0.034, 1.66), sheet("yellow" if sign > 0 else "white"), 0.001)
            words = ("WORKS", "ENTRANCE") if sign > 0 else ("AUTHORISED", "VEHICLES ONLY")
            for i, line in enumerate(words):
                s.text(line, 0.085, (-sign * leaf / 2, 0.0405, 1.73 - 0.14 * i), paint("black", dirt=0.0))
            for z in (0.45, 1.9):
                s.rod((0.06 * sign, 0, z - 0.05), (0.06 * sign, 0, z + 0.05), 0.03, steel(dark=True))
    if not is_open:
        s.tube(
            [(0.05 * math.cos(a), 0.05 * math.sin(a), 1.05) for a in (k * math.pi / 4 for k in range(8))],
            0.010,
            steel(dark=True),
            closed=True,
        )
        s.box((0.05, 0.025, 0.07), (0.0, 0.06, 0.98), paint("yellow"), 0.008)
    return s.built()
