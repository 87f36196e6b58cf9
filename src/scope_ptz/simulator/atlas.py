"""A sheet that holds all of a viewpoint's pictures of one kind side by side, so that a view is a single ``cv2.remap``.

The sheet holds the panorama and every tile, each at the scales that views ask for. Borders are wrapped or repeated, so that
bilinear look-ups never see a seam. Pictures are read on first use. The sheet may be large, because memory that is never used is
never touched.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from threading import Lock
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import PackError

MAX_SIDE_PX = 32766
"""OpenCV's remap addresses its source with 16-bit integers."""

BORDER_PX = 2
"""Border around every slot: one pixel for the bilinear neighbour, one for rounding."""

SHARPENING_SIGMA_PX = 0.7
SHARPENING_REACH_PX = 2  # OpenCV's Gaussian of this sigma has 5 taps for 8-bit pictures

BLOCK_PX = 512  # side of the blocks in which the panorama is sharpened
_REACH_PX = 4  # a bilinear look-up and its rounding stay within this many pixels of the map

Size = tuple[int, int]
"""Width, height."""


@dataclass(frozen=True, slots=True)
class Slot:
    """The place of one picture at one scale: its first pixel in the sheet, without the border, and its size."""

    x: int
    y: int
    width: int
    height: int


class Scale(NamedTuple):
    """A size at which pictures are kept, relative to the stored one, and the amount of sharpening applied."""

    size: float
    sharpening: float = 0.0


