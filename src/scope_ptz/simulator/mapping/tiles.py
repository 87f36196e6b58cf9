"""Geometry of a viewpoint's tiles: which tiles are visible in which parts of a view, and how pixels map between view and tile."""

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
"""A rectangular part of an image, as slices of rows and columns."""

BEHIND = 1e-6  # points with at most this depth along the optical axis count as behind the camera
BEHIND_POSITION = -1e3  # normalised coordinates of points behind a camera, far outside its image
_FAR_PX = 1e5  # tiles with a corner farther away than this have no polygon
_INSET_PX = 1.5  # distance between a polygon and its tile's edges
POLYGON_SHIFT = 8
"""Number of fractional bits of polygon coordinates, as passed to OpenCV."""
_SIDE_POINTS = 8  # outline points on each side of an image

MAX_CACHED_RESULTS = 4  # enough for a view and its half-size version, for two cameras


class TileInView(NamedTuple):
    """A tile in an image, and the part of the image that it may cover.

    For perspective images, ``turn`` is the (3, 3) rotation from the image's axes to the tile's, and ``polygon`` is a (4, 2)
    outline at least one pixel inside the tile, in 1/256 pixels. Both are None for panoramas. ``edges`` are the (4, 3) half-planes
    (a, b, c) of the polygon, or of ``place`` without a polygon: ``a * x + b * y + c`` is the distance from the edge in pixels,
    positive inside.
    """

    tile: int
    place: Place
    turn: Floats | None
    polygon: NDArray[np.int32] | None
    edges: Floats

    def mask(self) -> NDArray[np.uint8] | None:
        """Return an (H, W) mask of the part, 255 inside the polygon; None if there is no polygon."""
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
    """Perspective images around one optical centre, the sharpest first. Equally sharp images keep their order."""

    def __init__(self, views: Sequence[Perspective]) -> None:
        self.views = list(views)
        order = sorted(range(len(views)), key=lambda i: (-views[i].focal_px, i))
        self._order = np.array(order, dtype=np.int64)
        self._axes = np.array([camera_axes(v.pan_deg, v.tilt_deg) for v in views]).reshape(-1, 3, 3)
        self._reach_deg = np.array([v.max_off_axis_deg for v in views])
        self._results: list[tuple[Projection, list[TileInView]]] = []
        self._outlines = np.array([v.directions(OUTLINE) for v in views]).reshape(-1, len(OUTLINE), 3)

    def in_view(self, projection: Projection) -> list[TileInView]:
        """Return every tile that may be visible in an image. Recent results are cached, because several layers need them."""
        for cached, tiles in self._results:
            if cached == projection:
                return tiles
        tiles = self._find(projection)
        self._results = [(projection, tiles), *self._results[: MAX_CACHED_RESULTS - 1]]
        return tiles

    def _find(self, projection: Projection) -> list[TileInView]:
        if not self.views:
            return []
        separation_deg = angle_between_deg(self._axes[:, 2], projection.directions((0.5, 0.5)))
        candidates = self._order[(separation_deg <= self._reach_deg + projection.max_off_axis_deg)[self._order]]
        size = np.array([projection.width, projection.height])
        outlines = projection.points(self._outlines[candidates])
        places = bounds(projection, outlines)
        turns: list[Floats | None]
        polygons: list[NDArray[np.int32] | None]
        if isinstance(projection, Perspective):
            turns = list(self._axes[candidates] @ camera_axes(projection.pan_deg, projection.tilt_deg).T)
            polygons = _shrink_polygons(outlines[:, ::_SIDE_POINTS] * size)
        else:
            turns, polygons = [None] * len(candidates), [None] * len(candidates)
        edges = _edges(polygons, places)
        tiles_in_view = [TileInView(*fields) for fields in zip(candidates.tolist(), places, turns, polygons, edges, strict=True)]
        return [tile_in_view for tile_in_view in tiles_in_view if tile_in_view.place[0].start < tile_in_view.place[0].stop]

    def points(self, tile_in_view: TileInView, projection: Projection, x: Floats, y: Floats) -> Floats:
        """Return the tile's normalised points, as (rows, columns, 2), at columns ``x`` and rows ``y`` (pixels) of an image.

        Points behind the tile's camera get coordinates far outside the tile.
        """
        tile = self.views[tile_in_view.tile]
        if tile_in_view.turn is not None:
            right, up = x - projection.width / 2, projection.height / 2 - y
            constant = tile_in_view.turn[:, 1, None] * up + tile_in_view.turn[:, 2, None] * projection.pixels_per_radian
            local = tile_in_view.turn[:, 0, None, None] * right + constant[..., None]
        else:
            points = np.stack(np.meshgrid(x / projection.width, y / projection.height), axis=-1)
            local = np.moveaxis(projection.directions(points) @ self._axes[tile_in_view.tile].T, -1, 0)
        scale = tile.focal_px / np.maximum(local[2], BEHIND)
        normalised = np.empty((*local.shape[1:], 2))
        normalised[..., 0] = local[0] * (scale / tile.width) + 0.5
        normalised[..., 1] = local[1] * (scale / -tile.height) + 0.5
        if local[2].min() <= BEHIND:
            normalised[local[2] <= BEHIND] = BEHIND_POSITION
        return normalised


