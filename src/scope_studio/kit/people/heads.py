"""Heads with face, ears, neck and hair.

Head coordinates have their origin at the centre of the head, which is at ``CENTRE`` in the upright rest pose. The face looks
towards +y.
"""

from __future__ import annotations

import math

import numpy as np
from mathutils import Matrix, Vector, noise

from scope_studio.kit.core.volumes import SurfaceMesh, Volume, normals

CENTRE = (0.0, 0.012, 1.648)
"""Centre of the head of the upright figure (m)."""
EYES = ((-0.0315, 0.0775, 0.012), (0.0315, 0.0775, 0.012))
"""Positions of the eyes relative to ``CENTRE`` (m)."""


def head_and_neck(*, woman: bool, stout: float) -> SurfaceMesh:
    """Return the head and neck as one surface, in head coordinates."""
    v = Volume()
    jaw = 0.90 if woman else 1.0
    v.ellipsoid((0, -0.014, 0.036), (0.0755, 0.096, 0.086))
    v.ellipsoid((0, 0.018, -0.022), (0.0635 * jaw, 0.070, 0.088))
    v.ellipsoid((0, 0.040, -0.078), (0.040 * jaw * stout, 0.042, 0.032))
    v.ellipsoid((0, 0.066, -0.094), (0.020, 0.019, 0.017))
    v.capsule((-0.034, 0.070, 0.026), (0.034, 0.070, 0.026), 0.014, 0.014)
    v.capsule((0, 0.083, 0.016), (0, 0.101, -0.022), 0.0085, 0.0115)
    for s in (-1, 1):
        v.ellipsoid((s * 0.011, 0.093, -0.027), (0.0085, 0.010, 0.0075))
        v.ellipsoid((s * 0.041 * jaw, 0.051, -0.018), (0.020 * stout, 0.022, 0.019))
        v.ellipsoid((s * 0.046 * jaw * stout, 0.020, -0.066), (0.020, 0.036, 0.028))
        ear = Matrix.Translation((s * 0.0745, -0.010, -0.008)) @ Matrix.Rotation(s * math.radians(-24), 4, "Z")
        v.ellipsoid((0, 0, 0), (0.009, 0.021, 0.033), ear)
    v.capsule((-0.015, 0.078, -0.0560), (0.015, 0.078, -0.0560), 0.009, 0.009)
    v.capsule((-0.011, 0.077, -0.0665), (0.011, 0.077, -0.0665), 0.009, 0.009)
    v.capsule(
        (0, -0.020, -0.06),
        (0, -0.030, -0.185),
        0.052 * stout * (0.88 if woman else 1),
        0.060 * stout * (0.88 if woman else 1),
    )
    points, faces = v.merge(0.0058, 2)
    for x, y, z in EYES:  # eye sockets
        d = (points - (x, y, z)) / (0.021, 0.030, 0.0125)
        points[:, 1] -= 0.0125 * np.exp(-(d**2).sum(axis=1))
    return points, faces


def hair_cap(style: str, thickness: float, seed: float) -> SurfaceMesh:
    """Return hair as a shell over the skull. ``style`` is "short", "crop", "long", "bun" or "tail"."""
    v = Volume()
    t = thickness
    v.ellipsoid((0, -0.017, 0.040), (0.0755 + t, 0.096 + t, 0.085 + t))
    if style != "crop":
        v.ellipsoid((0, -0.035, 0.010), (0.070 + t, 0.072 + t, 0.075 + t))
        v.ellipsoid((0.012, 0.045, 0.098), (0.050, 0.040, 0.026 + t * 0.6))
    if style == "long":
        for s in (-1, 0, 1):
            v.capsule(
                (s * 0.052, -0.045 - 0.025 * (s == 0), 0.02),
                (s * 0.060, -0.062 - 0.02 * (s == 0), -0.165),
                0.045,
                0.033,
            )
    if style == "bun":
        v.ellipsoid((0, -0.125, 0.055), (0.036, 0.032, 0.036))
    if style == "tail":
        v.capsule((0, -0.108, 0.045), (0, -0.150, 0.010), 0.020, 0.026)
        v.capsule((0, -0.150, 0.010), (0, -0.128, -0.130), 0.026, 0.010)
    points, faces = v.merge(0.0075, 2)
    shift = np.array([noise.noise((x * 60 + seed, y * 26, z * 26)) for x, y, z in points])
    points = points + normals((points, faces)) * (0.0045 * shift)[:, None]
    wobble = np.array([noise.noise((x * 70, y * 40, z * 40 + seed)) for x, y, z in points]) * 0.008
    line = _hairline(points, style) + wobble
    visible_faces = [f for f in faces if any(points[i][2] > line[i] for i in f)]
    return points, visible_faces


def _hairline(points: np.ndarray, style: str) -> np.ndarray:
    """Return the height of the hair's lower edge, which depends on how far forward a point is.

    The edge is high at the forehead, just above the ears, and low at the back of the neck.
    """
    y = points[:, 1]
    table = [
        (-0.2, -0.075),
        (-0.06, -0.065),
        (-0.028, -0.012),
        (0.012, 0.006),
        (0.026, 0.030),
        (0.042, 0.072),
        (0.075, 0.083),
        (0.2, 0.086),
    ]
    if style in ("long", "tail"):
        table[:3] = [(-0.2, -0.30), (-0.022, -0.30), (-0.020, -0.03)]
    return np.interp(y, [t[0] for t in table], [t[1] for t in table])


def to_posed(surface: SurfaceMesh, frame: Matrix) -> SurfaceMesh:
    """Return a surface transformed from head coordinates to posed coordinates."""
    points, faces = surface
    offset = Vector(CENTRE)
    return np.array([tuple(frame @ (Vector(p) + offset)) for p in points]), faces
