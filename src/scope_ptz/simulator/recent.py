"""A limit on the number of viewpoints whose layers stay in memory across scenes."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import MutableMapping
from threading import Lock
from typing import Any

Opened = MutableMapping[str, Any]
"""The open viewpoints of one scene, by name."""


class RecentViewpoints:
    """A least-recently-used limit over the open viewpoints of several scenes. Safe to share between threads.

    A released viewpoint stays alive while something still refers to it. The next request reads it again.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._lock = Lock()
        self._used: OrderedDict[tuple[int, str], Opened] = OrderedDict()

    def used(self, opened: Opened, name: str) -> None:
        """Record that viewpoint ``name`` was requested, and release the least recently used ones beyond the limit."""
        with self._lock:
            self._used[id(opened), name] = opened
            self._used.move_to_end((id(opened), name))
            while len(self._used) > self._limit:
                (_, oldest), where = self._used.popitem(last=False)
                where.pop(oldest, None)
