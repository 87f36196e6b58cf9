"""A table as data, and its cells in words. Page, Markdown and CSV are all made from the same tables, so that they cannot differ."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from typing import Literal

from scope_ptz.bench.statistics.clustered import IntervalEstimate

MISSING = "not measured"
ColumnKind = Literal["text", "prose", "count", "share", "points", "width", "seconds", "number", "gb", "usd", "p", "ratio"]
"""``prose``: text of a sentence or more;
``share``: 0..1, shown in percent; ``points``: a difference, in percentage points; ``width``: that without a sign."""


@dataclass(frozen=True, slots=True)
class MarkedCell:
    """A value with what the page adds to it. ``best``: in its group; ``best_of_all``: in the table; ``link``: a page."""

    value: str | int | float | IntervalEstimate | None
    best: bool = False
    best_of_all: bool = False
    link: str = ""
    note: str = ""


CellValue = str | int | float | IntervalEstimate | MarkedCell | None


@dataclass(frozen=True, slots=True)
class Column:
    """``name`` heads the column of the CSV, ``title`` that of the page."""

    name: str
    title: str
    kind: ColumnKind = "text"

    @property
    def worded(self) -> bool:
        """Whether it holds words, not figures."""
        return self.kind in ("text", "prose")


@dataclass(frozen=True, slots=True)
class ReportTable:
    """``key``: its file name; ``notes``: how to read it. The first column names the row."""

    key: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[CellValue, ...], ...]
    notes: tuple[str, ...] = ()
    groups: dict[int, str] = field(default_factory=dict)
    """Headings before rows, by the number of the row."""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"table {self.key}: a row of {len(row)} values for {len(self.columns)} columns")


def unmarked(value: CellValue) -> str | int | float | IntervalEstimate | None:
    """A value without its marks."""
    return value.value if isinstance(value, MarkedCell) else value


def in_words(value: CellValue, kind: ColumnKind) -> str:
    """A cell as a person reads it; what is missing is said to be."""
    plain = unmarked(value)
    if plain is None:
        return MISSING
    if isinstance(plain, str):
        return plain
    if isinstance(plain, IntervalEstimate):
        told = ", ".join(filter(None, interval(plain, kind)))
        return f"{_number(plain.value, kind)} ({told})"
    return _number(plain, kind)


def interval(found: IntervalEstimate, kind: ColumnKind) -> tuple[str, str]:
    """The interval of an estimate in words, empty where there is none; and what must be known of it."""
    if found.low is None or found.high is None:
        return "", "interval not known"
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
    """RFC 4180, numbers in full precision, shares as 0..1, missing values empty. Estimates take three columns, and a fourth where
    an interval is without some strata."""
    cells_of = [[unmarked(row[index]) for row in table.rows] for index in range(len(table.columns))]
    endings = [_endings([cell for cell in cells if isinstance(cell, IntervalEstimate)]) for cells in cells_of]
    out = io.StringIO()
    writer = csv.writer(out)
    heads = (["group"] if table.groups else []) + [
        name
        for column, further in zip(table.columns, endings, strict=True)
        for name in (column.name, *(f"{column.name}_{ending}" for ending in further))
    ]
    writer.writerow(heads)
    group = ""
    for number, row in enumerate(table.rows):
        group = table.groups.get(number, group)
        cells: list[str | int | float | None] = [_inert(group)] if table.groups else []
        for value, further in zip(row, endings, strict=True):
            plain = unmarked(value)
            if isinstance(plain, IntervalEstimate):
                cells += [plain.value, plain.low, plain.high, " ".join(plain.without)][: 1 + len(further)]
            else:
                cells += [_inert(plain) if isinstance(plain, str) else plain, *(None for _ in further)]
        writer.writerow(cells)
    return out.getvalue()


def _endings(estimates: list[IntervalEstimate]) -> tuple[str, ...]:
    """The further columns that these estimates of one column take."""
    if not estimates:
        return ()
    return ("low", "high", "without") if any(found.without for found in estimates) else ("low", "high")


def _inert(text: str) -> str:
    """Text that a spreadsheet does not run as a formula, whatever a model wrote."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def as_markdown(table: ReportTable) -> str:
    """A pipe table with its heading and notes. Text is escaped, so that it is shown and never acts."""
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
    """Text for Markdown, on one line, without any meaning as markup."""
    plain = " ".join(text.split())
    return plain if plain.replace(".", "").replace(" ", "").isalnum() else plain.translate(_SPECIAL)
