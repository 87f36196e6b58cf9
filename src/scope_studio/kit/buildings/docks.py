"""Loading docks: shelters with roller doors, levellers, traffic lights, wheel guides, numbers.

The wall is the plane y = 0. Fronts face +y.
"""

from __future__ import annotations

from scope_studio.kit.buildings.warehouse import DOCK_HEIGHT_M, DOCK_SILL_M, DOCK_WIDTH_M
from scope_studio.kit.core.finishes import glow, lens, paint, rubber, sheet, steel
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import board, write

OPEN_FRACTION = {"closed": 0.0, "half open": 0.5, "open": 0.94}
"""Fraction of the opening that is free, for each state of the door."""


def roller_door(
    state: str = "closed",
    *,
    width: float = DOCK_WIDTH_M,
    height: float = DOCK_HEIGHT_M,
    sill: float = DOCK_SILL_M,
    colour: str = "light grey",
) -> Built:
    """Build a roller door in its guides. ``state`` is "closed", "half open" or "open"."""
    s = Solid("roller door")
    finish = paint(colour, dirt=0.30)
    low = sill + height * OPEN_FRACTION[state]
    slats = max(1, round((sill + height - low) / 0.115))
    pitch = (sill + height - low) / slats
    for k in range(slats):
        s.box((width - 0.06, 0.035, pitch - 0.008), (0, -0.10 + 0.004 * (k % 2), low + pitch * (k + 0.5)), finish, 0.012)
    s.box((width - 0.06, 0.06, 0.08), (0, -0.10, low + 0.04), rubber(), 0.01)
    for x in (-width / 2, width / 2):
        s.box((0.10, 0.10, height), (x, -0.08, sill + height / 2), steel(), 0.005)
    s.box((width + 0.2, 0.30, 0.34), (0, 0.02, sill + height + 0.10), paint("dark grey", dirt=0.3), 0.02)
    return s.built()


def shelter() -> Built:
    """Build the padded frame that a trailer backs against, with yellow guide stripes and, below it, rubber buffers."""
    s = Solid("dock shelter")
    pad, yellow = rubber(), sheet("yellow", dirt=0.4)
    w, low, height = DOCK_WIDTH_M / 2, DOCK_SILL_M - 0.15, DOCK_HEIGHT_M + 0.35
    for side in (-1, 1):
        x = side * (w + 0.26)
        s.box((0.50, 0.45, height), (x, 0.225, low + height / 2), pad, 0.04)
        s.box((0.10, 0.006, height - 0.3), (x + side * 0.12, 0.453, low + height / 2), yellow, 0.0)
        s.box((0.24, 0.26, 0.48), (side * (w - 0.35), 0.13, DOCK_SILL_M - 0.28), pad, 0.03)
        s.box((0.30, 0.04, 0.56), (side * (w - 0.35), 0.02, DOCK_SILL_M - 0.28), steel(dark=True), 0.006)
    s.box((2 * w + 1.02, 0.45, 0.55), (0, 0.225, low + height + 0.20), pad, 0.04)
    return s.built()


def leveller(*, lowered: bool = True) -> Built:
    """Build a hinged steel dock plate in the sill. If the plate is lowered, its lip hangs down; otherwise, it sticks out."""
    s = Solid("dock leveller")
    z = DOCK_SILL_M
    s.box((2.0, 2.2, 0.04), (0, -1.12, z - 0.02 if lowered else z + 0.10), steel(dark=True), 0.004)
    if lowered:
        s.box((1.9, 0.035, 0.36), (0, 0.0, z - 0.20), steel(), 0.006)
    else:
        s.box((1.9, 0.38, 0.03), (0, 0.16, z + 0.11), steel(), 0.006)
    for x in (-1.02, 1.02):
        s.box((0.05, 0.05, 0.5), (x, 0.02, z - 0.25), sheet("yellow", dirt=0.4), 0.004)
    s.box((2.1, 0.03, 0.40), (0, -0.02, z - 0.55), lens("black"), 0.0)
    return s.built()


def signal(state: str) -> Built:
    """Build a dock traffic light, red over green, on a grey backing board.

    ``state`` is "red", "green" or "unlit". Its back is at y = 0, and it is centred on z = 0.
    """
    s = Solid("dock light")
    s.box((0.30, 0.10, 0.62), (0, 0.05, 0), paint("dark grey", dirt=0.2), 0.02)
    for colour, z, brightness in (("red", 0.15, 6.0), ("green", -0.15, 14.0)):
        on = state == colour
        s.lathe([(0.115, 0.10), (0.12, 0.16), (0.105, 0.17)], paint("black"), (0, 0, z), "Y", 24)
        s.lathe(
            [(0.10, 0.13), (0.095, 0.172), (0.05, 0.190)],
            glow(colour, brightness) if on else lens(f"dark {colour}"),
            (0, 0, z),
            "Y",
            24,
        )
    return s.built()


def number(value: str) -> Built:
    """Build a large dock number on a blue board. Its back is at y = 0, and it is centred on z = 0."""
    s = Solid("dock number")
    with s.at(0, 0.02, 0):
        board(s, 1.20, 1.40, "blue", back=False)
        write(s, value, 1.02, 0, 0, "white")
    return s.built()


def wheel_guides(length: float = 8.0) -> Built:
    """Build two yellow tubes on the floor, along +y, that guide a trailer's wheels."""
    s = Solid("wheel guides")
    yellow = paint("yellow", dirt=0.55)
    for side in (-1, 1):
        x = side * 1.42
        s.tube(
            [(x, 0.3, 0.16), (x, length - 0.8, 0.16), (x + side * 0.35, length, 0.16), (x + side * 0.35, length, 0.0)],
            0.075,
            yellow,
            sides=12,
        )
        for k in range(4):
            s.rod((x, 0.5 + (length - 1.6) * k / 3, 0.0), (x, 0.5 + (length - 1.6) * k / 3, 0.16), 0.05, yellow)
    return s.built()
