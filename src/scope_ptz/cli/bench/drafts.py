"""``scope bench drafts``: convert drafts from operators' runs to tasks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.exit import FAILED, put, put_json
from scope_ptz.cli.options import JsonOption

if TYPE_CHECKING:
    from scope_ptz.simulator.pack import Scene
    from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
    from scope_ptz.taskgen.generating.run_draft_file import RunDraft


def drafts(
    file: Annotated[Path, typer.Argument(help="File that 'scope runs export --format drafts' wrote.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the drafts, the accepted tasks and the review list.")],
    known: Annotated[str, typer.Option(help="Split or task file whose tasks must not be repeated (default: none).")] = "",
    as_json: JsonOption = False,
) -> int:
    """Convert drafts from operators' runs to tasks. Expected answers come from the ground truth. Invalid drafts are dropped.

    The output lists every draft, with the reason if it was dropped. The exit code is 1 if no task was accepted.

    Running the same command again skips drafts that the folder already contains.
    """
    import anyio

    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.errors import InputError
    from scope_ptz.factory.task_validation import task_validator
    from scope_ptz.factory.worlds import open_scenes
    from scope_ptz.taskgen.facts.near_duplicates import KnownTasks
    from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
    from scope_ptz.taskgen.generating.run_draft_file import read_run_drafts, validate_run_drafts

    run_drafts, ledger = read_run_drafts(file), DraftLedger(out)
    earlier_count = len(ledger.entries)
    known_tasks = KnownTasks([*(load_split(known) if known else ()), *ledger.kept])

    def open_scene(name: str) -> Scene | None:
        try:
            return open_scenes([name])[name]
        except InputError:
            return None

    async def work() -> None:
        await validate_run_drafts(run_drafts, open_scene, task_validator, known_tasks, ledger)

    try:
        anyio.run(work)
    finally:
        tasks, review = ledger.finish()
    if as_json:
        put_json(
            {
                "drafts": [entry.model_dump(mode="json", include={"fate", "reason", "draft"}) for entry in ledger.entries],
                "new": len(ledger.entries) - earlier_count,
                "accepted": len(ledger.kept),
                "tasks": str(tasks),
                "review": str(review),
            }
        )
    else:
        _print_entries(run_drafts, ledger, earlier_count)
        put(f"Accepted {len(ledger.kept)} of {len(ledger.entries)} drafts: {tasks}; to review: {review}")
    return 0 if ledger.kept else FAILED


def _print_entries(run_drafts: list[RunDraft], ledger: DraftLedger, first: int) -> None:
    for entry in ledger.entries[first:]:
        text = entry.draft.get("instruction", "") if isinstance(entry.draft, dict) else str(entry.draft or "")
        put(f"{entry.fate:<15} {text[:90]}")
        if entry.reason:
            put(f"{'':<15} {entry.reason}")
    if not run_drafts:
        put("The file contains no drafts. Rate runs as good, then export them again.")
