"""Luggage: wheeled suitcases, backpacks, travel bags."""

from __future__ import annotations

from scope_studio.kit.core.finishes import cloth, paint, rubber, steel
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def suitcase(colour: str = "navy", *, height: float = 0.66, handle: bool = True) -> Built:
    """Build a ribbed hard-shell case on four wheels, with its broad side towards +y.

    If ``handle`` is true, the handle is extended.
    """
    s = Solid(f"{colour} suitcase")
    _case(s, colour, height, handle)
    return s.built()


def _case(s: Solid, colour: str, height: float, handle: bool) -> None:
    shell = paint(colour, dirt=0.12, roughness=0.35)
    w, d = height * 0.66, 0.25
    s.box((w, d, height - 0.07), (0, 0, height / 2 + 0.035), shell, 0.045)
    for k in range(5):
        x = -w / 2 + w * (k + 0.5) / 5
        for y in (-d / 2, d / 2):
            s.box((w * 0.09, 0.014, height * 0.78), (x, y, height / 2 + 0.035), shell, 0.006)
    s.box((w + 0.006, 0.012, height - 0.06), (0, 0, height / 2 + 0.035), paint("black", dirt=0.05), 0.04)
    for x in (-w / 2 + 0.06, w / 2 - 0.06):
        for y in (-d / 2 + 0.05, d / 2 - 0.05):
            s.lathe([(0.026, -0.012), (0.03, 0.0), (0.026, 0.012)], rubber(), (x, y, 0.03), "X", 14)
            s.box((0.05, 0.05, 0.03), (x, y, 0.062), paint("black"), 0.01)
    if handle:
        for x in (-0.09, 0.09):
            s.rod((x, -0.07, height), (x, -0.07, height + 0.36), 0.009, steel())
        s.box((0.24, 0.03, 0.035), (0, -0.07, height + 0.37), paint("black"), 0.012)
    else:
        s.box((0.20, 0.03, 0.025), (0, 0, height + 0.02), paint("black"), 0.01)


def trailing_case(colour: str, hand: Point, *, height: float = 0.66) -> Built:
    """Build a suitcase tilted onto two wheels, as pulled by a person walking towards +y. The end of its handle is at ``hand``."""
    s = Solid(f"{colour} suitcase")
    with s.at(hand[0], hand[1] - 0.62, 0.0, pitch=-38.0):
        _case(s, colour, height, True)
    return s.built()


def backpack(colour: str = "red") -> Built:
    """Build a full backpack that stands on the ground, with its pocket towards +y."""
    s = Solid(f"{colour} backpack")
    finish, strap = cloth(colour), paint("black", dirt=0.1, roughness=0.8)
    s.box((0.32, 0.20, 0.46), (0, 0, 0.23), finish, 0.07)
    s.box((0.25, 0.09, 0.22), (0, 0.12, 0.14), finish, 0.035)
    s.box((0.33, 0.22, 0.10), (0, 0.01, 0.45), finish, 0.045)
    for x in (-0.09, 0.09):
        s.box((0.03, 0.012, 0.20), (x, 0.115, 0.36), strap, 0.003)
        s.tube([(x, -0.10, 0.42), (x * 1.2, -0.16, 0.34), (x * 1.2, -0.15, 0.16), (x, -0.09, 0.08)], 0.016, strap, sides=6)
    s.tube([(-0.05, -0.06, 0.49), (0, -0.07, 0.54), (0.05, -0.06, 0.49)], 0.010, strap, sides=6)
    return s.built()


def travel_bag(colour: str = "brown") -> Built:
    """Build a soft holdall, 0.56 m long, with two handles."""
    s = Solid(f"{colour} travel bag")
    s.box((0.56, 0.27, 0.27), (0, 0, 0.14), cloth(colour), 0.08)
    for y in (-0.09, 0.09):
        s.tube([(-0.14, y, 0.24), (-0.10, y * 0.6, 0.36), (0.10, y * 0.6, 0.36), (0.14, y, 0.24)], 0.012, paint("black"), sides=6)
    return s.built()
