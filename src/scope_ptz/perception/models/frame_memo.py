"""A cache for results that are computed from images. A result is deleted together with its image."""

from __future__ import annotations

import threading
import weakref
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, Generic, TypeVar

import numpy as np
from anyio import to_thread
from numpy.typing import NDArray

Image = NDArray[np.uint8]
K = TypeVar("K", bound=Hashable)
T = TypeVar("T")


class FrameMemo(Generic[K, T]):
    """A cache for the results of ``make(image, key)``, for at most ``size`` pairs of image and key.

    Images are compared by identity. They are read-only, so a result stays valid until its image is deleted. Callers that request
    the same result at the same time, in any thread, share one computation.
    """

    def __init__(self, make: Callable[[Image, K], T], size: int = 8) -> None:
        self._make, self._size = make, size
        self._lock = threading.Lock()
        self._entries: OrderedDict[tuple[int, K], _Entry[T]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._entries)

    def get(self, image: Image, key: K) -> T:
        """Return the result. If it is not cached, compute it in this thread."""
        entry = self._entry(image, key)
        with entry.lock:
            if not entry.result:
                entry.result = (self._make(image, key),)
            return entry.result[0]

    async def get_async(self, image: Image, key: K) -> T:
        """Return the result. If it is not cached, compute it in a worker thread."""
        entry = self._entries.get((id(image), key))
        if entry is not None and entry.image() is image and entry.result:
            return entry.result[0]
        return await to_thread.run_sync(self.get, image, key)

    def _entry(self, image: Image, key: K) -> _Entry[T]:
        slot = (id(image), key)
        with self._lock:
            entry = self._entries.get(slot)
            if entry is None or entry.image() is not image:
                entry = self._entries[slot] = _Entry(weakref.ref(image, lambda reference: self._remove_entry(slot, reference)))
            self._entries.move_to_end(slot)
            while len(self._entries) > self._size:
                self._entries.popitem(last=False)
            return entry

    def _remove_entry(self, slot: tuple[int, K], reference: weakref.ref[Any]) -> None:
        # The lock is not acquired: this runs when the last reference is deleted, possibly in a thread that holds the lock.
        entry = self._entries.get(slot)
        if entry is not None and entry.image is reference:
            self._entries.pop(slot, None)


class _Entry(Generic[T]):
    def __init__(self, image: weakref.ref[Any]) -> None:
        self.image = image
        self.result: tuple[()] | tuple[T] = ()
        self.lock = threading.Lock()
