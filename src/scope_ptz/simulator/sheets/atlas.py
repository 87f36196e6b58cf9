"""A sheet that contains all of a viewpoint's pictures of one kind side by side, so that a view is a single ``cv2.remap``.

The sheet contains the panorama and every tile, each at the scales that views need. Borders are wrapped or repeated, so that
bilinear look-ups are seamless. Pictures are read on first use. The sheet may be large, because unused parts take no
memory. If the memory for tiles is limited, the sheet releases the least recently used tiles.
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

from scope_ptz.simulator.sheets.layout import BORDER_PX, Size, Slot, lay_out
from scope_ptz.simulator.sheets.memory import CAN_RELEASE, ReleasableArray
from scope_ptz.simulator.sheets.picture_cache import CachedSheet, PictureCache

SHARPENING_SIGMA_PX = 0.7
SHARPENING_RADIUS_PX = 2  # for 8-bit pictures, OpenCV's Gaussian with this sigma has 5 taps

STRIP_PX = 256  # rows that are decoded or sharpened at once, to keep intermediate arrays small


class Scale(NamedTuple):
    """A picture size on the sheet, relative to the stored size, and the amount of sharpening."""

    size: float
    sharpening: float = 0.0


@dataclass(frozen=True, slots=True)
class SheetCache:
    """A sheet's on-disk cache.

    Attributes:
        pictures: The cache folder.
        source: Identifies the sheet's contents, independently of its layout.
        verify: Verifies the file of picture ``i``. Raises ``PackError`` if it is damaged.
    """

    pictures: PictureCache
    source: str
    verify: Callable[[int], object]

    def open(self, slots: Sequence[tuple[Slot, ...]], shape: tuple[int, ...], dtype: type[np.generic]) -> CachedSheet | None:
        """Return the cached sheet; None if it cannot be cached."""
        return self.pictures.sheet(self.pictures.name(self.source, slots, shape), shape, dtype)


class Atlas:
    """One sheet with every picture of one kind, each at every scale. Safe to share between threads.

    ``slots[0]`` are the panorama's slots, one per scale; ``slots[1 + i]`` are those of tile ``i``.

    Args:
        sizes: Width and height of the panorama and of each tile, at full size.
        load: ``load(atlas, 0)`` reads the panorama and ``load(atlas, 1 + i)`` tile ``i``, at full size.
        dtype: Data type of a channel.
        channels: Channels per pixel.
        scales: Scales at which every picture is stored on the sheet.
        decode: Converts rows of a loaded picture to pixels; by default, they are used unchanged.
        pans_deg: Pan angles of the tiles; see ``lay_out``. Required with ``tile_bytes``.
        tile_bytes: Memory limit for tiles. The panorama always stays in memory.
        disk_cache: The sheet's on-disk cache. Without it, or with a memory limit, the sheet is only in memory.
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
        disk_cache: SheetCache | None = None,
    ) -> None:
        self.scales = tuple(scales)
        self._tile_bytes = tile_bytes if CAN_RELEASE else None
        self.slots, self._shelves, (width, height) = lay_out(sizes, [scale.size for scale in scales], pans_deg)
        self._load, self._decode = load, decode
        self._ready: set[tuple[int, int]] = set()
        self._lock = RLock()
        self._size = width, height
        rows = self._rows(width, height)
        shape = (rows, width, channels) if channels > 1 else (rows, width)
        self._disk_cache = None if self._tile_bytes is not None else disk_cache
        self._cached = self._disk_cache.open(self.slots, shape, dtype) if self._disk_cache is not None else None
        self._memory: ReleasableArray | None = None
        self.sheet: NDArray[Any]
        if self._cached is not None:
            self.sheet = self._cached.array
        else:
            self._memory = ReleasableArray(shape, dtype)
            self.sheet = self._memory.array
        self._clock = 0
        self._last_used: dict[int, int] = {}  # keyed by shelf; contains only shelves with tiles that are in use
        self._readers: list[int] = []

    def _rows(self, width: int, height: int) -> int:  # noqa: ARG002 - for subclasses
        """Return the number of rows for which memory is reserved. Subclasses may store more below the sheet."""
        return height

    @property
    def is_unlimited(self) -> bool:
        """Whether all pictures stay in memory once they have been read."""
        return self._tile_bytes is None

    @property
    def is_in_use(self) -> bool:
        """Whether any picture has been read."""
        return bool(self._ready)

    def ensure(self, index: int, scale: int = 0) -> Slot:
        """Load one picture at one scale, unless it is already loaded, and return its slot.

        If memory is limited, the slot keeps its contents while the caller is inside ``reading``.
        """
        slot = self.slots[index][scale]
        if self._tile_bytes is None and (index, scale) in self._ready:
            return slot
        self.ensure_scales(index, (scale,))
        return slot

    def ensure_scales(self, index: int, scales: Sequence[int]) -> None:
        """Load one picture at several scales, unless they are already loaded. The picture is read only once."""
        with self._lock:
            if index and self._tile_bytes is not None:
                self._clock += 1
                self._last_used |= {self.slots[index][scale].shelf: self._clock for scale in scales}
            missing = [scale for scale in scales if (index, scale) not in self._ready]
            if missing and self._cached is not None:
                self._find_or_fill(self._cached, index, missing)
            elif missing:
                self._fill_scales(index, missing)
                self._release_oldest()

    def _fill_scales(self, index: int, scales: Sequence[int]) -> None:
        picture = self._load(self, index)
        for scale in scales:
            self._fill(self.slots[index][scale], picture, self.scales[scale].sharpening, index)
            self._ready.add((index, scale))

    def _verify(self, index: int) -> None:
        if self._disk_cache is not None:
            self._disk_cache.verify(index)

    def _find_or_fill(self, cached: CachedSheet, index: int, scales: Sequence[int]) -> None:
        """Use the scales that are complete on disk, after verifying the picture's file, and fill the others."""
        pairs = {(index, scale) for scale in scales}
        if pairs <= cached.complete_pictures():
            self._verify(index)
            self._ready |= pairs
            return
        with cached.lock_for_filling():
            complete = pairs & cached.complete_pictures()
            if complete:
                self._verify(index)
            self._ready |= complete
            missing = sorted(scale for _, scale in pairs - complete)
            if missing:
                self._fill_scales(index, missing)
            for scale in missing:
                cached.mark_complete(index, scale)

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Keep every slot that is requested inside this context filled until the context ends."""
        if self._tile_bytes is None:
            yield
            return
        with self._lock:
            self._clock += 1
            start = self._clock
            self._readers.append(start)
        try:
            yield
        finally:
            with self._lock:
                self._readers.remove(start)
                self._release_oldest()

    def _release_oldest(self) -> None:
        """Release tile shelves, the least recently used first, until the limit is met or every remaining shelf is in use."""
        memory = self._memory
        if self._tile_bytes is None or memory is None:
            return
        releasable_before = min(self._readers, default=self._clock)
        row_bytes = self.sheet[0].nbytes
        shelf_bytes = {shelf: (self._shelves[shelf].bottom - self._shelves[shelf].top) * row_bytes for shelf in self._last_used}
        total = sum(shelf_bytes.values())
        for shelf in sorted(self._last_used, key=self._last_used.__getitem__):
            if total <= self._tile_bytes or self._last_used[shelf] >= releasable_before:
                return
            self._ready.difference_update(self._shelves[shelf].pictures)
            memory.release_rows(self._shelves[shelf].top, self._shelves[shelf].bottom)
            del self._last_used[shelf]
            total -= shelf_bytes[shelf]

    def _fill(self, slot: Slot, picture: NDArray[Any], sharpening: float, index: int) -> None:
        if (slot.width, slot.height) != (picture.shape[1], picture.shape[0]):
            picture = cv2.resize(picture, (slot.width, slot.height), interpolation=cv2.INTER_AREA)
        border = BORDER_PX
        place = self.sheet[slot.y - border : slot.y + slot.height + border, slot.x - border : slot.x + slot.width + border]
        for top in range(0, slot.height, STRIP_PX):
            rows = picture[top : top + STRIP_PX]
            place[border + top : border + top + len(rows), border:-border] = rows if self._decode is None else self._decode(rows)
        place[border:-border, :border], place[border:-border, -border:] = (
            (place[border:-border, -2 * border : -border], place[border:-border, border : 2 * border])
            if index == 0
            else (place[border:-border, border : border + 1], place[border:-border, -border - 1 : -border])
        )
        place[:border], place[-border:] = place[border], place[-border - 1]
        if sharpening:
            _sharpen(place, sharpening)


def _sharpen(picture: NDArray[Any], sharpening: float) -> None:
    """Sharpen a picture in place, strip by strip, with the same result as sharpening it whole."""
    radius, above = SHARPENING_RADIUS_PX, picture[:0]
    for top in range(0, len(picture), STRIP_PX):
        bottom = min(top + STRIP_PX, len(picture))
        # The rows above are already sharpened, so their original contents were saved in the previous iteration.
        strip = np.concatenate([above, picture[top : bottom + radius]])
        skip = len(above)
        above = picture[bottom - radius : bottom].copy()
        soft = cv2.GaussianBlur(strip, (0, 0), SHARPENING_SIGMA_PX)
        sharp = cv2.addWeighted(strip, 1 + sharpening, soft, -sharpening, 0, dst=soft)
        picture[top:bottom] = sharp[skip : skip + bottom - top]
