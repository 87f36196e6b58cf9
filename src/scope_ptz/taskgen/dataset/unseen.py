"""The unseen split: core tasks in varied worlds of the same scenes."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.assembly import QUOTAS, BuiltTasks, Progress, build
from scope_ptz.taskgen.authoring.selection import CanAnswer


def build_unseen(
    scenes: Sequence[Scene],
    numbers: Sequence[int],
    quotas: dict[Category, int] | None = None,
    progress: Progress | None = None,
    can_answer: CanAnswer | None = None,
) -> BuiltTasks:
    """Build core tasks in variations of some scenes.

    Args:
        scenes: The scenes.
        numbers: Numbers of the variations. The tasks are spread over all variations of all scenes.
        quotas: Tasks per category. By default the published ones.
        progress: Receives a line of text after every step.
        can_answer: Whether perception can answer the reference program of a draft.

    Returns:
        The tasks, and how many are missing.
    """
    worlds = [(scene, number, scene.varied(number)) for scene in scenes for number in dict.fromkeys(numbers)]
    # No core dataset uses such a seed, so that wordings and targets differ from it as well.
    seed = 1_000_000 + sum(number * 31**k for k, number in enumerate(numbers))
    made = build([world for _, _, world in worlds], seed, dict(quotas or QUOTAS), progress, can_answer)
    origins = {world.name: (scene, number) for scene, number, world in worlds}
    tasks = [_of_scene(task, *origins[task.scene]) for task in made.tasks if task.stratum == "core"]
    return BuiltTasks(tasks, made.short)


def _of_scene(task: Task, scene: Scene, number: int) -> Task:
    return Task.model_validate({**task.model_dump(), "scene": scene.name, "variation": number})
