"""The summary of a report for the terminal: problems, the table for choosing a pair, and the main results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scope_ptz.bench.reports.assemble import EvaluationReport
from scope_ptz.bench.reports.tables import CellValue, Column, cell_text, unmarked

TITLES = {
    "run": "Pair", "standing": "vs. highest", "macro": "Accuracy (%)", "corrected": "Corrected (%)", "latency_s": "s per turn",
    "p95_s": "p95", "memory_gb": "GB", "isolation": "Agent",
}  # fmt: skip
"""The columns of the table for choosing a pair that the terminal shows, with short titles."""
MAX_ROWS = 25
"""Maximum number of rows in the terminal. The report contains all of them."""
MAX_CELL_CHARS = 72
"""Longer texts are truncated."""


def terminal_lines(report: EvaluationReport) -> Iterator[str]:
    """Yield the lines that the command prints: what does not hold, which pair to choose, and the main results."""
    if report.notice:
        yield report.notice
    yield from report.contradictions
    yield from report.problems
    choice = report.sections[0]
    yield from choice.text
    (table,) = choice.tables
    selected = [index for index, column in enumerate(table.columns) if column.name in TITLES]
    selected = [i for i in selected if any(unmarked(row[i]) not in (None, "") for row in table.rows)]
    columns = [table.columns[index] for index in selected]
    rows = [[_text(row[i], c) for i, c in zip(selected, columns, strict=True)] for row in table.rows[:MAX_ROWS]]
    if rows:
        yield ""
        yield from _aligned([[TITLES[c.name] for c in columns], *rows], [c.is_text for c in columns])
        if len(table.rows) > MAX_ROWS:
            yield f"and {len(table.rows) - MAX_ROWS} more in the report"
        yield ""
    yield from report.summary
    yield from report.warnings


def _text(value: CellValue, column: Column) -> str:
    return _shortened("-" if unmarked(value) is None else cell_text(value, column.kind))


def _shortened(text: str) -> str:
    shown = "".join(mark if mark.isprintable() else " " for mark in text)
    return shown if len(shown) <= MAX_CELL_CHARS else shown[: MAX_CELL_CHARS - 1] + "…"


def _aligned(rows: Sequence[Sequence[str]], is_text: Sequence[bool]) -> Iterator[str]:
    """Yield rows with aligned columns: text to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (c.ljust(w) if text else c.rjust(w) for c, w, text in zip(row, widths, is_text, strict=True))
        yield "  ".join(cells).rstrip()
