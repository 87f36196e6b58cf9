"""A builder that collects primitives, materials and text marks, and creates one mesh object from them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
from mathutils import Matrix, Vector

from scope_studio.kit.core.lettering import letters
from scope_studio.kit.core.mesh import Point
from scope_studio.kit.core.stage import Built, TextMark

LETTERING_AXES = {
    "+Y": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "-Y": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "+X": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "-X": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "+Z": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
}
"""Unit vectors (right, up) of lettering, for each direction that it can face."""

SHARP_ANGLE = math.radians(38)
"""Angle between faces, in radians, above which their common edge is shaded as sharp."""


class Solid:
    """A collection of geometry. ``frame`` transforms all added points. Materials get slots in order of first use."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.points: list[Point] = []
        self.faces: list[tuple[int, ...]] = []
        self.slots: list[bpy.types.Material] = []
        self.face_slots: list[int] = []
        self.texts: list[TextMark] = []
        self.rest: dict[int, Point] = {}
        self.frame = Matrix.Identity(4)

    @contextmanager
    def at(
        self,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        *,
        turn: float = 0.0,
        pitch: float = 0.0,
        roll: float = 0.0,
    ) -> Iterator[None]:
        """Move and rotate the frame while the context is active: ``turn`` degrees about z, ``pitch`` about x, ``roll`` about y."""
        saved = self.frame
        rotation = Matrix.Rotation(math.radians(turn), 4, "Z")
        rotation @= Matrix.Rotation(math.radians(pitch), 4, "X") @ Matrix.Rotation(math.radians(roll), 4, "Y")
        self.frame = saved @ Matrix.Translation((x, y, z)) @ rotation
        try:
            yield
        finally:
            self.frame = saved

    def add(
        self,
        points: Sequence[Point],
        faces: Sequence[Sequence[int]],
        material: bpy.types.Material,
        rest: Sequence[Point] | None = None,
    ) -> None:
        """Add polygons, transformed by the current frame.

        ``rest`` contains a value of the "rest" attribute for each point, such as its position on an upright figure. Shaders use
        this attribute for masks.
        """
        if material not in self.slots:
            self.slots.append(material)
        base, slot = len(self.points), self.slots.index(material)
        self.points += [tuple(self.frame @ Vector(p)) for p in points]
        self.faces += [tuple(base + i for i in face) for face in faces]
        self.face_slots += [slot] * len(faces)
        if rest is not None:
            self.rest.update((base + i, tuple(r)) for i, r in enumerate(rest))

    def box(self, size: Point, centre: Point, material: bpy.types.Material, chamfer: float = 0.006) -> None:
        """Add a box with chamfered edges."""
        half = [s / 2 for s in size]
        cut = min(chamfer, 0.4 * min(size))
        signs = [(sx, sy, sz) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
        points, index = [], {}
        for sign in signs:
            for axis in range(3):  # the corner point on the face that is normal to ``axis``
                index[sign, axis] = len(points)
                points.append(tuple(centre[k] + sign[k] * (half[k] - (0 if k == axis else cut)) for k in range(3)))
        faces: list[tuple[int, ...]] = []

        def face(ids: list[int], outward: tuple[float, float, float]) -> None:
            a, b, c = (Vector(points[i]) for i in ids[:3])
            faces.append(tuple(ids if (b - a).cross(c - a).dot(Vector(outward)) > 0 else ids[::-1]))

        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            for s in (-1, 1):
                ring = []
                for su, sv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                    sign = [0, 0, 0]
                    sign[axis], sign[u], sign[v] = s, su, sv
                    ring.append(index[tuple(sign), axis])
                face(ring, tuple(s if k == axis else 0 for k in range(3)))
            for su in (-1, 1):
                for sv in (-1, 1):  # the edge along ``axis``, between the faces that are normal to u and v
                    low, high = [0, 0, 0], [0, 0, 0]
                    low[axis], low[u], low[v] = -1, su, sv
                    high[axis], high[u], high[v] = 1, su, sv
                    ring = [index[tuple(low), u], index[tuple(high), u], index[tuple(high), v], index[tuple(low), v]]
                    face(ring, tuple(su if k == u else sv if k == v else 0 for k in range(3)))
        for sign in signs:
            face([index[sign, 0], index[sign, 1], index[sign, 2]], sign)
        self.add(points, faces, material)

    def lathe(
        self,
        profile: Sequence[tuple[float, float]],
        material: bpy.types.Material,
        centre: Point = (0, 0, 0),
        axis: str = "Z",
        steps: int = 24,
    ) -> None:
        """Add a surface of revolution from ``(radius, height)`` pairs, listed from bottom to top, capped at both ends."""
        place = {"Z": lambda u, v, h: (u, v, h), "Y": lambda u, v, h: (v, h, u), "X": lambda u, v, h: (h, u, v)}[axis]
        points = []
        for radius, height in profile:
            for k in range(steps):
                a = 2 * math.pi * k / steps
                p = place(radius * math.cos(a), radius * math.sin(a), height)
                points.append((p[0] + centre[0], p[1] + centre[1], p[2] + centre[2]))
        faces = [
            (r * steps + k, r * steps + (k + 1) % steps, (r + 1) * steps + (k + 1) % steps, (r + 1) * steps + k)
            for r in range(len(profile) - 1)
            for k in range(steps)
        ]
        faces.append(tuple(range(steps))[::-1])
        faces.append(tuple(range((len(profile) - 1) * steps, len(profile) * steps)))
        self.add(points, faces, material)

    def rod(
        self,
        a: Point,
        b: Point,
        radius: float,
        material: bpy.types.Material,
        *,
        radius_b: float | None = None,
        sides: int = 10,
    ) -> None:
        """Add a straight round bar from ``a`` to ``b``. With ``radius_b``, it is tapered."""
        self.tube([a, b], radius, material, sides=sides, radius_b=radius_b)

    def tube(
        self,
        path: Sequence[Point],
        radius: float,
        material: bpy.types.Material,
        *,
        sides: int = 8,
        radius_b: float | None = None,
        closed: bool = False,
    ) -> None:
        """Add a round tube along a path, mitred at the corners."""
        line = [Vector(p) for p in path]
        count = len(line)
        ring_points: list[Point] = []
        normal: Vector | None = None
        for i, here in enumerate(line):
            before = (here - line[i - 1]).normalized() if i or closed else None
            after = (line[(i + 1) % count] - here).normalized() if i < count - 1 or closed else None
            tangent = ((before or after) + (after or before)).normalized()
            if normal is None:
                normal = tangent.orthogonal().normalized()
            normal = (normal - tangent * normal.dot(tangent)).normalized()
            side = tangent.cross(normal)
            stretch = 1.0 / max(0.5, tangent.dot(after or before))
            r = radius if radius_b is None else radius + (radius_b - radius) * i / (count - 1)
            bend = (after - before) if before and after else Vector()
            bend = bend.normalized() if bend.length > 1e-4 else Vector()
            for k in range(sides):
                a = 2 * math.pi * k / sides
                offset = normal * (r * math.cos(a)) + side * (r * math.sin(a))
                offset += bend * (offset.dot(bend) * (stretch - 1.0))
                ring_points.append(tuple(here + offset))
        rings = count if closed else count - 1
        total = len(ring_points)
        faces: list[tuple[int, ...]] = [
            (
                (i * sides + k) % total,
                (i * sides + (k + 1) % sides) % total,
                ((i + 1) * sides + (k + 1) % sides) % total,
                ((i + 1) * sides + k) % total,
            )
            for i in range(rings)
            for k in range(sides)
        ]
        if not closed:
            faces += [tuple(range(sides))[::-1], tuple(range(total - sides, total))]
        self.add(ring_points, faces, material)

    def prism(
        self,
        outline: Sequence[tuple[float, float]],
        depth: tuple[float, float],
        material: bpy.types.Material,
        plane: str = "XZ",
    ) -> None:
        """Add a polygon, which need not be convex, extruded between two depths along the axis normal to ``plane``."""
        place = {"XZ": lambda u, v, d: (u, d, v), "XY": lambda u, v, d: (u, v, d), "YZ": lambda u, v, d: (d, u, v)}[plane]
        count = len(outline)
        area = sum(outline[i - 1][0] * outline[i][1] - outline[i][0] * outline[i - 1][1] for i in range(count))
        ring = list(outline) if area > 0 else list(outline)[::-1]
        low, high = sorted(depth)
        points = [place(u, v, low) for u, v in ring] + [place(u, v, high) for u, v in ring]
        sides = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
        faces: list[tuple[int, ...]] = [tuple(range(count))[::-1], tuple(range(count, 2 * count)), *sides]
        if plane == "XZ":
            faces = [face[::-1] for face in faces]
        self.add(points, faces, material)

    def text(
        self,
        body: str,
        cap_height_m: float,
        centre: Point,
        material: bpy.types.Material,
        *,
        facing: str = "+Y",
        align: str = "CENTER",
        bold: bool = True,
        spacing: float | None = None,
        mark: bool = True,
    ) -> tuple[float, float]:
        """Add one line of lettering that faces in the direction ``facing``, with its exact text mark.

        Args:
            centre: Point at half the height of the capitals, at the centre, left end or right end of the line (see ``align``).
            mark: Whether to add a text mark for the line.

        Returns:
            Width and height of the letters in metres.
        """
        flat, faces = letters(body, cap_height_m, bold=bold, spacing=spacing)
        xs, ys = [p[0] for p in flat], [p[1] for p in flat]
        low, high = min(xs), max(xs)
        shift = {"CENTER": -(low + high) / 2, "LEFT": -low, "RIGHT": -high}[align]
        right, up = (Vector(v) for v in LETTERING_AXES[facing])
        origin, out = Vector(centre), right.cross(up)

        def in_frame(x: float, y: float, z: float = 0.0) -> Vector:
            return origin + right * (x + shift) + up * (y - cap_height_m / 2) + out * z

        self.add([tuple(in_frame(*p)) for p in flat], faces, material)
        width, height = high - low, max(ys) - min(ys)
        if mark:
            turn = self.frame.to_3x3()
            middle = self.frame @ in_frame((low + high) / 2, (max(ys) + min(ys)) / 2)
            self.texts.append(TextMark(body, tuple(middle), tuple(turn @ right), tuple(turn @ up), width, height, cap_height_m))
        return width, height

    def object(self) -> bpy.types.Object:
        """Create the mesh object and link it to the scene. Shading is smooth, except at edges above ``SHARP_ANGLE``."""
        mesh = bpy.data.meshes.new(self.name)
        mesh.from_pydata(self.points, [], self.faces)
        for material in self.slots:
            mesh.materials.append(material)
        mesh.polygons.foreach_set("material_index", self.face_slots)
        mesh.polygons.foreach_set("use_smooth", [True] * len(self.faces))
        mesh.set_sharp_from_angle(angle=SHARP_ANGLE)
        if self.rest:
            layer = mesh.attributes.new("rest", "FLOAT_VECTOR", "POINT")
            layer.data.foreach_set("vector", [c for i in range(len(self.points)) for c in self.rest.get(i, (0.0, 0.0, 0.0))])
        mesh.update()
        obj = bpy.data.objects.new(self.name, mesh)
        bpy.context.scene.collection.objects.link(obj)
        return obj

    def built(self) -> Built:
        """Create the mesh object and return it with its text marks."""
        return Built.of(self.name, [self.object()], self.texts)
