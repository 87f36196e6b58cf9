"""``scope bench browse``: one task with all that it rests on, or a list of those that fit."""

from __future__ import annotations

import random
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_inputs import worlds_of
from scope_ptz.cli.endings import ending, put
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task

CATEGORIES = (
    "counting", "descriptor", "location", "ocr", "single_call", "multi_step_command", "multi_step_reasoning", "comparative",
)  # fmt: skip


def browse(
    task: Annotated[str, typer.Argument(help="Id of a task, or its end (counting-017).")] = "",
    tasks: Annotated[str, typer.Option("--tasks", help="Split or task file; by default the core, then the others.")] = "",
    category: Annotated[str, typer.Option(help="Only tasks of this category.")] = "",
    scene: Annotated[str, typer.Option("--scene", help="Only tasks of this scene.")] = "",
    at_random: Annotated[bool, typer.Option("--random", help="Show any one of those that fit.")] = False,
    seed: Annotated[int | None, typer.Option(help="With --random: which one.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for pictures of the start and of the evidence.")] = None,
) -> None:
    """Show a task: what is asked and expected, the run of its reference program, and the frames that it rests on.

    Without an id the tasks that fit are listed.
    """
    with ending():
        rows = _fitting(_tasks(tasks), category, scene)
        if task:
            chosen = _named(rows, task)
        elif at_random:
            chosen = random.Random(seed).choice(rows)
        else:
            for row in rows:
                put(f"{row.id:<52} {row.instruction}")
            return
        from scope_ptz.cli.bench_show import reference_run, summary, write_frames

        (world,) = worlds_of([chosen]).values()
        for line in (*summary(chosen, [r for r in _tasks(tasks) if r.paraphrase_of == chosen.id]), *reference_run(chosen, world)):
            put(line)
        if out is not None:
            for path in write_frames(chosen, world, out):
                put(f"picture    {path}")


def _tasks(name: str) -> tuple[Task, ...]:
    from scope_ptz.bench.tasks.splits import load_split

    return load_split(name) if name else (*load_split("all"), *load_split("unseen"))


def _fitting(tasks: tuple[Task, ...], category: str, scene: str) -> list[Task]:
    if category and category not in CATEGORIES:
        raise InputError(f"There is no category '{category}'. There are: {', '.join(CATEGORIES)}.")
    found = [row for row in tasks if category in ("", row.category) and scene in ("", row.scene, row.world)]
    if not found:
        raise InputError("No task fits. Leave out --category or --scene, or name other tasks with --tasks.")
    return found


def _named(tasks: list[Task], name: str) -> Task:
    exact = [row for row in tasks if row.id == name]
    found = exact or [row for row in tasks if row.id.endswith(f"-{name}")]
    if not found:
        raise InputError(f"There is no task '{name}'. List them with 'scope bench browse --category counting'.")
    if len(found) > 1:
        raise InputError(f"There is more than one task '{name}': {', '.join(row.id for row in found[:4])}. Give a whole id.")
    return found[0]
