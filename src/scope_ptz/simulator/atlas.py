"""All pictures of one kind that a viewpoint has, side by side in one big sheet, so that a view is a single look-up.

The sheet holds the panorama (with a wrapped column and a repeated row on each side, so that bilinear look-ups never see a seam) and
every tile (with a repeated border), each at the scales that views ask for. Nothing is read before it is first used; memory that is
never used is never touched, so the sheet may be large.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Lock
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import PackError

MAX_SIDE_PX = 32766
"""OpenCV's remap addresses its source with 16-bit integers."""

BORDER_PX = 2
"""Around every slot: one pixel for the bilinear neighbour, one for rounding."""

SHARPENING_SIGMA_PX = 0.7

Size = tuple[int, int]
"""Width, height."""


@dataclass(frozen=True, slots=True)
class Slot:
    """Where one picture at one scale lies in the sheet: its first pixel (border not counted) and its size."""

    x: int
    y: int
    width: int
    height: int


class Scale(NamedTuple):
    """A size at which pictures are kept, relative to the stored one, and how much they are sharpened for it."""

    size: float
    sharpening: float = 0.0


class Atlas:
    """``slots[0]`` are the places of the panorama, one a scale, ``slots[1 + i]`` those of tile ``i``.

    ``load(0)`` reads the panorama and ``load(1 + i)`` tile ``i``, at full size.
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
        self._lock = Lock()
        self.sheet: NDArray[Any] = np.empty((height, width, channels) if channels > 1 else (height, width), dtype=dtype)

    def need(self, index: int, scale: int = 0) -> Slot:
        """The slot of one picture at one scale, filled."""
        slot = self.slots[index][scale]
        if (index, scale) not in self._ready:
            with self._lock:
                if (index, scale) not in self._ready:
                    self._fill(
                        slot,
                        self._load(index),
                        self.scales[scale].sharpening,
                        cv2.BORDER_WRAP if index == 0 else cv2.BORDER_REPLICATE,
                    )
                    self._ready.add((index, scale))
        return slot

    def _fill(self, slot: Slot, picture: NDArray[Any], sharpening: float, sides: int) -> None:
        if (slot.width, slot.height) != (picture.shape[1], picture.shape[0]):
            picture = cv2.resize(picture, (slot.width, slot.height), interpolation=cv2.INTER_AREA)
        b = BORDER_PX
        padded = cv2.copyMakeBorder(cv2.copyMakeBorder(picture, 0, 0, b, b, sides), b, b, 0, 0, cv2.BORDER_REPLICATE)
        if sharpening:
            padded = cv2.addWeighted(padded, 1 + sharpening, cv2.GaussianBlur(padded, (0, 0), SHARPENING_SIGMA_PX), -sharpening, 0)
        self.sheet[slot.y - b : slot.y + slot.height + b, slot.x - b : slot.x + slot.width + b] = padded


def _lay_out(sizes: Sequence[Size], scales: Sequence[float]) -> tuple[list[tuple[Slot, ...]], Size]:
    """Shelves of falling height. The sheet grows wider until it is low enough."""
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
