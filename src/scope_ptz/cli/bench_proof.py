"""Proof of tasks in the worlds that they are set in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import anyio

from scope_ptz.cli.bench_inputs import worlds_of
from scope_ptz.factory.validation_perception import KnownViews, equip_with_truth
from scope_ptz.taskgen.validation.validate import validate
from scope_ptz.taskgen.validation.validation_report import ValidationReport

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task


def prove(
    tasks: Sequence[Task], seed: int, say: Callable[[int, int], None] | None = None, beside: Sequence[Task] = ()
) -> ValidationReport:
    """The report of a validation. ``beside``: the dataset of which the tasks are a selection."""
    worlds, views = worlds_of(tasks), KnownViews()
    equip = equip_with_truth(worlds, views)
    return anyio.run(lambda: validate(tasks, worlds, equip, seed=seed, read_truth=views.look, progress=say, dataset=beside))
