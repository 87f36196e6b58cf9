"""``scope bench build``: tasks of scenes as they are, of varied worlds, or the whole dataset with all that goes with it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_inputs import SceneNames, scenes_named
from scope_ptz.cli.endings import FAILED, complain, ending, put
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Category
    from scope_ptz.taskgen.authoring.assembly import BuiltTasks

UNSEEN_NUMBERS = (7, 8, 9)


def build(
    out: Annotated[Path, typer.Option("--out", help="Where the tasks go: a JSONL file, with --all a folder.")],
    further: Annotated[list[int] | None, typer.Argument(hidden=True, metavar="")] = None,
    scene: SceneNames = None,
    seed: Annotated[int, typer.Option(help="Another seed makes another dataset of the same scenes.")] = 1,
    share: Annotated[float, typer.Option(min=0.02, max=1.0, help="Share of the published numbers to make.")] = 1.0,
    seeds: Annotated[list[int] | None, typer.Option("--seeds", min=1, help="Tasks of varied worlds: 7 8 9.")] = None,
    whole: Annotated[bool, typer.Option("--all", help="The whole dataset: every split, its proof and the gold runs.")] = False,
    card: Annotated[Path | None, typer.Option("--card", help="With --all: where the dataset card goes (Markdown).")] = None,
) -> None:
    """Make tasks from the ground truth of scenes. Exit code 1 when the scenes do not yield the numbers wanted."""
    with ending():
        numbers = _numbers(seeds, further)
        quotas = _quotas(share)
        if card is not None and not whole:
            raise InputError("A card is made of a whole dataset: give --all with --card, or use 'scope bench card'.")
        if whole:
            from scope_ptz.cli.bench_card import write_card
            from scope_ptz.cli.bench_dataset import build_dataset

            good = build_dataset(scenes_named(scene), out, seed, numbers or UNSEEN_NUMBERS, quotas)
            if card is not None:
                write_card(out, card)
            sys.exit(0 if good else FAILED)
        from scope_ptz.bench.tasks.files import dump_tasks
        from scope_ptz.factory.validation_perception import answered
        from scope_ptz.taskgen.authoring.assembly import build as make
        from scope_ptz.taskgen.dataset.unseen import build_unseen

        scenes = list(scenes_named(scene).values())
        made = (
            build_unseen(scenes, numbers, quotas, complain, answered) if numbers else make(scenes, seed, quotas, complain, answered)
        )
        out.parent.mkdir(parents=True, exist_ok=True)
        dump_tasks(made.tasks, out)
        put(f"{len(made.tasks)} tasks in {out}")
        if tell_short(made):
            sys.exit(FAILED)


def _numbers(seeds: list[int] | None, further: list[int] | None) -> tuple[int, ...]:
    """The numbers after ``--seeds``, which may follow it one after the other."""
    if further and not seeds:
        raise InputError(f"'{further[0]}' belongs to no option. Numbers of varied worlds follow --seeds.")
    numbers = (*(seeds or ()), *(further or ()))
    if any(not 1 <= number < 10**9 for number in numbers):
        raise InputError("Numbers of varied worlds are whole and from 1 to 999999999.")
    return tuple(dict.fromkeys(numbers))


def _quotas(share: float) -> dict[Category, int] | None:
    from scope_ptz.taskgen.authoring.assembly import QUOTAS

    return None if share == 1.0 else {name: max(2, round(number * share)) for name, number in QUOTAS.items()}


def tell_short(made: BuiltTasks, of: str = "") -> bool:
    """Say what the scenes did not yield; whether anything."""
    if made.short:
        missing = ", ".join(f"{number} of {name} are missing" for name, number in made.short.items())
        complain(f"too few{of}: {missing}")
    return bool(made.short)
