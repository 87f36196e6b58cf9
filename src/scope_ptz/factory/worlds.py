"""Open the scenes of tasks, with their variations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene


def open_scenes(names: list[str] | None) -> dict[str, Scene]:
    """Return scenes with ground truth by name; all of them if ``names`` is empty or None.

    Raises:
        InputError: A named scene was captured from a camera, so it has no ground truth.
        UnknownNameError: There is no such scene.
        PackError: The files of a scene are damaged.
    """
    from scope_ptz.factory.scenes import open_scene, scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.pack import list_scenes

    scenes = {name: open_scene(name) for name in dict.fromkeys(names or list_scenes(scene_search(load_settings())))}
    captured = [name for name, scene in scenes.items() if scene.file.captured is not None]
    if names and captured:
        raise InputError(
            f"The scene '{captured[0]}' was captured from a camera and has no ground truth, so tasks cannot be made or scored "
            "in it. Name a scene that was built with Blender."
        )
    return {name: scene for name, scene in scenes.items() if name not in captured}


def worlds_of(tasks: Iterable[Task]) -> dict[str, Scene]:
    """Return the worlds of tasks by name. A world is a scene or a variation of one.

    Variations of a scene share its pictures in memory.
    """
    needed = sorted({(task.scene, task.variation or 0) for task in tasks})
    scenes = open_scenes(sorted({scene for scene, _ in needed})) if needed else {}
    worlds = (scenes[name].varied(number) if number else scenes[name] for name, number in needed)
    return {world.name: world for world in worlds}
