"""Compose a picture from overlapping frames: match their tone, remove moving objects, and blend two frequency bands.

The low band is blended over the whole overlap, which hides the seams. Fine detail comes from the frame whose centre is nearest,
so that small pose errors do not blur it (Brown and Lowe, 2007). Where at least three frames overlap, a frame that differs from
the median shows a moving object there and is excluded.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capture.placed_frames import PlacedFrame
from scope_ptz.geometry import Equirectangular, Perspective, angle_between_deg
from scope_ptz.simulator.mapping.grid import Grid

UNSEEN_COLOUR = (64, 64, 64)
"""RGB colour of pixels that no frame covers."""

BLOCK_PX = (192, 384)
"""Height and width in pixels of the blocks in which a picture is composed."""

MARGIN_PX = 24  # width of the margin around a block, so that neighbouring blocks detect the same moving objects
LOW_SCALE = 8  # the low band has one value per 8 x 8 pixels of a frame
WEIGHT_SCALE = 4  # weights have one value per 4 x 4 pixels of a frame
COARSE_PX = 4  # weights and low bands are evaluated at every fourth pixel of a block
NEGLIGIBLE_WEIGHT = 2e-3  # frames whose weight is below this throughout a block add no detail to it
MOTION_DIFFERENCE = 14.0
"""Minimum difference of a moving object from the median after smoothing, on a scale of 0 to 255."""

MIXED_ZOOM_CELLS, MIXED_ZOOM_DIFFERENCE = 2.5, 20.0
"""Smoothing and threshold for comparing frames at different zooms, which never look exactly the same.

The smoothing is in cells of ``LOW_SCALE`` pixels in the coarsest frame. The threshold replaces ``MOTION_DIFFERENCE``.
"""

SHARP_POWER, SOFT_POWER = 12, 2
"""Exponents applied to the weight of a frame, for fine detail and for the low band."""

MIN_FINE_DENSITY = 0.8
"""Minimum pixel density of a "fine" frame, relative to the densest frame in a block.

