"""Many scenes at once: each opened once, its variations beside it, and only so much of them in memory."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from threading import RLock

from scope_ptz.simulator.pack import Scene, find_scenes, load_scene, variation_of
from scope_ptz.simulator.recent import Recent

OPEN_VIEWPOINTS = 2
"""So many have their layers in memory: some hundred megabytes each once their pictures are drawn."""


class Library:
    """Scenes by name, ``highway-works`` or ``highway-works-v7``. Variations share the layers of their scene.

    ``open_viewpoints``: of how many viewpoints, over all scenes, the layers stay in memory. Calling it raises ``UnknownNameError``
    when there is no such scene, and ``PackError`` when its files are damaged.
    """

    def __init__(self, search: Iterable[Path] = (), open_viewpoints: int = OPEN_VIEWPOINTS) -> None:
        self._search = tuple(search)
        self._recent = Recent(open_viewpoints)
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
            return load_scene(name, self._search, self._recent)
        return self(scene).varied(number)
