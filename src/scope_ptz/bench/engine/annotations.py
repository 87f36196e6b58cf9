"""Move the files next to a log, which contain human labels and judgements, when another log takes over its runs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from scope_ptz.bench.engine.judgement_journal import journal_file
from scope_ptz.bench.engine.logs import uuids_in
from scope_ptz.bench.engine.samples import sample_name
from scope_ptz.bench.judging.human_labels import LabelRow, labels_file, read_labels
from scope_ptz.bench.judging.json_lines import append_line, whole_lines


def check_beside(logs: Sequence[Path]) -> None:
    """Check that the human labels of logs can be read. Raises ``InputError``."""
    for log in logs:
        read_labels(labels_file(log))


def put_away(logs: Sequence[Path], new: Path, folder: Path) -> None:
    """Move logs that ``new`` supersedes into a folder, with their labels and journals.

    Reports then count no run twice. Labels and judgements of runs that were taken over are copied to the files of ``new``.
    Labels and judgements of runs that were repeated stay with the old log.
    """
    logs = [log for log in logs if log.is_file()]
    _carry_labels(logs, new)
    _carry_journals(logs, new)
    for log in logs:
        folder.mkdir(exist_ok=True)
        # The log is moved last, so that an interrupted move is repeated.
        for path in (labels_file(log), journal_file(log), log):
            if path.is_file():
                path.replace(folder / path.name)


def _names(log: Path) -> Mapping[str, str | None]:
    return {sample_name(*run): uuid for run, uuid in uuids_in(log).items()}


def _taken_over(log: Path, now: Mapping[str, str | None]) -> set[str]:
    """Return the names of the runs of a log that another log took over unchanged."""
    return {name for name, uuid in _names(log).items() if uuid is not None and now.get(name) == uuid}


def _carry_labels(logs: Sequence[Path], new: Path) -> None:
    if not any(labels_file(log).is_file() for log in logs):
        return
    now, target = _names(new), labels_file(new)
    newest: dict[tuple[str, str], LabelRow] = {}
    for log in logs:
        same = _taken_over(log, now)
        for row in read_labels(labels_file(log)):
            key = (row.sample, row.by)
            if row.sample in same and (key not in newest or newest[key].at < row.at):
                newest[key] = row
    there = {(row.sample, row.by): row.at for row in read_labels(target)}
    for row in sorted(newest.values(), key=lambda row: row.at):
        if (row.sample, row.by) not in there or there[row.sample, row.by] < row.at:
            append_line(target, row.model_dump_json())


def _carry_journals(logs: Sequence[Path], new: Path) -> None:
    """Copy the judgements of an interrupted rescoring that are not in the log yet."""
    if not any(journal_file(log).is_file() for log in logs):
        return
    now, target = _names(new), journal_file(new)
    there = {line for _, line in whole_lines(target)}
    for log in logs:
        same = _taken_over(log, now)
        for _, line in whole_lines(journal_file(log)):
            if line not in there and _sample_of(line) in same:
                append_line(target, line)


def _sample_of(line: str) -> str:
    try:
        return str(json.loads(line)["sample"])
    except (ValueError, KeyError, TypeError):
        return ""  # A damaged line stays with the old log.
