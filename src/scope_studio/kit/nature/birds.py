"""Pigeons that stand, peck or sit."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix, Vector

from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.core.volumes import SurfaceMesh, Volume

PLUMAGE = {
    "grey": ((0.16, 0.175, 0.20), (0.30, 0.32, 0.35)),
    "dark grey": ((0.045, 0.05, 0.06), (0.085, 0.09, 0.10)),
    "brown": ((0.16, 0.075, 0.045), (0.34, 0.27, 0.22)),
    "white": ((0.62, 0.62, 0.60), (0.75, 0.75, 0.73)),
}
"""Back and wing colours of a pigeon (linear RGB), by plain colour name."""


def pigeon(colour: str = "grey", *, pose: str = "stand") -> Built:
    """Build a town pigeon facing +y, about 0.30 m long. ``pose`` is "stand", "peck" (head down) or "rest" (sitting)."""
    s = Solid(f"{colour} pigeon")
    lift = {"stand": 0.0, "peck": -0.004, "rest": -0.055}[pose]
    tip = Matrix.Rotation(-0.32 if pose == "peck" else 0.18 if pose == "stand" else 0.0, 4, "X")
    body = Matrix.Translation((0, 0, 0.135 + lift)) @ tip
    surface = _body(body, pose)
    rest = [tuple(body.inverted() @ Vector(p)) for p in surface[0]]
    s.add(surface[0].tolist(), surface[1], _feathers(colour), rest)
    head = body @ _HEAD_POSITIONS[pose]
    beak = plain("pigeon beak", (0.03, 0.028, 0.03), 0.4)
    aim = ((body @ (_HEAD_POSITIONS[pose] + _BEAK_DIRECTIONS[pose])) - head).normalized()
    s.rod(tuple(head + aim * 0.022), tuple(head + aim * 0.046), 0.006, beak, radius_b=0.0015, sides=8)
    s.box(
        (0.012, 0.008, 0.007),
        tuple(head + aim * 0.025 + Vector((0, 0, 0.005))),
        plain("pigeon cere", (0.7, 0.68, 0.66), 0.6),
        0.002,
    )
    eye = plain("pigeon eye", (0.75, 0.16, 0.01), 0.15)
    for side in (-1, 1):
        centre = tuple(head + Vector((side * 0.0165, 0.006, 0.006)))
        s.lathe([(0.001, -0.002), (0.0045, 0.0), (0.001, 0.002)], eye, centre, "X", 8)
        if pose != "rest":
            _leg(s, side, body)
    return s.built()


_HEAD_POSITIONS = {"stand": Vector((0, 0.115, 0.105)), "peck": Vector((0, 0.158, -0.058)), "rest": Vector((0, 0.085, 0.065))}
"""Position of the head in metres, by pose."""
_BEAK_DIRECTIONS = {"stand": Vector((0, 1, -0.30)), "peck": Vector((0, 0.65, -0.9)), "rest": Vector((0, 1, -0.1))}
"""Direction of the beak, by pose."""


def _body(frame: Matrix, pose: str) -> SurfaceMesh:
    """Return body, neck, head, folded wings and tail as one surface, transformed by ``frame``."""
    v = Volume()
    v.ellipsoid((0, 0.02, 0.0), (0.058, 0.088, 0.056))
    v.ellipsoid((0, -0.055, 0.004), (0.046, 0.082, 0.040))
    head = _HEAD_POSITIONS[pose]
    v.capsule((0, 0.065, 0.022), tuple(Vector((0, 0.065, 0.022)).lerp(head, 0.9)), 0.042, 0.021)
    v.ellipsoid(tuple(head), (0.0195, 0.026, 0.0205))
    for side in (-1, 1):
        v.capsule((side * 0.050, 0.045, 0.010), (side * 0.020, -0.155, 0.012), 0.032, 0.011, flat=0.42, across=(0, 0, 1))
    v.capsule((0, -0.10, 0.0), (0, -0.20, -0.012), 0.034, 0.030, flat=0.22, across=(1, 0, 0))
    points, faces = v.merge(0.006, 2)
    turn = np.array(frame)
    return points @ turn[:3, :3].T + turn[:3, 3], faces


def _leg(s: Solid, side: int, body: Matrix) -> None:
    pink = plain("pigeon legs", (0.48, 0.12, 0.10), 0.6)
    y = 0.004 + side * 0.018
    top = body @ Vector((side * 0.024, -0.005, -0.045))
    s.tube([tuple(top), (side * 0.024, y - 0.010, 0.035), (side * 0.024, y, 0.006)], 0.0042, pink, sides=6)
    for dx, dy in ((-0.016, 0.030), (0.0, 0.036), (0.016, 0.030), (0.0, -0.018)):
        s.rod((side * 0.024, y, 0.005), (side * 0.024 + dx, y + dy, 0.003), 0.0035, pink, radius_b=0.002, sides=6)


def _feathers(colour: str) -> bpy.types.Material:
    """Return the material of plumage with a dark head, a sheen on the neck, two wing bars and a dark tail tip."""
    name = f"pigeon {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    coords = s.node("ShaderNodeAttribute", attribute_name="rest").outputs["Vector"]
    x, y, z = s.xyz(coords)
    dark, pale = PLUMAGE[colour]
    tone = s.mix(s.ramp(s.math("ABSOLUTE", x), 0.030, 0.042), dark, pale)
    tone = s.mix(s.ramp(s.noise(coords, 70.0, 3.0), 0.35, 0.65, 0.0, 0.35), tone, tuple(c * 0.6 for c in dark))
    neck = s.math("ADD", y, s.math("MULTIPLY", z, 0.7))
    collar = s.band(neck, 0.10, 0.158, 0.012)
    sheen = s.mix(s.ramp(s.noise(coords, 26.0, 2.0), 0.4, 0.6), (0.025, 0.13, 0.075), (0.13, 0.035, 0.12))
    tone = s.mix(s.ramp(neck, 0.148, 0.165), tone, tuple(c * 0.55 for c in dark))
    tone = s.mix(collar, tone, sheen if colour != "white" else pale)
    slant = s.math("ADD", y, s.math("MULTIPLY", z, 0.6))
    side = s.ramp(s.math("ABSOLUTE", x), 0.020, 0.034)
    bars = s.math("MAXIMUM", s.band(slant, -0.060, -0.042, 0.003), s.band(slant, -0.105, -0.088, 0.003))
    ink = (0.018, 0.018, 0.022) if colour != "white" else pale
    tone = s.mix(s.math("MULTIPLY", bars, side), tone, ink)
    tone = s.mix(s.ramp(y, -0.178, -0.190), tone, ink)
    return s.surface(base_color=tone, roughness=0.55, normal=s.bump(s.noise(coords, 160.0, 2.0), 0.3, 0.002))
