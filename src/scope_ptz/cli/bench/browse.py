"""``scope bench browse``: list tasks, or show a task with its reference run and evidence."""

from __future__ import annotations

import random
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import check_category
from scope_ptz.cli.exit import put
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task

MAX_AMBIGUOUS_LISTED = 4


def browse(
    task: Annotated[str, typer.Argument(help="Id of a task, or the end of one (counting-017).")] = "",
    tasks: Annotated[str, typer.Option("--tasks", help="Split or task file (default: every split).")] = "",
    category: Annotated[str, typer.Option(help="Show only tasks in this category.")] = "",
    scene: Annotated[str, typer.Option("--scene", help="Show only tasks in this scene.")] = "",
    at_random: Annotated[bool, typer.Option("--random", help="Show one of the matching tasks at random.")] = False,
    seed: Annotated[int | None, typer.Option(help="Seed for --random.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for pictures of the start view and of the evidence.")] = None,
) -> None:
    """List tasks, or show one: instruction, expected answer, reference run, and the frames that contain its evidence."""
    matches = _matching_tasks(_load_tasks(tasks), check_category(category), scene)
    if task:
        chosen = _task_with_id(matches, task)
    elif at_random:
        chosen = random.Random(seed).choice(matches)
    else:
        for candidate in matches:
            put(f"{candidate.id:<52} {candidate.instruction}")
        return
    from scope_ptz.factory.validation_perception import ground_truth_tools
    from scope_ptz.factory.worlds import open_worlds
    from scope_ptz.taskgen.task_sheet import reference_run, summary, write_frames

    worlds = open_worlds([chosen])
    (world,) = worlds.values()
    for line in summary(chosen, [candidate for candidate in _load_tasks(tasks) if candidate.paraphrase_of == chosen.id]):
        put(line)
    for line in reference_run(chosen, world, ground_truth_tools(worlds)):
        put(line)
    if out is not None:
        for path in write_frames(chosen, world, out):
            put(f"picture    {path}")


def _load_tasks(name: str) -> tuple[Task, ...]:
    from scope_ptz.bench.tasks.splits import load_split

    return load_split(name) if name else (*load_split("all"), *load_split("unseen"))


def _matching_tasks(tasks: tuple[Task, ...], category: str, scene: str) -> list[Task]:
    matches = [task for task in tasks if category in ("", task.category) and scene in ("", task.scene, task.world)]
    if not matches:
        raise InputError("No task matches. Remove --category or --scene, or select other tasks with --tasks.")
    return matches


def _task_with_id(tasks: list[Task], task_id: str) -> Task:
    exact = [task for task in tasks if task.id == task_id]
    matches = exact or [task for task in tasks if task.id.endswith(f"-{task_id}")]
    if not matches:
        raise InputError(f"There is no task '{task_id}'. List them with 'scope bench browse --category counting'.")
    if len(matches) > 1:
        names = ", ".join(task.id for task in matches[:MAX_AMBIGUOUS_LISTED])
        raise InputError(f"Several tasks end with '{task_id}': {names}. Give a full id.")
    return matches[0]
