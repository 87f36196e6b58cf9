"""Which parts of a view are already covered, in coarse cells."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.simulator.mapping.tiles import POLYGON_SHIFT, Place

CELL_PX = 8


class Cover:
    """Remembers the cells of a view that convex polygons cover completely.

    Args:
        width: Width of the view in pixels.
        height: Height of the view in pixels.
    """

    def __init__(self, width: int, height: int) -> None:
        # One more cell on every side, because a polygon covers a cell completely only if it also reaches all cells around it.
        self._cells = np.zeros((-(-height // CELL_PX) + 2, -(-width // CELL_PX) + 2), np.uint8)
        self._empty = True

    def add(self, polygon: NDArray[np.int32]) -> None:
        """Cover a (4, 2) convex polygon, given in 1/256 pixels."""
        touched = np.zeros_like(self._cells)
        half = 1 << (POLYGON_SHIFT - 1)
        cv2.fillConvexPoly(touched, (polygon + half) // CELL_PX + half, 255, shift=POLYGON_SHIFT)
        cv2.bitwise_or(self._cells, cv2.erode(touched, _AROUND, borderType=cv2.BORDER_CONSTANT, borderValue=0), dst=self._cells)
        self._empty = False

    def add_all(self) -> None:
        """Cover everything."""
        self._cells[...] = 255
        self._empty = False

    def gap(self, part: Place | None) -> Place | None:
        """Return the smallest rectangle of a part that contains all of its uncovered cells, or None if there are none."""
        if part is None or self._empty:
            return part
        rows, columns = part
        top, left = rows.start // CELL_PX, columns.start // CELL_PX
        cells = self._cells[1 + top : 1 - (-rows.stop // CELL_PX), 1 + left : 1 - (-columns.stop // CELL_PX)]
        x, y, width, height = cv2.boundingRect(cv2.bitwise_not(cells))
        if not width:
            return None
        return (
            slice(max(rows.start, (top + y) * CELL_PX), min(rows.stop, (top + y + height) * CELL_PX)),
            slice(max(columns.start, (left + x) * CELL_PX), min(columns.stop, (left + x + width) * CELL_PX)),
        )


def overlap(one: Place, two: Place) -> Place | None:
    """Return the rectangle that two rectangles share, or None."""
    rows, columns = (slice(max(a.start, b.start), min(a.stop, b.stop)) for a, b in zip(one, two, strict=True))
    return (rows, columns) if rows.start < rows.stop and columns.start < columns.stop else None


_AROUND = np.ones((3, 3), np.uint8)