Coarser frames help to detect moving objects and fill the areas that no fine frame covers.
"""

FINE_EDGE = 0.06
"""Weight below which coarse frames gradually replace the best fine frame."""

MIN_WEIGHT = 1e-7  # weight at the edge of a frame
MAX_CACHED_FRAMES = 40
_STEP = 8  # distance in pixels between the points at which directions are computed exactly
LUMA_WEIGHTS = np.array([0.299, 0.587, 0.114], np.float32)  # luma weights for red, green and blue

View = Equirectangular | Perspective

Floats = NDArray[np.float32]
Picture = NDArray[np.uint8]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class FramePicture:
    """The pixels of a frame.

    Attributes:
        image: Array of shape ``(H, W, 3)``, RGB, with the gains applied.
        low: The low band of the image, reduced by ``LOW_SCALE`` in both directions.
        weight: The weight, reduced by ``WEIGHT_SCALE``: 1 at the centre, 0 at the edges and in hidden parts.
    """

    image: Picture
    low: Floats
    weight: Floats


def frame_picture(image: Picture, hidden: Mask | None, gain: NDArray[np.float64]) -> FramePicture:
    """Prepare a frame, (H, W, 3) RGB, for composition: apply the gains, and compute the low band and the weights."""
    toned = image if np.allclose(gain, 1.0, atol=1e-3) else _apply_gain(image, gain)
    height, width = image.shape[:2]
    low = cv2.resize(toned, (max(1, width // LOW_SCALE), max(1, height // LOW_SCALE)), interpolation=cv2.INTER_AREA)
    low = cv2.GaussianBlur(low.astype(np.float32), (0, 0), 1.0, borderType=cv2.BORDER_REPLICATE)
    rows, columns = max(1, height // WEIGHT_SCALE), max(1, width // WEIGHT_SCALE)
    y, x = ((np.arange(n) + 0.5) / n for n in (rows, columns))
    share = (np.minimum(y, 1 - y)[:, None] * 2) * (np.minimum(x, 1 - x)[None, :] * 2)
    if hidden is not None:
        visible = cv2.resize((~hidden).astype(np.uint8), (columns, rows), interpolation=cv2.INTER_AREA)
        fine = cv2.erode((~hidden).astype(np.uint8), np.ones((9, 9), np.uint8))
        visible = np.minimum(visible, cv2.resize(fine, (columns, rows), interpolation=cv2.INTER_NEAREST))
        share = share * np.clip(cv2.distanceTransform(visible, cv2.DIST_L2, 3) / 12, 0, 1)
    return FramePicture(toned, low, share.astype(np.float32))


def _apply_gain(image: Picture, gain: NDArray[np.float64]) -> Picture:
    tables = np.clip(np.arange(256)[:, None] * gain, 0, 255).round().astype(np.uint8)
    return np.asarray(cv2.merge([cv2.LUT(np.ascontiguousarray(image[..., k]), tables[:, k]) for k in range(3)]))


class Composer:
    """Composes pictures from frames placed on the sphere.

    Args:
        frames: The frames.
        read: A function that returns the pixels of frame ``i``.
    """

    def __init__(self, frames: Sequence[PlacedFrame], read: Callable[[int], FramePicture]) -> None:
        self._frames, self._read = frames, read
        self._centres = np.array([frame.axes[2] for frame in frames]).reshape(-1, 3)
        self._reach_deg = np.array([frame.max_off_axis_deg for frame in frames])
        self._pictures: OrderedDict[int, FramePicture] = OrderedDict()

    def compose(
        self,
        projection: View,
        chosen: Sequence[int],
        progress: Callable[[int, int], None] = lambda *_: None,
    ) -> tuple[Picture, Mask]:
        """Compose a picture in the given projection from some of the frames.

        Args:
            projection: The projection of the picture.
            chosen: The indices of the frames to use.
            progress: Called with the number of finished blocks and the total number of blocks.

        Returns:
            The picture, (H, W, 3) RGB, and the mask (H, W) of the pixels that some frame covers.
        """
        picture = np.empty((projection.height, projection.width, 3), np.uint8)
        picture[:] = UNSEEN_COLOUR
        seen = np.zeros(picture.shape[:2], bool)
        blocks = list(_blocks(projection.height, projection.width))
        for number, (rows, columns) in enumerate(blocks):
            self._compose_block(projection, rows, columns, chosen, picture, seen)
            progress(number + 1, len(blocks))
        return picture, seen

    def _compose_block(
        self, projection: View, rows: slice, columns: slice, chosen: Sequence[int], out: Picture, seen: Mask
    ) -> None:  # fmt: skip
        extended = (
            slice(max(0, rows.start - MARGIN_PX), min(projection.height, rows.stop + MARGIN_PX)),
            slice(max(0, columns.start - MARGIN_PX), min(projection.width, columns.stop + MARGIN_PX)),
        )
        grid = Grid(projection, _STEP, extended)
        rays = grid.directions()
        layers = [layer for k in self._frames_near(rays, chosen) if (layer := self._layer(k, grid, rays)) is not None]
        if not layers:
            return
        image, shown_mask = _blend(layers, projection.pixels_per_radian)
        top, left = rows.start - extended[0].start, columns.start - extended[1].start
        inner = slice(top, top + rows.stop - rows.start), slice(left, left + columns.stop - columns.start)
        part, shown = image[inner], shown_mask[inner]
        out[rows, columns][shown] = part[shown]
        seen[rows, columns] = shown

    def _frames_near(self, rays: NDArray[np.float64], chosen: Sequence[int]) -> list[int]:
        """Return the indices of the chosen frames that may cover any of the directions."""
        indices = np.array(chosen, dtype=np.int64)
        centre = rays[rays.shape[0] // 2, rays.shape[1] // 2]
        reach = float(angle_between_deg(rays, centre).max())
        separations_deg = angle_between_deg(self._centres[indices], centre)
        return [int(k) for k in indices[separations_deg < reach + self._reach_deg[indices]]]

    def _layer(self, index: int, grid: Grid, rays: NDArray[np.float64]) -> _Layer | None:
        """Return a frame resampled to a block; None if it covers no part of the block."""
        frame = self._frames[index]
        nodes = frame.points(rays)
        if not np.any(np.all((nodes > -0.1) & (nodes < 1.1), axis=-1)):
            return None
        size = np.array([frame.width, frame.height])
        source_px = grid.to_pixels(np.nan_to_num(np.clip(nodes, -3.0, 4.0), nan=-3.0) * size - 0.5)
        inside = np.all((source_px >= 0) & (source_px <= (size - 1).astype(np.float32)), axis=-1)
        rows, columns = (_coarse_indices(length) for length in source_px.shape[:2])
        coarse = source_px[rows[:, None], columns[None, :]] + np.float32(0.5)
        pixels = self._pixels(index)
        share = _sample(pixels.weight, coarse / WEIGHT_SCALE - np.float32(0.5), cv2.INTER_LINEAR, cv2.BORDER_CONSTANT)
        if not share.any() or not inside.any():
            return None
        low = _sample(pixels.low, coarse / LOW_SCALE - np.float32(0.5), cv2.INTER_LINEAR, cv2.BORDER_REPLICATE)
        return _Layer(pixels.image, source_px, inside, low, share, frame.focal_px)

    def _pixels(self, index: int) -> FramePicture:
        if index not in self._pictures:
            self._pictures[index] = self._read(index)
            while len(self._pictures) > MAX_CACHED_FRAMES:
                self._pictures.popitem(last=False)
        self._pictures.move_to_end(index)
        return self._pictures[index]


@dataclass(frozen=True, slots=True)
class _Layer:
    """A frame resampled to a block of ``(H, W)`` pixels.

    Attributes:
        image: The frame.
        source_px: Coordinates in the frame for each pixel of the block, ``(H, W, 2)``.
        inside: Whether the frame covers each pixel, ``(H, W)``.
        low: Its low band on the coarse grid, ``(H / 4, W / 4, 3)``.
        weight: Its weight on the coarse grid, ``(H / 4, W / 4)``.
        focal_px: Its focal length in pixels, which is its density in pixels per radian.
    """

    image: Picture
    source_px: Floats
    inside: Mask
    low: Floats
    weight: Floats
    focal_px: float


def _blend(layers: Sequence[_Layer], density: float) -> tuple[Picture, Mask]:
    """Blend the layers of a block. Return the picture (H, W, 3) and the mask (H, W) of the pixels that any layer covers.

    Args:
        layers: The layers of a block.
        density: Pixel density of the picture in pixels per radian.
    """
    densest = max(layer.focal_px for layer in layers)
    trust, disputed = _trust_maps(layers, density)
    fine = [layer.focal_px >= MIN_FINE_DENSITY * densest for layer in layers]
    shares = [layer.weight * weight for layer, weight in zip(layers, trust, strict=True)]
    sharp_weights = [share**SHARP_POWER + MIN_WEIGHT * (layer.weight > 0) for share, layer in zip(shares, layers, strict=True)]
    soft_weights = [share**SOFT_POWER + MIN_WEIGHT * (layer.weight > 0) for share, layer in zip(shares, layers, strict=True)]
    best = np.max([share for share, is_fine in zip(shares, fine, strict=True) if is_fine], axis=0)
    sharp_weights, soft_weights = (
        _normalise_by_fineness(sharp_weights, fine, best),
        _normalise_by_fineness(soft_weights, fine, best),
    )
    # Where frames disagree, the low band also comes from a single frame, because mixing them would cause ghosting.
    low_weights = [soft + disputed * (sharp - soft) for soft, sharp in zip(soft_weights, sharp_weights, strict=True)]
    low = np.zeros_like(layers[0].low)
    for layer, weight in zip(layers, low_weights, strict=True):
        low += weight[..., None] * layer.low
    height, width = layers[0].inside.shape
    picture = _enlarge(low, height, width)
    total, shown = np.zeros((height, width), np.float32), np.zeros((height, width), bool)
    details = np.zeros_like(picture)
    for layer, weight in zip(layers, sharp_weights, strict=True):
        shown |= layer.inside & (_enlarge(layer.weight, height, width) > 0)
        if weight.max() < NEGLIGIBLE_WEIGHT:
            continue
        detail_weight = _enlarge(weight, height, width) * layer.inside
        full = cv2.remap(layer.image, layer.source_px, None, cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
        details += detail_weight[..., None] * (full - _enlarge(layer.low, height, width))
        total += detail_weight
    picture += details / np.maximum(total, 1e-6)[..., None]
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8), shown


def _normalise_by_fineness(weights: Sequence[Floats], fine: Sequence[bool], best: Floats) -> list[Floats]:
    """Normalise weights to sum to 1. Coarse frames get weight only where fine frames have little or none."""
    totals = {
        is_fine: sum((weight for weight, fine_flag in zip(weights, fine, strict=True) if fine_flag is is_fine), np.zeros_like(best))
        for is_fine in (True, False)
    }
    fine_share = np.where(totals[False] > 0, np.clip(best / FINE_EDGE, 0, 1), 1)
    shares = {True: fine_share, False: 1 - fine_share}
    return [
        np.asarray(weight / np.maximum(totals[fine_flag], 1e-30) * shares[fine_flag], np.float32)
        for weight, fine_flag in zip(weights, fine, strict=True)
    ]


def _trust_maps(layers: Sequence[_Layer], density: float) -> tuple[list[Floats], Floats]:
    """Return the trust in each layer, and the disagreement between trusted layers, both from 0 to 1 on the coarse grid.

    A layer is trusted except where it shows a moving object.
    """
    shape = layers[0].weight.shape
    if len(layers) == 1:
        return [np.ones(shape, np.float32)], np.zeros(shape, np.float32)
    coarsest = min(layer.focal_px for layer in layers)
    has_mixed_zooms = max(layer.focal_px for layer in layers) > coarsest / MIN_FINE_DENSITY
    cells, limit = (MIXED_ZOOM_CELLS, MIXED_ZOOM_DIFFERENCE) if has_mixed_zooms else (1.0, MOTION_DIFFERENCE)
    greys = np.stack([_smooth(layer.low @ LUMA_WEIGHTS, layer.focal_px, coarsest, density, cells) for layer in layers])
    absent = np.stack([layer.weight <= 0.02 for layer in layers])
    greys = np.where(absent, np.nan, greys)
    order = np.sort(greys, axis=0)  # NaN comes last
    count = (~absent).sum(axis=0)
    last_index = np.clip(count - 1, 0, None)
    median = (_select(order, last_index // 2) + _select(order, (last_index + 1) // 2)) / 2
    differences = np.nan_to_num(np.abs(greys - median))
    moving = np.stack([_moving_areas(layer_map, limit) for layer_map in np.where(count >= 3, differences, 0)])
    trust = [1 - (1 - 1e-3) * _soften(layer_map) for layer_map in moving]
    trusted = np.where(moving, np.nan, greys)
    order = np.sort(trusted, axis=0)
    count = (~np.isnan(trusted)).sum(axis=0)
    spread = np.nan_to_num(_select(order, np.clip(count - 1, 0, None)) - order[0])
    return trust, _soften(spread > limit)


def _smooth(grey: Floats, focal_px: float, coarsest_px: float, density: float, cells: float) -> Floats:
    """Smooth a grey picture over ``cells`` cells of the coarsest frame, to keep sharpness differences from looking like motion."""
    target, current = (LOW_SCALE * density / focal / COARSE_PX for focal in (coarsest_px, focal_px))
    sigma = math.sqrt(max(0.0, (cells * target) ** 2 - current**2))
    return grey if sigma < 0.3 else np.asarray(cv2.GaussianBlur(grey, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE))


def _select(stack: Floats, index: NDArray[np.int64]) -> Floats:
    return np.asarray(np.take_along_axis(stack, index[None], axis=0)[0])


def _moving_areas(differences: Floats, limit: float) -> Mask:
    """Return the mask of moving areas: connected areas that exceed a third of the limit throughout and the limit somewhere."""
    _, labels = cv2.connectedComponents((differences > limit / 3).astype(np.uint8))
    above = np.unique(labels[differences > limit])
    return np.isin(labels, above[above > 0])


def _soften(mask: Mask) -> Floats:
    """Enlarge a mask and soften its edges. Return values from 0 to 1."""
    if not mask.any():
        return np.zeros(mask.shape, np.float32)
    enlarged = cv2.dilate(mask.astype(np.float32), np.ones((7, 7), np.uint8))
    return np.asarray(cv2.GaussianBlur(enlarged, (5, 5), 0))


def _sample(picture: Floats, source_px: NDArray[np.floating], interpolation: int, border: int) -> NDArray[np.float32]:
    """Sample a picture at pixel coordinates (H, W, 2)."""
    return np.asarray(cv2.remap(picture, source_px, None, interpolation, borderMode=border))


def _coarse_indices(length: int) -> NDArray[np.int64]:
    """Return the row or column indices of the coarse grid, one near the centre of every four pixels."""
    return np.minimum(np.arange(-(-length // COARSE_PX)) * COARSE_PX + COARSE_PX // 2, length - 1)


def _enlarge(coarse: Floats, height: int, width: int) -> Floats:
    """Interpolate values on the coarse grid to every pixel of a block."""
    size = coarse.shape[1] * COARSE_PX, coarse.shape[0] * COARSE_PX
    return np.asarray(cv2.resize(coarse, size, interpolation=cv2.INTER_LINEAR)[:height, :width])


def _blocks(height: int, width: int) -> Iterator[tuple[slice, slice]]:
    """Yield blocks as row and column slices, column by column, so that consecutive blocks use the same frames."""
    for left in range(0, width, BLOCK_PX[1]):
        for top in range(0, height, BLOCK_PX[0]):
            yield slice(top, min(top + BLOCK_PX[0], height)), slice(left, min(left + BLOCK_PX[1], width))
