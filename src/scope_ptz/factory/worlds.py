"""Open the scenes of tasks, with their variations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene


def scenes_named(names: list[str] | None) -> dict[str, Scene]:
    """Return scenes by name; all scenes if ``names`` is empty or None."""
    from scope_ptz.factory.scenes import open_scene, scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.pack import list_scenes

    return {name: open_scene(name) for name in dict.fromkeys(names or list_scenes(scene_search(load_settings())))}


def worlds_of(tasks: Iterable[Task]) -> dict[str, Scene]:
    """Return the worlds of tasks by name. A world is a scene or a variation of one.

    Variations of a scene share its pictures in memory.
    """
    needed = sorted({(task.scene, task.variation or 0) for task in tasks})
    scenes = scenes_named(sorted({scene for scene, _ in needed})) if needed else {}
    worlds = (scenes[name].varied(number) if number else scenes[name] for name, number in needed)
    return {world.name: world for world in worlds}
