"""Open the scenes and scene variations in which tasks take place."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene


def open_scenes(names: list[str] | None) -> dict[str, Scene]:
    """Open scenes with ground truth, and return them by name. If ``names`` is empty or None, open all such scenes.

    Raises:
        InputError: A named scene was captured from a camera, so it has no ground truth.
        UnknownNameError: There is no such scene.
        PackError: A scene's files are damaged.
    """
    from scope_ptz.factory.scenes import open_scene, scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.pack import list_scenes

    scenes = {name: open_scene(name) for name in dict.fromkeys(names or list_scenes(scene_search(load_settings())))}
    captured = [name for name, scene in scenes.items() if scene.file.captured is not None]
    if names and captured:
        raise InputError(
            f"The scene '{captured[0]}' was captured from a camera and has no ground truth, so tasks cannot be created or scored "
            "in it. Choose a scene that was built with Blender."
        )
    return {name: scene for name, scene in scenes.items() if name not in captured}


def open_worlds(tasks: Iterable[Task]) -> dict[str, Scene]:
    """Open the tasks' worlds, and return them by name. A world is a scene or a scene variation.

    Variations share their scene's pictures in memory.
    """
    variations = sorted({(task.scene, task.variation or 0) for task in tasks})
    scenes = open_scenes(sorted({scene for scene, _ in variations})) if variations else {}
    worlds = (scenes[name].create_variation(number) if number else scenes[name] for name, number in variations)
    return {world.name: world for world in worlds}
