"""Archive logs whose runs have been carried over to a new log, together with their human labels and judgement journals."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from scope_ptz.bench.engine.judgement_journal import journal_file
from scope_ptz.bench.engine.logs import uuids_in
from scope_ptz.bench.engine.stored_run import sample_name
from scope_ptz.bench.judging.human_labels import LabelRow, labels_file, read_labels
from scope_ptz.bench.judging.json_lines import append_line, complete_lines


def check_labels(logs: Sequence[Path]) -> None:
    """Check that the labels files of logs can be read.

    Raises:
        InputError: A labels file cannot be read or is damaged.
    """
    for log in logs:
        read_labels(labels_file(log))


def archive_logs(logs: Sequence[Path], new: Path, folder: Path) -> None:
    """Move logs that have been replaced by ``new`` into a folder, so that no run is counted twice in reports.

    Labels files and journals are moved together with their logs. Labels and judgements of runs that were carried over to ``new``
    are also copied to its files. Those of repeated runs remain only with the old log.
    """
    logs = [log for log in logs if log.is_file()]
    _copy_labels(logs, new)
    _copy_journals(logs, new)
    for log in logs:
        folder.mkdir(exist_ok=True)
        # The log is moved last, so that an interrupted move is repeated.
        for path in (labels_file(log), journal_file(log), log):
            if path.is_file():
                path.replace(folder / path.name)


def _sample_uuids(log: Path) -> Mapping[str, str | None]:
    """Return the unique id of each run in a log, by sample name."""
    return {sample_name(*run): uuid for run, uuid in uuids_in(log).items()}


def _carried_over_samples(log: Path, new_uuids: Mapping[str, str | None]) -> set[str]:
    """Return the names of the samples that were carried over unchanged from a log to the new log."""
    return {name for name, uuid in _sample_uuids(log).items() if uuid is not None and new_uuids.get(name) == uuid}


def _copy_labels(logs: Sequence[Path], new: Path) -> None:
    """Copy each person's newest label for each run that was carried over."""
    if not any(labels_file(log).is_file() for log in logs):
        return
    new_uuids, target = _sample_uuids(new), labels_file(new)
    newest: dict[tuple[str, str], LabelRow] = {}
    for log in logs:
        carried_over = _carried_over_samples(log, new_uuids)
        for row in read_labels(labels_file(log)):
            key = (row.sample, row.by)
            if row.sample in carried_over and (key not in newest or newest[key].at < row.at):
                newest[key] = row
    existing = {(row.sample, row.by): row.at for row in read_labels(target)}
    for row in sorted(newest.values(), key=lambda row: row.at):
        if (row.sample, row.by) not in existing or existing[row.sample, row.by] < row.at:
            append_line(target, row.model_dump_json())


def _copy_journals(logs: Sequence[Path], new: Path) -> None:
    """Copy the judgements that interrupted rescorings left in journals."""
    if not any(journal_file(log).is_file() for log in logs):
        return
    new_uuids, target = _sample_uuids(new), journal_file(new)
    existing = {line for _, line in complete_lines(target)}
    for log in logs:
        carried_over = _carried_over_samples(log, new_uuids)
        for _, line in complete_lines(journal_file(log)):
            if line not in existing and _sample_of(line) in carried_over:
                append_line(target, line)


def _sample_of(line: str) -> str:
    try:
        return str(json.loads(line)["sample"])
    except (ValueError, KeyError, TypeError):
        return ""  # A damaged line remains with the old log.
