"""A builder that collects simple solids in one mesh, for vehicles and machines."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bmesh
import bpy
from mathutils import Matrix, Vector

Point = tuple[float, float, float]
Point2D = tuple[float, float]

_AXES = {
    "X": lambda a, b, h: (h, a, b),
    "Y": lambda a, b, h: (a, h, b),
    "Z": lambda a, b, h: (a, b, h),
}


class Parts:
    """A collection of polygons with materials. The current ``matrix`` transforms the points of each part when it is added."""

    def __init__(self) -> None:
        self.matrix = Matrix.Identity(4)
        self.materials: list[bpy.types.Material] = []
        self._points: list[Vector] = []
        self._faces: list[tuple[int, ...]] = []
        self._slots: list[int] = []
        self._smooth: list[bool] = []

    def slot(self, material: bpy.types.Material) -> int:
        """Return the slot number of a material, after adding a slot if the material is new."""
        if material not in self.materials:
            self.materials.append(material)
        return self.materials.index(material)

    def add(
        self,
        points: Sequence[Point],
        faces: Sequence[Sequence[int]],
        material: bpy.types.Material,
        *,
        smooth: bool = False,
    ) -> None:
        """Add polygons, transformed by ``matrix``. ``faces`` contains indices of ``points``, anticlockwise as seen from outside."""
        base, slot = len(self._points), self.slot(material)
        flipped = self.matrix.determinant() < 0
        self._points += [self.matrix @ Vector(p) for p in points]
        for face in faces:
            ring = tuple(base + k for k in face)
            self._faces.append(ring[::-1] if flipped else ring)
            self._slots.append(slot)
            self._smooth.append(smooth)

    def mesh(self, mesh: bpy.types.Mesh) -> None:
        """Add all polygons of an existing mesh, with its materials."""
        points = [tuple(v.co) for v in mesh.vertices]
        base = len(self._points)
        self._points += [self.matrix @ Vector(p) for p in points]
        slots = [self.slot(m) for m in mesh.materials]
        for polygon in mesh.polygons:
            self._faces.append(tuple(base + k for k in polygon.vertices))
            self._slots.append(slots[polygon.material_index])
            self._smooth.append(polygon.use_smooth)

    def box(self, size: Point, centre: Point, material: bpy.types.Material, *, bevel_m: float = 0.01) -> None:
        """Add a box with chamfered edges."""
        half = [s / 2 for s in size]
        cut = min(bevel_m, min(half) * 0.6)
        points: list[Point] = []
        index: dict[tuple[int, int, int, int], int] = {}
        for sx in (-1, 1):
            for sy in (-1, 1):
                for sz in (-1, 1):
                    signs = (sx, sy, sz)
                    for axis in range(3):
                        index[(*signs, axis)] = len(points)
                        points.append(
                            tuple(centre[k] + signs[k] * (half[k] if k == axis else half[k] - cut) for k in range(3))  # type: ignore[arg-type]
                        )
        faces: list[tuple[int, ...]] = []
        for axis in range(3):
            u, v = [k for k in range(3) if k != axis]
            for sign in (-1, 1):
                ring = []
                for su, sv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                    corner = [0, 0, 0]
                    corner[axis], corner[u], corner[v] = sign, su, sv
                    ring.append(index[(*corner, axis)])
                faces.append(tuple(ring))
        for axis in range(3):
            u, v = [k for k in range(3) if k != axis]
            for su in (-1, 1):
                for sv in (-1, 1):
                    low, high = [0, 0, 0], [0, 0, 0]
                    low[axis], low[u], low[v] = -1, su, sv
                    high[axis], high[u], high[v] = 1, su, sv
                    faces.append((index[(*low, u)], index[(*high, u)], index[(*high, v)], index[(*low, v)]))
        for corner_signs in {key[:3] for key in index}:
            faces.append(tuple(index[(*corner_signs, axis)] for axis in range(3)))
        middle = Vector(centre)
        self.add(points, [_outward(points, f, middle) for f in faces], material)

    def prism(
        self,
        outline: Sequence[Point2D],
        low: float,
        high: float,
        material: bpy.types.Material,
        *,
        axis: str = "X",
        bevel_m: float = 0.0,
        segments: int = 1,
        smooth: bool = False,
    ) -> None:
        """Add a closed outline, extruded along ``axis`` from ``low`` to ``high``.

        The outline is (y, z), (x, z) or (x, y) for axis X, Y or Z.
        """
        bm = bmesh.new()
        place = _AXES[axis]
        face = bm.faces.new([bm.verts.new(place(a, b, low)) for a, b in outline])
        extruded = bmesh.ops.extrude_face_region(bm, geom=[face])
        shift = Vector(place(0, 0, high - low))
        bmesh.ops.translate(bm, vec=shift, verts=[g for g in extruded["geom"] if isinstance(g, bmesh.types.BMVert)])
        bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])
        if bevel_m > 0:
            bmesh.ops.bevel(bm, geom=bm.edges[:], offset=bevel_m, segments=segments, profile=0.5, affect="EDGES")
        bm.verts.index_update()
        self.add([tuple(v.co) for v in bm.verts], [[v.index for v in f.verts] for f in bm.faces], material, smooth=smooth)
        bm.free()

    def lathe(
        self,
        profile: Sequence[Point2D],
        centre: Point,
        material: bpy.types.Material,
        *,
        axis: str = "Z",
        steps: int = 24,
        smooth: bool = True,
        caps: bool = True,
    ) -> None:
        """Add a surface of revolution about ``axis`` from ``(radius, height)`` pairs. ``caps`` closes its ends."""
        place = _AXES[axis]
        points: list[Point] = []
        for radius, height in profile:
            for k in range(steps):
                a = 2 * math.pi * k / steps
                p = place(radius * math.cos(a), radius * math.sin(a), height)
                points.append((p[0] + centre[0], p[1] + centre[1], p[2] + centre[2]))
        faces: list[tuple[int, ...]] = []
        for ring in range(len(profile) - 1):
            for k in range(steps):
                a0, b0 = ring * steps + k, ring * steps + (k + 1) % steps
                faces.append((a0, b0, b0 + steps, a0 + steps))
        last = (len(profile) - 1) * steps
        ends = [tuple(range(steps))[::-1], tuple(range(last, last + steps))]
        turn = (profile[-1][1] < profile[0][1]) ^ (axis == "Y")
        if turn:
            faces, ends = [f[::-1] for f in faces], [e[::-1] for e in ends]
        self.add(points, faces, material, smooth=smooth)
        if caps:
            self.add(points, ends, material)

    def disc(
        self,
        radius: float,
        low: float,
        high: float,
        centre: Point,
        material: bpy.types.Material,
        *,
        axis: str = "X",
        steps: int = 24,
    ) -> None:
        """Add a short cylinder with a small chamfer."""
        cut = min(0.006, radius * 0.2, abs(high - low) * 0.3)
        self.lathe(
            [(radius - cut, low), (radius, low + cut), (radius, high - cut), (radius - cut, high)],
            centre, material, axis=axis, steps=steps, smooth=False,
        )  # fmt: skip

    def tube(
        self,
        path: Sequence[Point],
        radius: float,
        material: bpy.types.Material,
        *,
        sides: int = 8,
        closed: bool = False,
    ) -> None:
        """Add a tube along a path. Its cross-section is a regular polygon with ``sides`` sides."""
        line = [Vector(p) for p in path]
        count = len(line)
        points: list[Point] = []
        side = Vector((0, 0, 1))
        for k, here in enumerate(line):
            before = line[k - 1] if k or closed else here
            after = line[(k + 1) % count] if k + 1 < count or closed else here
            along = (after - before).normalized()
            side -= along * side.dot(along)
            if side.length < 1e-3:
                side = along.orthogonal()
            side.normalize()
            other = along.cross(side)
            for n in range(sides):
                a = 2 * math.pi * (n + 0.5) / sides
                points.append(tuple(here + radius * (math.cos(a) * side + math.sin(a) * other)))
        faces: list[tuple[int, ...]] = []
        for ring in range(count if closed else count - 1):
            for n in range(sides):
                m, up = (n + 1) % sides, ((ring + 1) % count) * sides
                faces.append((ring * sides + n, ring * sides + m, up + m, up + n))
        if not closed:
            faces += [tuple(range(sides))[::-1], tuple(range((count - 1) * sides, count * sides))]
        self.add(points, faces, material, smooth=sides > 4)

    def build(self, name: str) -> bpy.types.Mesh:
        """Return the assembled mesh datablock."""
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([tuple(p) for p in self._points], [], self._faces)
        for material in self.materials:
            mesh.materials.append(material)
        mesh.polygons.foreach_set("material_index", self._slots)
        mesh.polygons.foreach_set("use_smooth", self._smooth)
        mesh.update()
        return mesh


def _outward(points: Sequence[Point], face: tuple[int, ...], middle: Vector) -> tuple[int, ...]:
    """Return the face with its points ordered so that its normal points away from ``middle``."""
    a, b, c = (Vector(points[k]) for k in face[:3])
    return face if (b - a).cross(c - b).dot(a - middle) > 0 else face[::-1]
