"""Report tables, and their conversion to text, Markdown and CSV."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from typing import Literal

from scope_ptz.bench.statistics.clustered import IntervalEstimate

MISSING = "not measured"
ColumnKind = Literal["text", "prose", "count", "share", "points", "width", "seconds", "number", "gb", "usd", "p", "ratio"]
"""Kinds of columns.

"prose": whole sentences; "share": a number from 0 to 1, shown in percent; "points": a signed difference, shown in percentage
points; "width": an unsigned difference, shown in percentage points.
"""


@dataclass(frozen=True, slots=True)
class MarkedCell:
    """A cell with marks, a link or a note.

    Attributes:
        value: The value.
        best: Whether the value is the best in its group.
        best_of_all: Whether the value is the best in the table.
        link: URL to which the value links; empty for none.
        note: Note after the value; empty for none.
    """

    value: str | int | float | IntervalEstimate | None
    best: bool = False
    best_of_all: bool = False
    link: str = ""
    note: str = ""


CellValue = str | int | float | IntervalEstimate | MarkedCell | None


@dataclass(frozen=True, slots=True)
class Column:
    """A table column. ``name`` is the header in CSV files, and ``title`` is the header on the page."""

    name: str
    title: str
    kind: ColumnKind = "text"

    @property
    def is_text(self) -> bool:
        """Whether the column contains text rather than numbers."""
        return self.kind in ("text", "prose")


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A table in a report.

    Attributes:
        key: Name of the CSV file, without its suffix.
        title: Title of the table.
        columns: The columns. The first column contains the row names.
        rows: The cells of each row.
        notes: Explanations below the table.
        groups: Headings between rows, by the index of the next row.
    """

    key: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[CellValue, ...], ...]
    notes: tuple[str, ...] = ()
    groups: dict[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"a row of table {self.key} must have {len(self.columns)} values; got {len(row)}")


def cell_value(value: CellValue) -> str | int | float | IntervalEstimate | None:
    """Return the value of a cell without marks."""
    return value.value if isinstance(value, MarkedCell) else value


def cell_text(value: CellValue, kind: ColumnKind) -> str:
    """Format a cell as text. A missing value becomes "not measured"."""
    plain = cell_value(value)
    if plain is None:
        return MISSING
    if isinstance(plain, str):
        return plain
    if isinstance(plain, IntervalEstimate):
        certainty = ", ".join(filter(None, interval_texts(plain, kind)))
        return f"{_number(plain.value, kind)} ({certainty})"
    return _number(plain, kind)


def interval_texts(estimate: IntervalEstimate, kind: ColumnKind) -> tuple[str, str]:
    """Return two texts, either of which may be empty: the interval of an estimate, and its limitation, such as omitted strata."""
    if estimate.low is None or estimate.high is None:
        return "", "interval unknown"
    omitted = ", ".join(name.replace("_", " ") for name in estimate.single_cluster_strata)
    return f"{_number(estimate.low, kind)} to {_number(estimate.high, kind)}", f"without {omitted}" if omitted else ""


def _number(value: float, kind: ColumnKind) -> str:
    match kind:
        case "share" | "width":
            return f"{100 * value:.1f}"
        case "points":
            return f"{100 * value + 0.0:+.1f}"
        case "seconds":
            return f"{value:.2f}" if value >= 0.01 or value == 0 else "< 0.01"
        case "gb":
            return f"{value:.1f}"
        case "usd":
            return f"{value:.4f}" if value < 1 else f"{value:,.2f}"
        case "p":
            return "< 0.001" if value < 0.001 else f"{value:.3f}"
        case "ratio":
            return f"{value:.2f}x"
        case "count":
            return f"{round(value):,}"
        case _:
            return f"{value:,}" if isinstance(value, int) else f"{value:.2f}"


def csv_text(table: ReportTable) -> str:
    """Convert a table to CSV (RFC 4180).

    Numbers have full precision, fractions range from 0 to 1, and missing values are empty. An estimate has three columns: value,
    low and high. If an interval omits strata, there is a fourth column.
    """
    columns = [[cell_value(row[index]) for row in table.rows] for index in range(len(table.columns))]
    suffixes = [_suffixes([cell for cell in cells if isinstance(cell, IntervalEstimate)]) for cells in columns]
    out = io.StringIO()
    writer = csv.writer(out)
    header = (["group"] if table.groups else []) + [
        name
        for column, additional in zip(table.columns, suffixes, strict=True)
        for name in (column.name, *(f"{column.name}_{suffix}" for suffix in additional))
    ]
    writer.writerow(header)
    group = ""
    for number, row in enumerate(table.rows):
        group = table.groups.get(number, group)
        cells: list[str | int | float | None] = [_escape_formula(group)] if table.groups else []
        for value, additional in zip(row, suffixes, strict=True):
            plain = cell_value(value)
            if isinstance(plain, IntervalEstimate):
                cells += [plain.value, plain.low, plain.high, " ".join(plain.single_cluster_strata)][: 1 + len(additional)]
            else:
                cells += [_escape_formula(plain) if isinstance(plain, str) else plain, *(None for _ in additional)]
        writer.writerow(cells)
    return out.getvalue()


def _suffixes(estimates: list[IntervalEstimate]) -> tuple[str, ...]:
    """Return the suffixes for the additional CSV columns of a column with estimates."""
    if not estimates:
        return ()
    return ("low", "high", "without") if any(estimate.single_cluster_strata for estimate in estimates) else ("low", "high")


def _escape_formula(text: str) -> str:
    """Add a leading apostrophe to text that a spreadsheet would interpret as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def markdown_text(table: ReportTable) -> str:
    """Convert a table to Markdown, with a heading and notes. All text is escaped."""
    lines = [f"### {escape(table.title)}", ""]
    lines += ["| " + " | ".join(escape(column.title) for column in table.columns) + " |"]
    lines += ["|" + "|".join("---" if column.is_text else "---:" for column in table.columns) + "|"]
    for number, row in enumerate(table.rows):
        if number in table.groups:
            lines.append(f"| **{escape(table.groups[number])}** |" + " |" * (len(table.columns) - 1))
        lines.append(
            "| " + " | ".join(_markdown_cell(value, column) for value, column in zip(row, table.columns, strict=True)) + " |"
        )
    return "\n".join([*lines, "", *(f"*{escape(note)}*\n" for note in table.notes)])


def _markdown_cell(value: CellValue, column: Column) -> str:
    text = escape(cell_text(value, column.kind))
    if isinstance(value, MarkedCell):
        text = f"[{text}]({value.link})" if value.link else text
        text = f"**{text}**" if value.best else text
        text = f"<u>{text}</u>" if value.best_of_all else text
        text = f"{text} {escape(value.note)}" if value.note else text
    return text


_SPECIAL = str.maketrans({mark: f"\\{mark}" for mark in "\\`*_{}[]()#+-!|~"} | {"&": "&amp;", "<": "&lt;", ">": "&gt;"})


def escape(text: str) -> str:
    """Escape text for Markdown, and join its lines."""
    plain = " ".join(text.split())
    return plain if plain.replace(".", "").replace(" ", "").isalnum() else plain.translate(_SPECIAL)
