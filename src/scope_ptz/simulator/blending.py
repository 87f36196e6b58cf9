"""Blend the borders of tiles into the pictures around them, and match the tone of tiles to the panorama.

A tile is a sharp picture inside a less sharp one. Its border would be visible as a hard edge, so over some pixels the tile fades
into the picture below it: the panorama, or a less sharp tile. Tiles are blended once, when they are read, so rendering a view takes
no extra time.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Sequence
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, angle_between_deg
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.panorama import panorama_map
from scope_ptz.simulator.mapping.tiles import POLYGON_SHIFT, Tiles
from scope_ptz.simulator.models import Band
from scope_ptz.simulator.sheets.atlas import Atlas

FADE_PX, MAX_FADE_FRACTION = 90.0, 0.2
"""A tile fades over this many of its pixels, but at most over this fraction of its shorter side."""

HIDDEN_PX = 4.0
"""Width of a tile's fully transparent edge, which is needed because views clip tiles slightly inside their border."""

JOINT_PX = 12.0
"""Adjoining tiles fade into each other over this many pixels. They overlap by about 28 pixels."""

SHARP_FRACTION = 0.7
"""A tile fades over only a few pixels where it adjoins a tile whose pixel density is at least this fraction of its own."""

COARSE_PX = 4  # side, in pixels, of the cells in which the distance from less sharp areas is computed

DETAIL_FADE_PX = 28.0
"""Texts and small objects near the border stay sharp. Around them, the tile fades over this many pixels."""

SMALL_PX = 160.0
"""Only objects up to this size, in tile pixels, stay sharp near the tile's border. Larger ones may fade."""

TONE_CELL_PX = 32
"""Size of the cells whose mean tones are matched, in pixels. Details smaller than a cell are preserved."""

MAX_TONE_SHIFT = 24.0
"""Maximum tone change, on a scale of 0 to 255. Larger differences are due to different content, so they are only reduced."""

MAX_CACHED_TILES = 4  # tone-matched tiles to keep in memory, because neighbouring tiles soon need them

Floats = NDArray[np.float32]


class Outlines:
    """Object outlines. In tiles in which an object is small, the object stays sharp near the border.

    Args:
        outlines: One array of (n, 3) directions for each object.
    """

    def __init__(self, outlines: Sequence[NDArray[np.float64]]) -> None:
        self._outlines = list(outlines)
        centres = np.array([outline.mean(axis=0) for outline in outlines]).reshape(-1, 3)
        self._centres = centres
        reach = (angle_between_deg(outline, centre).max() for outline, centre in zip(outlines, centres, strict=True))
        self._reach_deg = np.array(list(reach))

    def mask_of_small_objects(self, view: Perspective) -> NDArray[np.uint8]:
        """Return an (H, W) mask that covers the small objects in a view."""
        mask = np.zeros((view.height, view.width), np.uint8)
        size = np.array([view.width, view.height])
        separation_deg = angle_between_deg(self._centres, view.directions((0.5, 0.5)))
        small_deg = math.degrees(SMALL_PX / view.focal_px)
        for k in np.flatnonzero((separation_deg <= view.max_off_axis_deg + self._reach_deg) & (self._reach_deg < small_deg)):
            points = view.points(self._outlines[k]) * size
            if not np.isnan(points).any() and np.ptp(points, axis=0).max() <= SMALL_PX:
                cv2.fillConvexPoly(mask, cv2.convexHull(np.rint(points).astype(np.int32)), 255)
        return mask


class TileBlender:
    """Reads a viewpoint's tiles and blends their borders.

    Args:
        read: Function that returns stored tile ``i`` as (H, W, 3) RGB.
        tiles: Geometry of the tiles.
        band: The band of the sphere that the panorama covers.
        sharp_outlines: Function that returns the outlines of the objects that stay sharp near tile borders, each as an array of
            (n, 3) directions. It is called when the first tile is read.
    """

    def __init__(
        self,
        read: Callable[[int], NDArray[np.uint8]],
        tiles: Tiles,
        band: Band,
        sharp_outlines: Callable[[], Sequence[NDArray[np.float64]]],
    ) -> None:
        self._read, self._tiles, self._band, self._outlines = read, tiles, band, cache(lambda: Outlines(sharp_outlines()))
        self._matched_tiles: OrderedDict[int, NDArray[np.uint8]] = OrderedDict()

    def blend(self, atlas: Atlas, index: int) -> NDArray[np.uint8]:
        """Return tile ``index`` with blended borders as (H, W, 3) RGB. The panorama is taken from the atlas."""
        view = self._tiles.views[index]
        below = self._panorama(atlas, view)
        matched = self._matched_tile(atlas, index, below)
        order = self._tiles.in_view(view)
        position = next(k for k, tile_in_view in enumerate(order) if tile_in_view.tile == index)
        grid_step = step_px(view)
        for tile_in_view in reversed(order[position + 1 :]):  # begin with the least sharp tile
            grid = Grid(view, grid_step, tile_in_view.place)
            other = self._tiles.views[tile_in_view.tile]
            nodes = self._tiles.points(tile_in_view, view, grid.x, grid.y) * (other.width, other.height) - 0.5
            where = grid.to_pixels(nodes)
            if not _reaches(where, other):
                continue
            layer = cv2.remap(self._matched_tile(atlas, tile_in_view.tile), where, None, cv2.INTER_LINEAR, borderValue=(0, 0, 0, 0))
            part = below[tile_in_view.place]
            part[...] = _blend(layer, part)
        return _blend(matched, below)

    def clear_cache(self) -> None:
        """Release the cached tiles."""
        self._matched_tiles.clear()

    def _panorama(self, atlas: Atlas, view: Perspective) -> NDArray[np.uint8]:
        where = panorama_map(self._band, atlas.ensure(0, 0), Grid(view, step_px(view)))
        return np.asarray(cv2.remap(atlas.sheet, where, None, cv2.INTER_LINEAR))

    def _matched_tile(self, atlas: Atlas, index: int, panorama: NDArray[np.uint8] | None = None) -> NDArray[np.uint8]:
        """Return a tile as (H, W, 4), with its tone matched to the panorama. The fourth channel is its opacity."""
        if index not in self._matched_tiles:
            view = self._tiles.views[index]
            around = self._panorama(atlas, view) if panorama is None else panorama
            opacity = np.rint(_opacity(self._tiles, index, self._outlines()) * 255).astype(np.uint8)
            self._matched_tiles[index] = cv2.merge([*cv2.split(_match_tone(self._read(index), around)), opacity])
            while len(self._matched_tiles) > MAX_CACHED_TILES:
                self._matched_tiles.popitem(last=False)
        self._matched_tiles.move_to_end(index)
        return self._matched_tiles[index]


