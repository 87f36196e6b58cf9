"""Read and write human labels, which are stored as JSON lines in a file next to the log.

A later label by the same person for the same run replaces the earlier one. Lines are only ever appended, so an interruption cannot
lose labels.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.bench.judging.json_lines import append_line, complete_lines
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Label
from scope_ptz.errors import InputError

SUFFIX = ".labels.jsonl"
"""Suffix of a labels file. It is appended to the file name of the log."""


class LabelRow(BaseModel):
    """A line of a labels file. ``sample`` is the name of the run's sample in the log; ``at`` is the time of labelling."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    sample: str
    by: str = Field(min_length=1)
    verdict: Literal["correct", "incorrect", "unclear"]
    error_mode: ErrorMode | None = None
    note: str = ""
    at: datetime

    def label(self) -> Label:
        """Return the label itself, without the run and the time."""
        return Label(by=self.by, verdict=self.verdict, error_mode=self.error_mode, note=self.note)


def labels_file(log: Path) -> Path:
    """Return the path of a log's labels file."""
    return log.with_name(log.name + SUFFIX)


def read_labels(path: Path) -> tuple[LabelRow, ...]:
    """Read the newest label of each person for each run. A missing file contains no labels.

    An incomplete last line is ignored.

    Raises:
        InputError: The file cannot be read, or one of its complete lines is not a valid label.
    """
    newest: dict[tuple[str, str], LabelRow] = {}
    for number, line in complete_lines(path):
        row = _parse_row(line, path, number)
        newest[row.sample, row.by] = row
    return tuple(newest.values())


def _parse_row(line: str, path: Path, number: int) -> LabelRow:
    try:
        return LabelRow.model_validate(json.loads(line))
    except ValidationError as error:
        first_error = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first_error["loc"])
        problem = f"{field}: {first_error['msg']}" if field else first_error["msg"]
        raise InputError(f"{path}, line {number} is not a valid label: {problem}. Correct or remove the line.") from error
    except ValueError as error:
        raise InputError(f"{path}, line {number} is not a valid label: {error}. Correct or remove the line.") from error


def add_label(path: Path, label: Label, sample: str) -> LabelRow:
    """Append a label to a labels file, and return the new row.

    Raises:
        OutputError: The file cannot be written.
    """
    row = LabelRow(sample=sample, at=datetime.now(UTC), **label.model_dump())
    append_line(path, row.model_dump_json())
    return row


def with_labels(evaluation: Evaluation, rows: Iterable[LabelRow]) -> Evaluation:
    """Return a copy of an evaluation with human labels added to its trials."""
    by_sample: dict[str, list[Label]] = {}
    for row in rows:
        by_sample.setdefault(row.sample, []).append(row.label())
    trials = tuple(
        trial.model_copy(update={"labels": (*trial.labels, *by_sample[trial.sample])}) if trial.sample in by_sample else trial
        for trial in evaluation.trials
    )
    return evaluation.model_copy(update={"trials": trials})
