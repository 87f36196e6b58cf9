"""Maps from a view to an atlas: for each pixel, its position in the sharpest suitable picture on the sheet."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.mapping.cells import VisibleTile, visible_tiles
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.panorama import panorama_map
from scope_ptz.simulator.mapping.tile_maps import tile_maps
from scope_ptz.simulator.mapping.tiles import Place, Tiles
from scope_ptz.simulator.models import Band
from scope_ptz.simulator.sheets.atlas import Atlas
from scope_ptz.simulator.sheets.layout import Slot

TILE_GAIN = 1.1
"""Views with more than this many times the panorama's pixel density use tiles."""

OVERSAMPLING = 1.2
"""Minimum density of the source relative to the view. With bilinear look-up, a source that is 1.2 to 1.7 times as dense as the view
gives the sharpness of a rendered view; a less dense source blurs, and a denser one shimmers."""

Map = NDArray[np.float32]


def atlas_map(tiles: Tiles, band: Band, atlas: Atlas, projection: Projection, part: Place | None = None) -> Map:
    """Return each view pixel's position (x, y) on an atlas's sheet, as (H, W, 2), and fill the slots that the map needs.

    Args:
        tiles: Geometry of the viewpoint's tiles.
        band: The band of the sphere that the panorama covers.
        atlas: The atlas.
        projection: The view.
        part: The rows and columns that are needed; the default is the whole view. The result equals that part of the whole map.
    """
    step = step_px(projection)
    if part is None:
        part = slice(0, projection.height), slice(0, projection.width)
    visible: list[VisibleTile] = []
    uncovered: Place | None = part
    if projection.pixels_per_radian > TILE_GAIN * panorama_density(atlas) and len(atlas.slots) > 1:
        visible, uncovered = visible_tiles(tiles.in_view(projection), part)
    if uncovered is None:
        positions = np.empty((part[0].stop - part[0].start, part[1].stop - part[1].start, 2), np.float32)
    else:
        # The whole part is computed, even if tiles cover some of it, because copying the rest would take more time and memory.
        slot = atlas.ensure(0, suitable_scale(atlas, panorama_density(atlas), projection.pixels_per_radian))
        positions = panorama_map(band, slot, Grid(projection, step).inner(part), part)
    slots = [
        atlas.ensure(1 + index, suitable_scale(atlas, tiles.views[index].focal_px, projection.pixels_per_radian))
        for index in (tile.in_view.tile for tile in visible)
    ]
    # Start with the least sharp tile, over which the sharper ones are drawn. Only one map is in memory at a time.
    visible, slots = visible[::-1], slots[::-1]
    for tile, slot, where in zip(visible, slots, tile_maps(tiles, projection, step, visible, slots), strict=True):
        target = _crop(positions, part, tile.place)
        if tile.whole:
            target[...] = where
        else:
            cv2.copyTo(where, _mask(tile, slot, where), target)
    return positions


def panorama_density(atlas: Atlas) -> float:
    """Return the panorama's pixels per radian at full size."""
    return atlas.slots[0][0].width / (2 * math.pi)


def suitable_scale(atlas: Atlas, density: float, view_density: float) -> int:
    """Return the index of the scale at which to sample a picture for a view with the density ``view_density``.

    ``density`` is the picture's density at full size. Both are in pixels per radian.

    This is the coarsest scale that is at least ``OVERSAMPLING`` times as dense as the view, or the first scale if there is none.
    """
    if len(atlas.scales) == 1:
        return 0
    dense_enough = [k for k, scale in enumerate(atlas.scales) if scale.size * density >= OVERSAMPLING * view_density]
    return dense_enough[-1] if dense_enough else 0


def _mask(tile: VisibleTile, slot: Slot, where: Map) -> NDArray[np.uint8]:
    """Return a mask of the pixels that a tile covers, within the rows and columns in which it may be visible."""
    inside = tile.in_view.mask()
    if inside is not None:
        return _crop(inside, tile.in_view.place, tile.place)
    low, high = (slot.x, slot.y), (slot.x + slot.width - 1, slot.y + slot.height - 1)
    return np.asarray(cv2.inRange(where, low, high), dtype=np.uint8)


def _crop(whole: NDArray[np.generic], place: Place, part: Place) -> NDArray:  # type: ignore[type-arg]
    """Return the part of an array that shows the rows and columns ``part`` of a picture.

    The array itself shows the rows and columns ``place`` of the picture.
    """
    rows, columns = (slice(p.start - w.start, p.stop - w.start) for w, p in zip(place, part, strict=True))
    return whole[rows, columns]
