"""Maps from a view to tiles. The nodes for all tiles are computed together, because many small NumPy calls would be slower."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.mapping.cells import VisibleTile
from scope_ptz.simulator.mapping.grid import Grid
from scope_ptz.simulator.mapping.tiles import BEHIND, BEHIND_POSITION, Tiles
from scope_ptz.simulator.sheets.layout import Slot

Map = NDArray[np.float32]


def tile_maps(
    tiles: Tiles, projection: Projection, step: int, visible: Sequence[VisibleTile], slots: Sequence[Slot]
) -> Iterator[Map]:
    """Yield a map for each visible tile: an (h, w, 2) array with the position (x, y) on the sheet of each pixel in its ``place``.

    The values are equal to those from a ``Grid`` over the whole ``place`` of the ``TileInView``.

    Args:
        tiles: Geometry of the viewpoint's tiles.
        projection: The view.
        step: Distance between nodes in pixels.
        visible: The tiles and their places.
        slots: The tiles' slots on the sheet.
    """
    if any(tile.in_view.turn is None for tile in visible):
        yield from (_panoramic_map(tiles, projection, step, *pair) for pair in zip(visible, slots, strict=True))
        return
    grids = [_TileGrid(tile, step) for tile in visible]
    for grid, nodes in zip(grids, _positions(tiles, projection, step, visible, slots, grids), strict=True):
        fine = cv2.resize(nodes, (grid.columns * step, grid.rows * step), interpolation=cv2.INTER_LINEAR)
        yield fine[grid.skipped_rows : grid.skipped_rows + grid.height, grid.skipped_columns : grid.skipped_columns + grid.width]


class _TileGrid:
    """The grid of nodes over a visible tile, and the offsets and size of the part of the interpolated map that is used."""

    __slots__ = ("columns", "height", "left", "rows", "skipped_columns", "skipped_rows", "top", "width")

    def __init__(self, tile: VisibleTile, step: int) -> None:
        (whole_rows, whole_columns), (rows, columns) = tile.in_view.place, tile.place
        self.height, self.width = rows.stop - rows.start, columns.stop - columns.start
        first_row, skipped_rows = divmod(rows.start - whole_rows.start, step)
        first_column, skipped_columns = divmod(columns.start - whole_columns.start, step)
        self.top = whole_rows.start + (first_row - 0.5) * step
        self.left = whole_columns.start + (first_column - 0.5) * step
        self.rows = -(-(skipped_rows + self.height) // step) + 2
        self.columns = -(-(skipped_columns + self.width) // step) + 2
        self.skipped_rows, self.skipped_columns = step + skipped_rows, step + skipped_columns


def _positions(
    tiles: Tiles,
    projection: Projection,
    step: int,
    visible: Sequence[VisibleTile],
    slots: Sequence[Slot],
    grids: Sequence[_TileGrid],
) -> list[Map]:
    """Return a (rows, columns, 2) array for each tile: its nodes' positions on the sheet."""
    if not visible:
        return []
    counts = [grid.rows * grid.columns for grid in grids]
    ends = np.cumsum(counts)
    # One row for each parameter and one column for each tile. The columns are then repeated for each node.
    turns = np.stack([tile.in_view.turn for tile in visible if tile.in_view.turn is not None])
    views = [tiles.views[tile.in_view.tile] for tile in visible]
    parameters = np.array(
        [
            [g.left - projection.width / 2 for g in grids],
            [projection.height / 2 - g.top for g in grids],
            [v.focal_px for v in views],
            [v.width for v in views],
            [-v.height for v in views],
            [s.width for s in slots],
            [s.height for s in slots],
            [s.x - 0.5 for s in slots],
            [s.y - 0.5 for s in slots],
        ]
    )
    left, up, focal_px, width, height, slot_width, slot_height, x, y = np.repeat(parameters, counts, axis=1)
    to_right, to_up = (np.repeat(turns[:, :, axis].T, counts, axis=1) for axis in (0, 1))
    ahead = np.repeat(turns[:, :, 2].T * projection.pixels_per_radian, counts, axis=1)
    columns = np.repeat(np.array([grid.columns for grid in grids]), counts)
    row, column = np.divmod(np.arange(ends[-1]) - np.repeat(ends - counts, counts), columns)
    left += column * step
    up -= row * step
    local = to_right * left + (to_up * up + ahead)
    depth = local[2]
    scale = focal_px / np.maximum(depth, BEHIND)
    points = np.empty((len(depth), 2), np.float32)
    behind = depth <= BEHIND
    for axis, size, slot_size, slot_start in ((0, width, slot_width, x), (1, height, slot_height, y)):
        normalised = local[axis] * (scale / size) + 0.5
        normalised[behind] = BEHIND_POSITION
        points[:, axis] = normalised * slot_size + slot_start
    starts = (ends - counts).tolist()
    return [
        points[start:end].reshape(grid.rows, grid.columns, 2) for start, end, grid in zip(starts, ends.tolist(), grids, strict=True)
    ]


def _panoramic_map(tiles: Tiles, projection: Projection, step: int, tile: VisibleTile, slot: Slot) -> Map:
    grid = Grid(projection, step, tile.in_view.place).inner(tile.place)
    nodes = tiles.points(tile.in_view, projection, grid.x, grid.y) * (slot.width, slot.height) + (slot.x - 0.5, slot.y - 0.5)
    return grid.to_pixels(nodes, tile.place)
