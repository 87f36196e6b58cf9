"""Car bodies: lofted shells with windows, number plates, lettering, and the assembly of a painted vehicle."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import bmesh
import bpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from scope_studio.kit.core import lettering, shading
from scope_studio.kit.core.parts import Parts, Point, Point2D
from scope_studio.kit.core.stage import Built, TextMark
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles import wheels


@dataclass(frozen=True)
class Station:
    """A cross-section of a body at ``y``.

    ``section`` contains the right-hand ``(x, z)`` points, from the centre of the floor to the centre of the roof. ``dy`` moves
    individual points along y, which slants and curves the section.
    """

    y: float
    section: Sequence[Point2D]
    dy: dict[int, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Pane:
    """A window between two stations and two rows of section points, on both sides or, with ``across``, across the centre line.

    ``frame_m`` is the width of its black frame.
    """

    stations: tuple[int, int]
    rows: tuple[int, int]
    across: bool = False
    frame_m: float = 0.025
    tinted: bool = False


def shell(
    stations: Sequence[Station],
    panes: Sequence[Pane],
    *,
    creases: Sequence[tuple[int, float, int, int]],
    bulge: tuple[float, float],
    cutters: Parts | None = None,
    levels: int = 3,
) -> bpy.types.Mesh:
    """Return a closed body, lofted through ``stations`` from front to rear and subdivided, with windows framed in black trim.

    Args:
        creases: Edges to sharpen: (row, strength, first station, last station).
        bulge: Distances in metres by which the front and the rear bulge outwards.
        cutters: Solids to subtract (wheel arches). The cut faces keep the material of the cutter.
    """
    bm = bmesh.new()
    crease = bm.edges.layers.float.new("crease_edge")
    corner = bm.verts.layers.float.new("crease_vert")
    rows = len(stations[0].section)
    ring = 2 * rows - 2
    grid = [[bm.verts.new(_ring_point(s, j, rows)) for j in range(ring)] for s in stations]
    quads = {}
    for i in range(len(grid) - 1):
        for j in range(ring):
            k = (j + 1) % ring
            quads[i, j] = bm.faces.new((grid[i][j], grid[i + 1][j], grid[i + 1][k], grid[i][k]))
    for end, bulge_m in ((grid[0], bulge[0]), (grid[-1], -bulge[1])):
        _cap(bm, end, rows, bulge_m)
    bm.edges.ensure_lookup_table()
    for row, strength, first, last in creases:
        for column in {row, (ring - row) % ring}:
            for i in range(first, min(last, len(grid) - 1)):
                bm.edges.get((grid[i][column], grid[i + 1][column]))[crease] = strength
    for pane in panes:
        span = range(*pane.stations)
        right = [quads[i, j] for i in span for j in range(*pane.rows)]
        left = [quads[i, ring - 1 - j] for i in span for j in range(*pane.rows)]
        for region in [right + left] if pane.across else [right, left]:
            _glaze(bm, region, pane, crease, corner)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])
    data = bpy.data.meshes.new("shell")
    bm.to_mesh(data)
    bm.free()
    for material in (pw.paint_slot(), pw.black_trim(), pw.clear_glass(), pw.clear_glass(0.78)):
        data.materials.append(material)
    data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
    return _evaluate(data, cutters, levels)


def _ring_point(station: Station, j: int, rows: int) -> Point:
    """Return point ``j`` of a station's closed ring: first the right side upwards, then the left side downwards."""
    row = j if j < rows else 2 * rows - 2 - j
    x, z = station.section[row]
    return (x if j < rows else -x, station.y + station.dy.get(row, 0.0), z)


def _cap(bm: bmesh.types.BMesh, end: list[bmesh.types.BMVert], rows: int, bulge_m: float) -> None:
    """Close an end of the body with quads that bulge outwards by ``bulge_m`` metres."""
    ring = 2 * rows - 2
    spine = [end[0]]
    for row in range(2, rows - 2):
        middle = end[row].co.copy()
        middle.x, middle.y = 0.0, middle.y + bulge_m
        spine.append(bm.verts.new(middle))
    spine.append(end[rows - 1])
    for step in range(rows - 3):
        low, high = step + 1, step + 2
        bm.faces.new((end[low], end[high], spine[step + 1], spine[step]))
        bm.faces.new((spine[step], spine[step + 1], end[ring - high], end[ring - low]))


