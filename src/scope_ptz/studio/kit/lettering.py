"""Lettering as meshes, with exact cap heights: one clean sans face (Inter, which Blender carries) at two weights."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import bpy

from scope_ptz.studio.kit.mesh import Point

FONT_FILE = "Inter.woff2"
BOLD_OFFSET = 0.021
"""Outline growth that turns the regular weight into a road-sign bold, in em."""


def sans() -> bpy.types.VectorFont:
    """The kit's font, loaded once."""
    for font in bpy.data.fonts:
        if font.filepath.endswith(FONT_FILE):
            return font
    return bpy.data.fonts.load(str(Path(bpy.utils.system_resource("DATAFILES", path="fonts")) / FONT_FILE))


def letters(
    body: str, cap_height_m: float, *, bold: bool = True, spacing: float = 1.04
) -> tuple[list[Point], list[tuple[int, ...]]]:
    """Flat letters in the xy plane, baseline of the (single) line on y = 0, starting near x = 0. Returns points and faces."""
    scale = cap_height_m / _cap_height_em(bold)
    points, faces = _outline(body, bold, spacing)
    low = BOLD_OFFSET if bold else 0.0
    return [(x * scale, (y + low) * scale, 0.0) for x, y in points], faces


@cache
def _cap_height_em(bold: bool) -> float:
    points, _ = _outline("H", bold, 1.0)
    return max(y for _, y in points) - min(y for _, y in points)


@cache
def _outline(body: str, bold: bool, spacing: float) -> tuple[list[tuple[float, float]], list[tuple[int, ...]]]:
    curve = bpy.data.curves.new("letters", "FONT")
    curve.body = body
    curve.font = sans()
    curve.offset = BOLD_OFFSET if bold else 0.0
    curve.space_character = spacing
    curve.resolution_u = 4
    obj = bpy.data.objects.new("letters", curve)
    mesh = bpy.data.meshes.new_from_object(obj)
    points = [(v.co.x, v.co.y) for v in mesh.vertices]
    faces = [tuple(p.vertices) for p in mesh.polygons]
    bpy.data.objects.remove(obj)
    bpy.data.curves.remove(curve)
    bpy.data.meshes.remove(mesh)
    return points, faces
