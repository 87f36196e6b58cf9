"""``scope bench leaderboard``: write a static leaderboard page from submissions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import SPLITS, HostKeysOption
from scope_ptz.cli.exit import print_error, put, put_json
from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.leaderboard.entries import TaskSet


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
    from scope_ptz.cli.bench.report import require_report_packages

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