class Atlas:
    """One sheet with every picture of one kind, each at every scale.

    ``slots[0]`` holds the panorama's places, one per scale; ``slots[1 + i]`` those of tile ``i``.

    Args:
        sizes: Width and height of the panorama and of each tile, at full size.
        load: ``load(0)`` reads the panorama and ``load(1 + i)`` tile ``i``, at full size.
        dtype: Type of a pixel's channel.
        channels: Channels per pixel.
        scales: Scales at which every picture is kept.
    """

    def __init__(
        self,
        sizes: Sequence[Size],
        load: Callable[[int], NDArray[Any]],
        dtype: type[np.generic],
        channels: int,
        scales: Sequence[Scale] = (Scale(1.0),),
    ) -> None:
        self.scales = tuple(scales)
        self.slots, (width, height) = _lay_out(sizes, [scale.size for scale in scales])
        self._load = load
        self._ready: set[tuple[int, int]] = set()
        self._panorama: NDArray[Any] | None = None  # kept while a scale of it is only partly filled
        self._missing: dict[int, set[tuple[int, int]]] = {}
        self._lock = Lock()
        self.sheet: NDArray[Any] = np.empty((height, width, channels) if channels > 1 else (height, width), dtype=dtype)

    def need(self, index: int, scale: int = 0) -> Slot:
        """Fill one picture at one scale and return its slot."""
        slot = self.slots[index][scale]
        if (index, scale) not in self._ready:
            with self._lock:
                if (index, scale) not in self._ready:
                    self._fill(slot, self._read(index), self.scales[scale].sharpening, index)
                    self._finished(index, scale)
        return slot

    def need_panorama_part(self, scale: int, left: float, right: float, top: float, bottom: float) -> None:
        """Fill the blocks of the panorama that a view samples.

        Sharpening the whole panorama takes longer than everything else in a first view, and most views see a tenth of it.

        Args:
            scale: Index into ``scales``.
            left, right: Sampled columns in pixels of the slot; values beyond its sides wrap around.
            top, bottom: Sampled rows in pixels of the slot; values beyond its sides are clipped.
        """
        if (0, scale) in self._ready:
            return
        if self.scales[scale].size != 1.0 or not self.scales[scale].sharpening:
            self.need(0, scale)
            return
        with self._lock:
            slot = self.slots[0][scale]
            missing = self._missing.setdefault(scale, set(product(range(_blocks(slot.height)), range(_blocks(slot.width)))))
            wanted = missing & set(product(_rows(slot, top, bottom), _columns(slot, left, right)))
            if wanted:
                panorama = self._panorama = self._read(0) if self._panorama is None else self._panorama
                for row, column in wanted:
                    self._fill_block(slot, panorama, self.scales[scale].sharpening, row, column)
                missing -= wanted
                if not missing:
                    self._finished(0, scale)

    def _read(self, index: int) -> NDArray[Any]:
        return self._panorama if index == 0 and self._panorama is not None else self._load(index)

    def _finished(self, index: int, scale: int) -> None:
        self._ready.add((index, scale))
        if index == 0:
            self._missing.pop(scale, None)
            if not self._missing:
                self._panorama = None

    def _fill(self, slot: Slot, picture: NDArray[Any], sharpening: float, index: int) -> None:
        if (slot.width, slot.height) != (picture.shape[1], picture.shape[0]):
            picture = cv2.resize(picture, (slot.width, slot.height), interpolation=cv2.INTER_AREA)
        b = BORDER_PX
        sides = cv2.BORDER_WRAP if index == 0 else cv2.BORDER_REPLICATE
        place = self.sheet[slot.y - b : slot.y + slot.height + b, slot.x - b : slot.x + slot.width + b]
        if sharpening:
            padded = cv2.copyMakeBorder(cv2.copyMakeBorder(picture, 0, 0, b, b, sides), b, b, 0, 0, cv2.BORDER_REPLICATE)
            place[...] = _sharpened(padded, sharpening)
        else:  # straight into the sheet: these are the largest layers
            place[b:-b, b:-b] = picture
            place[b:-b, :b], place[b:-b, -b:] = (
                (picture[:, -b:], picture[:, :b]) if index == 0 else (picture[:, :1], picture[:, -1:])
            )
            place[:b], place[-b:] = place[b], place[-b - 1]

    def _fill_block(self, slot: Slot, panorama: NDArray[Any], sharpening: float, row: int, column: int) -> None:
        """Fill one block of the panorama, borders included where it touches a side, exactly as ``_fill`` would."""
        b, m = BORDER_PX, SHARPENING_REACH_PX
        height, width = slot.height + 2 * b, slot.width + 2 * b
        y0, y1 = row * BLOCK_PX, height if row == _blocks(slot.height) - 1 else (row + 1) * BLOCK_PX
        x0, x1 = column * BLOCK_PX, width if column == _blocks(slot.width) - 1 else (column + 1) * BLOCK_PX
        top, left = max(0, y0 - m), max(0, x0 - m)
        rows = np.arange(top, min(height, y1 + m)) - b
        columns = np.arange(left, min(width, x1 + m)) - b
        if rows[0] >= 0 and rows[-1] < slot.height and columns[0] >= 0 and columns[-1] < slot.width:
            padded = panorama[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        else:
            padded = panorama[np.clip(rows, 0, slot.height - 1)[:, None], columns % slot.width]
        sharp = _sharpened(padded, sharpening)[y0 - top : y1 - top, x0 - left : x1 - left]
        self.sheet[slot.y - b + y0 : slot.y - b + y1, slot.x - b + x0 : slot.x - b + x1] = sharp


def _sharpened(picture: NDArray[Any], sharpening: float) -> NDArray[Any]:
    soft = cv2.GaussianBlur(picture, (0, 0), SHARPENING_SIGMA_PX)
    return np.asarray(cv2.addWeighted(picture, 1 + sharpening, soft, -sharpening, 0, dst=soft))


def _blocks(side: int) -> int:
    """Return how many blocks a side of a slot is cut into; the last one takes the remainder and the borders."""
    return max(1, side // BLOCK_PX)


def _rows(slot: Slot, top: float, bottom: float) -> range:
    last = _blocks(slot.height) - 1
    first_px, last_px = (min(max(edge, 0.0), slot.height - 1.0) for edge in (top - _REACH_PX, bottom + _REACH_PX))
    return range(min(last, int(first_px) // BLOCK_PX), min(last, int(last_px + 2 * BORDER_PX) // BLOCK_PX) + 1)


def _columns(slot: Slot, left: float, right: float) -> set[int]:
    last = _blocks(slot.width) - 1
    if right - left + 2 * _REACH_PX >= slot.width:
        return set(range(last + 1))
    first_px, last_px = math.floor(left - _REACH_PX), math.ceil(right + _REACH_PX)
    sampled = np.arange(first_px, last_px + 1) % slot.width
    blocks = set(np.unique(np.minimum((sampled + BORDER_PX) // BLOCK_PX, last)).tolist())
    # The borders repeat the other side's columns.
    return blocks | ({0, last} if sampled.min() < _REACH_PX or sampled.max() >= slot.width - _REACH_PX else set())


def _lay_out(sizes: Sequence[Size], scales: Sequence[float]) -> tuple[list[tuple[Slot, ...]], Size]:
    """Place the pictures on shelves of falling height; widen the sheet until it is low enough."""
    scaled = [[(max(1, round(w * s)), max(1, round(h * s))) for s in scales] for w, h in sizes]
    flat = [(i, k) for i, sized in enumerate(scaled) for k in range(len(sized))]
    flat.sort(key=lambda ik: -scaled[ik[0]][ik[1]][1])
    sheet_width = max(w for sized in scaled for w, _ in sized) + 2 * BORDER_PX
    while sheet_width <= MAX_SIDE_PX:
        placed: dict[tuple[int, int], Slot] = {}
        x = y = shelf = 0
        for i, k in flat:
            w, h = scaled[i][k][0] + 2 * BORDER_PX, scaled[i][k][1] + 2 * BORDER_PX
            if x + w > sheet_width:
                x, y, shelf = 0, y + shelf, 0
            placed[i, k] = Slot(x + BORDER_PX, y + BORDER_PX, *scaled[i][k])
            x, shelf = x + w, max(shelf, h)
        if y + shelf <= MAX_SIDE_PX:
            return [tuple(placed[i, k] for k in range(len(scales))) for i in range(len(sizes))], (sheet_width, y + shelf)
        if sheet_width == MAX_SIDE_PX:
            break
        sheet_width = min(MAX_SIDE_PX, sheet_width * 5 // 4)
    raise PackError("This viewpoint has more pixels than one sheet of 32766 x 32766 holds. Bake it with fewer or smaller tiles.")
