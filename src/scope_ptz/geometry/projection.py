"""Projections between image points and directions, for perspective views and panoramas.

Points are normalised to [0, 1] with the origin at the top-left corner of the image, so the centre of pixel ``i`` of ``n`` is at
``(i + 0.5) / n``. Arrays of points have shape ``(..., 2)``, arrays of directions ``(..., 3)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scope_ptz.geometry.sphere import camera_axes, direction, pan_tilt_deg

Floats = NDArray[np.float64]


class Projection(Protocol):
    """The mapping between image points and directions around the camera."""

    @property
    def width(self) -> int: ...

    @property
    def height(self) -> int: ...

    @property
    def max_off_axis_deg(self) -> float:
        """Largest angle in degrees between the image centre and any pixel."""
        ...

    @property
    def pixels_per_radian(self) -> float:
        """Pixels per radian in the vertical direction at the centre of the image."""
        ...

    def directions(self, points: ArrayLike) -> Floats:
        """Return unit direction vectors (..., 3) for normalised points (..., 2)."""
        ...

    def points(self, directions: ArrayLike) -> Floats:
        """Return normalised points (..., 2) for directions (..., 3); NaN for directions behind the camera."""
        ...


@dataclass(frozen=True, slots=True)
class Perspective:
    """A pinhole view with square pixels and no roll, centred at ``pan_deg`` and ``tilt_deg``."""

    pan_deg: float
    tilt_deg: float
    hfov_deg: float
    width: int
    height: int

    @property
    def focal_px(self) -> float:
        """Focal length in pixels."""
        return self.width / 2 / math.tan(math.radians(self.hfov_deg) / 2)

    @property
    def vfov_deg(self) -> float:
        """Vertical field of view in degrees."""
        return math.degrees(2 * math.atan(self.height / 2 / self.focal_px))

    @property
    def max_off_axis_deg(self) -> float:
        return math.degrees(math.atan(math.hypot(self.width, self.height) / 2 / self.focal_px))

    @property
    def pixels_per_radian(self) -> float:
        return self.focal_px

    def directions(self, points: ArrayLike) -> Floats:
        p = np.asarray(points, dtype=np.float64)
        local = np.empty((*p.shape[:-1], 3))
        local[..., 0], local[..., 1], local[..., 2] = (p[..., 0] - 0.5) * self.width, (0.5 - p[..., 1]) * self.height, self.focal_px
        rays = local @ camera_axes(self.pan_deg, self.tilt_deg)
        return np.asarray(rays / np.sqrt(np.add.reduce(rays * rays, axis=-1, keepdims=True)))

    def points(self, directions: ArrayLike) -> Floats:
        local = np.asarray(directions, dtype=np.float64) @ camera_axes(self.pan_deg, self.tilt_deg).T
        depth = np.where(local[..., 2] > 1e-9, local[..., 2], np.nan)
        focal_px, result = self.focal_px, np.empty((*local.shape[:-1], 2))
        result[..., 0] = 0.5 + focal_px * local[..., 0] / depth / self.width
        result[..., 1] = 0.5 - focal_px * local[..., 1] / depth / self.height
        return result


@dataclass(frozen=True, slots=True)
class Equirectangular:
    """An equirectangular panorama: columns are linear in pan, and rows are linear in tilt.

    It covers ``pan_span_deg`` (at most 360) clockwise from ``left_pan_deg``.
    """

    left_pan_deg: float
    pan_span_deg: float
    top_tilt_deg: float
    bottom_tilt_deg: float
    width: int
    height: int

    @property
    def max_off_axis_deg(self) -> float:
        return 180.0

    @property
    def pixels_per_radian(self) -> float:
        return self.height / math.radians(self.top_tilt_deg - self.bottom_tilt_deg)

    def directions(self, points: ArrayLike) -> Floats:
        p = np.asarray(points, dtype=np.float64)
        pan = self.left_pan_deg + p[..., 0] * self.pan_span_deg
        tilt = self.top_tilt_deg + p[..., 1] * (self.bottom_tilt_deg - self.top_tilt_deg)
        return direction(pan, tilt)

    def points(self, directions: ArrayLike) -> Floats:
        pan, tilt = pan_tilt_deg(directions)
        turn = np.mod(pan - self.left_pan_deg, 360.0)
        return np.stack(
            [turn / self.pan_span_deg, (self.top_tilt_deg - tilt) / (self.top_tilt_deg - self.bottom_tilt_deg)], axis=-1
        )
