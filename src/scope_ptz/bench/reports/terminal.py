"""The terminal summary of a report: problems, a table for choosing a pair, and the main results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scope_ptz.bench.reports.assemble import EvaluationReport
from scope_ptz.bench.reports.tables import CellValue, Column, cell_text, cell_value

TITLES = {
    "run": "Pair", "standing": "vs. highest", "macro": "Accuracy (%)", "corrected": "Corrected (%)", "latency_s": "s per turn",
    "p95_s": "p95", "memory_gb": "GB", "isolation": "Agent",
}  # fmt: skip
"""Short titles for the table columns that are shown in the terminal, by column name."""
MAX_ROWS = 25
"""Maximum number of table rows in the terminal. The report contains all rows."""
MAX_CELL_CHARS = 72
"""Maximum length of a cell's text in characters. Longer text is truncated."""


def terminal_lines(report: EvaluationReport) -> Iterator[str]:
    """Yield the lines to print: problems, the pairs to choose from, and the main results."""
    if report.notice:
        yield report.notice
    yield from report.contradictions
    yield from report.problems
    choice = report.sections[0]
    yield from choice.text
    (table,) = choice.tables
    selected = [index for index, column in enumerate(table.columns) if column.name in TITLES]
    selected = [i for i in selected if any(cell_value(row[i]) not in (None, "") for row in table.rows)]
    columns = [table.columns[index] for index in selected]
    rows = [[_text(row[i], c) for i, c in zip(selected, columns, strict=True)] for row in table.rows[:MAX_ROWS]]
    if rows:
        yield ""
        yield from _align_columns([[TITLES[c.name] for c in columns], *rows], [c.is_text for c in columns])
        if len(table.rows) > MAX_ROWS:
            yield f"and {len(table.rows) - MAX_ROWS} more in the report"
        yield ""
    yield from report.summary
    yield from report.warnings


def _text(value: CellValue, column: Column) -> str:
    return _shorten("-" if cell_value(value) is None else cell_text(value, column.kind))


def _shorten(text: str) -> str:
    printable = "".join(character if character.isprintable() else " " for character in text)
    return printable if len(printable) <= MAX_CELL_CHARS else printable[: MAX_CELL_CHARS - 1] + "…"


def _align_columns(rows: Sequence[Sequence[str]], is_text: Sequence[bool]) -> Iterator[str]:
    """Yield rows with aligned columns. Text is left-aligned, and numbers are right-aligned."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (c.ljust(w) if text else c.rjust(w) for c, w, text in zip(row, widths, is_text, strict=True))
        yield "  ".join(cells).rstrip()