def _glaze(
    bm: bmesh.types.BMesh,
    region: list[bmesh.types.BMFace],
    pane: Pane,
    crease: bmesh.types.BMLayerItem,
    corner: bmesh.types.BMLayerItem,
) -> None:
    """Turn a region of faces into a window with a sharp frame of black trim."""
    bmesh.ops.inset_region(bm, faces=region, thickness=pane.frame_m, use_even_offset=True, use_boundary=True)
    _crease_border(region, 0.9, crease, corner)
    rim = bmesh.ops.inset_region(bm, faces=region, thickness=0.016, depth=-0.010, use_even_offset=True, use_boundary=True)
    _crease_border(region, 0.9, crease, corner)
    for face in rim["faces"]:
        face.material_index = 1
    for face in region:
        face.material_index = 3 if pane.tinted else 2


def _crease_border(
    region: list[bmesh.types.BMFace], strength: float, crease: bmesh.types.BMLayerItem, corner: bmesh.types.BMLayerItem
) -> None:
    """Sharpen the edges around a region and the corners of its outline."""
    inside = set(region)
    for face in region:
        for edge in face.edges:
            if sum(f in inside for f in edge.link_faces) == 1:
                edge[crease] = strength
        for vert in face.verts:
            if sum(f in inside for f in vert.link_faces) == 1:
                vert[corner] = 0.85


def _evaluate(data: bpy.types.Mesh, cutters: Parts | None, levels: int) -> bpy.types.Mesh:
    """Return the mesh after subdivision and subtraction of the cutters."""
    collection = bpy.context.scene.collection
    obj = bpy.data.objects.new("shell", data)
    collection.objects.link(obj)
    smooth = obj.modifiers.new("smooth", "SUBSURF")
    smooth.levels, smooth.render_levels = levels, levels
    cutter = None
    if cutters is not None:
        cutter = bpy.data.objects.new("cutters", cutters.build("cutters"))
        collection.objects.link(cutter)
        boolean = obj.modifiers.new("cut", "BOOLEAN")
        boolean.object, boolean.operation, boolean.solver, boolean.material_mode = cutter, "DIFFERENCE", "EXACT", "TRANSFER"
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph)
    for temporary in (obj, cutter):
        if temporary is not None:
            temporary_mesh = temporary.data
            bpy.data.objects.remove(temporary, do_unlink=True)
            bpy.data.meshes.remove(temporary_mesh)
    return mesh


class Surface:
    """A mesh for ray casts, which determine where fittings and lettering touch the body."""

    def __init__(self, mesh: bpy.types.Mesh) -> None:
        self.tree = BVHTree.FromPolygons([v.co for v in mesh.vertices], [p.vertices for p in mesh.polygons])

    def side_x(self, y: float, z: float) -> float:
        """Return the body's half-width at ``(y, z)`` on the right."""
        hit = self.tree.ray_cast(Vector((9.0, y, z)), Vector((-1, 0, 0)))[0]
        return hit.x if hit is not None else 0.0

    def end_y(self, x: float, z: float, front: bool) -> float:
        """Return the y coordinate of the body's front or rear at ``(x, z)``."""
        sign = 1.0 if front else -1.0
        hit = self.tree.ray_cast(Vector((x, 20.0 * sign, z)), Vector((0, -sign, 0)))[0]
        return hit.y if hit is not None else 0.0

    def top_z(self, x: float, y: float) -> float:
        """Return the height of the body at ``(x, y)``."""
        hit = self.tree.ray_cast(Vector((x, y, 20.0)), Vector((0, 0, -1)))[0]
        return hit.z if hit is not None else 0.0


@dataclass
class Lettering:
    """The mesh of a line of lettering on a vehicle, and its text mark."""

    points: list[Point]
    faces: list[tuple[int, ...]]
    colour: str
    mark: TextMark


_LETTERING_AXES: dict[str, tuple[Point, Point]] = {
    "-Y": ((1, 0, 0), (0, 0, 1)),
    "+Y": ((-1, 0, 0), (0, 0, 1)),
    "+X": ((0, 1, 0), (0, 0, 1)),
    "-X": ((0, -1, 0), (0, 0, 1)),
}
"""Unit vectors (right, up) of lettering, for each direction that it can face."""


def text_line(
    text: str,
    cap_m: float,
    centre: Point,
    facing: str,
    colour: str = "black",
    *,
    width_m: float = math.inf,
    onto: Surface | None = None,
) -> Lettering:
    """Return a line of lettering centred on ``centre``, narrowed to fit ``width_m``.

    With ``onto``, it is projected onto that curved surface instead of a plane.
    """
    flat, faces = lettering.letters(text, cap_m)
    if onto is not None:
        flat, faces = _subdivide(flat, faces)
    xs, ys = [p[0] for p in flat], [p[1] for p in flat]
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    squeeze = min(1.0, width_m / width)
    right, up = _LETTERING_AXES[facing]
    normal = Vector(right).cross(up)
    points: list[Point] = []
    for x, y, lift in flat:
        u, v = (x - (max(xs) + min(xs)) / 2) * squeeze, y - cap_m / 2
        px, py, pz = (centre[k] + right[k] * u + up[k] * v + normal[k] * lift for k in range(3))
        if onto is not None:
            px = math.copysign(onto.side_x(py, pz) + 0.004 + lift, -1 if facing == "-X" else 1)
        points.append((px, py, pz))
    if onto is not None:
        centre = (sum(p[0] for p in points) / len(points), centre[1], centre[2])
    return Lettering(points, faces, colour, TextMark(text, centre, right, up, width * squeeze, height, cap_m))


