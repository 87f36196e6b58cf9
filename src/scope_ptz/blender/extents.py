"""Compute the full silhouettes of instances as seen from a viewpoint, including hidden parts, from their triangles."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import pan_tilt_deg
from scope_ptz.geometry.sphere import camera_axes
from scope_ptz.simulator.models import Extent, SceneViewpoint

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RASTER_PX = 512  # side of the raster on which silhouettes are drawn
WIDE_DEG = 60.0
"""Silhouettes that extend further than this from their centre are drawn on the six faces of a cube."""

NEAR_M = 1e-3  # distance of the plane at which triangles are clipped
FRACTION_BITS = 4  # fractional bits of OpenCV's fixed-point coordinates
MAX_HULL_POINTS = 24  # maximum number of points in an outline


@dataclass(frozen=True, slots=True)
class InstanceMesh:
    """An instance's mesh: vertices ``(n, 3)`` in the viewpoint's coordinates, and triangles ``(m, 3)`` as vertex indices."""

    number: int
    vertices: Floats
    triangles: Ints


def extents(meshes_file: Path, viewpoint: SceneViewpoint, progress: Callable[[int, int], None]) -> list[Extent]:
    """Return the extent of every instance in a file that the worker's operation ``meshes`` wrote."""
    instance_meshes = read_meshes(meshes_file, viewpoint)
    found = []
    for k, mesh in enumerate(instance_meshes):
        found.append(extent(mesh))
        progress(k + 1, len(instance_meshes))
    return found


def read_meshes(meshes_file: Path, viewpoint: SceneViewpoint) -> list[InstanceMesh]:
    """Return the meshes of all instances in a viewpoint's coordinates, sorted by instance ID."""
    bearing = math.radians(viewpoint.pan0_bearing_deg)
    c, s = math.cos(bearing), math.sin(bearing)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    with np.load(meshes_file) as file:
        shapes = {
            int(k.removeprefix("vertices-")): (file[k], file[k.replace("vertices", "triangles")])
            for k in file
            if k.startswith("vertices-")
        }
        uses, matrices = file["uses"], file["matrices"]
    instance_meshes = []
    for number in sorted({int(n) for n in uses[:, 0]}):
        vertices, triangles, base = [], [], 0
        for (_, shape), matrix in zip(uses[uses[:, 0] == number], matrices[uses[:, 0] == number], strict=True):
            points, faces = shapes[int(shape)]
            world = points.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            vertices.append((world - viewpoint.position_m) @ rotation.T)
            triangles.append(faces.astype(np.int64) + base)
            base += len(points)
        instance_meshes.append(InstanceMesh(number, np.concatenate(vertices), np.concatenate(triangles)))
    return instance_meshes


def extent(mesh: InstanceMesh) -> Extent:
    """Return an instance's solid angle, convex outline and distance."""
    used = mesh.vertices[np.unique(mesh.triangles)]
    rays = used / np.linalg.norm(used, axis=1, keepdims=True)
    centre = rays.mean(axis=0)
    for _ in range(3):  # approximates the axis of the smallest cone around the rays
        centre = centre / max(np.linalg.norm(centre), 1e-9)
        farthest = rays[np.argmin(rays @ centre)]
        centre = centre + 0.25 * (farthest - centre)
    centre = centre / np.linalg.norm(centre)
    radius_deg = math.degrees(math.acos(np.clip(np.min(rays @ centre), -1, 1)))
    pan, tilt = (float(v) for v in pan_tilt_deg(centre))
    axes = camera_axes(pan, tilt)
    solid_angle = _narrow_solid_angle(mesh, axes) if radius_deg < WIDE_DEG else _wide_solid_angle(mesh)
    return Extent(
        number=mesh.number,
        solid_angle_sr=float(f"{solid_angle:.6g}"),
        hull=_hull(rays, axes) if radius_deg < 85.0 else [],
        distance_m=round(max(_nearest_m(mesh), 1e-3), 3),
    )


def _narrow_solid_angle(mesh: InstanceMesh, axes: Floats) -> float:
    local = mesh.vertices @ axes.T
    flat = local[:, :2] / local[:, 2:]
    used = flat[np.unique(mesh.triangles)]
    # The longest axis is aligned with the raster, so that a leaning pole covers more of it.
    _, lengthwise = np.linalg.eigh(np.cov(used.T))
    flat, used = flat @ lengthwise, used @ lengthwise
    low, high = used.min(axis=0), used.max(axis=0)
    coarse, fine = (_rasterised_solid_angle(flat[mesh.triangles], low, high, side) for side in (RASTER_PX, 2 * RASTER_PX))
    return _remove_fill_bias(coarse, fine)


def _remove_fill_bias(coarse: float, fine: float) -> float:
    """Correct a solid angle for the excess area in OpenCV's polygon fill, using rasters at two pixel sizes.

    OpenCV fills every pixel that an outline touches, so areas are too large. Halving the pixel size halves the excess.
    """
    return max(2 * fine - coarse, 0.3 * fine)


