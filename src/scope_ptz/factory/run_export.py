"""Export stored runs to a file, in the store's formats or as drafts for benchmark tasks."""

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
"""The formats of ``store.export``, and ``drafts``, which has one line for each run with positive feedback.

``scope bench drafts`` reads files in the format ``drafts``.
"""


def export_runs(store: RunStore, runs: Iterable[str], out: Path, kind: ExportFormat | AnyFormat) -> int:
    """Write runs to a new file, and return the number of runs written.

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
    """Yield a draft for each run with positive feedback, or the reason why the run cannot be converted. Skip all other runs."""
    from scope_ptz.taskgen.generating.draft_places import DraftRejectedError
    from scope_ptz.taskgen.generating.run_draft_file import RunDraft
    from scope_ptz.taskgen.generating.run_drafts import convert_run

    @cache
    def open_scene(name: str) -> Scene:
        from scope_ptz.factory.worlds import open_scenes

        try:
            return open_scenes([name])[name]
        except InputError as error:
            raise DraftRejectedError(str(error)) from error

    for run in runs:
        run_feedback = [entry for entry in feedback_on(store.database, run) if entry.position is None]
        if not any(entry.rating > 0 for entry in run_feedback) or any(entry.rating < 0 for entry in run_feedback):
            continue
        note = " ".join(entry.comment for entry in run_feedback if entry.comment)
        try:
            trace = read_trace(store.folder(run))
        except TraceError as error:
            yield RunDraft(run=run, note=note, reason=str(error))
            continue
        yield convert_run(run, trace, note, open_scene)
