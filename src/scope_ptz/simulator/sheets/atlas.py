"""A sheet that holds all of a viewpoint's pictures of one kind side by side, so that a view is a single ``cv2.remap``.

The sheet holds the panorama and every tile, each at the scales that views ask for. Borders are wrapped or repeated, so that
bilinear look-ups never see a seam. Pictures are read on first use. The sheet may be large, because memory that is never used is
never touched. A limit on the memory of tiles makes the sheet release those that were not used for longest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from threading import RLock
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.simulator.sheets.kept import KeptPictures, KeptSheet
from scope_ptz.simulator.sheets.layout import BORDER_PX, Size, Slot, lay_out
from scope_ptz.simulator.sheets.memory import CAN_RELEASE, ReleasableArray

SHARPENING_SIGMA_PX = 0.7
SHARPENING_REACH_PX = 2  # OpenCV's Gaussian of this sigma has 5 taps for 8-bit pictures

STRIP_PX = 256  # rows that are decoded or sharpened at once, to keep intermediate arrays small


class Scale(NamedTuple):
    """A size at which pictures are kept, relative to the stored one, and the amount of sharpening applied."""

    size: float
    sharpening: float = 0.0


@dataclass(frozen=True, slots=True)
class Keep:
    """Where a sheet stays on disk.

    Attributes:
        pictures: The folder.
        source: What the pixels of the sheet depend on, besides its layout.
        verify: Verifies the file of picture ``i``. Raises ``PackError`` if it is damaged.
    """

    pictures: KeptPictures
    source: str
    verify: Callable[[int], object]

    def open(self, slots: Sequence[tuple[Slot, ...]], shape: tuple[int, ...], dtype: type[np.generic]) -> KeptSheet | None:
        """Return the sheet, None if nothing can be kept."""
        return self.pictures.sheet(self.pictures.name(self.source, slots, shape), shape, dtype)


class Atlas:
    """One sheet with every picture of one kind, each at every scale. Safe to share between threads.

    ``slots[0]`` holds the panorama's places, one per scale; ``slots[1 + i]`` those of tile ``i``.

    Args:
        sizes: Width and height of the panorama and of each tile, at full size.
        load: ``load(atlas, 0)`` reads the panorama and ``load(atlas, 1 + i)`` tile ``i``, at full size.
        dtype: Type of a pixel's channel.
        channels: Channels per pixel.
        scales: Scales at which every picture is kept.
        decode: Turns rows of a loaded picture into pixels; the default takes them as they are.
        pans_deg: Directions of the tiles; see ``lay_out``. Needed for a limit.
        tile_bytes: Limit on the memory of tiles. The panorama is always kept.
        kept: Where the sheet stays on disk. Without it, or with a limit, the sheet is only in memory.
    """

    def __init__(
        self,
        sizes: Sequence[Size],
        load: Callable[[Atlas, int], NDArray[Any]],
        dtype: type[np.generic],
        channels: int,
        scales: Sequence[Scale] = (Scale(1.0),),
        *,
        decode: Callable[[NDArray[Any]], NDArray[Any]] | None = None,
        pans_deg: Sequence[float] | None = None,
        tile_bytes: int | None = None,
        kept: Keep | None = None,
    ) -> None:
        self.scales = tuple(scales)
        self.slots, self._shelves, (width, height) = lay_out(sizes, [scale.size for scale in scales], pans_deg)
        self._load, self._decode = load, decode
        self._ready: set[tuple[int, int]] = set()
        self._lock = RLock()
        self._tile_bytes = tile_bytes if CAN_RELEASE else None
        shape = (height, width, channels) if channels > 1 else (height, width)
        self._keep = None if self._tile_bytes is not None else kept
        self._kept = self._keep.open(self.slots, shape, dtype) if self._keep is not None else None
        self._memory: ReleasableArray | None = None
        self.sheet: NDArray[Any]
        if self._kept is not None:
            self.sheet = self._kept.array
        else:
            self._memory = ReleasableArray(shape, dtype)
            self.sheet = self._memory.array
        self._clock = 0
        self._last_used: dict[int, int] = {}  # of each shelf of tiles that holds something
        self._readers: list[int] = []

    @property
    def unlimited(self) -> bool:
        """Whether everything that was read stays in memory."""
        return self._tile_bytes is None

    def need(self, index: int, scale: int = 0) -> Slot:
        """Fill one picture at one scale and return its slot.

        If memory is limited, the slot keeps its content while the caller is inside ``reading``.
        """
        slot = self.slots[index][scale]
        if self._tile_bytes is None and (index, scale) in self._ready:
            return slot
        self.need_scales(index, (scale,))
        return slot

    def need_scales(self, index: int, scales: Sequence[int]) -> None:
        """Fill one picture at several scales. It is read only once."""
        with self._lock:
            if index and self._tile_bytes is not None:
                self._clock += 1
                self._last_used |= {self.slots[index][scale].shelf: self._clock for scale in scales}
            missing = [scale for scale in scales if (index, scale) not in self._ready]
            if missing and self._kept is not None:
                self._find_or_fill(self._kept, index, missing)
            elif missing:
                self._fill_scales(index, missing)
                self._release_oldest()

    def _fill_scales(self, index: int, scales: Sequence[int]) -> None:
        picture = self._load(self, index)
        for scale in scales:
            self._fill(self.slots[index][scale], picture, self.scales[scale].sharpening, index)
            self._ready.add((index, scale))

    def _verify(self, index: int) -> None:
        if self._keep is not None:
            self._keep.verify(index)

    def _find_or_fill(self, kept: KeptSheet, index: int, scales: Sequence[int]) -> None:
        """Use what is complete on disk, after verifying the file that it was read from, and fill the rest."""
        pairs = {(index, scale) for scale in scales}
        if pairs <= kept.complete():
            self._verify(index)
            self._ready |= pairs
            return
        with kept.filling():
            found = pairs & kept.complete()
            if found:
                self._verify(index)
            self._ready |= found
            missing = sorted(scale for _, scale in pairs - found)
            if missing:
                self._fill_scales(index, missing)
            for scale in missing:
                slot = self.slots[index][scale]
                kept.completed(index, scale, (slot.y - BORDER_PX, slot.y + slot.height + BORDER_PX))

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Keep all slots that are needed inside the context until it ends."""
        if self._tile_bytes is None:
            yield
            return
        with self._lock:
            self._clock += 1
            began = self._clock
            self._readers.append(began)
        try:
            yield
        finally:
            with self._lock:
                self._readers.remove(began)
                self._release_oldest()

    def _release_oldest(self) -> None:
        """Release shelves of tiles, the least recently used first, until the limit holds or every shelf is in use."""
        memory = self._memory
        if self._tile_bytes is None or memory is None:
            return
        free_before = min(self._readers, default=self._clock)
        row_bytes = self.sheet[0].nbytes
        held = {shelf: (self._shelves[shelf].bottom - self._shelves[shelf].top) * row_bytes for shelf in self._last_used}
        total = sum(held.values())
        for shelf in sorted(self._last_used, key=self._last_used.__getitem__):
            if total <= self._tile_bytes or self._last_used[shelf] >= free_before:
                return
            self._ready.difference_update(self._shelves[shelf].pictures)
            memory.release_rows(self._shelves[shelf].top, self._shelves[shelf].bottom)
            del self._last_used[shelf]
            total -= held[shelf]

    def _fill(self, slot: Slot, picture: NDArray[Any], sharpening: float, index: int) -> None:
        if (slot.width, slot.height) != (picture.shape[1], picture.shape[0]):
            picture = cv2.resize(picture, (slot.width, slot.height), interpolation=cv2.INTER_AREA)
        b = BORDER_PX
        place = self.sheet[slot.y - b : slot.y + slot.height + b, slot.x - b : slot.x + slot.width + b]
        for top in range(0, slot.height, STRIP_PX):
            rows = picture[top : top + STRIP_PX]
            place[b + top : b + top + len(rows), b:-b] = rows if self._decode is None else self._decode(rows)
        place[b:-b, :b], place[b:-b, -b:] = (
            (place[b:-b, -2 * b : -b], place[b:-b, b : 2 * b]) if index == 0 else (place[b:-b, b : b + 1], place[b:-b, -b - 1 : -b])
        )
        place[:b], place[-b:] = place[b], place[-b - 1]
        if sharpening:
            _sharpen(place, sharpening)


def _sharpen(picture: NDArray[Any], sharpening: float) -> None:
    """Sharpen a picture in place, strip by strip, with the same result as in one piece."""
    reach, above = SHARPENING_REACH_PX, picture[:0]
    for top in range(0, len(picture), STRIP_PX):
        bottom = min(top + STRIP_PX, len(picture))
        # The rows above have been sharpened already, so their original content is kept from the previous round.
        strip = np.concatenate([above, picture[top : bottom + reach]])
        skip = len(above)
        above = picture[bottom - reach : bottom].copy()
        soft = cv2.GaussianBlur(strip, (0, 0), SHARPENING_SIGMA_PX)
        sharp = cv2.addWeighted(strip, 1 + sharpening, soft, -sharpening, 0, dst=soft)
        picture[top:bottom] = sharp[skip : skip + bottom - top]
