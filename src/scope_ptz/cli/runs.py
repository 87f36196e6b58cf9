"""The ``scope runs`` commands: list, show, index, export and prune stored runs, and list audit logs."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption, OutputFile
from scope_ptz.cli.typer_extensions import command
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.store.rows import RunFilter, RunRow, StepRow
    from scope_ptz.store.run_store import RunStore

runs_app = typer.Typer()

RunId = Annotated[str, typer.Argument(metavar="RUN", help="Name of the run's folder.")]
RunsDir = Annotated[Path | None, typer.Option("--runs-dir", help="Folder with the runs (default: SCOPE_RUNS_DIR, else runs).")]
AuditLogs = Annotated[
    list[Path] | None,
    typer.Option("--audit", help="Audit log of a camera to index (default: those in scope.yaml; repeatable)."),
]


@dataclass(frozen=True, kw_only=True)
class FilterFlags:
    """Options that select runs."""

    text: Annotated[str, typer.Option("--text", help="Select only runs whose instruction or answer contains these words.")] = ""
    camera: Annotated[str | None, typer.Option("--camera", help="Select only runs with this camera or scene.")] = None
    outcome: Annotated[str | None, typer.Option("--outcome", help="Select only runs with this outcome, for example answered.")] = (
        None
    )
    tool: Annotated[str | None, typer.Option("--tool", help="Select only runs that called this tool.")] = None
    rating: Annotated[str | None, typer.Option("--rating", help="Select only runs with this rating: good or bad.")] = None
    since: Annotated[
        str | None,
        typer.Option(
            "--since", metavar="TIME", help="Select only runs that started at this time or later, for example 2026-05-01."
        ),
    ] = None
    until: Annotated[
        str | None, typer.Option("--until", metavar="TIME", help="Select only runs that started before this time.")
    ] = None

    def run_filter(self) -> RunFilter:
        """Convert the flags to a filter for the store.

        Raises:
            InputError: The rating or a time is invalid.
        """
        from scope_ptz.store.rows import RunFilter

        ratings: dict[str, Literal[-1, 1]] = {"good": 1, "bad": -1}
        if self.rating is not None and self.rating not in ratings:
            raise InputError(f"--rating must be good or bad; got '{self.rating[:40]}'.")
        return RunFilter(
            text=self.text[:200],
            camera=self.camera,
            outcome=self.outcome,
            tool=self.tool,
            rating=None if self.rating is None else ratings[self.rating],
            since=parse_time("--since", self.since),
            until=parse_time("--until", self.until),
        )


@runs_app.command("audit")
@command
def runs_audit(
    runs_dir: RunsDir = None,
    audit: AuditLogs = None,
    camera: Annotated[str | None, typer.Option("--camera", help="Print only entries of this camera.")] = None,
    since: Annotated[str | None, typer.Option("--since", metavar="TIME", help="Print only entries at this time or later.")] = None,
    until: Annotated[str | None, typer.Option("--until", metavar="TIME", help="Print only entries before this time.")] = None,
    limit: Annotated[int, typer.Option("--limit", min=1, max=10_000, help="Number of entries to print.")] = 50,
    as_json: JsonOption = False,
) -> None:
    """Index the audit logs of cameras and list their entries, newest first."""
    from scope_ptz.store.audit_index import list_audit

    from_time, to_time = parse_time("--since", since), parse_time("--until", until)
    with open_store(runs_dir) as store:
        index_audit_logs(store, audit)
        entries = list_audit(store.database, camera=camera, since=from_time, until=to_time, limit=limit)
    if as_json:
        put_json([entry.model_dump(mode="json") for entry in entries])
        return
    for entry in entries:
        columns = f"{entry.camera[:20]:<20}  {entry.actor[:16]:<16}  {entry.event:<12}"
        details = "".join(f"  {name}={value}" for name, value in entry.details.items())
        put(f"{entry.time.astimezone():%Y-%m-%d %H:%M:%S}  {columns}{details}".rstrip())
    if not entries:
        put("No entries. A camera writes an audit log if `audit_log` is set for it in scope.yaml.")


@runs_app.command("list")
@command
def runs_list(
    filters: FilterFlags,
    runs_dir: RunsDir = None,
    limit: Annotated[int, typer.Option("--limit", min=1, max=500, help="Number of runs to print.")] = 20,
    as_json: JsonOption = False,
) -> None:
    """List runs, newest first."""
    with open_store(runs_dir) as store:
        store.index()
        page = store.runs(filters.run_filter(), limit=limit)
    if as_json:
        put_json({"runs": [run.model_dump(mode="json") for run in page.runs], "more": page.next is not None})
        return
    for run in page.runs:
        put(f"{run.started.astimezone():%Y-%m-%d %H:%M}  {run.outcome:<13} {run.camera[:20]:<20}  {run.instruction[:70]}")
        put(f"                  {run.id}")
    if not page.runs:
        put("No runs found.")
    elif page.next is not None:
        put(f"There are more runs. Use --limit {min(500, limit * 5)} to list more of them.")


@runs_app.command("show")
@command
def runs_show(run: RunId, runs_dir: RunsDir = None, as_json: JsonOption = False) -> None:
    """Print a run: its instruction, tool calls, answer, times and feedback."""
    from scope_ptz.store.export import run_data
    from scope_ptz.store.feedback import feedback_on

    with open_store(runs_dir) as store:
        store.index()
        if as_json:
            put_json(run_data(store.database, run))
            return
        stored, feedback = store.run(run), feedback_on(store.database, run)
    _print_run(stored.run, stored.steps)
    for entry in feedback:
        subject = "run" if entry.position is None else f"call {entry.position + 1}"
        put(f"  {({1: 'good', -1: 'bad'}).get(entry.rating, 'note')} ({subject}, {entry.actor or 'unknown'}): {entry.comment}")


def _print_run(row: RunRow, steps: list[StepRow]) -> None:
    put(row.instruction)
    for step in steps:
        arguments = ", ".join(f"{name}={value!r}" for name, value in step.arguments.items())
        put(f"  {step.step}. {step.tool}({arguments}): {step.message} ({step.total_s:.2f} s)")
    put(f"{row.outcome}: {row.answer}" if row.answer else f"{row.outcome}.")
    put(f"  camera {row.camera}, planner {row.planner}, perception {row.perception}")
    put(
        f"  {row.total_s:.1f} s: planner {row.planner_s:.1f}, perception {row.perception_s:.1f}, camera {row.camera_s:.1f}, "
        f"rendering {row.render_s:.1f}, tools {row.tools_s:.1f}"
    )


@runs_app.command("index")
@command
def runs_index(
    runs_dir: RunsDir = None,
    audit: AuditLogs = None,
    as_json: JsonOption = False,
) -> int:
    """Index run folders and audit logs without changing them. The exit code is 1 if a folder is damaged."""
    with open_store(runs_dir) as store:
        report = store.index()
        entries = index_audit_logs(store, audit)
    if as_json:
        counts = {"added": report.added, "updated": report.updated, "removed": report.removed, "missing": report.missing}
        put_json({**counts, "audit_entries": entries, "damaged": report.damaged})
    else:
        put(f"Runs: {report.added} new, {report.updated} updated, {report.removed} removed. Audit entries: {entries} new.")
        if report.missing:
            put(f"The folders of {report.missing} runs with feedback are missing.")
    for problem in report.damaged.values():
        print_error(problem)
    return FAILED if report.damaged else 0


@runs_app.command("export")
@command
def runs_export(
    out: OutputFile,
    filters: FilterFlags,
    runs_dir: RunsDir = None,
    kind: Annotated[
        str,
        typer.Option(
            "--format", help="jsonl (data), chat (messages for fine-tuning), drafts (for scope bench drafts), or zip (run folders)."
        ),
    ] = "jsonl",
    run: Annotated[list[str] | None, typer.Option("--run", help="Export this run (default: all that match; repeatable).")] = None,
    as_json: JsonOption = False,
) -> None:
    """Write runs to a file."""
    from scope_ptz.factory.run_export import export_runs

    with open_store(runs_dir) as store:
        store.index()
        run_ids = run or store.ids(filters.run_filter())
        count = export_runs(store, run_ids, out, kind)  # type: ignore[arg-type] # export_runs checks the format
    if as_json:
        put_json({"runs": count, "file": str(out)})
    else:
        put(f"{count} runs: {out}")


@runs_app.command("prune")
@command
def runs_prune(
    runs_dir: RunsDir = None,
    older_than: Annotated[float | None, typer.Option("--older-than", min=0.0, help="Remove runs older than N days.")] = None,
    newest: Annotated[int | None, typer.Option("--newest", min=0, help="Keep at most the newest N runs.")] = None,
    max_gb: Annotated[float | None, typer.Option("--max-gb", min=0.0, help="Keep at most N GB of run folders.")] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Remove the runs. Without this option, only print their names.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Remove old runs with their folders, except runs with feedback, kept runs, and runs that may still be in progress."""
    from scope_ptz.store.retention import Retention

    retention = Retention(
        max_age_s=None if older_than is None else older_than * 86_400,
        max_runs=newest,
        max_bytes=None if max_gb is None else round(max_gb * 1e9),
    )
    with open_store(runs_dir) as store:
        store.index()
        pruned = store.prune(retention, dry_run=not yes)
    if as_json:
        put_json({"removed": yes, "runs": pruned.runs, "bytes": pruned.freed_bytes})
        return
    for name in pruned.runs:
        put(name)
    verb = "Removed" if yes else "Would remove"
    put(f"{verb} {len(pruned.runs)} runs, {pruned.freed_bytes / 1e6:.1f} MB.{'' if yes else ' Repeat with --yes to remove them.'}")


