"""What people and judges have said about the runs of a log, and stands beside it: it goes along when another log takes the runs
over."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from scope_ptz.bench.engine.journal import journal_file
from scope_ptz.bench.engine.logs import uuids_in
from scope_ptz.bench.engine.sampling import sample_name
from scope_ptz.bench.judging.human_labels import LabelRow, labels_file, read_labels
from scope_ptz.bench.judging.json_lines import append_line, whole_lines


def check_beside(logs: Sequence[Path]) -> None:
    """Whether what stands beside logs can go along later. Raises ``InputError``: better before the runs than after them."""
    for log in logs:
        read_labels(labels_file(log))


def put_away(logs: Sequence[Path], new: Path, folder: Path) -> None:
    """Move logs into a folder whose runs are all in ``new``, with what stands beside them: nothing is deleted, and no report counts
    a run twice. Labels and judgements of the runs that were taken over stand beside ``new`` then; those of runs that were made
    again are about other runs, and stay with the old log."""
    logs = [log for log in logs if log.is_file()]
    _carry_labels(logs, new)
    _carry_journals(logs, new)
    for log in logs:
        folder.mkdir(exist_ok=True)
        for path in (labels_file(log), journal_file(log), log):  # The log last: a break before it leaves all to be done again.
            if path.is_file():
                path.replace(folder / path.name)


def _names(log: Path) -> Mapping[str, str | None]:
    return {sample_name(*run): uuid for run, uuid in uuids_in(log).items()}


def _taken_over(log: Path, now: Mapping[str, str | None]) -> set[str]:
    """The runs of a log that are the very same ones in another, by name."""
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
    """What a rescoring that was killed had from its judge, and had not put into the log yet."""
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
        return ""  # Damaged: it stays with the old log.
