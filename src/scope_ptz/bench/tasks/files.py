"""Read and write task files: JSONL with one task per line, or a YAML list."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from scope_ptz.bench.tasks.task import TASK, Task
from scope_ptz.errors import InputError


def digest_of(tasks: Iterable[Task]) -> str:
    """Return the SHA-256 of the tasks' JSON."""
    return hashlib.sha256("\n".join(task.model_dump_json() for task in tasks).encode()).hexdigest()


def load_tasks(path: Path) -> tuple[Task, ...]:
    """Load tasks from a JSONL or YAML file.

    Raises:
        InputError: The file cannot be read or a task is invalid. The message names the file and the task.
    """
    try:
        text = path.read_text("utf-8")
        content = (
            yaml.safe_load(text) if path.suffix in (".yaml", ".yml") else [json.loads(row) for row in text.splitlines() if row]
        )
    except OSError as error:
        raise InputError(f"The tasks {path} cannot be read: {error.strerror}.") from error
    except (ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path} holds no tasks: {error}.") from error
    tasks = tuple(_task(row, path, number) for number, row in enumerate(content or (), 1))
    duplicates = (
        {t.id for t in tasks if sum(t.id == other.id for other in tasks) > 1} if len({t.id for t in tasks}) < len(tasks) else set()
    )
    if duplicates:
        raise InputError(f"{path} contains {', '.join(sorted(duplicates))} more than once.")
    return tasks


def _task(row: Any, path: Path, number: int) -> Task:
    try:
        return TASK.validate_python(row)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        name = row.get("id", f"number {number}") if isinstance(row, dict) else f"number {number}"
        raise InputError(f"{path}, task {name}: {where or 'as a whole'}: {first['msg']}.") from error


def dump_tasks(tasks: Iterable[Task], path: Path) -> None:
    """Write tasks as JSONL. Default values are left out, except the canary."""
    rows = ({**task.model_dump(mode="json", exclude_defaults=True), "canary": task.canary} for task in tasks)
    path.write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows), "utf-8")
