"""Maps from a view to an atlas: for each pixel, where on the sheet the sharpest suitable picture shows it."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.mapping.cover import Cover, overlap
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.panorama import panorama_map
from scope_ptz.simulator.mapping.tiles import Place, TileInView, Tiles
from scope_ptz.simulator.models import Band
from scope_ptz.simulator.sheets.atlas import Atlas

TILE_GAIN = 1.1
"""Views that need more than this many times the panorama's density use tiles."""

OVERSAMPLING = 1.2
"""Smallest density of the source relative to the view. Bilinear look-up keeps the sharpness of a rendered view when the source is
1.2 to 1.7 times as dense as the view; a sparser source blurs and a denser one shimmers."""

Map = NDArray[np.float32]


def atlas_map(tiles: Tiles, band: Band, atlas: Atlas, projection: Projection, part: Place | None = None) -> Map:
    """Return the (H, W, 2) position (x, y) of each pixel of a view on the sheet of an atlas, and fill what the map needs.

    Args:
        tiles: Geometry of the viewpoint's tiles.
        band: The band of the sphere that the panorama covers.
        atlas: The atlas.
        projection: The view.
        part: The rows and columns that are needed; the default is the whole view. The result is exactly that part of the whole.
    """
    step = step_px(projection)
    if part is None:
        part = slice(0, projection.height), slice(0, projection.width)
    patches: list[tuple[Place, Map, NDArray[np.uint8] | None]] = []
    cover = Cover(projection.width, projection.height)
    rest: Place | None = part
    if projection.density > TILE_GAIN * panorama_density(atlas) and len(atlas.slots) > 1:
        for showing in tiles.in_view(projection):
            # Sharper tiles come first, so that what they hide is never computed.
            visible = cover.gap(overlap(showing.place, part))
            if visible is None:
                continue
            where, inside = _tile_map(tiles, showing, atlas, Grid(projection, step, showing.place), visible)
            patches.append((visible, where, inside))
            if inside is None:
                cover.add_all()
                break
            if showing.polygon is not None:
                cover.add(showing.polygon)
        rest = cover.gap(part)
    if rest == part:
        slot = atlas.need(0, suitable_scale(atlas, panorama_density(atlas), projection.density))
        found = panorama_map(band, slot, Grid(projection, step).inner(part), part)
    else:
        found = np.empty((part[0].stop - part[0].start, part[1].stop - part[1].start, 2), np.float32)
        if rest is not None:
            slot = atlas.need(0, suitable_scale(atlas, panorama_density(atlas), projection.density))
            _within(found, part, rest)[...] = panorama_map(band, slot, Grid(projection, step).inner(rest), rest)
    for visible, where, inside in reversed(patches):
        if inside is None:
            _within(found, part, visible)[...] = where
        else:
            cv2.copyTo(where, inside, _within(found, part, visible))
    return found


def panorama_density(atlas: Atlas) -> float:
    """Return the pixels per radian of the panorama at full size."""
    return atlas.slots[0][0].width / (2 * math.pi)


def suitable_scale(atlas: Atlas, density: float, needed: float) -> int:
    """Return the scale at which a picture of full ``density`` (pixels per radian) suits a view of density ``needed``.

    That is the coarsest that is still ``OVERSAMPLING`` times as dense as the view, or the first when none is.
    """
    enough = [k for k, scale in enumerate(atlas.scales) if scale.size * density >= OVERSAMPLING * needed]
    return enough[-1] if enough else 0


def _tile_map(tiles: Tiles, showing: TileInView, atlas: Atlas, grid: Grid, visible: Place) -> tuple[Map, NDArray[np.uint8] | None]:
    """Return a tile's map over its visible part, and the mask of the pixels it covers: None if it covers the whole view."""
    projection = grid.projection
    density = tiles.views[showing.tile].focal_px
    slot = atlas.need(1 + showing.tile, suitable_scale(atlas, density, projection.density))
    low, high = (slot.x, slot.y), (slot.x + slot.width - 1, slot.y + slot.height - 1)
    may_cover_all = grid.covers_all
    inner = grid if may_cover_all else grid.inner(visible)
    nodes = tiles.points(showing, projection, inner.x, inner.y) * (slot.width, slot.height) + (slot.x - 0.5, slot.y - 0.5)
    where = inner.to_pixels(nodes, visible)
    if may_cover_all and bool(np.all((nodes >= low) & (nodes <= high))):
        return where, None
    inside = showing.mask()
    return where, cv2.inRange(where, low, high) if inside is None else _within(inside, showing.place, visible)


def _within(whole: NDArray[np.generic], place: Place, part: Place) -> NDArray:  # type: ignore[type-arg]
    """Return the rows and columns ``part`` of an array that shows the rows and columns ``place`` of a picture."""
    rows, columns = (slice(p.start - w.start, p.stop - w.start) for w, p in zip(place, part, strict=True))
    return whole[rows, columns]
