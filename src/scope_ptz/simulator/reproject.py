"""Re-projection: from the stored sphere of a viewpoint to any view, by one map and one look-up.

The map gives the position of each pixel of the view on the sheet of stored pictures. It is computed exactly at the nodes of a
coarse grid and interpolated between them; the grid is fine enough to keep errors below ``MAX_MAP_ERROR_PX``. The same pack and
projection always give the same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, Projection, pan_tilt_deg, wrap_pan_deg
from scope_ptz.simulator.atlas import Atlas, Slot
from scope_ptz.simulator.models import Band
from scope_ptz.simulator.tiles import Place, TileInView, Tiles
from scope_ptz.simulator.viewpoint import Viewpoint

MAX_MAP_ERROR_PX = 0.04
"""Largest permitted error of an interpolated map, in pixels of the view."""

MAX_STEP_PX = 32

TILE_GAIN = 1.1
"""Views that need more than this many times the panorama's density use tiles."""

OVERSAMPLING = 1.2
"""Smallest density of the source relative to the view. Bilinear look-up keeps the sharpness of a rendered view when the source is
1.2 to 1.7 times as dense as the view; a sparser source blurs and a denser one shimmers."""

_AROUND = ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1))
"""The eight neighbouring pixels, in the order in which they are tried."""

_REACHES_TEXELS = (1.0, 2.0)
"""How far from a pixel a distance on the right instance is searched for, in texels of the depth layer."""

Floats = NDArray[np.float64]
Map = NDArray[np.float32]


def colour_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.uint8]:
    """Return the still world through a projection as (H, W, 3) RGB."""
    return _look_up(viewpoint, viewpoint.colour_atlas, projection, cv2.INTER_LINEAR)


def id_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.uint16]:
    """Return the still world's (H, W) instance numbers, 0 where nothing is annotated."""
    return _look_up(viewpoint, viewpoint.id_atlas, projection, cv2.INTER_NEAREST)


def depth_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.float32]:
    """Return the still world's (H, W) distances from the optical centre in metres, infinite for the sky."""
    codes = _look_up(viewpoint, viewpoint.depth_atlas, projection, cv2.INTER_NEAREST)
    return np.take(viewpoint.depth_metres, codes)


def distances_m(viewpoint: Viewpoint, directions: Floats) -> tuple[NDArray[np.float32], NDArray[np.uint16]]:
    """Return distances along directions, and the instances on which they were measured.

    Both are those of the nearest texel of the depth layer.

    Args:
        viewpoint: The viewpoint.
        directions: (n, 3) unit vectors in the camera's own frame.

    Returns:
        (n,) metres, infinite for the sky, and (n,) instance numbers.
    """
    viewpoint.owner_atlas.need(0)
    slot, band = viewpoint.depth_atlas.need(0), viewpoint.manifest.band
    pan_deg, tilt_deg = pan_tilt_deg(directions)
    down = (band.top_tilt_deg - tilt_deg) / (band.top_tilt_deg - band.bottom_tilt_deg)
    columns = slot.x + np.floor((pan_deg + 180.0) / 360.0 * slot.width).astype(int) % slot.width
    rows = slot.y + np.clip(np.floor(down * slot.height).astype(int), 0, slot.height - 1)
    metres = np.take(viewpoint.depth_metres, viewpoint.depth_atlas.sheet[rows, columns])
    return metres, viewpoint.owner_atlas.sheet[rows, columns]


def outlined_depth_view(
    viewpoint: Viewpoint, projection: Projection, numbers: NDArray[np.uint16], places: Iterable[Place] | None = None
) -> NDArray[np.float32]:
    """Like ``depth_view``, but with the edges of instances as sharp as in ``numbers``, the view's (H, W) instance numbers.

    Where a distance was measured on a different instance than the pixel shows, it is replaced by a neighbour's distance that was
    measured on the right one.

    Args:
        viewpoint: The viewpoint.
        projection: The view.
        numbers: Its instance numbers.
        places: The parts of the view that are needed; the default is all of it. Other pixels are undefined.
    """
    where = atlas_map(viewpoint, viewpoint.depth_atlas, projection)
    viewpoint.owner_atlas.need(0)
    height, width = numbers.shape
    texel_px = max(1.0, projection.density / (viewpoint.manifest.depth.width / (2 * math.pi)))
    margin = math.ceil(_REACHES_TEXELS[-1] * texel_px) + 1
    found = np.empty((height, width), np.float32)
    for rows, columns in [(slice(0, height), slice(0, width))] if places is None else places:
        top, left = max(0, rows.start - margin), max(0, columns.start - margin)
        around = slice(top, rows.stop + margin), slice(left, columns.stop + margin)
        near = _outlined_depth(viewpoint, where[around], numbers[around], texel_px)
        found[rows, columns] = near[rows.start - top : rows.stop - top, columns.start - left : columns.stop - left]
    return found


