"""Coarse bounds on the static world, which quickly show where nothing can hide an actor.

Most of an actor is usually in front of everything else, so only the pixels in the remaining parts need the exact test.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection, pan_tilt_deg
from scope_ptz.simulator.mapping.tiles import Place
from scope_ptz.simulator.models import Band

BLOCK_TEXELS = 4
"""Side of the depth-layer blocks for which bounds are stored."""

REACH_BLOCKS = 3
"""A block's bounds also hold for this many blocks around it."""

FLAT_M = 0.05
"""A surface up to this height above the ground under an actor counts as ground, which never hides the actor."""

MIN_CELL_PX = 4  # with smaller cells, the coarse test would take as long as the exact test

TOLERANCE_M = 0.15
TOLERANCE_FRACTION = 0.01
"""Tolerance for every occlusion test: an actor is hidden where the static world is nearer by more than this.

The tolerance is the sum of a distance in metres and a fraction of the distance to the static world.
"""

Floats = NDArray[np.float32]
Floats64 = NDArray[np.float64]
Indices = NDArray[np.int64]


class Clearance:
    """Bounds on the static world's distances and heights around each block of a viewpoint's depth layer.

    Args:
        codes: (H, W) distance codes of the depth layer.
        metres: (65536,) table from codes to metres. The code 0 is the sky.
        band: The band of the sphere that the layer covers.
    """

    def __init__(self, codes: NDArray[np.uint16], metres: Floats, band: Band) -> None:
        (self._height, self._width), self._band = codes.shape, band
        tilt_deg = band.top_tilt_deg - (np.arange(self._height) + 0.5) / self._height * (band.top_tilt_deg - band.bottom_tilt_deg)
        # Codes increase with distance, except that of the sky. Subtracting 1 makes the sky the farthest.
        nearest = codes[:, ::BLOCK_TEXELS] - np.uint16(1)
        for column in range(1, BLOCK_TEXELS):
            others = codes[:, column::BLOCK_TEXELS] - np.uint16(1)
            np.minimum(nearest[:, : others.shape[1]], others, out=nearest[:, : others.shape[1]])
        distance_m = np.take(np.roll(metres, -1), nearest)
        rise = np.sin(np.radians(tilt_deg)).astype(np.float32)[:, None]
        height_m = np.multiply(distance_m, rise, out=np.full_like(distance_m, -np.inf), where=np.isfinite(distance_m))
        rows = np.arange(0, self._height, BLOCK_TEXELS)
        self._nearest_m = np.minimum.reduceat(distance_m, rows)
        self._highest_m = np.maximum.reduceat(height_m, rows)
        kernel, border = np.ones((2 * REACH_BLOCKS + 1, 2 * REACH_BLOCKS + 1), np.uint8), REACH_BLOCKS
        for bounds, spread in ((self._nearest_m, cv2.erode), (self._highest_m, cv2.dilate)):
            around = cv2.copyMakeBorder(bounds, 0, 0, border, border, cv2.BORDER_WRAP)
            bounds[...] = spread(around, kernel)[:, border:-border]

    def find_uncertain_part(
        self,
        projection: Projection,
        part: Place,
        needed: NDArray[np.uint8],
        *,
        steepest_rise: float,
        reach_px: float,
        far_m: float,
        ground_m: float,
    ) -> Place | None:
        """Return the smallest rectangle, relative to a part of a view, outside which nothing can hide an actor.

        The actor's shadow may be drawn over objects that are farther away than the actor, as if it fell on them.

        Args:
            projection: The view.
            part: Rows and columns of the view.
            needed: (rows, columns) mask of the part, 0 where the actor is not drawn.
            steepest_rise: Largest vertical component, upwards or downwards, of the unit vectors through the part.
            reach_px: Radius around a pixel from which the exact test takes distances.
            far_m: Distance to the actor's farthest point, not counting its shadow on the ground.
            ground_m: Height of the ground under the actor, relative to the optical centre.

        Returns:
            The rectangle, or None if the whole actor is visible.
        """
        # The bounds of the block at a cell's centre hold for all pixels in the cell. Steep pixels span more pan.
        texel_px = projection.pixels_per_radian * 2 * math.pi / self._width * math.sqrt(max(0.0, 1 - steepest_rise**2))
        cell_px = int(2 * ((REACH_BLOCKS * BLOCK_TEXELS - 1) * texel_px - reach_px))
        if cell_px < MIN_CELL_PX:
            return slice(0, needed.shape[0]), slice(0, needed.shape[1])
        rows, columns = (np.arange(0, size, cell_px) for size in needed.shape)
        centres = (span.start + first + cell_px / 2 for span, first in zip(part, (rows, columns), strict=True))
        row, column = self._blocks(projection, *centres)
        drawn = np.maximum.reduceat(np.maximum.reduceat(needed, rows), columns, axis=1) > 0
        clear = self._nearest_m[row, column] * np.float32(1 + TOLERANCE_FRACTION) >= far_m - TOLERANCE_M
        if ground_m < 0:
            clear |= self._highest_m[row, column] * np.float32(1 + TOLERANCE_FRACTION) <= ground_m + FLAT_M
        found = cv2.boundingRect((~clear & drawn).view(np.uint8))
        left, top, width, height = (cell_px * value for value in found)
        return (slice(top, top + height), slice(left, left + width)) if width else None

    def _blocks(self, projection: Projection, y: Floats64, x: Floats64) -> tuple[Indices, Indices]:
        """Return the rows and columns of the blocks at every combination of a row and a column of a view."""
        points = np.stack(np.meshgrid(x / projection.width, y / projection.height), axis=-1)
        pan_deg, tilt_deg = pan_tilt_deg(projection.directions(points))
        rows, columns = self._nearest_m.shape
        down = (self._band.top_tilt_deg - tilt_deg) / (self._band.top_tilt_deg - self._band.bottom_tilt_deg) * self._height
        right = (pan_deg + 180.0) / 360.0 * self._width
        row = np.minimum(np.maximum((down / BLOCK_TEXELS).astype(np.int64), 0), rows - 1)
        return row, (right / BLOCK_TEXELS).astype(np.int64) % columns
