"""The tables of a report, and their output as text, Markdown and CSV."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from typing import Literal

from scope_ptz.bench.statistics.clustered import IntervalEstimate

MISSING = "not measured"
ColumnKind = Literal["text", "prose", "count", "share", "points", "width", "seconds", "number", "gb", "usd", "p", "ratio"]
"""Kinds of columns. "prose": text of a sentence or more; "share": 0 to 1, shown in percent; "points": a difference in percentage
points; "width": the same without a sign."""


@dataclass(frozen=True, slots=True)
class MarkedCell:
    """A value with marks.

    Attributes:
        value: The value.
        best: Whether it is the best of its group.
        best_of_all: Whether it is the best of the table.
        link: Address of a page.
        note: A remark, which is shown next to the value.
    """

    value: str | int | float | IntervalEstimate | None
    best: bool = False
    best_of_all: bool = False
    link: str = ""
    note: str = ""


CellValue = str | int | float | IntervalEstimate | MarkedCell | None


@dataclass(frozen=True, slots=True)
class Column:
    """A column. ``name`` is its header in CSV files, ``title`` its header on the page."""

    name: str
    title: str
    kind: ColumnKind = "text"

    @property
    def worded(self) -> bool:
        """Whether the column contains text, not numbers."""
        return self.kind in ("text", "prose")


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A table.

    Attributes:
        key: Name of its CSV file.
        title: Its title.
        columns: The columns. The first one names the row.
        rows: The cells of each row.
        notes: Explanations below the table.
        groups: Headings, by the index of the row that they precede.
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
                raise ValueError(f"table {self.key}: a row of {len(row)} values for {len(self.columns)} columns")


def unmarked(value: CellValue) -> str | int | float | IntervalEstimate | None:
    """Return a value without its marks."""
    return value.value if isinstance(value, MarkedCell) else value


def in_words(value: CellValue, kind: ColumnKind) -> str:
    """Return a cell as text. A missing value is "not measured"."""
    plain = unmarked(value)
    if plain is None:
        return MISSING
    if isinstance(plain, str):
        return plain
    if isinstance(plain, IntervalEstimate):
        certainty = ", ".join(filter(None, interval(plain, kind)))
        return f"{_number(plain.value, kind)} ({certainty})"
    return _number(plain, kind)


def interval(found: IntervalEstimate, kind: ColumnKind) -> tuple[str, str]:
    """Return the interval of an estimate as text (empty if there is none), and its limitation."""
    if found.low is None or found.high is None:
        return "", "interval unknown"
    lacking = ", ".join(name.replace("_", " ") for name in found.without)
    return f"{_number(found.low, kind)} to {_number(found.high, kind)}", f"without {lacking}" if lacking else ""


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


def as_csv(table: ReportTable) -> str:
    """Return a table as CSV (RFC 4180).

    Numbers have full precision, shares are 0 to 1, missing values are empty. An estimate takes three columns, and a fourth one if
    its interval leaves out some strata.
    """
    cells_of = [[unmarked(row[index]) for row in table.rows] for index in range(len(table.columns))]
    suffixes = [_suffixes([cell for cell in cells if isinstance(cell, IntervalEstimate)]) for cells in cells_of]
    out = io.StringIO()
    writer = csv.writer(out)
    heads = (["group"] if table.groups else []) + [
        name
        for column, further in zip(table.columns, suffixes, strict=True)
        for name in (column.name, *(f"{column.name}_{suffix}" for suffix in further))
    ]
    writer.writerow(heads)
    group = ""
    for number, row in enumerate(table.rows):
        group = table.groups.get(number, group)
        cells: list[str | int | float | None] = [_without_formula(group)] if table.groups else []
        for value, further in zip(row, suffixes, strict=True):
            plain = unmarked(value)
            if isinstance(plain, IntervalEstimate):
                cells += [plain.value, plain.low, plain.high, " ".join(plain.without)][: 1 + len(further)]
            else:
                cells += [_without_formula(plain) if isinstance(plain, str) else plain, *(None for _ in further)]
        writer.writerow(cells)
    return out.getvalue()


def _suffixes(estimates: list[IntervalEstimate]) -> tuple[str, ...]:
    """Return the suffixes of the additional CSV columns of estimates."""
    if not estimates:
        return ()
    return ("low", "high", "without") if any(found.without for found in estimates) else ("low", "high")


def _without_formula(text: str) -> str:
    """Return text that a spreadsheet does not interpret as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def as_markdown(table: ReportTable) -> str:
    """Return a Markdown table with its heading and notes. All text is escaped."""
    lines = [f"### {escape(table.title)}", ""]
    lines += ["| " + " | ".join(escape(column.title) for column in table.columns) + " |"]
    lines += ["|" + "|".join("---" if column.worded else "---:" for column in table.columns) + "|"]
    for number, row in enumerate(table.rows):
        if number in table.groups:
            lines.append(f"| **{escape(table.groups[number])}** |" + " |" * (len(table.columns) - 1))
        lines.append(
            "| " + " | ".join(_markdown_cell(value, column) for value, column in zip(row, table.columns, strict=True)) + " |"
        )
    return "\n".join([*lines, "", *(f"*{escape(note)}*\n" for note in table.notes)])


def _markdown_cell(value: CellValue, column: Column) -> str:
    words = escape(in_words(value, column.kind))
    if isinstance(value, MarkedCell):
        words = f"[{words}]({value.link})" if value.link else words
        words = f"**{words}**" if value.best else words
        words = f"<u>{words}</u>" if value.best_of_all else words
        words = f"{words} {escape(value.note)}" if value.note else words
    return words


_SPECIAL = str.maketrans({mark: f"\\{mark}" for mark in "\\`*_{}[]()#+-!|~"} | {"&": "&amp;", "<": "&lt;", ">": "&gt;"})


def escape(text: str) -> str:
    """Escape text for Markdown and join it into one line."""
    plain = " ".join(text.split())
    return plain if plain.replace(".", "").replace(" ", "").isalnum() else plain.translate(_SPECIAL)
