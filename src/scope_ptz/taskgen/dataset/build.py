"""Build the whole dataset: every split, its proof, and the gold runs of the error modes."""

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

REPORT_EVERY = 100
"""Number of validated tasks between two progress notes."""

Prove = Callable[[Sequence[Task], int, Callable[[int, int], None]], ValidationReport]
MakeGold = Callable[[Sequence[Task], int], list[GoldRun]]


def build_dataset(
    scenes: Mapping[str, Scene],
    out: Path,
    seed: int,
    numbers: Sequence[int],
    quotas: dict[Category, int] | None,
    *,
    prove: Prove,
    make_gold: MakeGold,
    answered: Callable[[TaskDraft], bool],
    report: Callable[[str], None],
    notify: Callable[[str], None],
) -> bool:
    """Write a dataset into a folder. The same scenes, seed and numbers give the same bytes.

    Args:
        scenes: Scenes to make tasks for, by name.
        out: Folder to write.
        seed: Seed for every random choice.
        numbers: Variations of the scenes for the unseen split.
        quotas: Number of tasks of each category; None for the published numbers.
        prove: Validates tasks.
        make_gold: Makes gold runs.
        answered: Whether ground-truth perception can answer what a draft asks.
        report: Called with each line of the result.
        notify: Called with notes about progress and shortfalls.

    Returns:
        True if every quota was met and every task was validated.
    """
    core = build(list(scenes.values()), seed, quotas, notify, answered)
    unseen = build_unseen(list(scenes.values()), numbers, quotas, lambda text: notify(f"unseen {text}"), answered)
    short = [shortfall(core), shortfall(unseen, " unseen")]
    for text in filter(None, short):
        notify(text)
    written = write_splits(core.tasks, unseen.tasks, out, seed=seed)
    report(f"{len(core.tasks)} tasks and {len(unseen.tasks)} unseen ones in {out}")

    proofs = {}
    for name, tasks in (("published", core.tasks), ("unseen", unseen.tasks)):
        proofs[name] = prove(tasks, seed, partial(_notify_proved, notify, name))
        report(f"{name}: {'sound' if proofs[name].sound else 'NOT SOUND: see scope bench validate'}")
    written.append(out / PROOF)
    written[-1].write_text(json.dumps({name: proof.as_dict() for name, proof in proofs.items()}, indent=1) + "\n", "utf-8")

    gold = make_gold([task for task in core.tasks if task.stratum == "core"], seed)
    written.append(out / GOLD)
    write_gold(gold, written[-1])
    for line in matrix_lines(gold):
        report(line)
    write_manifest(out, written, scenes.values(), seed=seed, unseen=list(numbers), **({} if quotas is None else {"quotas": quotas}))
    return not any(short) and all(proof.sound for proof in proofs.values())


def shortfall(built: BuiltTasks, of: str = "") -> str:
    """Return a message that names the unmet quotas; empty if all quotas are met."""
    missing = ", ".join(f"{number} of {name} are missing" for name, number in built.short.items())
    return f"too few{of}: {missing}" if missing else ""


def _notify_proved(notify: Callable[[str], None], name: str, done: int, total: int) -> None:
    if done % REPORT_EVERY == 0 or done == total:
        notify(f"{name}: proved {done} of {total}")
