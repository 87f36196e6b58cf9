"""Standing or walking dogs, with or without a lead."""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

from scope_studio.kit.core.finishes import paint
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.core.volumes import Volume, crease

COATS = {
    "black": ((0.010, 0.009, 0.009), (0.022, 0.020, 0.019)),
    "golden": ((0.30, 0.16, 0.055), (0.46, 0.30, 0.13)),
    "brown": ((0.075, 0.034, 0.016), (0.13, 0.065, 0.03)),
    "white": ((0.55, 0.53, 0.49), (0.68, 0.66, 0.62)),
}
"""Darkest and lightest tone of a dog's coat (linear RGB), by plain colour name."""


def dog(colour: str = "black", *, phase: float | None = None, lead_to: Point | None = None, collar: str = "red") -> Built:
    """Build a labrador-like dog facing +y, 0.55 m at the shoulder.

    Args:
        phase: Gait phase in [0, 1) of a walking dog; None for a standing one.
        lead_to: Position of the hand that holds the lead; None for no lead.
    """
    s = Solid(f"{colour} dog")
    v = Volume()
    v.ellipsoid((0, 0.17, 0.43), (0.112, 0.18, 0.135))
    v.ellipsoid((0, -0.08, 0.450), (0.098, 0.21, 0.104))
    v.ellipsoid((0, -0.24, 0.45), (0.100, 0.13, 0.115))
    v.capsule((0, 0.26, 0.49), (0, 0.40, 0.63), 0.075, 0.062)
    v.ellipsoid((0, 0.43, 0.665), (0.065, 0.085, 0.062))
    v.capsule((0, 0.48, 0.652), (0, 0.595, 0.632), 0.042, 0.033)
    for side in (-1, 1):
        v.capsule((side * 0.052, 0.40, 0.705), (side * 0.078, 0.405, 0.615), 0.026, 0.020, flat=0.45, across=(0, 1, 0))
        for front in (True, False):
            _leg(v, side, front, phase)
    wag = 0.05 * math.sin(2 * math.pi * (phase or 0.0))
    v.capsule((0, -0.33, 0.49), (wag, -0.47, 0.45), 0.030, 0.021)
    v.capsule((wag, -0.47, 0.45), (2 * wag, -0.60, 0.50), 0.021, 0.011)
    surface = crease(v.merge(0.011, 3), 0.0025, (30.0, 12.0, 30.0), 3.0)
    s.add(surface[0].tolist(), surface[1], _coat(colour))
    dark = plain("dog nose", (0.008, 0.007, 0.007), 0.25)
    s.lathe([(0.008, 0.0), (0.017, 0.008), (0.006, 0.020)], dark, (0, 0.613, 0.648), "Y", 12)
    for side in (-1, 1):
        s.lathe([(0.001, 0.0), (0.008, 0.004), (0.002, 0.009)], dark, (side * 0.033, 0.497, 0.688), "Y", 10)
    ring = _collar()
    s.tube(ring, 0.010, paint(collar, dirt=0.1), sides=6, closed=True)
    if lead_to is not None:
        a, b = Vector((0, 0.30, 0.62)), Vector(lead_to)
        slack = [a.lerp(b, t / 8) - Vector((0, 0, 0.16 * math.sin(math.pi * t / 8))) for t in range(9)]
        s.tube([tuple(p) for p in slack], 0.006, paint(collar, dirt=0.1), sides=6)
    return s.built()


def _leg(v: Volume, side: int, front: bool, phase: float | None) -> None:
    """Add one leg, posed for the gait phase."""
    y, x = (0.20, 0.062) if front else (-0.27, 0.062)
    swing, lift = 0.0, 0.0
    if phase is not None:
        a = 2 * math.pi * (phase + (0.0 if (side > 0) == front else 0.5))
        swing, lift = 0.11 * math.sin(a), 0.05 * max(0.0, math.cos(a))
    knee = (side * x, y + (0.02 if front else 0.05) + swing * 0.4, 0.27 + lift * 0.5)
    heel = (side * x, y + (0.0 if front else -0.055) + swing * 0.8, 0.14 + lift)
    foot = (side * x, y + 0.005 + swing, 0.030 + lift)
    v.capsule((side * (x - 0.005), y, 0.42), knee, 0.072 if not front else 0.060, 0.042)
    v.capsule(knee, heel, 0.041, 0.029)
    v.capsule(heel, foot, 0.029, 0.028)
    v.capsule((foot[0], foot[1] - 0.005, foot[2] - 0.004), (foot[0], foot[1] + 0.05, foot[2] - 0.008), 0.027, 0.024)


def _collar() -> list[Point]:
    """Return the points of a collar around the neck."""
    middle, along = Vector((0, 0.335, 0.565)), Vector((0, 0.14, 0.14)).normalized()
    u, v = Vector((1, 0, 0)), along.cross(Vector((1, 0, 0)))
    return [tuple(middle + 0.073 * (u * math.cos(a) + v * math.sin(a))) for a in (math.pi * k / 10 for k in range(20))]


def _coat(colour: str) -> bpy.types.Material:
    """Return the material of a dog's coat."""
    name = f"dog {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    hair = s.noise(s.scaled(s.object_coords(), (60.0, 22.0, 60.0)), 1.0, 4.0, 0.6, 0.4)
    low, high = COATS[colour]
    return s.surface(base_color=s.mix(s.ramp(hair, 0.3, 0.7), low, high), roughness=0.55, normal=s.bump(hair, 0.5, 0.006))