def _shrink_polygons(corners: Floats) -> list[NDArray[np.int32] | None]:
    """Shrink quadrilaterals (n, 4, 2) about their centres, so that they stay inside the tiles after rounding."""
    centre = corners.mean(axis=1, keepdims=True)
    sides, to_centre = np.roll(corners, -1, axis=1) - corners, centre - corners
    areas = np.abs(sides[..., 0] * to_centre[..., 1] - sides[..., 1] * to_centre[..., 0])
    distances = (areas / np.maximum(np.sqrt((sides**2).sum(axis=-1)), 1e-9)).min(axis=1)
    inset = centre + (corners - centre) * np.maximum(0.0, 1.0 - _INSET_PX / np.maximum(distances, 1e-9))[:, None, None]
    in_range = np.abs(corners).max(axis=(1, 2)) < _FAR_PX  # also false for NaN
    rounded = np.rint((np.where(in_range[:, None, None], inset, 0.0) - 0.5) * (1 << POLYGON_SHIFT)).astype(np.int32)
    return [polygon if is_in_range else None for polygon, is_in_range in zip(rounded, in_range.tolist(), strict=True)]


def _edges(polygons: Sequence[NDArray[np.int32] | None], places: Sequence[Place]) -> Floats:
    """Return the (n, 4, 3) half-planes of convex polygons, or of the rectangles of places that have no polygon."""
    corners = np.array(
        [
            [(x.start, y.start), (x.stop - 1, y.start), (x.stop - 1, y.stop - 1), (x.start, y.stop - 1)]
            if polygon is None
            else polygon / (1 << POLYGON_SHIFT)
            for polygon, (y, x) in zip(polygons, places, strict=True)
        ]
    ).reshape(-1, 4, 2)
    sides = np.roll(corners, -1, axis=1) - corners
    normals = np.stack([-sides[..., 1], sides[..., 0]], axis=-1) / np.maximum(np.sqrt((sides**2).sum(axis=-1)), 1e-9)[..., None]
    offsets = -(normals * corners).sum(axis=-1)
    # Orient the edges so that the centre of the polygon is inside.
    inside = (normals * corners.mean(axis=1, keepdims=True)).sum(axis=-1) + offsets
    return np.concatenate([normals, offsets[..., None]], axis=-1) * np.where(inside < 0, -1.0, 1.0)[..., None]


def bounds(projection: Projection, points: Floats) -> list[Place]:
    """Return the rows and columns that each outline (n, m, 2) spans; empty for outlines outside the image."""
    size = np.array([projection.width, projection.height])
    unclear = np.isnan(points).any(axis=(1, 2))
    if isinstance(projection, Equirectangular):
        unclear |= np.ptp(points[..., 0], axis=1) > 0.5  # the outline crosses the seam
    points = np.minimum(np.maximum(np.where(np.isnan(points), 0.0, points), -1.0), 2.0)
    low = np.floor(points.min(axis=1) * size).astype(int) - 1
    high = np.ceil(points.max(axis=1) * size).astype(int) + 1
    low[unclear], high[unclear] = 0, size
    low, high = (np.minimum(np.maximum(corner, 0), size) for corner in (low, high))
    high[(low >= high).any(axis=1)] = 0
    return [(slice(y0, max(y0, y1)), slice(x0, x1)) for (x0, y0), (x1, y1) in zip(low.tolist(), high.tolist(), strict=True)]


def _outline() -> Floats:
    """Return points around the border of an image, clockwise from the top-left corner."""
    side = np.arange(_SIDE_POINTS) / _SIDE_POINTS
    zero, one = np.zeros_like(side), np.ones_like(side)
    return np.concatenate([np.stack(p, axis=-1) for p in ((side, zero), (one, side), (1 - side, one), (zero, 1 - side))])


OUTLINE = _outline()
