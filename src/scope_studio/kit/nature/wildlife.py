"""Wild animals: a standing or trotting fox."""

from __future__ import annotations

import math

import bpy

from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.core.volumes import Volume

TROT_STRIDE_M = 0.78
"""Length in metres of one gait cycle of a trotting fox."""


def fox(*, phase: float | None = None) -> Built:
    """Build a red fox facing +y, 0.38 m at the shoulder and 1.1 m long with its tail. With a ``phase`` in [0, 1), it trots."""
    s = Solid("fox")
    v = Volume()
    v.ellipsoid((0, 0.15, 0.315), (0.070, 0.125, 0.088))
    v.ellipsoid((0, -0.02, 0.325), (0.064, 0.16, 0.074))
    v.ellipsoid((0, -0.17, 0.325), (0.068, 0.10, 0.082))
    v.capsule((0, 0.21, 0.35), (0, 0.30, 0.43), 0.052, 0.045)
    v.ellipsoid((0, 0.335, 0.455), (0.056, 0.062, 0.048))
    v.capsule((0, 0.37, 0.443), (0, 0.455, 0.428), 0.030, 0.014)
    for side in (-1, 1):
        v.capsule((side * 0.034, 0.315, 0.49), (side * 0.047, 0.312, 0.555), 0.022, 0.006, flat=0.5)
        for front in (True, False):
            _leg(v, side, front, phase)
    sway = 0.03 * math.sin(2 * math.pi * (phase or 0.0))
    v.capsule((0, -0.25, 0.335), (sway * 0.5, -0.38, 0.29), 0.030, 0.050)
    v.capsule((sway * 0.5, -0.38, 0.29), (sway, -0.58, 0.26), 0.052, 0.046)
    v.capsule((sway, -0.58, 0.26), (sway * 1.3, -0.70, 0.265), 0.044, 0.012)
    points, faces = v.merge(0.009, 3)
    s.add(points.tolist(), faces, _coat(), points.tolist())
    dark = plain("fox nose", (0.008, 0.007, 0.007), 0.3)
    s.lathe([(0.004, 0.0), (0.010, 0.006), (0.004, 0.012)], dark, (0, 0.463, 0.430), "Y", 10)
    for side in (-1, 1):
        s.lathe(
            [(0.001, 0.0), (0.007, 0.004), (0.002, 0.008)],
            plain("fox eye", (0.10, 0.06, 0.01), 0.15),
            (side * 0.030, 0.375, 0.468),
            "Y",
            10,
        )
    return s.built()


def _leg(v: Volume, side: int, front: bool, phase: float | None) -> None:
    """Add one leg, posed for the gait phase."""
    y, x = (0.17, 0.040) if front else (-0.19, 0.040)
    swing = lift = 0.0
    if phase is not None:
        a = 2 * math.pi * (phase + (0.0 if (side > 0) == front else 0.5))
        swing, lift = 0.12 * math.sin(a), 0.045 * max(0.0, math.cos(a))
    knee = (side * x, y + (0.015 if front else 0.035) + swing * 0.4, 0.185 + lift * 0.5)
    heel = (side * x, y + (0.0 if front else -0.045) + swing * 0.8, 0.10 + lift)
    foot = (side * x, y + swing, 0.020 + lift)
    v.capsule((side * x, y, 0.29), knee, 0.042, 0.026)
    v.capsule(knee, heel, 0.025, 0.018)
    v.capsule(heel, foot, 0.018, 0.017)
    v.capsule(foot, (foot[0], foot[1] + 0.032, foot[2] - 0.003), 0.018, 0.015)


def _coat() -> bpy.types.Material:
    """Return the material of a fox's coat: red above, with white throat, belly and tail tip, and black legs and ears."""
    existing = bpy.data.materials.get("fox coat")
    if existing is not None:
        return existing
    s = Shader("fox coat")
    rest = s.node("ShaderNodeAttribute", attribute_name="rest").outputs["Vector"]
    _, y, z = s.xyz(rest)
    hair = s.noise(s.scaled(rest, (70.0, 26.0, 70.0)), 1.0, 4.0, 0.6, 0.4)
    colour = s.mix(s.ramp(hair, 0.3, 0.7), (0.24, 0.075, 0.018), (0.42, 0.165, 0.045))
    stocking = s.math("MULTIPLY", s.ramp(z, 0.16, 0.20, 1.0, 0.0), s.ramp(y, -0.32, -0.29))
    colour = s.mix(stocking, colour, (0.014, 0.012, 0.011))
    colour = s.mix(s.ramp(z, 0.525, 0.54), colour, (0.014, 0.012, 0.011))
    colour = s.mix(s.ramp(y, -0.66, -0.60, 1.0, 0.0), colour, (0.62, 0.60, 0.55))
    throat = s.math(
        "MULTIPLY", s.ramp(y, 0.20, 0.24), s.ramp(s.math("SUBTRACT", z, s.math("MULTIPLY", y, 0.42)), 0.255, 0.285, 1.0, 0.0)
    )
    colour = s.mix(throat, colour, (0.58, 0.55, 0.50))
    return s.surface(base_color=colour, roughness=0.65, normal=s.bump(hair, 0.5, 0.005))
