"""Build the unseen split, which contains core tasks in variations of the scenes."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256

from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.assembly import QUOTAS, BuiltTasks, Progress, build
from scope_ptz.taskgen.authoring.selection import CanAnswer

PUBLISHED_SEED = 1
"""Seed of the published unseen split."""


def build_unseen(
    scenes: Sequence[Scene],
    numbers: Sequence[int],
    quotas: dict[Category, int] | None = None,
    progress: Progress | None = None,
    can_answer: CanAnswer | None = None,
    seed: int = PUBLISHED_SEED,
) -> BuiltTasks:
    """Build core tasks in variations of scenes.

    Args:
        scenes: The scenes.
        numbers: Numbers of the variations. The tasks are distributed over all variations of all scenes.
        quotas: Number of tasks per category; None for the published numbers.
        progress: Called with a line of text after every step.
        can_answer: Returns whether perception can answer the questions of a draft.
        seed: Seed for every random choice. The variations depend only on their numbers.

    Returns:
        The tasks, and how many are missing per category.
    """
    variations = [(scene, number, scene.create_variation(number)) for scene in scenes for number in dict.fromkeys(numbers)]
    # This seed is larger than the seeds of core datasets, so the wordings and objects of the unseen tasks differ from theirs.
    split_seed = 1_000_000 + sum(number * 31**k for k, number in enumerate(numbers))
    if seed != PUBLISHED_SEED:
        split_seed = int.from_bytes(sha256(f"{split_seed}:{seed}".encode()).digest()[:8], "big")
    built = build([variation for _, _, variation in variations], split_seed, dict(quotas or QUOTAS), progress, can_answer)
    origins = {variation.name: (scene, number) for scene, number, variation in variations}
    tasks = [_set_variation(task, *origins[task.scene]) for task in built.tasks if task.stratum == "core"]
    return BuiltTasks(tasks, built.missing)


def _set_variation(task: Task, scene: Scene, number: int) -> Task:
    """Return a task with the name of the original scene and the number of its variation."""
    return Task.model_validate({**task.model_dump(), "scene": scene.name, "variation": number})
