"""Commands that report, compare and publish results: ``report``, ``gate``, ``submission`` and ``leaderboard``."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import SPLITS, HostKeysOption, published_tasks
from scope_ptz.cli.bench.verify import print_findings, read_log, verify_and_show
from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption
from scope_ptz.cli.typer_extensions import command
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.bench.leaderboard.entries import TaskSet
    from scope_ptz.bench.reports.task_pages import OpenedRun
    from scope_ptz.bench.scoring.trials import Evaluation, Trial
    from scope_ptz.bench.submissions.submission import Header, TrialLine
    from scope_ptz.bench.tasks.task import Task

submission_app = typer.Typer(help="Write and check the file for a public leaderboard.", no_args_is_help=True)
MAX_FAULTS_LISTED = 50
MAX_FAULTS_ON_ONE_LINE = 3
HUMAN_RESULT_SUFFIX = ".json"
"""Suffix of the results of ``scope bench human``, which are JSON files rather than logs."""


def report(
    logs: Annotated[list[Path], typer.Argument(help="Logs of 'scope bench run', and results of 'scope bench human' (.json).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder to write. An older report in it is replaced.")],
    tasks: Annotated[
        str | None,
        typer.Option(
            "--tasks",
            help="Split or task file with the tasks of the logs, for evidence and chance levels (default: all published tasks).",
        ),
    ] = None,
    pages: Annotated[bool, typer.Option("--pages/--no-pages", help="Write a page with frames for each failed task.")] = True,
) -> None:
    """Write a report on one or more logs: a web page, Markdown, and CSV tables.

    It contains all tables and figures of the paper, for any set of runs.
    """
    require_report_packages()
    from scope_ptz.bench.reports.terminal import terminal_lines
    from scope_ptz.bench.reports.writer import write_report
    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.registry import load_registry
    from scope_ptz.settings import load_settings

    paths = list(dict.fromkeys(path.resolve() for path in logs))
    evaluations = [_read(path) for path in paths]
    path_of = {id(evaluation): path for evaluation, path in zip(evaluations, paths, strict=True)}

    def open_trial(evaluation: Evaluation, trial: Trial) -> OpenedRun:
        from scope_ptz.bench.engine.sample_files import open_sample
        from scope_ptz.bench.human_runs import open_run

        path = path_of[id(evaluation)]
        return open_run(path, trial.sample) if path.suffix == HUMAN_RESULT_SUFFIX else open_sample(path, trial.sample)

    known: Sequence[Task] = load_split(tasks) if tasks is not None else published_tasks()
    result = write_report(
        evaluations,
        load_registry(load_settings().models_file()),
        out,
        open_sample=open_trial,
        tasks={task.id: task for task in known},
        progress=_print_progress if sys.stderr.isatty() else None,
        pages=pages,
    )
    for line in terminal_lines(result):
        put(line)
    put(f"{out / 'index.html'}")


def gate(
    log: Annotated[Path, typer.Argument(help="Log to check.")],
    baseline: Annotated[Path, typer.Option("--baseline", help="Log to compare with.")],
    alpha: Annotated[
        float, typer.Option(min=1e-6, max=0.5, help="Significance level: a loss with a smaller p value is significant.")
    ] = 0.05,
    as_json: JsonOption = False,
) -> int:
    """Compare two logs task by task, for continuous integration.

    The exit code is 1 on a significant loss, overall or in a category, and 2 if the logs are not comparable.
    """
    from scope_ptz.factory.evaluate import require_engine

    require_engine()
    from scope_ptz.bench.engine.regression.gate import compare_evaluations
    from scope_ptz.bench.engine.regression.text import comparison_lines, judge_change_note

    current, reference = read_log(log), read_log(baseline)
    for evaluation in (current, reference):
        print_findings(evaluation)
    comparison = compare_evaluations(current, reference, alpha)
    if as_json:
        groups = [asdict(comparison.overall), *(asdict(c) for c in comparison.categories)]
        put_json({"passed": comparison.passed, "alpha": alpha, "groups": groups, "left_out": comparison.unscored_tasks}, indent=2)
    else:
        for line in comparison_lines(comparison, current):
            put(line)
    if note := judge_change_note(current, reference):
        print_error(note)
    return 0 if comparison.passed else FAILED


@submission_app.command("make")
@command
def submission_make(
    log: Annotated[Path, typer.Argument(help="Log of a finished evaluation.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write (JSON lines).")],
    tasks: Annotated[
        str | None, typer.Option("--tasks", help="Split or task file that the log must cover (default: the split of the log).")
    ] = None,
    partial: Annotated[
        bool, typer.Option("--partial", help="Write an incomplete submission, which `submission validate` rejects.")
    ] = False,
    traces: Annotated[
        bool, typer.Option("--traces/--no-traces", help="Include the traces (format 2). Without them, nothing can be verified.")
    ] = True,
) -> None:
    """Write the submission for a log: its run card, and the verdict, answer, calls, times and trace of every task.

    A log that does not cover its split is rejected.
    """
    require_report_packages()
    from scope_ptz.bench.submissions.submission import submission_lines, write_submission
    from scope_ptz.bench.tasks.splits import SPLITS as KNOWN_SPLITS

    evaluation = _read(log)
    print_findings(evaluation)
    with_traces = traces and log.suffix != HUMAN_RESULT_SUFFIX
    header, lines = _lines_with_traces(log, evaluation) if with_traces else submission_lines(evaluation)
    skip_coverage = partial and tasks is None and header.card.split not in KNOWN_SPLITS
    faults = [] if skip_coverage else _coverage_faults(header, lines, tasks)
    if faults and not partial:
        raise InputError(
            f"{log} does not cover {tasks or header.card.split}: {_fault_summary(faults)}. A submission must cover a whole split: "
            "run the remaining tasks without --limit, --category and --scene, or write an incomplete submission with --partial."
        )
    write_submission((header, lines), out)
    put(f"{out}: {len(evaluation.trials)} trials of {evaluation.card.pair}")
    if faults:
        print_error(f"{out} is incomplete and not a valid submission: {_fault_summary(faults)}.")


@submission_app.command("validate")
@command
def submission_validate(
    file: Annotated[Path, typer.Argument(help="Submission to check.")],
    tasks: Annotated[
        str | None, typer.Option("--tasks", help="Split or task file to compare with (default: the split that it names).")
    ] = None,
    verify: Annotated[
        bool,
        typer.Option("--verify", help="Repeat the calls of every run, and compare the results with the trace. This takes minutes."),
    ] = False,
    host_key: HostKeysOption = None,
    as_json: JsonOption = False,
) -> int:
    """Check that a submission is complete and consistent, and that its verdicts follow from its traces.

    It is accepted as hosted only if the key of a trusted host signed exactly this file. Otherwise it is self-reported.

    The exit code is 1 on any fault.
    """
    from scope_ptz.bench.signatures.keys import read_trusted_keys
    from scope_ptz.bench.submissions.submission_checks import check_submission

    result = check_submission(file, _load_tasks(tasks), read_trusted_keys(host_key or ()))
    verification = verify_and_show(result.runs, len(result.runs), file.name, quiet=as_json) if verify else None
    differing = verification.of("differs") if verification is not None else []
    if as_json:
        put_json({**result.as_dict(), **({"verified": verification.as_dict()} if verification is not None else {})}, indent=1)
    else:
        for fault in result.faults[:MAX_FAULTS_LISTED]:
            print_error(fault)
        if len(result.faults) > MAX_FAULTS_LISTED:
            print_error(f"and {len(result.faults) - MAX_FAULTS_LISTED} more")
        put(result.summary)
        if verification is not None and result.runs:
            put("frames are not part of a submission, so they were not compared; `scope bench verify LOG` compares them")
    return FAILED if result.faults or differing else 0


def leaderboard(
    folder: Annotated[Path, typer.Argument(help="Folder with submissions (*.jsonl) and their signatures (*.jsonl.sig).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="HTML file to write.")],
    tasks: Annotated[
        list[str] | None,
        typer.Option(
            "--tasks", help=f"Task file or split that submissions may cover (repeatable; splits: {SPLITS}; default: core)."
        ),
    ] = None,
    host_key: HostKeysOption = None,
    title: Annotated[str, typer.Option("--title", help="Title of the page.")] = "SCOPE leaderboard",
    as_json: JsonOption = False,
) -> None:
    """Write a leaderboard from submissions, as one self-contained HTML page.

    Submissions that are not valid are listed with the reason at the end of the page.
    """
    require_report_packages()
    from scope_ptz.bench.leaderboard.entries import read_entries
    from scope_ptz.bench.leaderboard.page import write_leaderboard
    from scope_ptz.bench.signatures.keys import read_trusted_keys

    entries, refused = read_entries(folder, [_task_set(name) for name in tasks or ["core"]], read_trusted_keys(host_key or ()))
    tables = write_leaderboard(entries, refused, out, title=title)
    if as_json:
        rows = [{"file": e.file, "name": e.name, "labels": e.labels, "ranked": e.ranked} for e in entries]
        put_json({"page": str(out), "entries": rows, "refused": [{"file": r.file, "reason": r.reason} for r in refused]}, indent=1)
        return
    for submission in refused:
        print_error(f"{submission.file}: not listed: {submission.reason}")
    rows_text = "1 entry" if len(entries) == 1 else f"{len(entries)} entries"
    put(f"{out}: {rows_text} in {len(tables)} {'table' if len(tables) == 1 else 'tables'}")


def _task_set(name: str) -> TaskSet:
    from scope_ptz.bench.leaderboard.entries import TaskSet
    from scope_ptz.factory.evaluation import load_entries
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.library import Library

    entries = load_entries(name, Library(scene_search(load_settings())))
    tasks = tuple(entry.task for entry in entries if entry.task is not None)
    if not tasks:
        raise InputError(f"{name} contains no tasks with executable checks, so it cannot have a leaderboard.")
    return TaskSet(Path(name).name, tasks, {entry.facts.id: entry.facts for entry in entries})


def _lines_with_traces(log: Path, evaluation: Evaluation) -> tuple[Header, list[TrialLine]]:
    from scope_ptz.bench.engine.traces.log_runs import read_runs
    from scope_ptz.bench.submissions.submission import submission_lines
    from scope_ptz.bench.submissions.submission_traces import publish_runs

    published = publish_runs(evaluation, read_runs(log))
    return submission_lines(published.evaluation, published.runs, published.places)


def _coverage_faults(header: Header, lines: Sequence[TrialLine], tasks: str | None) -> list[str]:
    from scope_ptz.bench.submissions.submission_checks import coverage_faults

    return coverage_faults(header, lines, _load_tasks(tasks))


def _fault_summary(faults: Sequence[str]) -> str:
    more = len(faults) - MAX_FAULTS_ON_ONE_LINE
    return "; ".join(faults[:MAX_FAULTS_ON_ONE_LINE]) + (f"; and {more} more faults" if more > 0 else "")


def require_report_packages() -> None:
    """Raise ``ConfigError`` if the packages for writing reports are not installed."""
    from scope_ptz.perception.backends.spec import require_packages

    require_packages("bench", "inspect_ai", "jinja2", "matplotlib", "scipy")


def _read(path: Path) -> Evaluation:
    """Read a log with its human labels, or a human result. Raises ``TraceError`` or ``InputError``."""
    from scope_ptz.bench.judging.human_labels import labels_file, read_labels, with_labels

    if path.suffix == HUMAN_RESULT_SUFFIX:
        from scope_ptz.bench.human_runs import read_result

        return read_result(path)
    return with_labels(read_log(path), read_labels(labels_file(path)))


def _load_tasks(name: str | None) -> Sequence[Task] | None:
    from scope_ptz.bench.tasks.splits import load_split

    return None if name is None else load_split(name)


def _print_progress(done: int, total: int) -> None:
    sys.stderr.write(f"\rpages of failed tasks: {done} of {total}" + ("\n" if done == total else ""))
    sys.stderr.flush()
