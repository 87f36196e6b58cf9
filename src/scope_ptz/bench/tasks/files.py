"""Read and write task files: JSONL files with one task per line, or YAML lists."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from scope_ptz.bench.tasks.task import TASK, Task
from scope_ptz.errors import InputError
from scope_ptz.regular_files import check_regular_file


def digest_of(tasks: Iterable[Task]) -> str:
    """Return the SHA-256 digest of tasks in JSON form."""
    return hashlib.sha256("\n".join(task.model_dump_json() for task in tasks).encode()).hexdigest()


def load_tasks(path: Path) -> tuple[Task, ...]:
    """Load tasks from a JSONL or YAML file.

    Raises:
        InputError: The file cannot be read or a task is invalid. The message names the file and the task.
    """
    try:
        check_regular_file(path)
        text = path.read_text("utf-8")
        content = (
            yaml.safe_load(text) if path.suffix in (".yaml", ".yml") else [json.loads(row) for row in text.splitlines() if row]
        )
    except OSError as error:
        raise InputError(f"The task file {path} cannot be read: {error.strerror}.") from error
    except (ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path} is neither valid JSONL with one task per line nor a valid YAML list: {error}.") from error
    tasks = tuple(_parse_task(row, path, number) for number, row in enumerate(content or (), 1))
    duplicates = sorted(name for name, count in Counter(task.id for task in tasks).items() if count > 1)
    if duplicates:
        raise InputError(f"{path} contains {', '.join(duplicates)} more than once. Every task must have its own id.")
    return tasks


def _parse_task(row: Any, path: Path, number: int) -> Task:
    try:
        return TASK.validate_python(row)
    except ValidationError as error:
        first_error = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first_error["loc"])
        name = row.get("id", f"number {number}") if isinstance(row, dict) else f"number {number}"
        raise InputError(f"{path}, task {name}: {f'{field}: ' if field else ''}{first_error['msg']}.") from error


def dump_tasks(tasks: Iterable[Task], path: Path) -> None:
    """Write tasks to a JSONL file. Default values are omitted, except for the canary."""
    rows = ({**task.model_dump(mode="json", exclude_defaults=True), "canary": task.canary} for task in tasks)
    path.write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows), "utf-8")
