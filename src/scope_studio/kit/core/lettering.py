"""Lettering as meshes with exact cap heights, in two weights of Blender's built-in sans serif font.

Blender's other Latin fonts are unsuitable: the contours of Inter overlap, so K, R and A are filled incorrectly, and Noto Sans
CJK takes 15 s to load.
"""

from __future__ import annotations

from functools import cache

import bpy

from scope_studio.kit.core.mesh import Point

EMBOLDEN = ((-0.040, -0.026), (-0.040, 0.026), (0.040, -0.026), (0.040, 0.026))
"""Shifts of the copies that together form the bold weight, as multiples of the cap height. Offsetting outlines breaks counters."""


def letters(
    body: str, cap_height_m: float, *, bold: bool = True, spacing: float | None = None
) -> tuple[list[Point], list[tuple[int, ...]]]:
    """Return points and faces of flat letters in the xy plane, with the baseline on y = 0 and the start of the line near x = 0.

    The copies that form the bold weight lie 0.05 mm apart in z.
    """
    outline, polygons = _outline(body, _spacing(bold, spacing))
    points: list[Point] = []
    faces: list[tuple[int, ...]] = []
    grow = max(y for _, y in EMBOLDEN) if bold else 0.0
    for k, (dx, dy) in enumerate(EMBOLDEN if bold else ((0.0, 0.0),)):
        base = len(points)
        scale = cap_height_m / (1 + 2 * grow)
        points += [((x + dx) * scale, (y + dy + grow) * scale, 0.00005 * k) for x, y in outline]
        faces += [tuple(base + i for i in face) for face in polygons]
    return points, faces


def extent(body: str, cap_height_m: float, *, bold: bool = True, spacing: float | None = None) -> float:
    """Return the width of a line in metres."""
    xs = [x for x, _, _ in letters(body, cap_height_m, bold=bold, spacing=spacing)[0]]
    return max(xs) - min(xs) if xs else 0.0


def _spacing(bold: bool, spacing: float | None) -> float:
    """Return the given letter spacing, or the default of the weight."""
    return spacing if spacing is not None else (1.12 if bold else 1.06)


@cache
def _outline(body: str, spacing: float) -> tuple[list[tuple[float, float]], list[tuple[int, ...]]]:
    """Return points and faces of a line with cap height 1."""
    points, faces = _font_mesh(body, spacing)
    cap = max(y for _, y in _font_mesh("H", 1.0)[0])
    return [(x / cap, y / cap) for x, y in points], faces


@cache
def _font_mesh(body: str, spacing: float) -> tuple[list[tuple[float, float]], list[tuple[int, ...]]]:
    """Return points and faces of a line as Blender's font generates them."""
    curve = bpy.data.curves.new("letters", "FONT")
    curve.body = body
    curve.space_character = spacing
    curve.resolution_u = 3
    obj = bpy.data.objects.new("letters", curve)
    mesh = bpy.data.meshes.new_from_object(obj)
    points = [(v.co.x, v.co.y) for v in mesh.vertices]
    faces = [tuple(p.vertices) for p in mesh.polygons]
    bpy.data.objects.remove(obj)
    bpy.data.curves.remove(curve)
    bpy.data.meshes.remove(mesh)
    return points, faces
