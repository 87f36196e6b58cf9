"""Read CSV files with byte order marks, several encodings, four separators, blank lines and ragged rows."""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.errors import InputError

MOST_BYTES = 256 * 2**20
_LONGEST_CELL = 4 * 2**20  # characters
_SEPARATORS = ",;\t|"
_ENCODINGS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
REQUIRED = ("question", "expected_answer")


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the file.

    Attributes:
        line: The line on which it begins.
        cells: Stripped cells by column.
        extra: Cells beyond the header.
        short: Number of missing cells.
    """

    line: int
    cells: dict[str, str]
    extra: tuple[str, ...] = ()
    short: int = 0


@dataclass(frozen=True, slots=True)
class Table:
    """A file: its columns in lower case, its rows, notes on what is unusual about it, and its encoding."""

    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...]
    encoding: str


def read_table(path: Path) -> Table:
    """Read a CSV file.

    Raises:
        InputError: The file cannot be read, is not CSV, or lacks the columns that make a task.
    """
    text, encoding, notes = _text(path)
    separator = _separator(text)
    lines = _lines(text, separator, path)
    try:
        _, header = next(lines)
    except StopIteration:
        raise InputError(f"{path} is empty.") from None
    columns = [_plain(name) for name in header]
    missing = [name for name in REQUIRED if name not in columns]
    if missing:
        raise InputError(
            f"{path} has no column {' and no column '.join(missing)}; it has: {', '.join(columns)[:500]}. "
            "The paper's format has question_id, file_location, preset_start, question, expected_answer, eval_category, ..."
        )
    if repeated := sorted({name for name in columns if name and columns.count(name) > 1}):
        notes.append(f"columns that occur more than once (the first one is used): {', '.join(repeated)}")
    rows = tuple(_row(line, cells, columns) for line, cells in lines)
    if _open_quote(text, separator):
        notes.append("a quotation mark is never closed; the rows after it may have been read as one cell")
    return Table(tuple(columns), rows, tuple(notes), encoding)


def _text(path: Path) -> tuple[str, str, list[str]]:
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{path} is larger than {MOST_BYTES // 2**20} MB, which is too large for a file of tasks.")
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    marked = next((name for mark, name in _ENCODINGS if data.startswith(mark)), None)
    if marked is None and b"\0" in data[:65536]:
        raise InputError(f"{path} is not a CSV file: it contains null bytes. Save it as CSV in UTF-8.")
    try:
        name = marked or "utf-8"
        return data.decode(name), name, []
    except UnicodeDecodeError as error:
        if marked:
            raise InputError(f"{path} claims to be {name}, but is not: {error.reason} at byte {error.start}.") from error
        return (
            data.decode("cp1252", errors="replace"),
            "cp1252",
            ["the file is not UTF-8 and was read as Windows-1252; check accented letters"],
        )


def _separator(text: str) -> str:
    """Return the separator that splits the header into most columns."""
    header = next((line for line in text.splitlines() if line.strip()), "")
    return max(_SEPARATORS, key=lambda mark: (header.count(mark), -_SEPARATORS.index(mark)))


def _lines(text: str, separator: str, path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the rows that are not blank, each with the line on which it begins."""
    csv.field_size_limit(_LONGEST_CELL)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    began = 1
    while True:
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            raise InputError(f"{path}, line {reader.line_num}: {error}.") from error
        if any(cell.strip() for cell in cells):
            yield began, cells
        began = reader.line_num + 1


def _open_quote(text: str, separator: str) -> bool:
    try:
        for _ in csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True):
            pass
    except csv.Error as error:
        return "unexpected end" in str(error)
    return False


def _plain(name: str) -> str:
    """Return the name of a column in lower case, with underscores for spaces and hyphens."""
    return re.sub(r"[\s\-/.]+", "_", name.strip().lower()).strip("_")


def _row(line: int, cells: list[str], columns: list[str]) -> Row:
    named: dict[str, str] = {}
    for name, cell in zip(columns, cells, strict=False):
        if name:
            named.setdefault(name, cell.strip())
    extra = tuple(cell for cell in cells[len(columns) :] if cell.strip())
    return Row(line, {name: named.get(name, "") for name in columns if name}, extra, max(0, len(columns) - len(cells)))
