"""Edit logs as an attacker would, by changing the JSON files in the ZIP archive of a log."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

from scope_ptz.bench.engine.sample_files import ATTACHMENT, stored_run_in
from scope_ptz.bench.engine.stored_run import STORE

Json = dict[str, Any]
Change = Callable[[Json], Any]


def files_of(log: Path) -> dict[str, Any]:
    """Return the files of a log by name."""
    with ZipFile(log) as archive:
        return {name: json.loads(archive.read(name)) for name in archive.namelist()}


def write_log(files: Mapping[str, Any], out: Path) -> Path:
    with ZipFile(out, "w", ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, json.dumps(content))
    return out


def edit_log(log: Path, out: Path, change: Change, only: Iterable[str]) -> Path:
    """Write a copy of a log, with ``change`` applied to the samples named in ``only`` (``task#epoch``). Return its path."""
    files, names = files_of(log), set(only)
    changed = 0
    for name, content in files.items():
        if name.startswith("samples/") and f"{content['id']}#{content['epoch']}" in names:
            change(content)
            changed += 1
    assert changed == len(names)
    return write_log(files, out)


def records_of(sample: Json) -> list[Json]:
    stored = stored_run_in(sample)
    assert stored is not None
    return [json.loads(line) for line in stored.trace.split("\n") if line]


def set_trace(sample: Json, records: Iterable[Json] | str) -> None:
    """Replace the trace of a sample, wherever the sample stores it."""
    text = records if isinstance(records, str) else "".join(json.dumps(record) + "\n" for record in records)
    store = sample["store"][STORE]
    if str(store["trace"]).startswith(ATTACHMENT):
        sample["attachments"][store["trace"].removeprefix(ATTACHMENT)] = text
    else:
        store["trace"] = text


def trace_change(change: Callable[[list[Json]], list[Json] | None]) -> Change:
    """Return a change of a sample that edits the records of its trace."""

    def apply(sample: Json) -> None:
        records = records_of(sample)
        set_trace(sample, change(records) or records)

    return apply
