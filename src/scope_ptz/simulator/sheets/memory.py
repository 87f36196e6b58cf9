"""Large arrays whose memory can be returned to the operating system in parts."""

from __future__ import annotations

import ctypes
import math
import mmap
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

CAN_RELEASE = hasattr(mmap, "MADV_DONTNEED") and hasattr(mmap, "MAP_PRIVATE") and hasattr(mmap, "MAP_ANONYMOUS")
"""Whether the operating system supports releasing parts of an array. If not, ``release_rows`` is never used."""


class ReleasableArray:
    """An array in separately mapped memory. Parts that are never written take no memory, and whole rows can be released.

    Attributes:
        array: The array, with the requested shape. Rows that were never written, or were released, are zero.
    """

    def __init__(self, shape: tuple[int, ...], dtype: type[np.generic]) -> None:
        self._row_bytes = math.prod(shape[1:]) * np.dtype(dtype).itemsize
        self._memory: mmap.mmap | None = None
        self.array: NDArray[Any]
        if CAN_RELEASE:
            self._memory = mmap.mmap(-1, max(1, shape[0] * self._row_bytes), flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
            self.array = np.frombuffer(self._memory, dtype, math.prod(shape)).reshape(shape)
        else:
            self.array = np.zeros(shape, dtype)

    def release_rows(self, first: int, last: int) -> None:
        """Release the memory of rows ``first`` to ``last - 1``. Memory pages shared with other rows are not released."""
        if self._memory is not None:
            start = -(-first * self._row_bytes // mmap.PAGESIZE) * mmap.PAGESIZE
            stop = last * self._row_bytes // mmap.PAGESIZE * mmap.PAGESIZE
            if stop > start:
                self._memory.madvise(mmap.MADV_DONTNEED, start, stop - start)


def release_free_memory() -> None:
    """Return freed memory to the operating system. Without this, glibc keeps it after large pictures are decoded."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:
        trim(0)
