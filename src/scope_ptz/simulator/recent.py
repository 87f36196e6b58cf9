"""Which viewpoints have their layers in memory when many scenes are in use, and which are let go of."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import MutableMapping
from threading import Lock
from typing import Any

Opened = MutableMapping[str, Any]
"""What one scene has open, by name."""


class Recent:
    """The most recently used of what several scenes have open. Safe to share between threads.

    Whoever still holds a viewpoint that is let go of keeps it until done; who asks for it again has it read again.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._lock = Lock()
        self._used: OrderedDict[tuple[int, str], Opened] = OrderedDict()

    def used(self, opened: Opened, name: str) -> None:
        """Note that ``name`` of a scene was asked for; drop the least recently used beyond the limit."""
        with self._lock:
            self._used[id(opened), name] = opened
            self._used.move_to_end((id(opened), name))
            while len(self._used) > self._limit:
                (_, oldest), where = self._used.popitem(last=False)
                where.pop(oldest, None)