def _outlined_depth(viewpoint: Viewpoint, where: Map, numbers: NDArray[np.uint16], texel_px: float) -> NDArray[np.float32]:
    """Return those distances for a part of a view, given its map on the depth layer. They are exact away from the part's edges."""
    metres: NDArray[np.float32] = np.take(
        viewpoint.depth_metres, cv2.remap(viewpoint.depth_atlas.sheet, where, None, cv2.INTER_NEAREST)
    )
    owners = cv2.remap(viewpoint.owner_atlas.sheet, where, None, cv2.INTER_NEAREST)
    ys, xs = np.nonzero(owners != numbers)
    last_row, last_column = numbers.shape[0] - 1, numbers.shape[1] - 1
    refined = metres.copy()
    for reach in _REACHES_TEXELS:
        for dx, dy in _AROUND:
            y = np.clip(ys + round(dy * reach * texel_px), 0, last_row)
            x = np.clip(xs + round(dx * reach * texel_px), 0, last_column)
            fits = (owners[y, x] == numbers[ys, xs]) & (owners[y, x] == numbers[y, x])
            refined[ys[fits], xs[fits]] = metres[y[fits], x[fits]]
            ys, xs = ys[~fits], xs[~fits]
    return refined


def _look_up(viewpoint: Viewpoint, atlas: Atlas, projection: Projection, interpolation: int) -> NDArray[Any]:
    where = atlas_map(viewpoint, atlas, projection)
    return np.asarray(cv2.remap(atlas.sheet, where, None, interpolation))


def atlas_map(viewpoint: Viewpoint, atlas: Atlas, projection: Projection) -> Map:
    """Return the (H, W, 2) position (x, y) of each pixel of the view on the sheet of an atlas."""
    needed = projection.density
    step = step_px(projection)
    patches: list[tuple[Place, Map, NDArray[np.uint8]]] = []
    behind: Map | None = None
    if needed > TILE_GAIN * atlas.slots[0][0].width / (2 * math.pi) and len(atlas.slots) > 1:
        for showing in viewpoint.tiles.in_view(projection):
            where, inside, filled = _tile_map(viewpoint.tiles, showing, atlas, Grid(projection, step, showing.place))
            if filled:  # sharper tiles found earlier are drawn over it
                behind = where
                break
            patches.append((showing.place, where, inside))
    if behind is None:
        scale = _scale(atlas, atlas.slots[0][0].width / (2 * math.pi), needed)
        behind = _base_map(viewpoint.manifest.band, atlas, scale, Grid(projection, step))
    for place, where, inside in reversed(patches):
        cv2.copyTo(where, inside, behind[place])
    return behind


