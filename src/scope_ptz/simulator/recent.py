"""Limit the number of viewpoints, across scenes, whose layers stay in memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import MutableMapping
from threading import Lock
from typing import Any

OpenViewpoints = MutableMapping[str, Any]
"""One scene's open viewpoints, by name."""


class RecentViewpoints:
    """A limit on the number of open viewpoints across scenes. Safe to share between threads.

    The least recently used viewpoints are released first. A released viewpoint stays alive while other objects refer to it. The
    next request reads it again.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._lock = Lock()
        self._used: OrderedDict[tuple[int, str], OpenViewpoints] = OrderedDict()

    def mark_used(self, opened: OpenViewpoints, name: str) -> None:
        """Record that the viewpoint ``name`` was requested, and release the least recently used viewpoints beyond the limit."""
        with self._lock:
            self._used[id(opened), name] = opened
            self._used.move_to_end((id(opened), name))
            while len(self._used) > self._limit:
                (_, oldest), where = self._used.popitem(last=False)
                where.pop(oldest, None)