def _rasterised_solid_angle(triangles: Floats, low: Floats, high: Floats, side: int) -> float:
    """Return the solid angle of the union of triangles in a tangent plane.

    Args:
        triangles: Shape ``(m, 3, 2)``.
        low: Lower corner of the raster.
        high: Upper corner of the raster.
        side: Width and height of the raster in pixels. The pixels need not be square.
    """
    pitch = np.maximum((high - low) / side, 1e-12)
    mask = np.zeros((side + 3, side + 3), dtype=np.uint8)
    fixed = np.rint(((triangles - low) / pitch + 1.0) * (1 << FRACTION_BITS)).astype(np.int32)
    for corners in np.unique(fixed.reshape(-1, 6), axis=0).reshape(-1, 3, 2):
        cv2.fillConvexPoly(mask, corners, 1, cv2.LINE_8, FRACTION_BITS)
    x, y = (low + (np.arange(side + 3) - 1.0)[:, None] * pitch).T
    weight = (1.0 + x[None, :] ** 2 + y[:, None] ** 2) ** -1.5
    return float((mask * weight).sum() * pitch[0] * pitch[1])


def _wide_solid_angle(mesh: InstanceMesh) -> float:
    totals = [0.0, 0.0]
    low, high = np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    for pan, tilt in ((0, 0), (90, 0), (180, 0), (-90, 0), (0, 90), (0, -90)):
        local = mesh.vertices @ camera_axes(pan, tilt).T
        corners = _clip_behind_camera(local[mesh.triangles])
        flat = corners[..., :2] / corners[..., 2:]
        overlapping = np.all(flat.max(axis=1) > low, axis=1) & np.all(flat.min(axis=1) < high, axis=1)
        if overlapping.any():
            for k, side in enumerate((RASTER_PX, 2 * RASTER_PX)):
                totals[k] += _rasterised_solid_angle(flat[overlapping], low, high, side)
    return _remove_fill_bias(*totals)


def _clip_behind_camera(corners: Floats) -> Floats:
    """Clip triangles of shape ``(m, 3, 3)`` at a plane just in front of the camera. Quadrilaterals are split into two triangles."""
    ahead = corners[..., 2] > NEAR_M
    whole = corners[ahead.all(axis=1)]
    pieces = []
    for triangle in corners[ahead.any(axis=1) & ~ahead.all(axis=1)]:
        ring = []
        for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
            if a[2] > NEAR_M:
                ring.append(a)
            if (a[2] > NEAR_M) != (b[2] > NEAR_M):
                ring.append(a + (b - a) * ((NEAR_M - a[2]) / (b[2] - a[2])))
        pieces += [np.stack([ring[0], ring[k], ring[k + 1]]) for k in range(1, len(ring) - 1)]
    return np.concatenate([whole, np.stack(pieces)]) if pieces else whole


def _hull(rays: Floats, axes: Floats) -> list[tuple[float, float]]:
    local = rays @ axes.T
    flat = (local[:, :2] / local[:, 2:]).astype(np.float32)
    outline = cv2.convexHull(flat)
    tolerance = 1e-4 * float(np.ptp(flat, axis=0).max())
    simple = outline
    while len(simple) > MAX_HULL_POINTS:
        tolerance *= 2
        simple = cv2.approxPolyDP(outline, tolerance, closed=True)
    plane = simple.reshape(-1, 2).astype(np.float64)
    pan, tilt = pan_tilt_deg(np.column_stack([plane, np.ones(len(plane))]) @ axes)
    return [(round(float(p), 3), round(float(t), 3)) for p, t in zip(pan, tilt, strict=True)]


def _nearest_m(mesh: InstanceMesh) -> float:
    """Return the distance from the origin to the nearest point on any triangle."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    nearest = min(_edge_distance(a, b), _edge_distance(b, c), _edge_distance(c, a))
    normal = np.cross(b - a, c - a)
    area2 = np.einsum("ij,ij->i", normal, normal)
    not_degenerate = area2 > 1e-18
    a, b, c, normal, area2 = a[not_degenerate], b[not_degenerate], c[not_degenerate], normal[not_degenerate], area2[not_degenerate]
    foot = normal * (np.einsum("ij,ij->i", normal, a) / area2)[:, None]
    inside = np.ones(len(a), dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(q - p, foot - p), normal) >= 0
    if inside.any():
        nearest = min(nearest, float(np.linalg.norm(foot[inside], axis=1).min()))
    return nearest


def _edge_distance(a: Floats, b: Floats) -> float:
    along = b - a
    length2 = np.maximum(np.einsum("ij,ij->i", along, along), 1e-18)
    fraction = np.clip(-np.einsum("ij,ij->i", a, along) / length2, 0.0, 1.0)
    return float(np.linalg.norm(a + along * fraction[:, None], axis=1).min())
