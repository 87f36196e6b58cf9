"""``scope bench sweep``: many pairs on the same tasks, one log a pair, resumable as a whole."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli import bench_run as options
from scope_ptz.cli import model_options as models
from scope_ptz.cli.endings import FAILED, complain, ending, put_json
from scope_ptz.errors import InputError, ScopeError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import Console
    from rich.table import Table

    from scope_ptz.bench.scoring.trials import Evaluation
    from scope_ptz.cli.bench_evaluate import RunOptions
    from scope_ptz.factory.models import ModelOptions

WIDE = 160
"""Characters of a window that has room for a column a category."""
PAIR_WIDTH = 36
"""Of the longest names of pairs."""


def sweep(
    pairs: Annotated[
        str | None, typer.Option("--pairs", help="Pairs PLANNER+EYES, or models that are both, joined by commas.")
    ] = None,
    paper: Annotated[bool, typer.Option("--paper", help="The paper's 19 pairs.")] = False,
    split: options.SplitOption = "core",
    category: options.CategoryOption = None,
    scene: options.SceneOption = None,
    limit: options.LimitOption = None,
    epochs: options.EpochsOption = 1,
    concurrency: options.ConcurrencyOption = None,
    latency: options.LatencyOption = False,
    seed: options.SeedOption = 1,
    max_steps: options.StepsOption = 60,
    time_budget: options.TimeOption = None,
    out: options.OutOption = options.LOGS,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object at the end.")] = False,
    planner_url: models.PlannerUrlOption = None,
    perception_url: models.PerceptionUrlOption = None,
    planner_key_file: models.PlannerKeyOption = None,
    perception_key_file: models.PerceptionKeyOption = None,
    planner_option: models.PlannerOptions = None,
    perception_option: models.PerceptionOptions = None,
    timeout: models.TimeoutOption = None,
) -> None:
    """Run pair after pair. Where servers listen stands in your models file, or is the same for all (--planner-url, --perception-url).

    The same command goes on where it stopped, skips what is done, and tries again what could not be reached.
    """
    with ending(as_json=as_json):
        from rich.console import Console

        from scope_ptz.cli.bench_evaluate import RunOptions, need_engine

        need_engine()
        names = named_pairs(pairs, paper=paper)
        shared = models.model_options(
            None, None, None, planner_url, perception_url, None, None, planner_key_file, perception_key_file, planner_option, perception_option,
            None, None, timeout,
        )  # fmt: skip
        each = RunOptions(
            wishes=shared, out=out, tasks=split, categories=tuple(category or ()), scenes=tuple(scene or ()), limit=limit,
            epochs=epochs, seed=seed, max_steps=max_steps, time_s=time_budget, concurrency=concurrency, latency=latency,
        )  # fmt: skip
        console = Console(highlight=False, stderr=as_json)
        done = _run_all(names, each, console)
        if as_json:
            put_json({name: options.result(made) if not isinstance(made, str) else {"error": made} for name, made in done.items()})
        else:
            for table in tables_of(done, console.width):
                console.print(table, "")
        if any(isinstance(made, str) or not complete(made) for made in done.values()):
            complain("not every pair is complete; the same command goes on with those that are not.")
            sys.exit(FAILED)


def named_pairs(text: str | None, *, paper: bool) -> list[str]:
    """The pairs to run, each once. Raises ``InputError`` for unknown ones, before anything is run."""
    from scope_ptz.factory.model_resolver import read_pair
    from scope_ptz.registry import load_registry
    from scope_ptz.settings import load_settings

    if (text is None) == (not paper):
        raise InputError("Say which pairs: --pairs a+b,c+d or --paper.")
    registry = load_registry(load_settings().models_file())
    if paper:
        return [pair.name for pair in registry.pairs.values() if pair.origin == "paper"]
    names = list(dict.fromkeys(name.strip() for name in (text or "").split(",") if name.strip()))
    if not names:
        raise InputError("--pairs names no pair.")
    for name in names:
        read_pair(registry, name)
    return names


def _run_all(names: list[str], each: RunOptions, console: Console) -> dict[str, Evaluation | str]:
    """Of each pair its evaluation, or why there is none."""
    import anyio

    from scope_ptz.cli.bench_evaluate import evaluate
    from scope_ptz.cli.bench_troubles import troubles

    done: dict[str, Evaluation | str] = {}
    for number, name in enumerate(names, 1):
        console.rule(f"{number} of {len(names)}: {name}")
        try:
            made = anyio.run(evaluate, replace(each, wishes=_wishes(each.wishes, name)), console).evaluation
            done[name] = made
            for line in troubles(made.trials, made.card):
                complain(f"{name}: {line}")
        except ScopeError as error:
            done[name] = str(error)
            complain(f"{name}: {error}")
    return done


def _wishes(shared: ModelOptions, name: str) -> ModelOptions:
    """A pair with what is said of all. A server's address is for a model; the built-in planner and eyes have none."""
    from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, GRAMMAR

    planner, _, eyes = name.partition("+")
    wishes = replace(shared, pair=name)
    if planner == GRAMMAR:
        wishes = replace(wishes, planner_url=None, planner_key_file=None, planner_options=())
    if eyes in BUILT_IN_PERCEPTION:
        wishes = replace(wishes, perception_url=None, perception_key_file=None, perception_options=())
    return wishes