def open_store(runs_dir: Path | None) -> RunStore:
    """Open the store of a runs folder.

    Raises:
        InputError: The folder does not exist, or SQLAlchemy is not installed.
    """
    from scope_ptz.settings import load_settings

    try:
        from scope_ptz.store.run_store import RunStore
    except ModuleNotFoundError as error:
        if error.name != "sqlalchemy":
            raise
        raise InputError("The store requires SQLAlchemy. Install it with: pip install 'scope-ptz[store]'.") from error
    root = runs_dir or load_settings().runs_dir
    if not root.is_dir():
        raise InputError(f"The runs folder {root} does not exist. Specify another one with --runs-dir.")
    return RunStore(root)


def parse_time(option: str, text: str | None) -> datetime | None:
    """Parse the value of an option as a time, which is local unless it has a time zone. Return None if the option is missing.

    Raises:
        InputError: The value is not a valid time.
    """
    if text is None:
        return None
    try:
        time = datetime.fromisoformat(text)
        return time.astimezone(UTC)
    except (ValueError, OverflowError):
        raise InputError(f"{option} must be a time such as 2026-05-01 or 2026-05-01T14:30; got '{text[:40]}'.") from None


def index_audit_logs(store: RunStore, paths: list[Path] | None) -> int:
    """Index audit logs, and return the number of new entries. By default, index the logs in ``scope.yaml``.

    Raises:
        InputError: A file cannot be read.
    """
    from scope_ptz.factory.cameras.named_cameras import audit_logs
    from scope_ptz.store.audit_index import index_audit_log

    logs = paths if paths is not None else [path for path in audit_logs() if path.is_file()]
    return sum(index_audit_log(store.database, path) for path in logs)
