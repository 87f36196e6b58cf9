"""Validate tasks in their scenes with ground-truth perception."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import anyio

from scope_ptz.factory.validation_perception import TruthCache, ground_truth_tools
from scope_ptz.factory.worlds import open_worlds
from scope_ptz.taskgen.validation.validate import validate
from scope_ptz.taskgen.validation.validation_report import ValidationReport

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene
    from scope_ptz.taskgen.generating.drafting_loop import ValidateTask


def validate_tasks(
    tasks: Sequence[Task], seed: int, progress: Callable[[int, int], None] | None = None, dataset: Sequence[Task] = ()
) -> ValidationReport:
    """Run each task's reference program and adversarial programs.

    The report lists every run that passed or failed unexpectedly.

    Args:
        tasks: The tasks to validate.
        seed: Seed for choosing wrong answers.
        progress: Called with the number of validated tasks and the total number of tasks.
        dataset: The whole dataset, if ``tasks`` is a subset of it.
    """
    worlds, truth = open_worlds(tasks), TruthCache()
    make_context = ground_truth_tools(worlds, truth)
    return anyio.run(
        lambda: validate(tasks, worlds, make_context, seed=seed, read_truth=truth.read, progress=progress, dataset=dataset)
    )


def task_validator(scene: Scene) -> ValidateTask:
    """Return a function that validates a task in a scene and returns its first fault, or None if there is none.

    The checks are those of ``scope bench validate``.
    """
    truth = TruthCache()
    make_context = ground_truth_tools({scene.name: scene}, truth)

    async def validate_task(task: Task) -> str | None:
        report = await validate([task], {task.world: scene}, make_context, read_truth=truth.read)
        faults = [*report.faults, *report.adversarial_passes, *report.disagreements]
        return f"{faults[0].attempt}: {faults[0].reason}" if faults else None

    return validate_task
