"""From the stored sphere of a viewpoint to any view: one map, one look-up.

Where a pixel of the view lies on the sheet of stored pictures is computed exactly on a coarse grid and interpolated between its
nodes; the grid is as fine as it must be for errors to stay below ``MAX_MAP_ERROR_PX``. Nothing here keeps state that could change
a result: the same pack and projection give the same bytes.
"""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, Projection, angle_between_deg, pan_tilt_deg, wrap_pan_deg
from scope_ptz.world.atlas import Atlas, Slot
from scope_ptz.world.models import Band, Tile
from scope_ptz.world.pack import Viewpoint

MAX_MAP_ERROR_PX = 0.04
"""Largest error of an interpolated map, in pixels of the view."""

MAX_STEP_PX = 32

TILE_GAIN = 1.1
"""Tiles are used from views on that need this many times the density of the panorama."""

Floats = NDArray[np.float64]
Map = NDArray[np.float32]


def colour_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.uint8]:
    """(H, W, 3) RGB: the still world through a projection."""
    return _look_up(viewpoint, viewpoint.colour_atlas, projection, cv2.INTER_LINEAR)


def id_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.uint16]:
    """(H, W) instance numbers of the still world, 0 where nothing is annotated."""
    return _look_up(viewpoint, viewpoint.id_atlas, projection, cv2.INTER_NEAREST)


def depth_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.float32]:
    """(H, W) distance of the still world from the optical centre in metres, infinite for the sky."""
    codes = _look_up(viewpoint, viewpoint.depth_atlas, projection, cv2.INTER_NEAREST)
    return np.take(viewpoint.depth_metres, codes)


def density(projection: Projection) -> float:
    """Pixels per radian in the middle of a picture."""
    if isinstance(projection, Perspective):
        return projection.focal_px
    middle, below = projection.directions((0.5, 0.5)), projection.directions((0.5, 0.5 + 1 / projection.height))
    return 1.0 / math.radians(float(angle_between_deg(middle, below)))


def _look_up(viewpoint: Viewpoint, atlas: Atlas, projection: Projection, interpolation: int) -> NDArray[Any]:
    where = atlas_map(viewpoint, atlas, projection)
    return np.asarray(cv2.remap(atlas.sheet, where, None, interpolation))


def atlas_map(viewpoint: Viewpoint, atlas: Atlas, projection: Projection) -> Map:
    """(H, W, 2): for each pixel of the view its x, y on the sheet of an atlas."""
    needed = density(projection)
    grid = Grid(projection, step_px(projection))
    patches: list[tuple[Map, NDArray[np.uint8] | None, slice, slice]] = []
    if needed > TILE_GAIN * atlas.slots[0][0].width / (2 * math.pi):
        for index in _tiles_in(viewpoint.manifest.tiles[: len(atlas.slots) - 1], projection):
            patch = _tile_patch(viewpoint.manifest.tiles[index], atlas, 1 + index, grid)
            if patch is not None:
                patches.append(patch)
                if patch[1] is None:
                    return patch[0]
    slots = atlas.need(0)
    where = _base_map(viewpoint.manifest.band, _level(slots, slots[0].width / (2 * math.pi), needed), grid)
    for patch_map, inside, rows, columns in reversed(patches):
        cv2.copyTo(patch_map, inside, where[rows, columns])
    return where


class Grid:
    """Nodes ``step`` pixels apart over a picture and one step beyond it, and the way back from nodes to pixels."""

    def __init__(self, projection: Projection, step: int) -> None:
        self.projection, self.step = projection, step
        columns, rows = -(-projection.width // step) + 2, -(-projection.height // step) + 2
        x = (np.arange(columns) - 0.5) * step / projection.width
        y = (np.arange(rows) - 0.5) * step / projection.height
        self.points: Floats = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1)
        self._directions: Floats | None = None

    @property
    def directions(self) -> Floats:
        """(rows, columns, 3) unit vectors at the nodes."""
        if self._directions is None:
            self._directions = self.projection.directions(self.points)
        return self._directions

    def to_pixels(self, nodes: Floats) -> Map:
        """Values at nodes (rows, columns, 2), bilinear between them, at the middle of every pixel (H, W, 2)."""
        n, rows, columns = self.step, nodes.shape[0], nodes.shape[1]
        fine: Map = cv2.resize(nodes.astype(np.float32), (columns * n, rows * n), interpolation=cv2.INTER_LINEAR)
        return fine[n : n + self.projection.height, n : n + self.projection.width]