class Grid:
    """Nodes ``step`` pixels apart that cover a part of a picture and one step beyond it.

    ``x`` and ``y`` are the columns and rows of the nodes in pixels, counted from the picture's top-left corner.
    """

    def __init__(self, projection: Projection, step: int, place: Place | None = None) -> None:
        self.projection, self.step = projection, step
        self.place = place or (slice(0, projection.height), slice(0, projection.width))
        rows, columns = self.place
        self.x: Floats = columns.start + (np.arange(-(-(columns.stop - columns.start) // step) + 2) - 0.5) * step
        self.y: Floats = rows.start + (np.arange(-(-(rows.stop - rows.start) // step) + 2) - 0.5) * step

    def directions(self) -> Floats:
        """Return (rows, columns, 3) unit vectors at the nodes."""
        points = np.stack(np.meshgrid(self.x / self.projection.width, self.y / self.projection.height), axis=-1)
        return self.projection.directions(points)

    def to_pixels(self, nodes: Floats) -> NDArray[np.float32]:
        """Interpolate node values, (rows, columns) or (rows, columns, n), to the centre of each pixel of the part."""
        n, (rows, columns) = self.step, self.place
        size = nodes.shape[1] * n, nodes.shape[0] * n
        fine: NDArray[np.float32] = cv2.resize(nodes.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
        return fine[n : n + rows.stop - rows.start, n : n + columns.stop - columns.start]


def step_px(projection: Projection) -> int:
    """Return the largest power of two that keeps ``step ** 2 / 8 * curvature`` within ``MAX_MAP_ERROR_PX``."""
    if isinstance(projection, Equirectangular):
        return 8
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.0], [0.5, 1.0]])
    poles = projection.points(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
    if np.any(np.all((poles > -0.05) & (poles < 1.05), axis=-1)):
        return 1
    _, tilt = pan_tilt_deg(projection.directions(corners))
    from_pole = math.radians(90.0 - float(np.abs(tilt).max()))
    widest = math.sqrt(8 * MAX_MAP_ERROR_PX * projection.density * math.sin(from_pole))
    return int(min(MAX_STEP_PX, 2 ** math.floor(math.log2(max(1.0, widest)))))


def _base_map(band: Band, atlas: Atlas, scale: int, grid: Grid) -> Map:
    slot = atlas.slots[0][scale]
    middle, turn, tilt = _turn_and_tilt_deg(grid)
    x = slot.x - 0.5 + (wrap_pan_deg(middle) + 180.0 + turn) / 360.0 * slot.width
    y = slot.y - 0.5 + (band.top_tilt_deg - tilt) / (band.top_tilt_deg - band.bottom_tilt_deg) * slot.height
    atlas.need_panorama_part(scale, x.min() - slot.x, x.max() - slot.x, y.min() - slot.y, y.max() - slot.y)
    where = grid.to_pixels(np.stack([x, np.clip(y, slot.y - 0.5, slot.y + slot.height - 0.5)], axis=-1))
    left, right = slot.x - 0.5, slot.x + slot.width - 0.5
    for beyond, turn_px in ((x < left, slot.width), (x > right, -slot.width)):
        columns = np.flatnonzero(beyond.any(axis=0))
        if columns.size:
            # Pixels beyond the seam lie between the node before and the node after, so only these columns need the turn.
            first, last = max(0, (columns[0] - 2) * grid.step), (columns[-1] + 1) * grid.step
            part = where[:, first:last, 0]
            part += np.float32(turn_px) * (part < left if turn_px > 0 else part > right)
    return where


def _turn_and_tilt_deg(grid: Grid) -> tuple[float, Floats, Floats]:
    """Return the pan of the picture's centre and, for each node, its turn from there and its tilt, all in degrees."""
    projection = grid.projection
    if isinstance(projection, Equirectangular):
        fall = projection.bottom_tilt_deg - projection.top_tilt_deg
        turn, tilt = np.meshgrid(
            (grid.x / projection.width - 0.5) * projection.pan_span_deg, projection.top_tilt_deg + grid.y / projection.height * fall
        )
        return projection.left_pan_deg + projection.pan_span_deg / 2, turn, tilt
    if isinstance(projection, Perspective):
        # A ray is (right, up, focal length) in the view. The tilt turns it in the plane of the last two.
        sine, cosine = math.sin(math.radians(projection.tilt_deg)), math.cos(math.radians(projection.tilt_deg))
        right, up = grid.x - projection.width / 2, (projection.height / 2 - grid.y)[:, None]
        ahead, rise = projection.focal_px * cosine - up * sine, projection.focal_px * sine + up * cosine
        level = np.sqrt(right**2 + ahead**2)
        return projection.pan_deg, np.degrees(np.arctan2(right, ahead)), np.degrees(np.arctan2(rise, level))
    raise TypeError(f"no map for {type(projection).__name__}")


def _tile_map(tiles: Tiles, showing: TileInView, atlas: Atlas, grid: Grid) -> tuple[Map, NDArray[np.uint8], bool]:
    """Return a tile's map over a part of the view, the mask of the pixels it covers, and whether it covers the whole view."""
    projection = grid.projection
    slot = _slot(atlas, 1 + showing.tile, tiles.views[showing.tile].focal_px, projection.density)
    nodes = tiles.points(showing, projection, grid.x, grid.y) * (slot.width, slot.height) + (slot.x - 0.5, slot.y - 0.5)
    low, high = (slot.x, slot.y), (slot.x + slot.width - 1, slot.y + slot.height - 1)
    where = grid.to_pixels(nodes)
    inside = showing.mask()
    if inside is None:
        inside = cv2.inRange(where, low, high)
    whole = where.shape[:2] == (projection.height, projection.width) and bool(np.all((nodes >= low) & (nodes <= high)))
    return where, inside, whole


def _slot(atlas: Atlas, index: int, density: float, needed: float) -> Slot:
    """Return the filled slot of a picture at the scale that suits a view."""
    return atlas.need(index, _scale(atlas, density, needed))


def _scale(atlas: Atlas, density: float, needed: float) -> int:
    """Return the scale at which a picture of full ``density`` (pixels per radian) suits a view of density ``needed``.

    That is the coarsest that is still ``OVERSAMPLING`` times as dense as the view, or the first when none is.
    """
    enough = [k for k, scale in enumerate(atlas.scales) if scale.size * density >= OVERSAMPLING * needed]
    return enough[-1] if enough else 0
