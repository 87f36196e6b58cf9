"""Emissive materials of lit lamps and illuminated signs."""

from __future__ import annotations

import bpy

from scope_studio.kit.core.shading import Shader
from scope_studio.kit.light import dusk


def glowing_face(colour: str, strength: float) -> bpy.types.Material:
    """Return the material of the translucent face of an illuminated sign."""
    rgb = {
        "white": (0.95, 0.97, 1.0),
        "blue": (0.08, 0.28, 0.95),
        "green": (0.05, 0.75, 0.25),
        "red": (0.9, 0.06, 0.04),
        "amber": (1.0, 0.45, 0.05),
    }
    name = f"sign glow {colour} {strength:g}"
    return bpy.data.materials.get(name) or Shader(name).surface(
        base_color=rgb[colour], emission_color=rgb[colour], emission_strength=strength, roughness=0.5
    )


def lit_lens(kind: str, strength: float = 5.0) -> bpy.types.Material:
    """Return the emissive material of a lamp's lens. ``kind`` is "sodium", "led" or "warm"."""
    rgb = {"sodium": dusk.SODIUM, "led": dusk.LED, "warm": dusk.WARM}[kind]
    name = f"lit lens {kind} {strength:g}"
    return bpy.data.materials.get(name) or Shader(name).surface(
        base_color=rgb, emission_color=rgb, emission_strength=strength, roughness=0.4
    )
