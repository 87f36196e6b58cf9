"""Materials and small fittings that heavy vehicles and machines share."""

from __future__ import annotations

import bpy
from mathutils import Matrix

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts, Point2D
from scope_studio.kit.vehicles import paintwork as pw

DARK_PAINTS = {"black", "blue", "dark blue", "red", "dark red", "green", "dark green", "grey", "purple", "brown"}
"""Paint colours on which lettering is white."""


def lettering_colour(colour: str) -> str:
    """Return the lettering colour that is easiest to read on a paint colour."""
    return "white" if colour in DARK_PAINTS else "dark blue"


def set_side(parts: Parts, sign: int) -> None:
    """Set the matrix of ``parts``, so that parts are added as modelled (``sign`` +1) or mirrored to the left side (-1)."""
    parts.matrix = Matrix.Scale(sign, 4, (1, 0, 0))


def aluminium() -> bpy.types.Material:
    """Return the material of plain aluminium parts."""
    return shading.plain("lorry aluminium", (0.50, 0.51, 0.52), 0.38, 0.7)


def seats_behind_glass(parts: Parts, places: list[Point2D], sill: float, face: float, axis: str) -> None:
    """Add flat seat backs with headrests directly behind glass.

    ``places`` are positions (horizontal, height) in the plane that is normal to ``axis`` at ``face``.
    """
    cloth = shading.plain("lorry seat cloth", (0.10, 0.105, 0.12), 0.9)
    for across, height in places:
        for half, low, high in ((0.24, 0.0, 0.46), (0.13, 0.49, 0.62)):
            z0, z1 = height + sill + low, height + sill + high
            outline = [
                (across - half, z0),
                (across + half, z0),
                (across + half * 0.94, z1 - 0.05),
                (across + half * 0.7, z1),
                (across - half * 0.7, z1),
                (across - half * 0.94, z1 - 0.05),
            ]
            parts.prism(outline, face - 0.01, face + 0.002, cloth, axis=axis)


def iron() -> bpy.types.Material:
    """Return the material of dark iron parts."""
    return shading.plain("machine iron", (0.022, 0.022, 0.023), 0.6)


def chrome() -> bpy.types.Material:
    """Return the material of chromed parts."""
    return shading.plain("machine chrome", (0.65, 0.66, 0.67), 0.15, 1.0)


def worn_steel() -> bpy.types.Material:
    """Return the material of worn steel with rust."""
    existing = bpy.data.materials.get("machine worn steel")
    if existing is not None:
        return existing
    sh = shading.Shader("machine worn steel")
    rust = sh.ramp(sh.noise(sh.object_coords(), 7.0, detail=6.0), 0.45, 0.65)
    return sh.surface(base_color=sh.mix(rust, (0.16, 0.155, 0.15), (0.085, 0.055, 0.038)), roughness=0.55, metallic=0.5)


def machine_paint(model: str, colour: str) -> bpy.types.Material:
    """Return the material of a machine's paint, with dirt."""
    return pw.paint(model, colour, dirt_top_m=1.3, dirt=0.6, gloss=0.2)


def beacon(parts: Parts, x: float, y: float, z: float) -> None:
    """Add an orange warning beacon at a position."""
    parts.lathe([(0.055, 0.0), (0.055, 0.05)], (x, y, z), pw.black_trim(), steps=16)
    parts.lathe([(0.062, 0.05), (0.062, 0.16), (0.045, 0.19), (0.01, 0.195)], (x, y, z), pw.lamp("beacon"), steps=16)
