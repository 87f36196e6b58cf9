"""Imported tasks, and the JSONL files that store them with one task per line."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.bench.tasks.findings import RowFinding
from scope_ptz.bench.tasks.task import RequiredCall
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.errors import InputError, OutputError
from scope_ptz.regular_files import check_regular_file

Policy = Literal["all", "exact", "any", "none"]
"""How the expected calls are checked.

"all": every expected call was made; "exact": every expected call was made, and no other tool was used; "any": at least one
expected call was made; "none": the calls are not checked.
"""


class ImportedTask(BaseModel):
    """A task imported from a file in another format. A judge scores its answer, and a check verifies its expected calls.

    Attributes:
        imported: Version of this format.
        facts: The task's properties, as judges and reports use them.
        line: Line number in the source file.
        raw: The unchanged cells of the row in the source file.
        calls: The expected calls.
        policy: How the expected calls are checked.
        order: Whether the calls must be made in the given order ("ordered") or may be made in any order ("any").
        start_s: Scene time at the start, in seconds.
        findings: Problems found in the source row.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    imported: Literal[1] = 1
    facts: TaskFacts
    line: int
    raw: dict[str, str]
    calls: tuple[RequiredCall, ...] = ()
    policy: Policy = "all"
    order: Literal["ordered", "any"] = "any"
    start_s: float = 0.0
    findings: tuple[RowFinding, ...] = ()


def is_imported_file(path: Path) -> bool:
    """Return whether a file contains imported tasks, judging by its first line."""
    try:
        check_regular_file(path)
        with path.open(encoding="utf-8") as file:
            first = json.loads(file.readline(2**20))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(first, dict) and first.get("imported") == 1


def load_imported(path: Path) -> tuple[ImportedTask, ...]:
    """Load imported tasks from a file.

    Raises:
        InputError: The file cannot be read, or a task is invalid. The message states the line number.
    """
    try:
        lines = path.read_text("utf-8").split("\n")  # JSON strings may contain other line separators.
    except OSError as error:
        raise InputError(f"The task file {path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not a file of imported tasks, because it is not UTF-8 text.") from error
    tasks = list[ImportedTask]()
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            tasks.append(ImportedTask.model_validate_json(line))
        except ValidationError as error:
            first_error = error.errors(include_url=False, include_input=False)[0]
            field = ".".join(str(part) for part in first_error["loc"])
            raise InputError(f"{path}, line {number}: {f'{field}: ' if field else ''}{first_error['msg']}.") from error
    return tuple(tasks)


def dump_imported(tasks: Iterable[ImportedTask], path: Path) -> None:
    """Write imported tasks to a JSONL file.

    Raises:
        OutputError: The file cannot be written.
    """
    rows = ({**task.model_dump(mode="json", exclude_defaults=True), "imported": 1} for task in tasks)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows), "utf-8")
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror}.") from error
