"""Validation of tasks in the worlds in which they are set."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import anyio

from scope_ptz.factory.validation_perception import KnownViews, equip_with_truth
from scope_ptz.factory.worlds import worlds_of
from scope_ptz.taskgen.validation.validate import validate
from scope_ptz.taskgen.validation.validation_report import ValidationReport

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene
    from scope_ptz.taskgen.generating.drafting_loop import Prove


def prove(
    tasks: Sequence[Task], seed: int, say: Callable[[int, int], None] | None = None, beside: Sequence[Task] = ()
) -> ValidationReport:
    """Validate tasks with ground-truth perception.

    Args:
        tasks: Tasks to validate.
        seed: Seed for the wrong answers to try.
        say: Called with the number of validated tasks and the total.
        beside: The dataset that the tasks are selected from.
    """
    worlds, views = worlds_of(tasks), KnownViews()
    equip = equip_with_truth(worlds, views)
    return anyio.run(lambda: validate(tasks, worlds, equip, seed=seed, read_truth=views.look, progress=say, dataset=beside))


def task_prover(scene: Scene) -> Prove:
    """Return a function that proves single tasks in a scene, as ``scope bench validate`` does, and returns the first fault."""
    views = KnownViews()
    equip = equip_with_truth({scene.name: scene}, views)

    async def prove_task(task: Task) -> str | None:
        report = await validate([task], {task.world: scene}, equip, read_truth=views.look)
        faults = [*report.faults, *report.adversarial_passes, *report.disagreements]
        return f"{faults[0].attempt}: {faults[0].reason}" if faults else None

    return prove_task
