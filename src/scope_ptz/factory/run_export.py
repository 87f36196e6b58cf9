"""Export stored runs to a file, in the formats of the store or as drafts of benchmark tasks."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import IO, TYPE_CHECKING, Literal, get_args

from scope_ptz.agent.trace import read_trace
from scope_ptz.errors import InputError, TraceError
from scope_ptz.store.export import ExportFormat, write_atomically
from scope_ptz.store.feedback import feedback_on

if TYPE_CHECKING:
    from scope_ptz.simulator.pack import Scene
    from scope_ptz.store.run_store import RunStore
    from scope_ptz.taskgen.generating.run_draft_file import RunDraft

AnyFormat = Literal["jsonl", "chat", "zip", "drafts"]
FORMATS: tuple[str, ...] = get_args(AnyFormat)
"""The formats of ``store.export``, and ``drafts``: a line for each run with positive feedback, for ``scope bench drafts``."""


def export_runs(store: RunStore, runs: Iterable[str], out: Path, kind: ExportFormat | AnyFormat) -> int:
    """Write runs to a new file, and return how many were written.

    Raises:
        InputError: The format is unknown.
        UnknownNameError: There is no such run.
        OutputError: The file cannot be written.
    """
    if kind not in FORMATS:
        raise InputError(f"There is no export format '{kind}'. Use one of: {', '.join(FORMATS)}.")
    if kind != "drafts":
        return store.export(list(runs), out, kind)

    def write(file: IO[bytes]) -> int:
        count = 0
        for draft in run_drafts(store, runs):
            file.write(json.dumps(draft.model_dump(mode="json"), ensure_ascii=False).encode() + b"\n")
            count += 1
        return count

    return write_atomically(out, write)


def run_drafts(store: RunStore, runs: Iterable[str]) -> Iterator[RunDraft]:
    """Yield the draft of each run with positive feedback, or the reason why the run cannot be converted. Other runs are skipped."""
    from scope_ptz.taskgen.generating.draft_places import DraftRejectedError
    from scope_ptz.taskgen.generating.run_draft_file import RunDraft
    from scope_ptz.taskgen.generating.run_drafts import run_draft

    @cache
    def open_scene(name: str) -> Scene:
        from scope_ptz.factory.worlds import open_scenes

        try:
            return open_scenes([name])[name]
        except InputError as error:
            raise DraftRejectedError(str(error)) from error

    for run in runs:
        about_run = [each for each in feedback_on(store.database, run) if each.position is None]
        if not any(each.rating > 0 for each in about_run) or any(each.rating < 0 for each in about_run):
            continue
        note = " ".join(each.comment for each in about_run if each.comment)
        try:
            trace = read_trace(store.folder(run))
        except TraceError as error:
            yield RunDraft(run=run, note=note, reason=str(error))
            continue
        yield run_draft(run, trace, note, open_scene)
