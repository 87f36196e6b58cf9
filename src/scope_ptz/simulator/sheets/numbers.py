"""Sheets that store instance IDs in one byte per pixel instead of two."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import islice
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.simulator.sheets.atlas import STRIP_PX, Atlas, SheetCache
from scope_ptz.simulator.sheets.layout import BORDER_PX, Size, Slot

RARE = 255
"""The code shared by all IDs without a code of their own."""

BLOCK_HEIGHT_PX, BLOCK_WIDTH_PX = 32, 64
"""Size of a block of ``SparseIds``: 4096 bytes, at two bytes per pixel."""

_HAS_16_BIT_LUT = int(cv2.__version__.split(".")[0]) >= 5
"""Whether OpenCV's ``LUT`` accepts 16-bit numbers. It takes a third of the time of ``np.take``."""

Ids = NDArray[np.uint16]
Indices = NDArray[np.integer]


class IdCodes:
    """One-byte codes for a viewpoint's most common instance IDs.

    Args:
        common: Distinct IDs, the most common first. The first 254 from 1 to 65535 get codes from 1 to 254; 0 has the code 0.
    """

    def __init__(self, common: Iterable[int]) -> None:
        self._ids = np.zeros(256, np.uint16)
        self._codes = np.full(65536, RARE, np.uint8)
        self._codes[0] = 0
        valid = (number for number in common if 0 < number < len(self._codes))
        for code, number in enumerate(islice(valid, RARE - 1), start=1):
            self._ids[code], self._codes[number] = number, code

    def encode(self, ids: Ids) -> NDArray[np.uint8]:
        """Return the codes for IDs, ``RARE`` where an ID has no code."""
        if _HAS_16_BIT_LUT and ids.size:
            return np.asarray(cv2.LUT(ids, self._codes), np.uint8).reshape(ids.shape)
        return np.asarray(np.take(self._codes, ids))

    def decode(self, codes: NDArray[np.uint8]) -> Ids:
        """Return the IDs for codes, in an array of the same shape. Where the code is ``RARE``, the ID is undefined."""
        if not codes.size:
            return np.zeros(codes.shape, np.uint16)
        return np.asarray(cv2.LUT(codes, self._ids), np.uint16).reshape(codes.shape)


class SparseIds:
    """Instance IDs for a few pixels of a sheet. Memory is used only around these pixels.

    The pixels are stored in blocks that each fill one memory page. In row order, almost every page would contain one of them.

    Args:
        memory: An empty array of bytes, at least ``bytes_for(shape)`` long.
        shape: Height and width of the sheet.
    """

    def __init__(self, memory: NDArray[np.uint8], shape: tuple[int, int]) -> None:
        size = self.bytes_for(shape)
        self._blocks_per_row = -(-shape[1] // BLOCK_WIDTH_PX)
        self._ids: Ids = memory.reshape(-1)[:size].view(np.uint16)

    @staticmethod
    def bytes_for(shape: tuple[int, int]) -> int:
        """Return the number of bytes needed to store an ID for every pixel of a sheet."""
        return 2 * -(-shape[0] // BLOCK_HEIGHT_PX) * -(-shape[1] // BLOCK_WIDTH_PX) * BLOCK_HEIGHT_PX * BLOCK_WIDTH_PX

    def write(self, rows: Indices, columns: Indices, ids: Ids) -> None:
        """Store the IDs of pixels."""
        self._ids[self._places(rows, columns)] = ids

    def read(self, rows: Indices, columns: Indices) -> Ids:
        """Return the stored IDs of pixels."""
        return self._ids[self._places(rows, columns)]

    def _places(self, rows: Indices, columns: Indices) -> Indices:
        row, y = np.divmod(rows, BLOCK_HEIGHT_PX)
        column, x = np.divmod(columns, BLOCK_WIDTH_PX)
        return ((row * self._blocks_per_row + column) * BLOCK_HEIGHT_PX + y) * BLOCK_WIDTH_PX + x


class IdAtlas(Atlas):
    """An atlas of instance IDs. Its sheet contains codes; IDs without a code are stored separately.

    Args:
        sizes: As in ``Atlas``.
        load: As in ``Atlas``.
        codes: The codes for the viewpoint's instance IDs.
        decode: Converts rows of a loaded picture to IDs; by default, they are used unchanged.
        disk_cache: As in ``Atlas``.
    """

    def __init__(
        self,
        sizes: Sequence[Size],
        load: Callable[[Atlas, int], NDArray[Any]],
        codes: IdCodes,
        *,
        decode: Callable[[NDArray[Any]], Ids] | None = None,
        disk_cache: SheetCache | None = None,
    ) -> None:
        super().__init__(sizes, load, np.uint8, 1, decode=decode, disk_cache=disk_cache)
        self._codes = codes
        memory, height = self.sheet, self._size[1]
        self.sheet = memory[:height]
        self._rare = SparseIds(memory[height:], (height, memory.shape[1]))

    def _rows(self, width: int, height: int) -> int:
        # IDs without a code are stored in separate rows below the sheet.
        return height - (-SparseIds.bytes_for((height, width)) // width)

    def sample(self, positions: NDArray[Any]) -> Ids:
        """Return the (h, w) instance IDs in the pixels nearest to (h, w, 2) positions on the sheet."""
        codes = self.sample_codes(positions)
        ids = self._codes.decode(codes)
        rare = codes == RARE
        if rare.any():
            x, y = np.rint(positions[rare]).astype(np.int64).T  # rounded as in ``cv2.remap``
            ids[rare] = self._rare.read(y, x)
        return ids

    def sample_codes(self, positions: NDArray[Any]) -> NDArray[np.uint8]:
        """Return the (h, w) codes for the IDs that ``sample`` returns. Pixels with different codes have different IDs."""
        return np.asarray(cv2.remap(self.sheet, positions, None, cv2.INTER_NEAREST), np.uint8)

    def at(self, rows: Indices, columns: Indices) -> Ids:
        """Return the IDs at rows and columns of the sheet, which are broadcast together."""
        codes = self.sheet[rows, columns]
        ids = self._codes.decode(codes)
        rare = codes == RARE
        if rare.any():
            y, x = (np.broadcast_to(indices, codes.shape)[rare] for indices in (rows, columns))
            ids[rare] = self._rare.read(y, x)
        return ids

    def _fill(self, slot: Slot, picture: NDArray[Any], sharpening: float, index: int) -> None:  # noqa: ARG002 - IDs stay exact
        border = BORDER_PX
        for top in range(0, slot.height, STRIP_PX):
            strip = picture[top : top + STRIP_PX]
            ids = strip if self._decode is None else self._decode(strip)
            side_border = cv2.BORDER_WRAP if index == 0 else cv2.BORDER_REPLICATE
            ids = cv2.copyMakeBorder(ids, 0, 0, border, border, side_border)
            y = slot.y + top
            self._write(y, slot.x - border, ids)
            if top == 0:
                self._write(y - border, slot.x - border, np.repeat(ids[:1], border, axis=0))
            if top + len(ids) == slot.height:
                self._write(y + len(ids), slot.x - border, np.repeat(ids[-1:], border, axis=0))

    def _write(self, y: int, x: int, ids: Ids) -> None:
        """Write IDs to the part of the sheet that starts at row ``y`` and column ``x``."""
        codes = self._codes.encode(ids)
        self.sheet[y : y + codes.shape[0], x : x + codes.shape[1]] = codes
        if codes.max() == RARE:
            rows, columns = np.nonzero(codes == RARE)
            self._rare.write(rows + y, columns + x, ids[rows, columns])
