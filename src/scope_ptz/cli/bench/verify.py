"""``scope bench verify``: repeat the calls of logged runs, and compare the results with the traces.

The functions that read logs are shared with other benchmark commands.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption

if TYPE_CHECKING:
    from scope_ptz.bench.engine.traces.verification import RunToVerify
    from scope_ptz.bench.engine.traces.verification_results import VerificationResult
    from scope_ptz.bench.scoring.trials import Evaluation

MAX_RUNS_LISTED = 50
MIN_SAMPLES_SHOWN = 40
"""Minimum number of samples for which a progress bar is shown."""


def verify(
    logs: Annotated[list[Path], typer.Argument(help="Logs of evaluations.")],
    limit: Annotated[int | None, typer.Option("--limit", min=1, help="Verify at most N runs of each log.")] = None,
    as_json: JsonOption = False,
) -> int:
    """Verify logs: repeat the calls of each run in the simulator, without models.

    Poses, ground-truth replies and results must be exactly as recorded, and frames must match within a tolerance. The exit code is
    1 if a run differs. Runs made with a different version of the simulator are reported as not verifiable.
    """
    from scope_ptz.factory.evaluate import require_engine

    require_engine()
    from scope_ptz.bench.engine.traces.log_runs import read_runs

    results: dict[str, VerificationResult] = {}
    for log in logs:
        evaluation = read_log(log)
        print_findings(evaluation)
        runs = islice(read_runs(log), limit)
        total = min(len(evaluation.trials), limit or len(evaluation.trials))
        results[str(log)] = verify_and_show(runs, total, log.name, quiet=as_json)
    if as_json:
        put_json({log: result.as_dict() for log, result in results.items()}, indent=1)
    return FAILED if any(result.of("differs") for result in results.values()) else 0


def verify_and_show(runs: Iterable[RunToVerify], total: int, name: str, *, quiet: bool) -> VerificationResult:
    """Verify runs with a progress bar, and print the result.

    Args:
        runs: The runs.
        total: Number of runs.
        name: File name to show in the output.
        quiet: Whether to print nothing, for callers that print JSON.
    """
    import anyio

    from scope_ptz.bench.engine.traces.verification import verify_runs
    from scope_ptz.factory.verification import verification_context

    context = verification_context()

    with progress_bar(f"Verifying {name}") as progress:

        async def work() -> VerificationResult:
            return await verify_runs(iter(runs), context, lambda done: progress(done, total))

        result = anyio.run(work)
    if not quiet:
        differing = result.of("differs")
        for run in differing[:MAX_RUNS_LISTED]:
            print_error(f"{run.run}: {'; '.join(run.differences)}")
        if len(differing) > MAX_RUNS_LISTED:
            print_error(f"and {len(differing) - MAX_RUNS_LISTED} more runs differ")
        for line in result.summary:
            put(f"{name}: {line}")
    return result


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """Yield a function that shows the number of finished items and the total number. Without a terminal, nothing is shown."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(title, total=None, visible=False)

        def show(done: int, total: int) -> None:
            progress.update(task, completed=done, total=total, visible=total >= MIN_SAMPLES_SHOWN)

        yield show


def read_log(path: Path) -> Evaluation:
    """Read a log, and recompute its verdicts from the traces. For a large log, a progress bar is shown.

    Raises:
        TraceError: The log does not exist or is damaged.
    """
    from scope_ptz.bench.engine.logs import read_evaluation

    with progress_bar(f"Scoring {path.name}") as progress:
        return read_evaluation(path, progress)


def print_findings(evaluation: Evaluation) -> None:
    """Print the contradictions between a log and its traces to stderr."""
    from scope_ptz.bench.reports.log_findings import finding_lines

    for line in finding_lines(evaluation):
        print_error(line)
