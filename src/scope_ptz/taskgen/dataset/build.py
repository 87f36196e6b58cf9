"""Build the whole dataset: every split with its validation report, and the gold runs for the error modes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from scope_ptz.bench.tasks.splits import write_manifest, write_splits
from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.assembly import BuiltTasks, build
from scope_ptz.taskgen.authoring.drafts import TaskDraft
from scope_ptz.taskgen.dataset.card import GOLD, PROOF
from scope_ptz.taskgen.dataset.unseen import build_unseen
from scope_ptz.taskgen.gold.gold_runs import write_gold
from scope_ptz.taskgen.gold.mutations import GoldRun
from scope_ptz.taskgen.gold.reference_runs import matrix_lines
from scope_ptz.taskgen.validation.validation_report import ValidationReport

PROGRESS_INTERVAL = 100
"""Number of tasks to validate between progress notes."""

ValidateTasks = Callable[[Sequence[Task], int, Callable[[int, int], None]], ValidationReport]
"""A function that validates tasks, given a seed, and reports progress to a callback."""
MakeGold = Callable[[Sequence[Task], int], list[GoldRun]]
"""A function that creates gold runs from tasks, given a seed."""


def build_dataset(
    scenes: Mapping[str, Scene],
    out: Path,
    seed: int,
    numbers: Sequence[int],
    quotas: dict[Category, int] | None,
    *,
    validate: ValidateTasks,
    make_gold: MakeGold,
    can_answer: Callable[[TaskDraft], bool],
    report: Callable[[str], None],
    notify: Callable[[str], None],
) -> bool:
    """Write a dataset to a folder. The same scenes, seed and variations always give identical files.

    Args:
        scenes: Scenes for the tasks, by name.
        out: The dataset folder.
        seed: Seed for every random choice.
        numbers: Numbers of the scene variations for the unseen split.
        quotas: Number of tasks in each category; None for the published numbers.
        validate: Validates the tasks of one split.
        make_gold: Creates gold runs from the core tasks.
        can_answer: Returns whether ground-truth perception can answer the questions of a draft.
        report: Called with each line that states a result.
        notify: Called with notes about progress and missing tasks.

    Returns:
        True if every quota was met and every split passed validation.
    """
    core = build(list(scenes.values()), seed, quotas, notify, can_answer)
    unseen = build_unseen(list(scenes.values()), numbers, quotas, lambda text: notify(f"unseen {text}"), can_answer, seed)
    messages = [missing_tasks_message(core), missing_tasks_message(unseen, " unseen")]
    for text in filter(None, messages):
        notify(text)
    written = write_splits(core.tasks, unseen.tasks, out, seed=seed)
    report(f"Wrote {len(core.tasks)} tasks and {len(unseen.tasks)} unseen tasks to {out}")

    reports = {}
    for name, tasks in (("published", core.tasks), ("unseen", unseen.tasks)):
        reports[name] = validate(tasks, seed, partial(_notify_progress, notify, name))
        report(f"{name}: {'sound' if reports[name].sound else 'NOT SOUND: run `scope bench validate` for details'}")
    written.append(out / PROOF)
    written[-1].write_text(json.dumps({name: result.as_dict() for name, result in reports.items()}, indent=1) + "\n", "utf-8")

    gold = make_gold([task for task in core.tasks if task.stratum == "core"], seed)
    written.append(out / GOLD)
    write_gold(gold, written[-1])
    for line in matrix_lines(gold):
        report(line)
    write_manifest(out, written, scenes.values(), seed=seed, unseen=list(numbers), **({} if quotas is None else {"quotas": quotas}))
    return not any(messages) and all(result.sound for result in reports.values())


def missing_tasks_message(built: BuiltTasks, split: str = "") -> str:
    """Return a message about unmet quotas; empty if all quotas are met. ``split`` qualifies the tasks, such as " unseen"."""
    missing = ", ".join(f"{number} of {name} are missing" for name, number in built.missing.items())
    return f"too few{split} tasks: {missing}" if missing else ""


def _notify_progress(notify: Callable[[str], None], name: str, done: int, total: int) -> None:
    if done % PROGRESS_INTERVAL == 0 or done == total:
        notify(f"{name}: validated {done} of {total}")
