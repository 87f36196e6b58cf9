"""Geometry of a viewpoint's tiles: which tiles a view shows, where, and how pixels map between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, Projection, angle_between_deg
from scope_ptz.geometry.sphere import camera_axes

Floats = NDArray[np.float64]
Place = tuple[slice, slice]
"""A rectangle of a picture: rows and columns."""

_BEHIND = 1e-6
_FAR_PX = 1e5
_INSET_PX = 1.5
POLYGON_SHIFT = 8
"""Bits after the binary point of polygon coordinates, as OpenCV expects them."""
_SIDE_POINTS = 8

KEPT_ANSWERS = 4  # a view and its half-size version, for two cameras


class TileInView(NamedTuple):
    """A tile in a picture and the part of the picture in which it shows.

    For perspective pictures, ``turn`` is the (3, 3) rotation from the picture's axes to the tile's, and ``polygon`` is a (4, 2)
    outline at least one pixel inside the tile, in 1/256 pixels as OpenCV expects. Both are None for panoramas.
    """

    tile: int
    place: Place
    turn: Floats | None
    polygon: NDArray[np.int32] | None

    def mask(self) -> NDArray[np.uint8] | None:
        """Return an (H, W) mask of the part that is 255 inside the polygon, or None without a polygon."""
        if self.polygon is None:
            return None
        rows, columns = self.place
        mask = np.zeros((rows.stop - rows.start, columns.stop - columns.start), dtype=np.uint8)
        return np.asarray(
            cv2.fillConvexPoly(
                mask, self.polygon - (columns.start << POLYGON_SHIFT, rows.start << POLYGON_SHIFT), 255, shift=POLYGON_SHIFT
            )
        )


class Tiles:
    """Perspective pictures around one optical centre, the sharpest first; equally sharp ones keep their order."""

    def __init__(self, views: Sequence[Perspective]) -> None:
        self.views = list(views)
        order = sorted(range(len(views)), key=lambda i: (-views[i].focal_px, i))
        self._order = np.array(order, dtype=np.int64)
        self._axes = np.array([camera_axes(v.pan_deg, v.tilt_deg) for v in views]).reshape(-1, 3, 3)
        self._reach_deg = np.array([v.reach_deg for v in views])
        self._answers: list[tuple[Projection, list[TileInView]]] = []
        self._outlines = np.array([v.directions(OUTLINE) for v in views]).reshape(-1, len(OUTLINE), 3)

    def in_view(self, projection: Projection) -> list[TileInView]:
        """Return every tile that may show in a picture. The last answers are kept, because several layers ask the same."""
        for known, found in self._answers:
            if known == projection:
                return found
        found = self._find(projection)
        self._answers = [(projection, found), *self._answers[: KEPT_ANSWERS - 1]]
        return found

    def _find(self, projection: Projection) -> list[TileInView]:
        if not self.views:
            return []
        apart = angle_between_deg(self._axes[:, 2], projection.directions((0.5, 0.5)))
        near = self._order[(apart <= self._reach_deg + projection.reach_deg)[self._order]]
        size = np.array([projection.width, projection.height])
        outlines = projection.points(self._outlines[near])
        places = bounds(projection, outlines)
        if isinstance(projection, Perspective):
            turns = list(self._axes[near] @ camera_axes(projection.pan_deg, projection.tilt_deg).T)
            polygons = _inset(outlines[:, ::_SIDE_POINTS] * size)
            shown = [TileInView(*fields) for fields in zip(near.tolist(), places, turns, polygons, strict=True)]
        else:
            shown = [TileInView(i, place, None, None) for i, place in zip(near.tolist(), places, strict=True)]
        return [showing for showing in shown if showing.place[0].start < showing.place[0].stop]

    def points(self, showing: TileInView, projection: Projection, x: Floats, y: Floats) -> Floats:
        """Return the tile's normalised points (rows, columns, 2) under columns ``x`` and rows ``y`` (pixels) of a picture.

        Points behind the tile's camera get coordinates far outside the tile.
        """
        tile = self.views[showing.tile]
        if showing.turn is not None:
            right, up = x - projection.width / 2, projection.height / 2 - y
            constant = showing.turn[:, 1, None] * up + showing.turn[:, 2, None] * projection.density
            local = showing.turn[:, 0, None, None] * right + constant[..., None]
        else:
            points = np.stack(np.meshgrid(x / projection.width, y / projection.height), axis=-1)
            local = np.moveaxis(projection.directions(points) @ self._axes[showing.tile].T, -1, 0)
        scale = tile.focal_px / np.maximum(local[2], _BEHIND)
        found = np.empty((*local.shape[1:], 2))
        found[..., 0] = local[0] * (scale / tile.width) + 0.5
        found[..., 1] = local[1] * (scale / -tile.height) + 0.5
        if local[2].min() <= _BEHIND:
            found[local[2] <= _BEHIND] = -1e3
        return found


def _inset(corners: Floats) -> list[NDArray[np.int32] | None]:
    """Shrink quadrilaterals (n, 4, 2) about their centres, so that rounding never reaches beyond the tile."""
    middle = corners.mean(axis=1, keepdims=True)
    sides, towards = np.roll(corners, -1, axis=1) - corners, middle - corners
    across = np.abs(sides[..., 0] * towards[..., 1] - sides[..., 1] * towards[..., 0])
    away = (across / np.maximum(np.sqrt((sides**2).sum(axis=-1)), 1e-9)).min(axis=1)
    inset = middle + (corners - middle) * np.maximum(0.0, 1.0 - _INSET_PX / np.maximum(away, 1e-9))[:, None, None]
    clear = np.abs(corners).max(axis=(1, 2)) < _FAR_PX  # also false for NaN
    fixed = np.rint((np.where(clear[:, None, None], inset, 0.0) - 0.5) * (1 << POLYGON_SHIFT)).astype(np.int32)
    return [polygon if fine else None for polygon, fine in zip(fixed, clear.tolist(), strict=True)]


def bounds(projection: Projection, points: Floats) -> list[Place]:
    """Return the rows and columns that each outline (n, m, 2) spans; they are empty where it misses the picture."""
    size = np.array([projection.width, projection.height])
    unclear = np.isnan(points).any(axis=(1, 2))
    if isinstance(projection, Equirectangular):
        unclear |= np.ptp(points[..., 0], axis=1) > 0.5  # it crosses the seam
    points = np.clip(np.where(np.isnan(points), 0.0, points), -1.0, 2.0)
    low = np.floor(points.min(axis=1) * size).astype(int) - 1
    high = np.ceil(points.max(axis=1) * size).astype(int) + 1
    low[unclear], high[unclear] = 0, size
    low, high = np.clip(low, 0, size), np.clip(high, 0, size)
    high[(low >= high).any(axis=1)] = 0
    return [(slice(y0, max(y0, y1)), slice(x0, x1)) for (x0, y0), (x1, y1) in zip(low.tolist(), high.tolist(), strict=True)]


def _outline() -> Floats:
    """Return points around the border of a picture, clockwise from the top-left corner."""
    side = np.arange(_SIDE_POINTS) / _SIDE_POINTS
    zero, one = np.zeros_like(side), np.ones_like(side)
    return np.concatenate([np.stack(p, axis=-1) for p in ((side, zero), (one, side), (1 - side, one), (zero, 1 - side))])


OUTLINE = _outline()
