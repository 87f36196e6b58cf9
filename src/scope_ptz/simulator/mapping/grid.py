"""Coarse grids over an image, on which maps are computed exactly and from which they are interpolated."""

from __future__ import annotations

import math
from collections.abc import Hashable
from functools import cached_property, lru_cache
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Projection, pan_tilt_deg
from scope_ptz.simulator.mapping.tiles import Place

MAX_MAP_ERROR_PX = 0.04
"""Maximum permitted error of an interpolated map, in view pixels."""

MAX_STEP_PX = 32  # maximum distance between grid nodes

Floats = NDArray[np.float64]


class Grid:
    """Nodes ``step`` pixels apart that cover a part of an image and one step beyond it.

    ``x`` and ``y`` are the columns and rows of the nodes in pixels, counted from the image's top-left corner.
    """

    def __init__(self, projection: Projection, step: int, place: Place | None = None) -> None:
        self.projection, self.step = projection, step
        self.place = place or (slice(0, projection.height), slice(0, projection.width))
        self._origin, self._first = self.place, (0, 0)

    @cached_property
    def x(self) -> Floats:
        return self._nodes(1)

    @cached_property
    def y(self) -> Floats:
        return self._nodes(0)

    def _nodes(self, axis: int) -> Floats:
        span, step, first = self.place[axis], self.step, self._first[axis]
        count = -(-(span.stop - span.start) // step) + 2
        return np.asarray(self._origin[axis].start + (np.arange(first, first + count) - 0.5) * step)

    @property
    def covers_all(self) -> bool:
        """Whether the grid covers the whole image."""
        rows, columns = self.place
        return (rows.stop - rows.start, columns.stop - columns.start) == (self.projection.height, self.projection.width)

    def directions(self) -> Floats:
        """Return (rows, columns, 3) unit vectors at the nodes."""
        points = np.stack(np.meshgrid(self.x / self.projection.width, self.y / self.projection.height), axis=-1)
        return self.projection.directions(points)

    def inner(self, part: Place) -> Grid:
        """Return a grid with only the nodes that a part of the image requires. Interpolated values stay the same."""
        top, left = ((requested.start - whole.start) // self.step for whole, requested in zip(self.place, part, strict=True))
        rows, columns = self.place
        place = (
            slice(rows.start + top * self.step, part[0].stop),
            slice(columns.start + left * self.step, part[1].stop),
        )
        grid = Grid(self.projection, self.step, place)
        grid._origin, grid._first = self._origin, (self._first[0] + top, self._first[1] + left)
        return grid

    def to_pixels(self, nodes: Floats | NDArray[np.float32], part: Place | None = None) -> NDArray[np.float32]:
        """Interpolate node values to the centre of each pixel.

        Args:
            nodes: (rows, columns) or (rows, columns, n) values at all nodes.
            part: The rows and columns of the image that are needed; by default, all that the grid covers. The result equals
                that part of the whole.
        """
        n, (rows, columns) = self.step, part or self.place
        top, left = rows.start - self.place[0].start, columns.start - self.place[1].start
        height, width = rows.stop - rows.start, columns.stop - columns.start
        first_row, first_column = top // n, left // n
        last_row, last_column = -(-(top + height) // n) + 2, -(-(left + width) // n) + 2
        used = nodes[first_row:last_row, first_column:last_column].astype(np.float32, copy=False)
        fine: NDArray[np.float32] = cv2.resize(used, (used.shape[1] * n, used.shape[0] * n), interpolation=cv2.INTER_LINEAR)
        y, x = n + top - first_row * n, n + left - first_column * n
        return fine[y : y + height, x : x + width]


def step_px(projection: Projection) -> int:
    """Return the distance between grid nodes in pixels.

    This is the largest power of two for which the interpolation error, ``step ** 2 / 8 * curvature``, is within
    ``MAX_MAP_ERROR_PX``.
    """
    return _step_px(cast(Hashable, projection))


@lru_cache(maxsize=64)
def _step_px(projection: Projection) -> int:
    if isinstance(projection, Equirectangular):
        return 8
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.0], [0.5, 1.0]])
    poles = projection.points(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
    if np.any(np.all((poles > -0.05) & (poles < 1.05), axis=-1)):
        return 1
    _, tilt = pan_tilt_deg(projection.directions(corners))
    from_pole = math.radians(90.0 - float(np.abs(tilt).max()))
    max_step = math.sqrt(8 * MAX_MAP_ERROR_PX * projection.pixels_per_radian * math.sin(from_pole))
    return int(min(MAX_STEP_PX, 2 ** math.floor(math.log2(max(1.0, max_step)))))