def complete(evaluation: Evaluation) -> bool:
    """Whether every run is there and none was broken by infrastructure."""
    return evaluation.finished and not any(trial.headline == "infrastructure" for trial in evaluation.trials)


def tables_of(done: dict[str, Evaluation | str], width: int) -> Iterator[Table]:
    """Pairs of models best first, then what is no result of a model, then what servers did to runs, then what was not run;
    categories where ``width``, in characters, has room for them."""
    from scope_ptz.cli.bench_troubles import troubles

    made = [(name, e) for name, e in done.items() if not isinstance(e, str)]
    ranked, others = [row for row in made if row[1].card.ranked], [row for row in made if not row[1].card.ranked]
    if ranked:
        yield _pairs_table("Pairs of models, best first", ranked, width)
    if others:
        yield _pairs_table("Built-in planner or ground-truth eyes: a check of the benchmark, no result of a model", others, width)
    spoilt = [(name, line) for name, e in made for line in troubles(e.trials, e.card)]
    missing = [(name, why) for name, why in done.items() if isinstance(why, str)]
    for title, rows in (("What servers did to runs", spoilt), ("Not run", missing)):
        if rows:
            table = _table(title)
            table.add_column("why", overflow="fold")
            for row in rows:
                table.add_row(*row)
            yield table


def _pairs_table(title: str, rows: Sequence[tuple[str, Evaluation]], width: int) -> Table:
    from scope_ptz.cli.bench_live import CATEGORIES, accuracy, macro

    shown = CATEGORIES if width >= WIDE else ()
    table = _table(title)
    for column in ("macro", "micro", *(c.replace("_", " ") for c in shown), "runs", "broken"):
        table.add_column(column, justify="right", no_wrap=column in ("macro", "micro", "runs", "broken"))
    for name, evaluation in sorted(rows, key=lambda row: -(macro(row[1].trials) or 0.0)):
        trials = evaluation.trials
        shares = [macro(trials), accuracy(trials), *(accuracy([t for t in trials if t.task.category == c]) for c in shown)]
        broken = sum(t.headline == "infrastructure" for t in trials)
        cells = [f"{100 * share:.1f}" if share is not None else "-" for share in shares]
        table.add_row(name, *cells, f"{len(trials)} of {evaluation.wanted}", str(broken) if broken else "-")
    return table


def _table(title: str) -> Table:
    from rich.table import Table

    table = Table(title=title, title_justify="left", title_style="", box=None, pad_edge=False, header_style="bold")
    table.add_column("pair", overflow="fold", min_width=PAIR_WIDTH)
    return table
