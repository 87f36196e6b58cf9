"""Scene packs by name, from the configured folder and from the package."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.settings import ScopeSettings, load_settings

if TYPE_CHECKING:
    from scope_ptz.simulator.pack import Scene


def scene_search(settings: ScopeSettings) -> tuple[Path, ...]:
    """Return the folders that are searched for scenes before the built-in ones."""
    return (settings.scenes_dir,) if settings.scenes_dir else ()


def open_scene(name: str) -> Scene:
    """Open a scene by name.

    Raises:
        UnknownNameError: There is no such scene.
        PackError: Its files are damaged.
    """
    from scope_ptz.simulator.pack import load_scene

    return load_scene(name, scene_search(load_settings()))
