"""The on-disk record of all drafts, from which an interrupted generation resumes, and the list of tasks to review."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.bench.tasks.task_wording import expected_in_words
from scope_ptz.errors import InputError, OutputError

RECORD, TASKS, REVIEW = "drafts.jsonl", "tasks.jsonl", "review.md"
DraftFate = Literal["kept", "dropped", "near-duplicate", "no reply"]


class LedgerEntry(BaseModel):
    """The record of one draft, or of a reply without drafts.

    Attributes:
        batch: Number of the request.
        fate: "kept", or how the draft was rejected.
        reason: Why the draft was not kept; empty for a kept draft.
        draft: The draft as the model wrote it.
        task: The task created from the draft; None if the draft was not kept.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    batch: int
    fate: DraftFate
    reason: str = ""
    draft: Any = None
    task: Task | None = None


class DraftLedger:
    """The record of drafts in a folder. Entries are added, but never changed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
            lines = (folder / RECORD).read_text("utf-8").splitlines() if (folder / RECORD).is_file() else []
        except OSError as error:
            raise OutputError(f"The folder {folder} cannot be used: {error.strerror}. Choose another with --out.") from error
        self.entries = [_parse_entry(line, folder / RECORD, number) for number, line in enumerate(lines, 1)]

    @property
    def kept(self) -> list[Task]:
        """The tasks of all drafts that were kept."""
        return [entry.task for entry in self.entries if entry.task is not None and entry.fate == "kept"]

    @property
    def batches(self) -> int:
        """Number of requests to the model so far."""
        return max((entry.batch for entry in self.entries), default=0)

    def missing(self, requested: dict[Category, int]) -> dict[Category, int]:
        """Return the number of missing tasks for each incomplete category."""
        existing = Counter(task.category for task in self.kept)
        return {category: number - existing[category] for category, number in requested.items() if number > existing[category]}

    def last_reasons(self, limit: int = 8) -> list[str]:
        """Return the most recent reasons for not keeping drafts, without duplicates."""
        reasons = [entry.reason for entry in reversed(self.entries) if entry.fate in ("dropped", "near-duplicate")]
        return list(dict.fromkeys(reasons))[:limit]

    def add(self, entry: LedgerEntry) -> None:
        """Add an entry and write it to disk immediately."""
        row = entry.model_dump(mode="json", exclude={"task"})
        row["task"] = entry.task.model_dump(mode="json", exclude_defaults=True) if entry.task else None
        try:
            with (self.folder / RECORD).open("a", encoding="utf-8") as file:
                file.write(json.dumps(row, ensure_ascii=False) + "\n")
        except OSError as error:
            raise OutputError(f"{self.folder / RECORD} cannot be written: {error.strerror}.") from error
        self.entries.append(entry)

    def finish(self) -> list[Path]:
        """Write the kept tasks and the review list, and return the paths of both files."""
        tasks, review = self.folder / TASKS, self.folder / REVIEW
        try:
            dump_tasks(self.kept, tasks)
            review.write_text("\n".join(_review_lines(self.entries)) + "\n", "utf-8")
        except OSError as error:
            raise OutputError(f"The tasks cannot be written to {self.folder}: {error.strerror}.") from error
        return [tasks, review]


def _parse_entry(line: str, path: Path, number: int) -> LedgerEntry:
    try:
        return LedgerEntry.model_validate_json(line)
    except ValidationError as error:
        raise InputError(
            f"{path}, line {number} is damaged: {error.errors(include_url=False)[0]['msg']}. Delete the line to continue."
        ) from error


def _review_lines(entries: Sequence[LedgerEntry]) -> list[str]:
    """Return the review list as Markdown. The model's text is in code spans, so that it is not interpreted as markup."""
    counts_by_fate = Counter(entry.fate for entry in entries)
    lines = [
        "# Drafted tasks for review",
        "",
        ", ".join(f"{number} {fate}" for fate, number in counts_by_fate.most_common()) or "none",
        "",
    ]
    lines += ["Tick the tasks to keep. View each one with `scope bench browse ID --tasks tasks.jsonl --out pictures`.", ""]
    for entry in entries:
        if entry.fate == "kept" and entry.task is not None:
            task = entry.task
            lines.append(
                f"- [ ] {task.id} ({task.category}, {task.difficulty}), from {task.preset}: {_code_span(task.instruction)}"
            )
            lines.append(f"      expected: {_code_span(expected_in_words(task.expected))}")
    lines += ["", "## Not kept", ""]
    for entry in entries:
        if entry.fate != "kept":
            text = entry.draft.get("instruction", entry.draft) if isinstance(entry.draft, dict) else entry.draft
            lines.append(f"- {entry.fate}: {_code_span(entry.reason)}" + (f" {_code_span(str(text)[:200])}" if text else ""))
    return lines


def _code_span(text: str) -> str:
    clean = "".join(c if c.isprintable() else " " for c in text).replace("`", "'")
    return f"`{clean}`"
