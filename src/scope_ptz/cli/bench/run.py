"""``scope bench run`` and ``sweep``: run or resume an evaluation of one pair, or of several pairs with one log per pair."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from scope_ptz.cli.bench.flags import (
    AgentFlags,
    EvaluationFlags,
    JudgeRepeatsOption,
    SelectionFlags,
    SingleEvaluationFlags,
    agent_options,
    evaluation_options,
    judge_settings,
    parse_price,
)
from scope_ptz.cli.exit import FAILED, print_error, put, put_json, run_async
from scope_ptz.cli.options import JsonOption, JudgeFlags, ModelFlags, PairFlags
from scope_ptz.errors import InputError, ScopeError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from rich.console import Console
    from rich.table import Table

    from scope_ptz.bench.scoring.trials import Evaluation
    from scope_ptz.factory.evaluation_options import EvaluationOptions, EvaluationResult
    from scope_ptz.factory.models import ModelOptions

PAIR_COLUMN_WIDTH = 36
"""Width, in characters, of the pair-name column. Longer names widen it, and narrow terminals make it narrower."""
UNLIMITED_WIDTH = 10_000  # terminal width, in characters, for measuring a table that is not wrapped


def run(
    selection: SelectionFlags,
    evaluation: SingleEvaluationFlags,
    agent: AgentFlags,
    models: PairFlags,
    judge: JudgeFlags,
    judge_repeats: JudgeRepeatsOption = 1,
    as_json: JsonOption = False,
) -> int:
    """Run a planner with a perception backend, or an external agent, on the benchmark, and print the scores.

    Without options, the built-in planner and ground-truth perception run the published core tasks.
    This needs neither a server nor a key.

    Running the same command again resumes an interrupted evaluation.

    The exit code is 1 if runs are missing or failed because of infrastructure.
    """
    from rich.console import Console

    from scope_ptz.bench.engine.run_totals import evaluation_summary
    from scope_ptz.factory.evaluation_display import summary

    judge_options = judge_settings(judge, judge_repeats)
    options = replace(
        evaluation_options(selection, evaluation, models.options()),
        agent=agent.agent,
        agent_options=agent_options(agent),
        pictures=evaluation.pictures,
        variant=evaluation.variant,
        fresh=evaluation.fresh,
        resume=evaluation.resume,
        price=parse_price(evaluation.price),
        judge=judge_options if judge_options.requested else None,
    )
    console = Console(highlight=False, stderr=as_json)

    result = _evaluate(options, console, evaluation.progress)
    if as_json:
        judgements = {"judge": result.judge, "judgements": asdict(result.judgements)} if result.judgements is not None else {}
        put_json(evaluation_summary(result.evaluation) | judgements)
    else:
        console.print(summary(result.evaluation))
        if result.judgements is not None:
            put(f"judge      {result.judge}: {result.judgements.summary}")
        put(f"log        {result.evaluation.log}")
    return _report_failures(result)


def _evaluate(options: EvaluationOptions, console: Console, progress_folder: Path | None) -> EvaluationResult:
    """Run the evaluation, show its progress in the terminal and, if there is a ``progress_folder``, write progress files to it."""
    from contextlib import closing

    from scope_ptz.factory.evaluate import evaluate, require_engine
    from scope_ptz.factory.evaluation_display import LiveProgress

    require_engine()
    results: list[EvaluationResult] = []
    if progress_folder is None:

        async def work() -> None:
            results.append(await evaluate(options, progress=LiveProgress(console, print_error)))

        run_async(work)
        return results[0]
    from scope_ptz.factory.progress_files import ProgressFiles, ProgressGroup

    with closing(ProgressFiles(progress_folder)) as progress:

        async def work_with_files() -> None:
            results.append(await evaluate(options, progress=ProgressGroup(LiveProgress(console, print_error), progress)))

        run_async(work_with_files)
        progress.finish(results[0])
    return results[0]


def _report_failures(result: EvaluationResult) -> int:
    """Print the failures and how to repeat the failed runs, and return the exit code."""
    from scope_ptz.bench.engine.failure_summary import failure_summary
    from scope_ptz.cli.bench.judge import judge_failure_text

    evaluation, judgements = result.evaluation, result.judgements
    broken = sum(trial.headline == "infrastructure" for trial in evaluation.trials)
    missing = max(evaluation.wanted - len(evaluation.trials), 0)
    for line in failure_summary(evaluation.trials, evaluation.card):
        print_error(line)
    if broken or missing:
        parts = []
        if broken:
            parts.append(f"{broken} {'run' if broken == 1 else 'runs'} failed because of infrastructure")
        if missing:
            parts.append(f"{missing} {'run is' if missing == 1 else 'runs are'} missing")
        print_error(f"{' and '.join(parts)}; running the same command again repeats {'it' if broken + missing == 1 else 'them'}.")
    judging_failed = judgements is not None and judgements.failed
    if judgements is not None and judging_failed:
        print_error(
            f"{judge_failure_text(judgements)} No run is lost. Run the same command again to retry, or "
            f"`scope bench rescore {evaluation.log} --judge-url ...`."
        )
    return FAILED if broken or missing or judging_failed else 0


@dataclass(frozen=True, kw_only=True)
class SweepServerFlags(ModelFlags):
    """Options for model servers that apply to all pairs.

    The options of ``ModelFlags`` that name models are removed, because the pairs name the models.
    """

    planner: ClassVar[None] = None  # type: ignore[misc]
    perception: ClassVar[None] = None  # type: ignore[misc]
    planner_model: ClassVar[None] = None  # type: ignore[misc]
    perception_model: ClassVar[None] = None  # type: ignore[misc]
    reader: ClassVar[None] = None  # type: ignore[misc]
    detector: ClassVar[None] = None  # type: ignore[misc]


def sweep(
    selection: SelectionFlags,
    evaluation: EvaluationFlags,
    servers: SweepServerFlags,
    pairs: Annotated[
        str | None,
        typer.Option("--pairs", help="Pairs to run, separated by commas: PLANNER+PERCEPTION, or one model that does both."),
    ] = None,
    paper: Annotated[bool, typer.Option("--paper", help="Run the 19 pairs of the paper.")] = False,
    as_json: JsonOption = False,
) -> int:
    """Run several pairs on the same tasks, one after the other, and compare their scores.

    Your models file states where each model is served; --planner-url and --perception-url apply to all pairs.

    Running the same command again resumes the sweep: it skips complete pairs and retries pairs whose servers could not be reached.
    """
    from rich.console import Console

    from scope_ptz.bench.engine.run_totals import evaluation_summary
    from scope_ptz.factory.evaluate import require_engine

    require_engine()
    names = pair_names(pairs, paper=paper)
    shared_options = evaluation_options(selection, evaluation, servers.options())
    console = Console(highlight=False, stderr=as_json)
    results = _run_all(names, shared_options, console)
    if as_json:
        put_json(
            {name: {"error": result} if isinstance(result, str) else evaluation_summary(result) for name, result in results.items()}
        )
    else:
        for table in sweep_tables(results, console):
            console.print(table, "")
    if any(isinstance(result, str) or not is_complete(result) for result in results.values()):
        print_error("some pairs are incomplete; running the same command again resumes them.")
        return FAILED
    return 0


def pair_names(text: str | None, *, paper: bool) -> list[str]:
    """Return the names of the pairs to run, without duplicates. Raises ``InputError`` if a pair is unknown."""
    from scope_ptz.factory.model_resolver import read_pair
    from scope_ptz.registry import load_registry
    from scope_ptz.settings import load_settings

    if (text is None) == (not paper):
        raise InputError("Give the pairs to run, either with --pairs A+B,C+D or with --paper.")
    registry = load_registry(load_settings().models_file())
    if paper:
        return [pair.name for pair in registry.pairs.values() if pair.origin == "paper"]
    names = list(dict.fromkeys(name.strip() for name in (text or "").split(",") if name.strip()))
    if not names:
        raise InputError("--pairs is empty. Give pairs such as A+B,C+D.")
    for name in names:
        read_pair(registry, name)
    return names


def _run_all(names: list[str], shared_options: EvaluationOptions, console: Console) -> dict[str, Evaluation | str]:
    """Run all pairs. Return, for each pair, its evaluation or, if it failed, the error message."""
    import anyio

    from scope_ptz.bench.engine.failure_summary import failure_summary
    from scope_ptz.factory.evaluate import evaluate
    from scope_ptz.factory.evaluation_display import LiveProgress

    async def work(options: EvaluationOptions) -> EvaluationResult:
        return await evaluate(options, progress=LiveProgress(console, print_error))

    results: dict[str, Evaluation | str] = {}
    for number, name in enumerate(names, 1):
        console.rule(f"{number} of {len(names)}: {name}")
        try:
            evaluation = anyio.run(work, replace(shared_options, models=_models_of_pair(shared_options.models, name))).evaluation
            results[name] = evaluation
            for line in failure_summary(evaluation.trials, evaluation.card):
                print_error(f"{name}: {line}")
        except ScopeError as error:
            results[name] = str(error)
            print_error(f"{name}: {error}")
    return results


def _models_of_pair(shared_options: ModelOptions, name: str) -> ModelOptions:
    """Return the model options for one pair. For the built-in planner and perception, addresses and keys are removed."""
    from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, GRAMMAR

    planner, _, perception = name.partition("+")
    options = replace(shared_options, pair=name)
    if planner == GRAMMAR:
        options = replace(options, planner_url=None, planner_key_file=None, planner_options=())
    if perception in BUILT_IN_PERCEPTION:
        options = replace(options, perception_url=None, perception_key_file=None, perception_options=())
    return options


def is_complete(evaluation: Evaluation) -> bool:
    """Return whether all runs have ended without an infrastructure failure."""
    return evaluation.finished and not any(trial.headline == "infrastructure" for trial in evaluation.trials)


def sweep_tables(results: dict[str, Evaluation | str], console: Console) -> Iterator[Table]:
    """Yield tables for model pairs, built-in baselines, server failures, and pairs that did not run.

    If the terminal is wide enough, there is a column per category.
    """
    from rich.cells import cell_len
    from rich.text import Text

    from scope_ptz.bench.engine.failure_summary import failure_summary

    pair_width = min(max([PAIR_COLUMN_WIDTH, *map(cell_len, results)]), console.width // 2)
    evaluations = [(name, e) for name, e in results.items() if not isinstance(e, str)]
    ranked, others = [row for row in evaluations if row[1].card.ranked], [row for row in evaluations if not row[1].card.ranked]
    if ranked:
        yield _fitting_pairs_table("Pairs of models, best first", ranked, pair_width, console)
    if others:
        title = "Rule-based planner or ground-truth perception: baselines, not model results"
        yield _fitting_pairs_table(title, others, pair_width, console)
    failures = [(name, line) for name, e in evaluations for line in failure_summary(e.trials, e.card)]
    not_run = [(name, message) for name, message in results.items() if isinstance(message, str)]
    for title, rows in (("Server failures", failures), ("Not run", not_run)):
        if rows:
            table = _table(title, pair_width)
            table.add_column("reason", overflow="fold")
            for name, reason in rows:
                table.add_row(name, Text(reason))  # plain text, because "scope-ptz[local]" is not markup
            yield table


def _fitting_pairs_table(title: str, rows: Sequence[tuple[str, Evaluation]], pair_width: int, console: Console) -> Table:
    """Return the most detailed table that fits in the terminal.

    The category columns have headers of one line, or else of two lines, or else they are omitted. If the table is still too wide,
    its pair names are wrapped.
    """
    from scope_ptz.bench.engine.run_totals import CATEGORIES

    one_line = {category: category.replace("_", " ") for category in CATEGORIES}
    two_lines = {category: "\n".join(header.rsplit(" ", 1)) for category, header in one_line.items()}
    unlimited = console.options.update_width(UNLIMITED_WIDTH)
    for category_headers in (one_line, two_lines, {}):
        table = _pairs_table(title, rows, category_headers, pair_width)
        excess = console.measure(table, options=unlimited).maximum - console.width
        if excess <= 0:
            return table
    return _pairs_table(title, rows, {}, max(1, pair_width - excess))


def _pairs_table(title: str, rows: Sequence[tuple[str, Evaluation]], category_headers: Mapping[str, str], pair_width: int) -> Table:
    from scope_ptz.bench.engine.run_totals import accuracy, macro_accuracy

    table = _table(title, pair_width)
    for column in ("macro", "micro", *category_headers.values(), "runs", "failed"):
        table.add_column(column, justify="right", no_wrap=True)
    for name, evaluation in sorted(rows, key=lambda row: -(macro_accuracy(row[1].trials) or 0.0)):
        trials = evaluation.trials
        fractions = [macro_accuracy(trials), accuracy(trials)]
        fractions += [accuracy([t for t in trials if t.task.category == category]) for category in category_headers]
        failed = sum(t.headline == "infrastructure" for t in trials)
        cells = [f"{100 * fraction:.1f}" if fraction is not None else "-" for fraction in fractions]
        table.add_row(name, *cells, f"{len(trials)} of {evaluation.wanted}", str(failed) if failed else "-")
    return table


def _table(title: str, pair_width: int) -> Table:
    from rich.table import Table

    table = Table(title=title, title_justify="left", title_style="", box=None, pad_edge=False, header_style="bold")
    table.add_column("pair", overflow="fold", width=pair_width)
    return table
