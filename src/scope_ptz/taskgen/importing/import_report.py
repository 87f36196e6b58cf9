"""Import a file: convert every row to a task, or report why that is impossible."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from scope_ptz.bench.tasks.findings import BLOCKING, FINDING_DESCRIPTIONS, FindingKind, RowFinding
from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.task import Category
from scope_ptz.taskgen.importing.csv_table import read_table
from scope_ptz.taskgen.importing.row_checks import check_rows, normalised_words
from scope_ptz.taskgen.importing.row_reading import ParsedRow, parse_row, unique_ids
from scope_ptz.taskgen.importing.scene_names import SceneNames

PAPER_COUNTS: dict[Category, int] = {
    "counting": 95, "descriptor": 89, "location": 53, "ocr": 54, "single_call": 72, "multi_step_command": 57,
    "multi_step_reasoning": 54, "comparative": 62,
}  # fmt: skip
"""The paper's number of tasks per category, for comparison."""

_MAX_LISTED = 12  # maximum number of details, and of line numbers, per finding in the text report
_DETAIL_HAS_LINES: frozenset[FindingKind] = frozenset({"duplicate", "contradiction", "same-at-every-preset", "id-repeated"})
"""Types of findings whose detail already contains line numbers."""


@dataclass(frozen=True)
class ImportedFile:
    """An imported file.

    Attributes:
        source: Path of the file.
        encoding: Its encoding.
        notes: Notes for the user about unusual properties of the file.
        rows: All rows.
        ids: Task ids, by line.
        findings: Findings about each row, by line.
        tasks: The tasks from the rows that can be run, in file order.
    """

    source: str
    encoding: str
    notes: tuple[str, ...]
    rows: tuple[ParsedRow, ...]
    ids: dict[int, str]
    findings: dict[int, tuple[RowFinding, ...]]
    tasks: tuple[ImportedTask, ...]

    @property
    def not_runnable(self) -> tuple[ParsedRow, ...]:
        """The rows that cannot be run."""
        ready = {task.line for task in self.tasks}
        return tuple(row for row in self.rows if row.line not in ready)

    def lines_with_finding(self, kind: FindingKind) -> list[int]:
        """Return the line numbers of the rows with a given type of finding."""
        return [row.line for row in self.rows if any(finding.kind == kind for finding in self.findings[row.line])]

    def mapping_template(self) -> dict[str, Any]:
        """Return a template for a mapping file, with the names of scenes and presets that were not found."""
        presets: dict[str, dict[str, str]] = {}
        for row in self.rows:
            if row.scene is not None and row.preset is None:
                presets.setdefault(row.scene, {})[row.place[1]] = ""
        return {"scenes": dict.fromkeys(sorted({row.place[0] for row in self.rows if row.scene is None}), ""), "presets": presets}

    def as_dict(self) -> dict[str, Any]:
        """Return the report as JSON data, with the cells of every row."""
        ready = {task.line for task in self.tasks}
        return {
            "source": self.source,
            "encoding": self.encoding,
            "notes": list(self.notes),
            "rows": len(self.rows),
            "runnable": len(self.tasks),
            "left_out": len(self.rows) - len(self.tasks),
            "distinct_questions": len({tuple(normalised_words(row.question)) for row in self.rows}),
            "distinct_tasks": len({(tuple(normalised_words(row.question)), row.view) for row in self.rows}),
            "by_category": {
                name: {"rows": sum(row.category == name for row in self.rows), "paper": PAPER_COUNTS[name]}
                for name in get_args(Category)
            },
            "findings": {kind: self.lines_with_finding(kind) for kind in FINDING_DESCRIPTIONS if self.lines_with_finding(kind)},
            "map_to_fill": self.mapping_template(),
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


def import_file(path: Path, scene_names: SceneNames) -> ImportedFile:
    """Import a file. Rows that cannot be run are included in the result and do not raise an error.

    Raises:
        InputError: The file cannot be read.
    """
    table = read_table(path)
    dataset = "imported-" + (re.sub(r"[^a-z0-9]+", "-", path.stem.lower()).strip("-")[:40] or "tasks")
    rows = tuple(parse_row(row, scene_names) for row in table.rows)
    ids = dict(zip((row.line for row in rows), unique_ids([row.row for row in rows], dataset), strict=True))
    questionable = check_rows(rows)
    findings = {row.line: (*row.findings, *questionable.get(row.line, ())) for row in rows}
    tasks = (row.task(dataset, ids[row.line], scene_names, findings[row.line]) for row in rows)
    return ImportedFile(
        source=str(path),
        encoding=table.encoding,
        notes=(*table.notes, *_merged_notes(rows, scene_names)),
        rows=rows,
        ids=ids,
        findings=findings,
        tasks=tuple(task for task in tasks if task is not None),
    )


def _merged_notes(rows: Sequence[ParsedRow], scene_names: SceneNames) -> Iterator[str]:
    """Yield a note for each preset to which several presets in the file are mapped. Their answers cannot all be correct there."""
    for (scene, preset), names in scene_names.merged_presets(row.place for row in rows).items():
        yield f"{len(names)} presets in the file are mapped to the preset {preset} of {scene}: {'; '.join(names[:_MAX_LISTED])}"


def report_lines(imported: ImportedFile) -> Iterator[str]:
    """Yield the report as lines of text: counts, rows that cannot be run and why, and questionable rows."""
    content = imported.as_dict()
    runs = f"{content['runnable']} can be run, {content['left_out']} cannot"
    yield f"{content['rows']} rows in {imported.source} ({imported.encoding}): {runs}"
    yield from (f"note: {note}" for note in imported.notes)
    yield f"{content['distinct_questions']} distinct questions, {content['distinct_tasks']} distinct pairs of question and view"
    yield ""
    yield f"{'category':<24}{'rows':>6}{'in the paper':>14}"
    for name, row in content["by_category"].items():
        yield f"{name:<24}{row['rows']:>6}{row['paper']:>14}"
    for title, kinds in (
        ("cannot be run", [kind for kind in FINDING_DESCRIPTIONS if kind in BLOCKING]),
        ("can be run, but is questionable", [kind for kind in FINDING_DESCRIPTIONS if kind not in BLOCKING]),
    ):
        if any(imported.lines_with_finding(kind) for kind in kinds):
            yield ""
            yield title
        for kind in kinds:
            yield from _kind_lines(imported, kind)


def _kind_lines(imported: ImportedFile, kind: FindingKind) -> Iterator[str]:
    lines = imported.lines_with_finding(kind)
    if not lines:
        return
    yield f"  {len(lines):>5}  {kind}: {FINDING_DESCRIPTIONS[kind]}"
    details: dict[str, list[int]] = {}
    for line in lines:
        for finding in imported.findings[line]:
            if finding.kind == kind:
                details.setdefault(finding.detail, []).append(line)
    most_frequent = sorted(details, key=lambda detail: -len(details[detail]))[:_MAX_LISTED]
    listed = [
        detail if kind in _DETAIL_HAS_LINES else f"{detail} ({_line_text(details[detail])})" for detail in most_frequent if detail
    ]
    yield from (f"         {''.join(c if c.isprintable() else ' ' for c in one)}" for one in listed)
    if not listed:
        yield f"         {_line_text(lines)}"
    elif len(details) > _MAX_LISTED:
        yield f"         ... and {len(details) - _MAX_LISTED} more, in the report file"


def _line_text(lines: Sequence[int]) -> str:
    """Return "line 7" or "lines 2, 3, 5"."""
    listed = ", ".join(map(str, lines[:_MAX_LISTED]))
    return f"line{'s' if len(lines) > 1 else ''} {listed}{' ...' if len(lines) > _MAX_LISTED else ''}"
