"""Create mesh objects: boxes, surfaces of revolution, tubes, text."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bmesh
import bpy

from scope_studio.kit.core.stage import TextMark

Point = tuple[float, float, float]


def from_data(
    name: str,
    points: Sequence[Point],
    faces: Sequence[Sequence[int]],
    material: bpy.types.Material | None = None,
    *,
    smooth: bool = False,
) -> bpy.types.Object:
    """Create an object from vertices and polygons and link it to the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(list(points), [], [list(f) for f in faces])
    mesh.update()
    if smooth:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if material is not None:
        mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def box(
    name: str, size: Point, centre: Point, material: bpy.types.Material | None = None, *, bevel_m: float = 0.01, segments: int = 2
) -> bpy.types.Object:
    """Create a box with bevelled edges. ``size`` and ``centre`` are in metres."""
    mesh = bpy.data.meshes.new(name)
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=1.0)
    bmesh.ops.scale(bm, vec=size, verts=bm.verts)
    if bevel_m > 0:
        width = min(bevel_m, min(size) * 0.45)
        bmesh.ops.bevel(bm, geom=bm.edges[:], offset=width, segments=segments, profile=0.5, affect="EDGES")
    bmesh.ops.translate(bm, vec=centre, verts=bm.verts)
    bm.to_mesh(mesh)
    bm.free()
    if material is not None:
        mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def lathe(
    name: str,
    profile: Sequence[tuple[float, float]],
    material: bpy.types.Material | None = None,
    *,
    steps: int = 32,
    axis: str = "Z",
) -> bpy.types.Object:
    """Create a surface of revolution from ``(radius, height)`` pairs about ``axis`` through the origin ("Z", or "X" for wheels)."""
    points: list[Point] = []
    for radius, height in profile:
        for k in range(steps):
            a = 2 * math.pi * k / steps
            u, v = radius * math.cos(a), radius * math.sin(a)
            points.append((u, v, height) if axis == "Z" else (height, u, v))
    faces = []
    for ring in range(len(profile) - 1):
        for k in range(steps):
            a, b = ring * steps + k, ring * steps + (k + 1) % steps
            faces.append((a, b, b + steps, a + steps))
    faces.append(tuple(range(steps))[::-1])
    faces.append(tuple(range((len(profile) - 1) * steps, len(profile) * steps)))
    return from_data(name, points, faces, material, smooth=True)


def tube(
    name: str, path: Sequence[Point], radius_m: float, material: bpy.types.Material | None = None, *, sides: int = 8
) -> bpy.types.Object:
    """Create a round tube along a path, as a mesh."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = radius_m
    curve.bevel_resolution = max(0, sides // 4 - 1)
    curve.use_fill_caps = True
    spline = curve.splines.new("POLY")
    spline.points.add(len(path) - 1)
    for point, (x, y, z) in zip(spline.points, path, strict=True):
        point.co = (x, y, z, 1.0)
    obj = bpy.data.objects.new(name, curve)
    bpy.context.scene.collection.objects.link(obj)
    if material is not None:
        curve.materials.append(material)
    return to_mesh(obj)


def to_mesh(obj: bpy.types.Object) -> bpy.types.Object:
    """Replace a curve, text or modified object with its evaluated mesh, in place."""
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph)
    converted = bpy.data.objects.new(obj.name, mesh)
    converted.matrix_world = obj.matrix_world.copy()
    bpy.context.scene.collection.objects.link(converted)
    bpy.data.objects.remove(obj, do_unlink=True)
    return converted


def join(name: str, parts: Sequence[bpy.types.Object]) -> bpy.types.Object:
    """Join mesh objects into one object, which renders and exports faster. The original objects are removed."""
    with bpy.context.temp_override(active_object=parts[0], selected_editable_objects=list(parts), selected_objects=list(parts)):
        bpy.ops.object.join()
    parts[0].name = name
    return parts[0]


def text(
    name: str,
    body: str,
    cap_height_m: float,
    centre: Point,
    material: bpy.types.Material,
    *,
    facing: str = "-Y",
    font: bpy.types.VectorFont | None = None,
    align: str = "CENTER",
    thickness_m: float = 0.002,
) -> tuple[bpy.types.Object, TextMark]:
    """Create flat lettering and its text mark.

    Args:
        facing: Direction that the lettering faces: "-Y", "+Y", "+X", "-X" or "+Z".
        centre: Centre of the text block if ``align`` is "CENTER", or its left edge if ``align`` is "LEFT".

    Returns:
        The object, and its text mark with the measured size of the text.
    """
    curve = bpy.data.curves.new(name, "FONT")
    curve.body = body
    if font is not None:
        curve.font = font
    curve.align_x, curve.align_y = align, "CENTER"
    curve.extrude = thickness_m / 2
    text_object = bpy.data.objects.new(name, curve)
    bpy.context.scene.collection.objects.link(text_object)
    curve.body = "H"
    bpy.context.view_layer.update()
    curve.size = cap_height_m / max(text_object.dimensions.y, 1e-6)
    curve.body = body
    curve.materials.append(material)
    bpy.context.view_layer.update()
    obj = to_mesh(text_object)
    xs = [v.co.x for v in obj.data.vertices]
    ys = [v.co.y for v in obj.data.vertices]
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    middle = ((max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2)
    right, up = {
        "-Y": ((1, 0, 0), (0, 0, 1)),
        "+Y": ((-1, 0, 0), (0, 0, 1)),
        "+X": ((0, 1, 0), (0, 0, 1)),
        "-X": ((0, -1, 0), (0, 0, 1)),
        "+Z": ((1, 0, 0), (0, 1, 0)),
    }[facing]
    normal = (
        right[1] * up[2] - right[2] * up[1],
        right[2] * up[0] - right[0] * up[2],
        right[0] * up[1] - right[1] * up[0],
    )
    for v in obj.data.vertices:
        x, y, z = v.co
        v.co = tuple(centre[i] + right[i] * x + up[i] * y + normal[i] * z for i in range(3))
    mark_centre = tuple(centre[i] + right[i] * middle[0] + up[i] * middle[1] for i in range(3))
    return obj, TextMark(body, mark_centre, right, up, width, height, cap_height_m)
