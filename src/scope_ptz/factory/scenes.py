"""Open scenes by name, from the configured folder or from the built-in scenes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import ConfigError
from scope_ptz.settings import ScopeSettings, load_settings
from scope_ptz.version import __version__

if TYPE_CHECKING:
    from PIL import Image

    from scope_ptz.simulator.pack import Scene


def scene_search(settings: ScopeSettings) -> tuple[Path, ...]:
    """Return the folders to search for scenes before the built-in ones.

    Raises:
        ConfigError: SCOPE_SCENES_DIR is not a folder.
    """
    if settings.scenes_dir is None:
        return ()
    if not settings.scenes_dir.is_dir():
        raise ConfigError(f"SCOPE_SCENES_DIR is {settings.scenes_dir}, which is not a folder. Correct or unset the variable.")
    return (settings.scenes_dir,)


def open_scene(name: str, *, cache_pictures: bool = False) -> Scene:
    """Open a scene by name.

    Args:
        name: Name of the scene or variation.
        cache_pictures: Whether to cache decoded pictures on disk, so that later processes render their first view sooner.

    Raises:
        UnknownNameError: There is no such scene.
        PackError: The scene's files are damaged.
    """
    from scope_ptz.simulator.pack import load_scene
    from scope_ptz.simulator.sheets.picture_cache import PictureCache
    from scope_ptz.simulator.views import RENDERING_VERSION

    settings = load_settings()
    cache = PictureCache(settings.pictures_folder(), f"{__version__} {RENDERING_VERSION}") if cache_pictures else None
    return load_scene(name, scene_search(settings), tile_bytes=settings.tile_bytes(), picture_cache=cache)


async def draw_presets(scene: Scene) -> Image.Image:
    """Draw a contact sheet with a scene's views at all presets."""
    from PIL import Image

    from scope_ptz.agent.contact_sheet import contact_sheet
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.simulator.clock import SceneClock

    camera = SimulatedCamera(scene, clock=SceneClock(scene.file.start_s))
    pictures = []
    for preset in scene.file.presets:
        await camera.go_to_preset(preset.name)
        pictures.append((f"{preset.name} · {preset.viewpoint}", Image.fromarray((await camera.frame()).image)))
    return contact_sheet(scene.file.title, pictures)
