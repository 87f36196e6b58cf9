"""A cache for the static world in repeated views. While a camera stands still, only moving actors have to be rendered."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection

MAX_PICTURES = 2  # number of cached pictures; one camera with two streams may need two sizes

MAX_REQUESTS = 4  # number of recent views with which a new request is compared, to detect repeated views

Picture = NDArray[np.uint8]


class StillViews:
    """Caches the static world in views that are requested repeatedly. Safe to share between threads.

    The first request for a view only records the view, so a moving camera uses no memory here.
    """

    def __init__(self) -> None:
        self._requests: deque[Projection] = deque(maxlen=MAX_REQUESTS)
        self._pictures: OrderedDict[Projection, Picture] = OrderedDict()
        self._lock = Lock()

    def get(self, projection: Projection, render: Callable[[], Picture]) -> Picture:
        """Return the static world in a view as a new (H, W, 3) array.

        Args:
            projection: The view.
            render: Renders the picture. Called if the picture is not cached.
        """
        picture = self._find(projection)
        if picture is None:
            picture = render()
            if not self._record(projection, picture):
                return picture
        return picture.copy()

    def is_cached(self, projection: Projection) -> bool:
        """Return whether a view's picture is cached."""
        return self._find(projection) is not None

    def _find(self, projection: Projection) -> Picture | None:
        with self._lock:
            if projection in self._pictures:
                self._pictures.move_to_end(projection)
            return self._pictures.get(projection)

    def _record(self, projection: Projection, picture: Picture) -> bool:
        """Record a request. If the view was requested before, cache the picture and return True."""
        with self._lock:
            repeated = projection in self._requests
            if not repeated:
                self._requests.append(projection)
                return False
            self._pictures[projection] = picture
            while len(self._pictures) > MAX_PICTURES:
                self._pictures.popitem(last=False)
            return True