def step_px(projection: Projection) -> int:
    """The widest power of two that keeps ``step ** 2 / 8 * curvature`` within the error allowed."""
    if isinstance(projection, Equirectangular):
        return 8
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.0], [0.5, 1.0]])
    poles = projection.points(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
    if np.any(np.all((poles > -0.05) & (poles < 1.05), axis=-1)):
        return 1
    _, tilt = pan_tilt_deg(projection.directions(corners))
    from_pole = math.radians(90.0 - float(np.abs(tilt).max()))
    widest = math.sqrt(8 * MAX_MAP_ERROR_PX * density(projection) * math.sin(from_pole))
    return int(min(MAX_STEP_PX, 2 ** math.floor(math.log2(max(1.0, widest)))))


def _base_map(band: Band, slot: Slot, grid: Grid) -> Map:
    projection = grid.projection
    if isinstance(projection, Equirectangular):
        middle = projection.left_pan_deg + projection.pan_span_deg / 2
        turn = (grid.points[..., 0] - 0.5) * projection.pan_span_deg
        tilt = projection.top_tilt_deg + grid.points[..., 1] * (projection.bottom_tilt_deg - projection.top_tilt_deg)
    else:
        pan, tilt = pan_tilt_deg(grid.directions)
        middle = float(pan_tilt_deg(projection.directions((0.5, 0.5)))[0])
        turn = (pan - middle + 180.0) % 360.0 - 180.0
    x = slot.x - 0.5 + (wrap_pan_deg(middle) + 180.0 + turn) / 360.0 * slot.width
    y = slot.y - 0.5 + (band.top_tilt_deg - tilt) / (band.top_tilt_deg - band.bottom_tilt_deg) * slot.height
    where = grid.to_pixels(np.stack([x, np.clip(y, slot.y - 0.5, slot.y + slot.height - 0.5)], axis=-1))
    left, right = slot.x - 0.5, slot.x + slot.width - 0.5
    if x.min() < left:
        np.add(where[..., 0], slot.width, out=where[..., 0], where=where[..., 0] < left)
    if x.max() > right:
        np.subtract(where[..., 0], slot.width, out=where[..., 0], where=where[..., 0] > right)
    return where


def _tiles_in(tiles: list[Tile], projection: Projection) -> list[int]:
    """Indices of the tiles that may show in a view, sharpest first (then in the order of the manifest)."""
    views = [tile_view(tile) for tile in tiles]
    near = [i for i, view in enumerate(views) if bounds(view, projection) is not None]
    return sorted(near, key=lambda i: (-views[i].focal_px, i))


def tile_view(tile: Tile) -> Perspective:
    """The view that a tile's picture is."""
    return Perspective(tile.pan_deg, tile.tilt_deg, tile.hfov_deg, tile.colour.width, tile.colour.height)


def _reach_deg(projection: Projection) -> float:
    """Angle from the middle of a picture to its farthest corner."""
    if isinstance(projection, Equirectangular):
        return 180.0
    return float(angle_between_deg(projection.directions((0.0, 0.0)), projection.directions((0.5, 0.5))))


def _tile_patch(tile: Tile, atlas: Atlas, index: int, grid: Grid) -> tuple[Map, NDArray[np.uint8] | None, slice, slice] | None:
    """Where a tile shows in the view: its map, the pixels that it covers (None: all of the view), and their rows and columns."""
    view = tile_view(tile)
    place = bounds(view, grid.projection)
    if place is None:
        return None
    slot = _level(atlas.need(index), view.focal_px, density(grid.projection))
    uv = np.nan_to_num(view.points(grid.directions), nan=-1e3)
    xy = uv * (slot.width, slot.height) + (slot.x - 0.5, slot.y - 0.5)
    low, high = (slot.x, slot.y), (slot.x + slot.width - 1, slot.y + slot.height - 1)
    if np.all((xy >= low) & (xy <= high)):
        return grid.to_pixels(xy), None, slice(None), slice(None)
    rows, columns = place
    where = grid.to_pixels(xy)[rows, columns]
    return where, cv2.inRange(where, low, high), rows, columns


def bounds(view: Perspective, projection: Projection) -> tuple[slice, slice] | None:
    """Rows and columns of a picture that the outline of a perspective view spans; None when it does not reach into the picture."""
    apart = angle_between_deg(view.directions((0.5, 0.5)), projection.directions((0.5, 0.5)))
    if apart > _reach_deg(view) + _reach_deg(projection):
        return None
    side = np.linspace(0.0, 1.0, 9)
    zero, one = np.zeros(9), np.ones(9)
    outline = np.concatenate([np.stack(p, axis=-1) for p in ((side, zero), (one, side), (side, one), (zero, side))])
    points = projection.points(view.directions(outline))
    if np.isnan(points).any() or (isinstance(projection, Equirectangular) and np.ptp(points[:, 0]) > 0.5):
        return slice(0, projection.height), slice(0, projection.width)
    low = np.floor(points.min(axis=0) * (projection.width, projection.height)).astype(int) - 1
    high = np.ceil(points.max(axis=0) * (projection.width, projection.height)).astype(int) + 1
    rows = slice(max(0, int(low[1])), min(projection.height, int(high[1])))
    columns = slice(max(0, int(low[0])), min(projection.width, int(high[0])))
    return (rows, columns) if rows.start < rows.stop and columns.start < columns.stop else None


def _level(slots: tuple[Slot, ...], finest: float, needed: float) -> Slot:
    """The coarsest scale that is about as dense as the view: denser would shimmer, coarser would blur."""
    enough = [slot for slot in slots if finest * slot.width / slots[0].width >= 0.9 * needed]
    return enough[-1] if enough else slots[0]
