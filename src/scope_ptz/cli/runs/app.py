"""The ``scope runs`` app and its commands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.options import JsonOption, OutputFile, command
from scope_ptz.cli.runs import HELP
from scope_ptz.cli.runs.audit import runs_audit
from scope_ptz.cli.runs.common import AuditLogs, FilterFlags, RunsDir, index_audit_logs, open_store

if TYPE_CHECKING:
    from scope_ptz.store.rows import RunRow, StepRow

RunId = Annotated[str, typer.Argument(metavar="RUN", help="Name of the run's folder.")]
runs_app = typer.Typer(help=HELP, no_args_is_help=True)


@runs_app.callback(help=HELP)
def _runs() -> None:
    """Define the group of commands for stored runs."""


runs_app.command("audit")(command(runs_audit))


@runs_app.command("list")
@command
def runs_list(
    filters: FilterFlags,
    runs_dir: RunsDir = None,
    limit: Annotated[int, typer.Option("--limit", min=1, max=500, help="Number of runs to print.")] = 20,
    as_json: JsonOption = False,
) -> None:
    """List runs, newest first."""
    from scope_ptz.cli.exit import put, put_json

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
    from scope_ptz.cli.exit import put, put_json
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
    from scope_ptz.cli.exit import put

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
    from scope_ptz.cli.exit import FAILED, print_error, put, put_json

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
    from scope_ptz.cli.exit import put, put_json
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
    from scope_ptz.cli.exit import put, put_json
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
