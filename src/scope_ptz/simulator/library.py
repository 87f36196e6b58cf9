"""A cache of scenes and their variations that limits how many viewpoints stay in memory."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from threading import RLock

from scope_ptz.simulator.pack import Scene, find_scenes, load_scene, variation_of
from scope_ptz.simulator.recent import RecentViewpoints

OPEN_VIEWPOINTS = 2
"""Number of viewpoints whose layers stay in memory. Each takes several hundred megabytes once views have been rendered."""


class Library:
    """Scenes by name, such as ``highway-works``, or ``highway-works-v7`` for a variation.

    Calling the library with a name returns the scene, or raises ``UnknownNameError`` if it does not exist and ``PackError`` if its
    files are damaged. Variations share their scene's layers.

    Args:
        search: Additional scene folders, searched before the built-in ones.
        open_viewpoints: Number of viewpoints, across all scenes, whose layers stay in memory.
        tile_bytes: Memory limit for each viewpoint's tiles; see ``Scene``.
    """

    def __init__(self, search: Iterable[Path] = (), open_viewpoints: int = OPEN_VIEWPOINTS, tile_bytes: int | None = None) -> None:
        self._search, self._tile_bytes = tuple(search), tile_bytes
        self._recent = RecentViewpoints(open_viewpoints)
        self._scenes: dict[str, Scene] = {}
        self._lock = RLock()

    def __call__(self, name: str) -> Scene:
        with self._lock:
            if name not in self._scenes:
                self._scenes[name] = self._open(name)
            return self._scenes[name]

    def _open(self, name: str) -> Scene:
        scene, number = variation_of(name)
        if number is None or name in find_scenes(self._search):
            return load_scene(name, self._search, self._recent, self._tile_bytes)
        return self(scene).create_variation(number)
