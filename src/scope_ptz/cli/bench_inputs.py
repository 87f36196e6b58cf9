"""What the commands of the benchmark work on: tasks by split or file, and the worlds that they are set in."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene

TasksOption = Annotated[
    str,
    typer.Option("--tasks", help="Split (core, lite, paraphrase, reaction, unseen, all) or task file (JSONL or YAML)."),
]
SceneNames = Annotated[list[str] | None, typer.Option("--scene", help="A scene to make tasks of; by default every one there is.")]


def scenes_named(names: list[str] | None) -> dict[str, Scene]:
    """Scenes by name; all there are when none is named."""
    from scope_ptz.factory.scenes import open_scene, scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.pack import list_scenes

    return {name: open_scene(name) for name in dict.fromkeys(names or list_scenes(scene_search(load_settings())))}


def worlds_of(tasks: Iterable[Task]) -> dict[str, Scene]:
    """The worlds of tasks by name. Variations of a scene share its pictures in memory."""
    wanted = sorted({(task.scene, task.variation or 0) for task in tasks})
    scenes = scenes_named(sorted({scene for scene, _ in wanted})) if wanted else {}
    worlds = (scenes[name].varied(number) if number else scenes[name] for name, number in wanted)
    return {world.name: world for world in worlds}
