"""Read evaluation logs with a progress bar, and print contradictions between logs and traces."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.cli.exit import print_error

if TYPE_CHECKING:
    from scope_ptz.bench.scoring.trials import Evaluation

MIN_SAMPLES_SHOWN = 40
"""Minimum number of samples for which a progress bar is shown."""


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