def _reaches(where: Floats, other: Perspective) -> bool:
    return bool(np.any((where[..., 0] > 0) & (where[..., 0] < other.width) & (where[..., 1] > 0) & (where[..., 1] < other.height)))


def _blend(over: NDArray[np.uint8], under: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Blend an (H, W, 4) picture, whose fourth channel is its opacity, over an (H, W, 3) picture."""
    opacity = cv2.extractChannel(over, 3) / np.float32(255)
    return np.asarray(cv2.blendLinear(cv2.cvtColor(over, cv2.COLOR_RGBA2RGB), np.ascontiguousarray(under), opacity, 1 - opacity))


def _match_tone(tile: NDArray[np.uint8], panorama: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a tile whose mean tones over large cells match those of the panorama."""
    height, width = tile.shape[:2]
    cells = max(2, round(width / TONE_CELL_PX)), max(2, round(height / TONE_CELL_PX))
    means = (cv2.resize(picture, cells, interpolation=cv2.INTER_AREA).astype(np.float32) for picture in (panorama, tile))
    shift = np.clip(next(means) - next(means), -MAX_TONE_SHIFT, MAX_TONE_SHIFT)
    smooth = cv2.resize(cv2.GaussianBlur(shift, (3, 3), 0), (width, height), interpolation=cv2.INTER_LINEAR)
    return np.asarray(cv2.add(tile, smooth, dtype=cv2.CV_8U))


def _opacity(tiles: Tiles, index: int, outlines: Outlines) -> Floats:
    """Return a tile's (H, W) opacity, from 0 to 1.

    The opacity decreases to 0 at the tile's border: gradually where the sharp area ends, and over a few pixels where another tile
    adjoins.
    """
    view = tiles.views[index]
    columns, rows = (np.minimum(np.arange(n) + 0.5, n - np.arange(n) - 0.5) for n in (view.width, view.height))
    inside = np.minimum(rows[:, None], columns[None, :]).astype(np.float32) - np.float32(HIDDEN_PX)
    fade_px = min(FADE_PX, MAX_FADE_FRACTION * min(view.width, view.height))
    opacity = np.minimum(
        _smoothstep(inside / JOINT_PX), _smoothstep((_distance_to_soft_px(tiles, index, fade_px) - HIDDEN_PX) / fade_px)
    )
    details = outlines.mask_of_small_objects(view)
    if details.any():
        distance_px = np.asarray(cv2.distanceTransform(255 - details, cv2.DIST_L2, 5))
        opacity = np.maximum(opacity, np.minimum(_smoothstep(1 - distance_px / DETAIL_FADE_PX), _smoothstep(inside / JOINT_PX)))
    return opacity


def _distance_to_soft_px(tiles: Tiles, index: int, reach_px: float) -> Floats:
    """Return each pixel's distance, as (H, W), from the nearest area that no similarly sharp tile covers.

    Distances are exact up to ``reach_px``.
    """
    view = tiles.views[index]
    pad = COARSE_PX * math.ceil(reach_px / COARSE_PX + 1)
    width, height = view.width + 2 * pad, view.height + 2 * pad
    hfov_deg = math.degrees(2 * math.atan(width / 2 / view.focal_px))
    around = Perspective(view.pan_deg, view.tilt_deg, hfov_deg, width, height)
    sharp = np.zeros((-(-height // COARSE_PX), -(-width // COARSE_PX)), np.uint8)
    for tile_in_view in tiles.in_view(around):
        if tile_in_view.polygon is not None and tiles.views[tile_in_view.tile].focal_px >= SHARP_FRACTION * view.focal_px:
            cv2.fillConvexPoly(sharp, tile_in_view.polygon // COARSE_PX, 255, shift=POLYGON_SHIFT)
    # If the whole neighbourhood is sharp, the distance transform returns very large distances, so they are limited to the padding.
    distance_px = np.minimum(cv2.distanceTransform(sharp, cv2.DIST_L2, 5), pad) * np.float32(COARSE_PX)
    fine = cv2.resize(distance_px, (sharp.shape[1] * COARSE_PX, sharp.shape[0] * COARSE_PX), interpolation=cv2.INTER_LINEAR)
    return np.asarray(fine[pad : pad + view.height, pad : pad + view.width])


def _smoothstep(value: NDArray[np.floating]) -> Floats:
    """Map [0, 1] to [0, 1] with zero slope at both ends (smoothstep)."""
    t = np.clip(value, 0, 1)
    return np.asarray(t * t * (3 - 2 * t), dtype=np.float32)
