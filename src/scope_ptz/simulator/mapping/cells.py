"""Determine, in coarse cells, where each tile is visible in a view, so that hidden parts of tiles are not computed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scope_ptz.simulator.mapping.tiles import Place, TileInView

CELL_PX = 32  # side of a cell in pixels

MARGIN_PX = 1.5
"""Minimum distance in pixels from a tile's edges to a cell that counts as inside or outside, because OpenCV rounds outlines."""

Bools = NDArray[np.bool_]


class VisibleTile(NamedTuple):
    """A tile that may be partly visible in a view, and the rows and columns of the part that may be visible.

    ``whole`` is true if the tile covers every pixel of these rows and columns.
    """

    in_view: TileInView
    place: Place
    whole: bool


def visible_tiles(tiles_in_view: Sequence[TileInView], part: Place) -> tuple[list[VisibleTile], Place | None]:
    """Return the tiles that may be visible in a part of a view, and where the panorama may be visible.

    Args:
        tiles_in_view: Tiles that may be visible, sharpest first. Each tile hides those after it.
        part: The rows and columns of the view that are needed.

    Returns:
        The visible tiles in the same order, and the smallest rectangle around all cells that no tile covers; None if there are no
        such cells.
    """
    overlapping = [tile_in_view for tile_in_view in tiles_in_view if overlap(tile_in_view.place, part) is not None]
    if not overlapping:
        return [], part
    touched, filled = _cell_masks(overlapping, part)
    covered = np.asarray(np.logical_or.accumulate(filled, axis=0))
    needed: Bools = np.concatenate([touched, ~covered[-1:]])  # the last element is the panorama
    needed[1:-1] &= ~covered[:-1]
    in_rows, in_columns = (np.asarray(needed.any(axis=axis)) for axis in (2, 1))
    top, left = in_rows.argmax(axis=1), in_columns.argmax(axis=1)
    bottom = in_rows.shape[1] - in_rows[:, ::-1].argmax(axis=1)
    right = in_columns.shape[1] - in_columns[:, ::-1].argmax(axis=1)
    tiles: list[VisibleTile] = []
    rest: Place | None = None
    for k in np.flatnonzero(in_rows.any(axis=1)).tolist():
        place = _pixels(part, (top[k], bottom[k]), (left[k], right[k]))
        if k == len(overlapping):
            rest = place
        elif (visible := overlap(place, overlapping[k].place)) is not None:
            tiles.append(VisibleTile(overlapping[k], visible, bool(filled[k, top[k] : bottom[k], left[k] : right[k]].all())))
    return tiles, rest


def overlap(one: Place, two: Place) -> Place | None:
    """Return the intersection of two rectangles, or None if they do not overlap."""
    (rows, columns), (other_rows, other_columns) = one, two
    top, bottom = max(rows.start, other_rows.start), min(rows.stop, other_rows.stop)
    left, right = max(columns.start, other_columns.start), min(columns.stop, other_columns.stop)
    return (slice(top, bottom), slice(left, right)) if top < bottom and left < right else None


def _cell_masks(tiles_in_view: Sequence[TileInView], part: Place) -> tuple[Bools, Bools]:
    """Return two (tiles, rows, columns) masks of the cells in a part: the cells that a tile may touch, and those that it covers."""
    # The distance from an edge to a pixel (x, y) is a * x + b * y + c, so its extremes over a cell are those of a * x and b * y.
    edges = np.array([tile_in_view.edges for tile_in_view in tiles_in_view], np.float32)[..., None]
    extremes = []
    for axis, span in ((1, part[0]), (0, part[1])):
        first = np.arange(span.start, span.stop, CELL_PX, dtype=np.float32)
        last = np.minimum(first + (CELL_PX - 1), np.float32(span.stop - 1))
        at_first, at_last = edges[:, :, axis] * first, edges[:, :, axis] * last
        extremes.append((np.minimum(at_first, at_last), np.maximum(at_first, at_last)))
    (low_y, high_y), (low_x, high_x) = extremes
    offset = edges[:, :, 2]
    touched = ((high_y + offset)[..., None] + high_x[:, :, None]).min(axis=1) >= -MARGIN_PX
    filled = ((low_y + offset)[..., None] + low_x[:, :, None]).min(axis=1) >= MARGIN_PX
    for k, tile_in_view in enumerate(tiles_in_view):
        if tile_in_view.polygon is None:
            filled[k] = False
    return touched, filled


def _pixels(part: Place, cell_rows: tuple[int, int], cell_columns: tuple[int, int]) -> Place:
    """Return the pixel rows and columns that a rectangle of cells covers in a part."""
    rows, columns = (
        slice(span.start + int(first) * CELL_PX, min(span.stop, span.start + int(end) * CELL_PX))
        for span, (first, end) in zip(part, (cell_rows, cell_columns), strict=True)
    )
    return rows, columns
