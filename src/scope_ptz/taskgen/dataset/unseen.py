"""The unseen split: the same rules as for the core, on varied worlds of the same scenes."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.assembly import QUOTAS, Built, Say, build
from scope_ptz.taskgen.authoring.selection import Answered


def build_unseen(
    scenes: Sequence[Scene],
    numbers: Sequence[int],
    quotas: dict[Category, int] | None = None,
    say: Say | None = None,
    answered: Answered | None = None,
) -> Built:
    """Core tasks of variations ``numbers`` of every scene, shared out over them. What is missing is told in ``short``."""
    worlds = [(scene, number, scene.varied(number)) for scene in scenes for number in dict.fromkeys(numbers)]
    # A seed that no core dataset would be made with, so that wordings and targets are others too.
    seed = 1_000_000 + sum(number * 31**k for k, number in enumerate(numbers))
    made = build([world for _, _, world in worlds], seed, dict(quotas or QUOTAS), say, answered)
    origins = {world.name: (scene, number) for scene, number, world in worlds}
    tasks = [_of_scene(task, *origins[task.scene]) for task in made.tasks if task.stratum == "core"]
    return Built(tasks, made.short)


def _of_scene(task: Task, scene: Scene, number: int) -> Task:
    return Task.model_validate({**task.model_dump(), "scene": scene.name, "variation": number})
