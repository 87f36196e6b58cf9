"""Frames at their adjusted positions on the sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scope_ptz.geometry import Perspective, pan_tilt_deg

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PlacedFrame:
    """A frame with its adjusted orientation, which, unlike a camera pose, may include roll.

    Attributes:
        axes: The right, up and forward axes, as the rows of a (3, 3) matrix.
        focal_px: Focal length in pixels.
        width: Width in pixels.
        height: Height in pixels.
    """

    axes: Floats
    focal_px: float
    width: int
    height: int

    @property
    def max_off_axis_deg(self) -> float:
        """Largest angle in degrees between the frame's centre and any of its pixels."""
        return math.degrees(math.atan(math.hypot(self.width, self.height) / 2 / self.focal_px))

    @property
    def upright(self) -> Perspective:
        """The same view without roll."""
        pan, tilt = pan_tilt_deg(self.axes[2])
        hfov_deg = math.degrees(2 * math.atan(self.width / 2 / self.focal_px))
        return Perspective(float(pan), float(tilt), hfov_deg, self.width, self.height)

    def directions(self, points: ArrayLike) -> Floats:
        """Return unit direction vectors (..., 3) for points (..., 2), from (0, 0) at the top left to (1, 1) at the bottom right."""
        p = np.asarray(points, dtype=np.float64)
        local = np.stack(
            [(p[..., 0] - 0.5) * self.width, (0.5 - p[..., 1]) * self.height, np.full(p.shape[:-1], self.focal_px)], axis=-1
        )
        return np.asarray(local @ self.axes / np.linalg.norm(local, axis=-1, keepdims=True))

    def points(self, directions: ArrayLike) -> Floats:
        """Return the points (..., 2) at which directions (..., 3) appear.

        Points range from (0, 0) at the top left to (1, 1) at the bottom right. Points for directions behind the camera are NaN.
        """
        local = np.asarray(directions, dtype=np.float64) @ self.axes.T
        depth = np.where(local[..., 2] > 0.05, local[..., 2], np.nan)
        x = 0.5 + self.focal_px * local[..., 0] / depth / self.width
        y = 0.5 - self.focal_px * local[..., 1] / depth / self.height
        return np.stack([x, y], axis=-1)
