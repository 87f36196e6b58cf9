"""Commands that build and check a dataset: ``build``, ``card``, ``validate``, ``schema``, and ``gold`` for gold runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import GoldOption, ScenesOption, TasksOption
from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption
from scope_ptz.cli.typer_extensions import command
from scope_ptz.errors import InputError, OutputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.bench.tasks.task import Category, Task
    from scope_ptz.taskgen.gold.mutations import GoldRun

gold_app = typer.Typer(help="Make and check gold runs: runs with one known fault each.", no_args_is_help=True)
UNSEEN_VARIATIONS = (7, 8, 9)
"""Numbers of the scene variations that the published unseen split uses."""


def build(
    out: Annotated[Path, typer.Option("--out", help="File for the tasks (JSONL); with --all, a folder.")],
    more_seeds: Annotated[list[int] | None, typer.Argument(hidden=True, metavar="")] = None,
    scene: ScenesOption = None,
    seed: Annotated[
        int, typer.Option(help="Seed for every random choice; a different seed gives a different dataset of the same scenes.")
    ] = 1,
    share: Annotated[float, typer.Option(min=0.02, max=1.0, help="Fraction of the published number of tasks to make.")] = 1.0,
    seeds: Annotated[
        list[int] | None,
        typer.Option("--seeds", min=1, help="Numbers of scene variations to use instead of the scenes, for example 7 8 9."),
    ] = None,
    whole_dataset: Annotated[
        bool, typer.Option("--all", help="Make the whole dataset: every split, its validation and the gold runs.")
    ] = False,
    card: Annotated[Path | None, typer.Option("--card", help="With --all: file for the dataset card (Markdown).")] = None,
) -> int:
    """Make tasks from the ground truth of scenes. The exit code is 1 if the scenes do not yield enough tasks."""
    from scope_ptz.bench.tasks.files import dump_tasks
    from scope_ptz.factory.validation_perception import is_answerable
    from scope_ptz.factory.worlds import open_scenes
    from scope_ptz.taskgen.authoring.assembly import build as build_tasks
    from scope_ptz.taskgen.dataset.build import missing_tasks_message
    from scope_ptz.taskgen.dataset.unseen import build_unseen

    variations = variation_numbers(seeds, more_seeds)
    quotas = _quotas(share)
    if card is not None and not whole_dataset:
        raise InputError("A card describes a whole dataset. Use --card together with --all, or run 'scope bench card'.")
    if whole_dataset:
        return _build_all(scene, out, card, seed, variations or UNSEEN_VARIATIONS, quotas)
    scenes = list(open_scenes(scene).values())
    if variations:
        built = build_unseen(scenes, variations, quotas, print_error, is_answerable, seed)
    else:
        built = build_tasks(scenes, seed, quotas, print_error, is_answerable)
    out.parent.mkdir(parents=True, exist_ok=True)
    dump_tasks(built.tasks, out)
    put(f"{len(built.tasks)} tasks in {out}")
    if missing := missing_tasks_message(built):
        print_error(missing)
        return FAILED
    return 0


def _build_all(
    scene: list[str] | None, out: Path, card: Path | None, seed: int, variations: Sequence[int], quotas: dict[Category, int] | None
) -> int:
    from scope_ptz.factory.task_validation import validate_tasks
    from scope_ptz.factory.validation_perception import is_answerable
    from scope_ptz.factory.worlds import open_scenes
    from scope_ptz.taskgen.dataset.build import build_dataset

    is_valid = build_dataset(
        open_scenes(scene), out, seed, variations, quotas, validate=validate_tasks, make_gold=_gold_runs, can_answer=is_answerable,
        report=put, notify=print_error,
    )  # fmt: skip
    if card is not None:
        write_card(out, card)
    return 0 if is_valid else FAILED


def variation_numbers(seeds: list[int] | None, more_seeds: list[int] | None) -> tuple[int, ...]:
    """Return the numbers given after ``--seeds``. The option need not be repeated for each number. Raises ``InputError``."""
    if more_seeds and not seeds:
        raise InputError(f"Unexpected argument '{more_seeds[0]}'. Give the numbers of scene variations after --seeds.")
    numbers = (*(seeds or ()), *(more_seeds or ()))
    if any(not 1 <= number < 10**9 for number in numbers):
        raise InputError("The numbers of scene variations must be whole numbers from 1 to 999999999.")
    return tuple(dict.fromkeys(numbers))


def _quotas(share: float) -> dict[Category, int] | None:
    from scope_ptz.taskgen.authoring.assembly import QUOTAS

    return None if share == 1.0 else {name: max(2, round(number * share)) for name, number in QUOTAS.items()}


def card(
    data: Annotated[Path | None, typer.Option("--data", help="Dataset folder (default: the published dataset).")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="File to write (Markdown; default: print it).")] = None,
) -> None:
    """Write the card of a dataset from its files."""
    from scope_ptz.bench.tasks.splits import published_folder
    from scope_ptz.taskgen.dataset.card import Dataset
    from scope_ptz.taskgen.dataset.card import render_card as card_text

    folder = data or published_folder()
    if out is not None:
        write_card(folder, out)
        put(f"Wrote the card of {folder} to {out}")
    else:
        put(card_text(Dataset.read(folder)).rstrip())


def write_card(folder: Path, out: Path) -> None:
    """Write the dataset card for a dataset folder."""
    from scope_ptz.taskgen.dataset.card import Dataset
    from scope_ptz.taskgen.dataset.card import render_card as card_text

    text = card_text(Dataset.read(folder))
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text, "utf-8")
    except OSError as error:
        raise OutputError(f"The card {out} cannot be written: {error.strerror}.") from error


def validate(
    tasks: TasksOption = "all",
    as_json: JsonOption = False,
    seed: Annotated[int, typer.Option(help="Seed for choosing the wrong answers.")] = 1,
) -> int:
    """Validate tasks: correct programs and answers must pass, and adversarial ones must fail. The exit code is 1 on any failure."""
    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.factory.task_validation import validate_tasks
    from scope_ptz.taskgen.validation.report_text import report_lines

    report = validate_tasks(load_split(tasks), seed, dataset=load_split("core") if tasks in ("lite", "paraphrase") else ())
    if as_json:
        put_json({**report.as_dict(), "adaptive": report.adaptive_as_dict()})
    else:
        for line in report_lines(report):
            put(line)
    return 0 if report.sound else FAILED


def schema() -> None:
    """Print the JSON schema of a task."""
    from scope_ptz.bench.tasks.task import schema as task_schema

    put_json(task_schema(), indent=2)


@gold_app.command("make")
@command
def gold_make(
    out: Annotated[Path, typer.Option("--out", help="File for the runs (gzipped JSONL).")],
    tasks: TasksOption = "core",
    seed: Annotated[int, typer.Option(help="Seed for the choice of runs and faults.")] = 1,
    as_json: JsonOption = False,
) -> None:
    """Run the reference programs of tasks, and insert one known fault into some of the runs."""
    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.taskgen.gold.gold_runs import confusion_matrix, write_gold
    from scope_ptz.taskgen.gold.reference_runs import matrix_lines

    gold = _gold_runs(load_split(tasks), seed)
    out.parent.mkdir(parents=True, exist_ok=True)
    write_gold(gold, out)
    if as_json:
        put_json(confusion_matrix(gold).as_dict())
        return
    for line in (*matrix_lines(gold), f"{len(gold)} runs in {out}"):
        put(line)


@gold_app.command("check")
@command
def gold_check(
    gold: GoldOption = None,
    tasks: TasksOption = "core",
    as_json: JsonOption = False,
) -> int:
    """Apply the error-mode rules to gold runs, and compare the result with the published one.

    The exit code is 1 if the rules name fewer faults, or accept more faulty runs, than the published result.
    """
    from scope_ptz.bench.tasks.splits import load_split, published_folder
    from scope_ptz.taskgen.gold.gold_runs import confusion_matrix, read_gold
    from scope_ptz.taskgen.gold.reference_runs import matrix_lines

    published, runs = read_gold(gold or published_folder() / "gold.jsonl.gz", load_split(tasks))
    result = confusion_matrix(runs)
    is_worse = result.is_worse_than(published)
    if as_json:
        put_json({**result.as_dict(), "published": published, "worse": is_worse})
    else:
        for line in matrix_lines(runs):
            put(line)
        verdict = "WORSE" if is_worse else "not worse"
        put(f"published: {published['named']} named, {published['accepted']} accepted; this result is {verdict}")
    return FAILED if is_worse else 0


def _gold_runs(tasks: Sequence[Task], seed: int) -> list[GoldRun]:
    import anyio

    from scope_ptz.factory.validation_perception import TruthCache, ground_truth_tools
    from scope_ptz.factory.worlds import open_worlds
    from scope_ptz.taskgen.gold.reference_runs import make_gold_runs

    worlds = open_worlds(tasks)
    return anyio.run(make_gold_runs, tasks, worlds, ground_truth_tools(worlds, TruthCache()), seed)
