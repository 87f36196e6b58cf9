"""Scenes that are shared by all environments of a process."""

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
"""The open scenes, by name and search folders. They are shared through this module, because Gymnasium creates the environments of a
vector separately and passes them no common object. A scene is closed when no environment uses it."""

_ORIGINALS: WeakKeyDictionary[Scene, Scene] = WeakKeyDictionary()
"""The original scene of each open variation. It stays open with the variation, so that other variations can share its layers."""


def shared_scene(name: str) -> Scene:
    """Return a scene with ground truth, or a variation of one. Environments that use the same scene share its layers.

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
                scene = original.create_variation(number)
                _ORIGINALS[scene] = original
            else:
                scene = open_scene(name, cache_pictures=True)
            if scene.file.captured is not None:
                raise InputError(
                    f"The scene '{name}' was captured from a camera and has no ground truth, so it cannot give rewards. "
                    "Choose a scene that was built with Blender."
                )
            _OPEN[name, search] = scene
        return scene
