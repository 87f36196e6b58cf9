"""Scenes that all environments of a process share."""

from __future__ import annotations

from pathlib import Path
from threading import RLock
from weakref import WeakKeyDictionary, WeakValueDictionary

from scope_ptz.errors import InputError
from scope_ptz.factory.scenes import open_scene, scene_search
from scope_ptz.settings import load_settings
from scope_ptz.simulator.pack import Scene, find_scenes, variation_of

_LOCK = RLock()
_OPEN: WeakValueDictionary[tuple[str, tuple[Path, ...]], Scene] = WeakValueDictionary()
"""The open scenes by name and search folders. Gymnasium creates each environment of a vector separately and passes it no common
object, so only the process can share them. A scene is closed when no environment uses it any more."""

_BASES: WeakKeyDictionary[Scene, Scene] = WeakKeyDictionary()
"""The scene of each open variation. It stays open with the variation, so that other variations share its layers."""


def shared_scene(name: str) -> Scene:
    """Return a scene, or a variation of one, that has ground truth. Environments that name the same scene share its layers.

    Raises:
        UnknownNameError: There is no such scene.
        InputError: The scene was captured from a camera, so it has no ground truth.
        PackError: The files of the scene are damaged.
    """
    search = scene_search(load_settings())
    with _LOCK:
        scene = _OPEN.get((name, search))
        if scene is None:
            base, number = variation_of(name)
            varied = number is not None and name not in find_scenes(search)
            if varied and number is not None:
                original = shared_scene(base)
                scene = original.varied(number)
                _BASES[scene] = original
            else:
                scene = open_scene(name, cache_pictures=True)
            if scene.file.captured is not None:
                raise InputError(
                    f"The scene '{name}' was captured from a camera and has no ground truth, so nothing can be rewarded in it. "
                    "Name a scene that was built with Blender."
                )
            _OPEN[name, search] = scene
        return scene
