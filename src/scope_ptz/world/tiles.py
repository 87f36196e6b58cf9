"""The tiles of a viewpoint as geometry: which of them a view shows, where, and how its pixels map to theirs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, Projection, angle_between_deg
from scope_ptz.geometry.sphere import camera_axes

Floats = NDArray[np.float64]
Place = tuple[slice, slice]
"""Rows and columns of a picture."""

_BEHIND = 1e-6
_FAR_PX = 1e5
_INSET_PX = 1.5
_SIDE_POINTS = 8


@dataclass(frozen=True, slots=True)
class Showing:
    """A tile in a picture: which, in which part, and its corners (4, 2) in pixels where straight lines join them."""

    index: int
    place: Place
    corners: Floats | None

    def mask(self) -> NDArray[np.uint8] | None:
        """(H, W) of the part: 255 inside the tile, at least a pixel from its edge. None where the corners do not tell."""
        if self.corners is None or np.abs(self.corners).max() > _FAR_PX:
            return None
        rows, columns = self.place
        middle = self.corners.mean(axis=0)
        sides = np.roll(self.corners, -1, axis=0) - self.corners
        towards = middle - self.corners
        away = np.abs(sides[:, 0] * towards[:, 1] - sides[:, 1] * towards[:, 0]) / np.maximum(np.hypot(*sides.T), 1e-9)
        # Shrunk about its middle, so that rounding never reaches beyond the tile.
        inset = middle + (self.corners - middle) * max(0.0, 1.0 - _INSET_PX / max(float(away.min()), 1e-9))
        mask = np.zeros((rows.stop - rows.start, columns.stop - columns.start), dtype=np.uint8)
        points = np.rint((inset - (columns.start + 0.5, rows.start + 0.5)) * 256).astype(np.int32)
        cv2.fillConvexPoly(mask, points, 255, shift=8)
        return mask


class Tiles:
    """Perspective pictures around one optical centre, in order of preference: the sharpest first, then as given."""

    def __init__(self, views: Sequence[Perspective]) -> None:
        self.views = list(views)
        order = sorted(range(len(views)), key=lambda i: (-views[i].focal_px, i))
        self._order = np.array(order, dtype=np.int64)
        self._axes = np.array([camera_axes(v.pan_deg, v.tilt_deg) for v in views]).reshape(-1, 3, 3)
        self._reach_deg = np.array([v.reach_deg for v in views])
        self._outlines = np.array([v.directions(_OUTLINE) for v in views]).reshape(-1, len(_OUTLINE), 3)

    def in_view(self, projection: Projection) -> list[Showing]:
        """Every tile that may show in a picture."""
        if not self.views:
            return []
        apart = angle_between_deg(self._axes[:, 2], projection.directions((0.5, 0.5)))
        near = self._order[(apart <= self._reach_deg + projection.reach_deg)[self._order]]
        size = np.array([projection.width, projection.height])
        outlines = projection.points(self._outlines[near])
        clear: NDArray[np.bool_] = np.asarray(np.isfinite(outlines).all(axis=(1, 2)))
        plain = [isinstance(projection, Perspective) and ok for ok in clear.tolist()]
        shown = zip(near.tolist(), _bounds(projection, outlines), outlines[:, ::_SIDE_POINTS] * size, plain, strict=True)
        return [Showing(i, place, corners if simple else None) for i, place, corners, simple in shown if place is not None]

    def points(self, index: int, projection: Projection, x: Floats, y: Floats) -> Floats:
        """Normalised points (rows, columns, 2) of a tile under the columns ``x`` and rows ``y`` (in pixels) of a picture.

        Far outside the tile, or behind it, they are merely far outside.
        """
        tile = self.views[index]
        if isinstance(projection, Perspective):
            # Both pictures are planes seen from one point, so a 3x3 matrix leads from one to the other.
            turn = self._axes[index] @ camera_axes(projection.pan_deg, projection.tilt_deg).T
            right, up = x - projection.width / 2, projection.height / 2 - y
            local = (
                turn[:, 0, None, None] * right
                + turn[:, 1, None, None] * up[:, None]
                + (turn[:, 2] * projection.focal_px)[:, None, None]
            )
        else:
            points = np.stack(np.meshgrid(x / projection.width, y / projection.height), axis=-1)
            local = np.moveaxis(projection.directions(points) @ self._axes[index].T, -1, 0)
        scale = tile.focal_px / np.maximum(local[2], _BEHIND)
        u, v = 0.5 + local[0] * scale / tile.width, 0.5 - local[1] * scale / tile.height
        return np.where((local[2] > _BEHIND)[..., None], np.stack([u, v], axis=-1), -1e3)


def _bounds(projection: Projection, points: Floats) -> list[Place | None]:
    """For each outline (n, m, 2) of normalised points the rows and columns that it spans; None where it misses the picture."""
    size = np.array([projection.width, projection.height])
    unclear = np.isnan(points).any(axis=(1, 2))
    if isinstance(projection, Equirectangular):
        unclear |= np.ptp(points[..., 0], axis=1) > 0.5  # across the seam
    points = np.clip(np.where(np.isnan(points), 0.0, points), -1.0, 2.0)
    low = np.floor(points.min(axis=1) * size).astype(int) - 1
    high = np.ceil(points.max(axis=1) * size).astype(int) + 1
    low[unclear], high[unclear] = 0, size
    low, high = np.clip(low, 0, size), np.clip(high, 0, size)
    return [
        (slice(y0, y1), slice(x0, x1)) if x0 < x1 and y0 < y1 else None
        for (x0, y0), (x1, y1) in zip(low.tolist(), high.tolist(), strict=True)
    ]


def _outline() -> Floats:
    """Points around a picture, clockwise from its first corner."""
    side = np.arange(_SIDE_POINTS) / _SIDE_POINTS
    zero, one = np.zeros_like(side), np.ones_like(side)
    return np.concatenate([np.stack(p, axis=-1) for p in ((side, zero), (one, side), (1 - side, one), (zero, 1 - side))])


_OUTLINE = _outline()
