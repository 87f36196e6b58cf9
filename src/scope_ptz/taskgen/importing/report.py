"""An import as a whole: every row of the file, what became of it, and why."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from scope_ptz.bench.tasks.findings import BLOCKING, MEANINGS, FindingKind, RowFinding
from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.task import Category
from scope_ptz.taskgen.importing.audit import audit, comparable
from scope_ptz.taskgen.importing.places import Places
from scope_ptz.taskgen.importing.rows import RowRead, ids_of, read_row
from scope_ptz.taskgen.importing.table import read_table

PAPER_COUNTS: dict[Category, int] = {
    "counting": 95, "descriptor": 89, "location": 53, "ocr": 54, "single_call": 72, "multi_step_command": 57,
    "multi_step_reasoning": 54, "comparative": 62,
}  # fmt: skip
"""As the paper states them, for comparison."""

_MOST_LISTED = 12
_NAMING_LINES: frozenset[FindingKind] = frozenset({"duplicate", "contradiction", "same-at-every-preset", "id-repeated"})
"""Findings whose detail names the lines itself."""


@dataclass(frozen=True)
class Imported:
    """``findings`` by line, of every row; ``ids`` likewise; ``tasks``: the rows that can be run, in the file's order."""

    source: str
    encoding: str
    notes: tuple[str, ...]
    rows: tuple[RowRead, ...]
    ids: dict[int, str]
    findings: dict[int, tuple[RowFinding, ...]]
    tasks: tuple[ImportedTask, ...]

    @property
    def left_out(self) -> tuple[RowRead, ...]:
        """The rows that cannot be run."""
        ready = {task.line for task in self.tasks}
        return tuple(row for row in self.rows if row.line not in ready)

    def lines_with(self, kind: FindingKind) -> list[int]:
        """The lines of rows with a finding of a kind."""
        return [row.line for row in self.rows if any(finding.kind == kind for finding in self.findings[row.line])]

    def map_to_fill(self) -> dict[str, Any]:
        """What a mapping file would have to say so that rows find their scenes and presets: the names that are not known yet."""
        presets: dict[str, dict[str, str]] = {}
        for row in self.rows:
            if row.scene is not None and row.preset is None:
                presets.setdefault(row.scene, {})[row.place[1]] = ""
        return {"scenes": dict.fromkeys(sorted({row.place[0] for row in self.rows if row.scene is None}), ""), "presets": presets}

    def as_dict(self) -> dict[str, Any]:
        """As JSON data, every row with its cells."""
        ready = {task.line for task in self.tasks}
        return {
            "source": self.source,
            "encoding": self.encoding,
            "notes": list(self.notes),
            "rows": len(self.rows),
            "runnable": len(self.tasks),
            "left_out": len(self.rows) - len(self.tasks),
            "distinct_questions": len({tuple(comparable(row.question)) for row in self.rows}),
            "distinct_tasks": len({(tuple(comparable(row.question)), row.view) for row in self.rows}),
            "by_category": {
                name: {"rows": sum(row.category == name for row in self.rows), "paper": PAPER_COUNTS[name]}
                for name in get_args(Category)
            },
            "findings": {kind: self.lines_with(kind) for kind in MEANINGS if self.lines_with(kind)},
            "map_to_fill": self.map_to_fill(),
            "each": [
                {
                    "line": row.line,
                    "id": self.ids[row.line],
                    "runs": row.line in ready,
                    "findings": [finding.model_dump() for finding in self.findings[row.line]],
                    "cells": row.row.cells,
                    **({"extra_cells": list(row.row.extra)} if row.row.extra else {}),
                }
                for row in self.rows
            ],
        }


def import_file(path: Path, places: Places) -> Imported:
    """Read, map and check a file. Raises ``InputError`` when it cannot be read at all; rows never raise."""
    table = read_table(path)
    dataset = "imported-" + (re.sub(r"[^a-z0-9]+", "-", path.stem.lower()).strip("-")[:40] or "tasks")
    rows = tuple(read_row(row, places) for row in table.rows)
    ids = dict(zip((row.line for row in rows), ids_of([row.row for row in rows], dataset), strict=True))
    audited = audit(rows)
    findings = {row.line: (*row.findings, *audited.get(row.line, ())) for row in rows}
    tasks = (row.task(dataset, ids[row.line], places, findings[row.line]) for row in rows)
    return Imported(
        source=str(path),
        encoding=table.encoding,
        notes=table.notes,
        rows=rows,
        ids=ids,
        findings=findings,
        tasks=tuple(task for task in tasks if task is not None),
    )


def report_lines(imported: Imported) -> Iterator[str]:
    """The report as text: counts, what cannot be run and why, what is doubtful."""
    content = imported.as_dict()
    runs = f"{content['runnable']} can be run, {content['left_out']} cannot"
    yield f"{content['rows']} rows in {imported.source} ({imported.encoding}): {runs}"
    yield from (f"note: {note}" for note in imported.notes)
    yield f"{content['distinct_questions']} distinct questions, {content['distinct_tasks']} distinct questions about a view"
    yield ""
    yield f"{'category':<24}{'rows':>6}{'in the paper':>14}"
    for name, row in content["by_category"].items():
        yield f"{name:<24}{row['rows']:>6}{row['paper']:>14}"
    for title, kinds in (
        ("cannot be run", [kind for kind in MEANINGS if kind in BLOCKING]),
        ("is run as it stands, and is doubtful", [kind for kind in MEANINGS if kind not in BLOCKING]),
    ):
        if any(imported.lines_with(kind) for kind in kinds):
            yield ""
            yield title
        for kind in kinds:
            yield from _kind_lines(imported, kind)


def _kind_lines(imported: Imported, kind: FindingKind) -> Iterator[str]:
    lines = imported.lines_with(kind)
    if not lines:
        return
    yield f"  {len(lines):>5}  {kind}: {MEANINGS[kind]}"
    details: dict[str, list[int]] = {}
    for line in lines:
        for finding in imported.findings[line]:
            if finding.kind == kind:
                details.setdefault(finding.detail, []).append(line)
    often = sorted(details, key=lambda detail: -len(details[detail]))[:_MOST_LISTED]
    told = [detail if kind in _NAMING_LINES else f"{detail} ({_lines(details[detail])})" for detail in often if detail]
    yield from (f"         {''.join(c if c.isprintable() else ' ' for c in one)}" for one in told)
    if not told:
        yield f"         {_lines(lines)}"
    elif len(details) > _MOST_LISTED:
        yield f"         ... and {len(details) - _MOST_LISTED} more, in the report file"


def _lines(lines: Sequence[int]) -> str:
    """Line 7, or lines 2, 3, 5."""
    listed = ", ".join(map(str, lines[:_MOST_LISTED]))
    return f"line{'s' if len(lines) > 1 else ''} {listed}{' ...' if len(lines) > _MOST_LISTED else ''}"
