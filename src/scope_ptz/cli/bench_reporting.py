"""``scope bench report``, and the file for a public leaderboard: ``scope bench submission make`` and ``validate``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.endings import FAILED, complain, ending, put, put_json
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.bench.reports.submission import Header, TrialLine
    from scope_ptz.bench.reports.task_pages import StoredRun
    from scope_ptz.bench.scoring.trials import Evaluation, Trial
    from scope_ptz.bench.tasks.task import Task

submission_app = typer.Typer(help="The file for a public leaderboard.", no_args_is_help=True)
MOST_TOLD = 50
FIRST_TOLD = 3
"""Of many faults of one kind, on one line."""
RESULT = ".json"
"""Of a person: the evaluation itself, not a log."""


def report(
    logs: Annotated[list[Path], typer.Argument(help="Logs of 'scope bench run', and results of 'scope bench human' (.json).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder to write; an older report in it is replaced.")],
    tasks: Annotated[
        str | None,
        typer.Option("--tasks", help="Split or task file, for the evidence on the pages of failed tasks (default: all published)."),
    ] = None,
    pages: Annotated[bool, typer.Option("--pages/--no-pages", help="A page with frames for each failed task.")] = True,
) -> None:
    """Write a page, Markdown and CSV tables of logs: everything that the paper shows, for any set of runs."""
    with ending():
        _need_extra()
        from scope_ptz.bench.reports.writer import write_report
        from scope_ptz.registry import load_registry
        from scope_ptz.settings import load_settings

        evaluations = [_read(path) for path in _each_once(logs)]
        where = {id(evaluation): path for evaluation, path in zip(evaluations, _each_once(logs), strict=True)}

        def open_trial(evaluation: Evaluation, trial: Trial) -> StoredRun:
            from scope_ptz.bench.engine.logs import open_sample
            from scope_ptz.bench.human_runs import open_run

            path = where[id(evaluation)]
            return open_run(path, trial.sample) if path.suffix == RESULT else open_sample(path, trial.sample)

        made = write_report(
            evaluations,
            load_registry(load_settings().models_file()),
            out,
            open_sample=open_trial,
            tasks={task.id: task for task in _tasks(tasks)} if pages else {},
            progress=_progress if sys.stderr.isatty() else None,
            pages=pages,
        )
        for line in (*made.summary, *made.warnings):
            put(line)
        put(f"{out / 'index.html'}")


@submission_app.command("make")
def submission_make(
    log: Annotated[Path, typer.Argument(help="The log of a finished run.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write (JSON lines).")],
    tasks: Annotated[
        str | None, typer.Option("--tasks", help="Split or task file that it has to cover (default: the split that was run).")
    ] = None,
    partial: Annotated[
        bool, typer.Option("--partial", help="Write it although it does not cover the split: `validate` will refuse it.")
    ] = False,
) -> None:
    """Write a log's run card and the verdict, answer, calls and times of every task for a public leaderboard.

    A log that does not cover its split is refused.
    """
    with ending():
        _need_extra()
        from scope_ptz.bench.reports.submission import submission_lines, write_submission

        evaluation = _read(log)
        header, lines = submission_lines(evaluation)
        lacking = [] if partial and tasks is None and not _is_published(header.card.split) else _lacking(header, lines, tasks)
        if lacking and not partial:
            raise InputError(
                f"{log} does not cover {tasks or header.card.split}: {_some(lacking)}. A submission is of a whole split: run the "
                "rest, without --limit, --category and --scene, or write what there is with --partial."
            )
        write_submission((header, lines), out)
        put(f"{out}: {len(evaluation.trials)} trials of {evaluation.card.pair}")
        if lacking:
            complain(f"{out} is partial and no valid submission: {_some(lacking)}.")


@submission_app.command("validate")
def submission_validate(
    file: Annotated[Path, typer.Argument(help="The submission.")],
    tasks: Annotated[
        str | None, typer.Option("--tasks", help="Split or task file to hold it against (default: the split that it names).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The findings as JSON.")] = False,
) -> None:
    """Check a submission: complete, consistent, in range, of a known dataset. Exit code 1 when anything is wrong."""
    with ending(as_json=as_json):
        from scope_ptz.bench.reports.submission_checks import check_submission

        found = check_submission(file, _expected(tasks))
        if as_json:
            put_json(found.as_dict(), indent=1)
        else:
            for fault in found.faults[:MOST_TOLD]:
                complain(fault)
            if len(found.faults) > MOST_TOLD:
                complain(f"and {len(found.faults) - MOST_TOLD} more")
            put(found.summary)
        if found.faults:
            sys.exit(FAILED)


def _lacking(header: Header, lines: Sequence[TrialLine], tasks: str | None) -> list[str]:
    from scope_ptz.bench.reports.submission_checks import coverage

    return coverage(header, lines, _expected(tasks))


def _is_published(split: str) -> bool:
    from scope_ptz.bench.tasks.splits import SPLITS

    return split in SPLITS


def _some(faults: Sequence[str]) -> str:
    more = len(faults) - FIRST_TOLD
    return "; ".join(faults[:FIRST_TOLD]) + (f"; and {more} more such faults" if more > 0 else "")


def _need_extra() -> None:
    from scope_ptz.perception.backends.spec import need

    need("bench", "inspect_ai", "jinja2", "matplotlib", "scipy")


def _each_once(logs: Sequence[Path]) -> list[Path]:
    return list(dict.fromkeys(path.resolve() for path in logs))


def _read(path: Path) -> Evaluation:
    """A log with people's labels. Raises ``TraceError`` or ``InputError``."""
    from scope_ptz.bench.judging.human_labels import labels_file, read_labels, with_labels

    if path.suffix == RESULT:
        from scope_ptz.bench.human_runs import read_result

        return read_result(path)
    from scope_ptz.bench.engine.logs import read_evaluation

    return with_labels(read_evaluation(path), read_labels(labels_file(path)))


def _tasks(wanted: str | None) -> Sequence[Task]:
    """The tasks named; by default whatever is published, which may be nothing."""
    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.errors import InputError

    if wanted is not None:
        return load_split(wanted)
    found: list[Task] = []
    for split in ("core", "paraphrase", "reaction", "unseen"):
        try:
            found += load_split(split)
        except InputError:
            continue
    return found


def _expected(wanted: str | None) -> Sequence[Task] | None:
    from scope_ptz.bench.tasks.splits import load_split

    return None if wanted is None else load_split(wanted)


def _progress(done: int, of: int) -> None:
    sys.stderr.write(f"\rpages of failed tasks: {done} of {of}" + ("\n" if done == of else ""))
    sys.stderr.flush()
