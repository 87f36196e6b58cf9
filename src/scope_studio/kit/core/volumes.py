"""Rounded bodies of people, animals and objects. A voxel remesh merges capsules, ellipsoids and lofts into one surface."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import bpy
import numpy as np
from mathutils import Matrix, Vector, noise

Vec = Vector | tuple[float, float, float]
SurfaceMesh = tuple[np.ndarray, list[tuple[int, ...]]]
"""Surface mesh of a body: points (n, 3) and faces."""


class Volume:
    """A set of overlapping closed shapes to merge into one surface."""

    def __init__(self) -> None:
        self.points: list[tuple[float, float, float]] = []
        self.faces: list[tuple[int, ...]] = []

    def rings(self, rows: Sequence[Sequence[Vec]]) -> None:
        """Add a tube through rings with equal numbers of points, closed at both ends."""
        base, n = len(self.points), len(rows[0])
        for row in rows:
            self.points += [tuple(p) for p in row]
        for i in range(len(rows) - 1):
            for k in range(n):
                a, b = base + i * n + k, base + i * n + (k + 1) % n
                self.faces.append((a, b, b + n, a + n))
        self.faces.append(tuple(range(base, base + n))[::-1])
        self.faces.append(tuple(range(base + (len(rows) - 1) * n, base + len(rows) * n)))

    def capsule(self, a: Vec, b: Vec, ra: float, rb: float, *, sides: int = 16, flat: float = 1.0, across: Vec = (1, 0, 0)) -> None:
        """Add a tapered capsule. If ``flat`` is less than 1, the capsule is thinner at right angles to ``across``."""
        a, b = Vector(a), Vector(b)
        axis = (b - a).normalized()
        u = Vector(across) - axis * axis.dot(Vector(across))
        u = u.normalized() if u.length > 1e-3 else axis.orthogonal().normalized()
        v = axis.cross(u)
        rows = []
        for centre, radius, angles in ((a, ra, (-80, -50, -25, 0)), (b, rb, (0, 25, 50, 80))):
            for angle in angles:
                w, h = math.cos(math.radians(angle)) * radius, math.sin(math.radians(angle)) * radius
                rows.append(
                    [
                        centre
                        + axis * h
                        + u * (w * math.cos(2 * math.pi * k / sides))
                        + v * (w * flat * math.sin(2 * math.pi * k / sides))
                        for k in range(sides)
                    ]
                )
        self.rings(rows)

    def ellipsoid(self, centre: Vec, radii: tuple[float, float, float], frame: Matrix | None = None) -> None:
        """Add an axis-aligned ellipsoid, transformed by ``frame`` if it is given."""
        rows = []
        for i in range(13):
            t = math.radians(-84 + 14 * i)
            row = []
            for k in range(20):
                a = 2 * math.pi * k / 20
                p = Vector(centre) + Vector(
                    (radii[0] * math.cos(t) * math.cos(a), radii[1] * math.cos(t) * math.sin(a), radii[2] * math.sin(t))
                )
                row.append(frame @ p if frame else p)
            rows.append(row)
        self.rings(rows)

    def merge(self, voxel_m: float, smooth: int = 4) -> SurfaceMesh:
        """Merge the shapes into one smoothed, watertight surface."""
        mesh = bpy.data.meshes.new("merge")
        mesh.from_pydata(self.points, [], self.faces)
        obj = bpy.data.objects.new("merge", mesh)
        remesh = obj.modifiers.new("remesh", "REMESH")
        remesh.mode, remesh.voxel_size = "VOXEL", voxel_m
        if smooth:
            smoothing = obj.modifiers.new("smooth", "SMOOTH")
            smoothing.factor, smoothing.iterations = 0.5, smooth
        scratch = bpy.data.scenes.new("merge")  # a separate scene, so that the evaluation does not include the whole stage
        scratch.collection.objects.link(obj)
        layer = scratch.view_layers[0]
        layer.update()
        merged = bpy.data.meshes.new_from_object(obj.evaluated_get(layer.depsgraph), depsgraph=layer.depsgraph)
        points = np.empty(len(merged.vertices) * 3)
        merged.vertices.foreach_get("co", points)
        faces = [tuple(p.vertices) for p in merged.polygons]
        bpy.data.scenes.remove(scratch)
        bpy.data.objects.remove(obj)
        bpy.data.meshes.remove(merged)
        bpy.data.meshes.remove(mesh)
        return points.reshape(-1, 3), faces


def normals(surface: SurfaceMesh) -> np.ndarray:
    """Return the unit vertex normals of a quad surface, (n, 3)."""
    points, faces = surface
    quads = np.array([f if len(f) == 4 else (*f, f[-1]) for f in faces])
    cross = np.cross(points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]])
    total = np.zeros_like(points)
    for k in range(4):
        np.add.at(total, quads[:, k], cross)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)


def crease(
    surface: SurfaceMesh,
    amount: Callable[[np.ndarray], np.ndarray] | np.ndarray | float,
    scale: tuple[float, float, float],
    seed: float,
) -> SurfaceMesh:
    """Return the surface displaced by noise that imitates the folds of cloth.

    Args:
        amount: Displacement in metres: a number, an array (n,), or a function of the points (n, 3) that returns either.
    """
    points, faces = surface
    size = amount(points) if callable(amount) else amount
    shift = np.array(
        [
            noise.noise((x * scale[0] + seed, y * scale[1], z * scale[2]))
            + 0.5 * noise.noise((x * scale[0] * 2.1, y * scale[1] * 2.1 + seed, z * scale[2] * 2.3))
            for x, y, z in points
        ]
    )
    return points + normals(surface) * (shift * size)[:, None], faces
