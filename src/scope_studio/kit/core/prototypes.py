"""A cache of built objects, so that repeated objects share their mesh data."""

from __future__ import annotations

from collections.abc import Callable

from scope_studio.kit.core.stage import Built


class Prototypes:
    """A cache that builds each kind of object once and returns linked copies afterwards."""

    def __init__(self) -> None:
        self._built: dict[str, Built] = {}

    def get(self, key: str, make: Callable[[], Built]) -> Built:
        """Return the object for ``key``: built by ``make`` on the first call, a linked copy on later calls."""
        if key in self._built:
            return self._built[key].copy()
        self._built[key] = make()
        return self._built[key]