def _subdivide(points: list[Point], faces: list[tuple[int, ...]]) -> tuple[list[Point], list[tuple[int, ...]]]:
    """Split long triangles, so that letters can follow a curve."""
    bm = bmesh.new()
    verts = [bm.verts.new(p) for p in points]
    for face in faces:
        if len(set(face)) > 2:
            bm.faces.new([verts[k] for k in face])
    for _ in range(4):
        bmesh.ops.triangulate(bm, faces=bm.faces[:])
        long = [e for e in bm.edges if e.calc_length() > 0.07]
        if not long:
            break
        bmesh.ops.subdivide_edges(bm, edges=long, cuts=1)
    bm.verts.index_update()
    result = [tuple(v.co) for v in bm.verts], [tuple(v.index for v in f.verts) for f in bm.faces]
    bm.free()
    return result


def text_on_both_sides(
    text: str,
    cap_m: float,
    y: float,
    z: float,
    colour: str,
    *,
    x: float = 0.0,
    width_m: float = math.inf,
    onto: Surface | None = None,
) -> list[Lettering]:
    """Return the same line of lettering for the right and left sides.

    The lettering is on the planes at ``x`` and -``x`` or, with ``onto``, projected onto that surface.
    """
    return [
        text_line(text, cap_m, (sign * (x + 0.003), y, z), facing, colour, width_m=width_m, onto=onto)
        for sign, facing in ((1, "+X"), (-1, "-X"))
    ]


def number_plates(plate: str, front: tuple[float, float], rear: tuple[float, float]) -> tuple[Parts, list[Lettering]]:
    """Return UK number plates (white at the front, yellow at the rear) and their lettering.

    ``front`` and ``rear`` are the positions (y, z) of the faces of the plates.
    """
    parts, letters = Parts(), []
    for (y, z), colour, rgb, sign in (
        (front, "white", (0.82, 0.82, 0.80), 1),
        (rear, "yellow", (0.86, 0.52, 0.01), -1),
    ):
        parts.box((0.55, 0.016, 0.135), (0, y - sign * 0.004, z), pw.black_trim(), bevel_m=0.004)
        face = shading.plain(f"number plate {colour}", rgb, 0.35)
        parts.box((0.52, 0.012, 0.111), (0, y, z), face, bevel_m=0.003)
        letters.append(text_line(plate, 0.079, (0, y + sign * 0.0085, z), "+Y" if sign > 0 else "-Y", width_m=0.47))
    return parts, letters


def body_mesh(model: str, make: Callable[[], Parts]) -> bpy.types.Mesh:
    """Return the mesh that all vehicles of a model share. ``make`` creates it on first use."""
    return bpy.data.meshes.get(f"kit {model}") or make().build(f"kit {model}")


def finish(
    name: str,
    body: bpy.types.Mesh,
    paints: Sequence[bpy.types.Material],
    letters: Sequence[Lettering] = (),
    fittings: Parts | None = None,
) -> Built:
    """Assemble a vehicle: the shared mesh with individual paint, and a second object with the lettering and fittings."""
    obj = bpy.data.objects.new(name, body)
    bpy.context.scene.collection.objects.link(obj)
    for number, material in enumerate(paints):
        slot = next(s for s in obj.material_slots if s.material == pw.paint_slot(number))
        slot.link = "OBJECT"
        slot.material = material
    parts = fittings or Parts()
    marks = []
    for line in letters:
        parts.add(line.points, line.faces, pw.ink(line.colour))
        marks.append(line.mark)
    objects = [obj]
    if parts.materials:
        extra = bpy.data.objects.new(f"{name} fittings", parts.build(f"{name} fittings"))
        bpy.context.scene.collection.objects.link(extra)
        objects.append(extra)
    return Built.of(name, objects, marks)


def arch_cutters(axles: Sequence[float], radius: float, inner_x: float) -> Parts:
    """Return the solids to subtract for wheel arches at the y coordinates ``axles``. They extend outwards from ``inner_x``."""
    cutters = Parts()
    for y in axles:
        for sign in (-1, 1):
            low, high = sorted((sign * inner_x, sign * 1.6))
            cutters.disc(radius, low, high, (0, y, radius * 0.86), wheels.shade(), axis="X", steps=40)
    return cutters
