"""Read CSV files. Byte order marks, several encodings and separators, blank lines and rows of any length are supported."""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.errors import InputError

MAX_FILE_BYTES = 256 * 2**20
_MAX_CELL_CHARS = 4 * 2**20
_SEPARATORS = ",;\t|"
_ENCODINGS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
REQUIRED_COLUMNS = ("question", "expected_answer")


@dataclass(frozen=True, slots=True)
class Row:
    """A row in a CSV file.

    Attributes:
        line: Line number at which the row begins.
        cells: Cells by column, without surrounding whitespace.
        extra: Cells after the header's last column.
        missing: Number of missing cells.
    """

    line: int
    cells: dict[str, str]
    extra: tuple[str, ...] = ()
    missing: int = 0


@dataclass(frozen=True, slots=True)
class Table:
    """The content of a CSV file.

    Attributes:
        columns: Names of the columns, in lower case.
        rows: The rows, without blank ones.
        notes: Notes for the user about unusual properties of the file.
        encoding: The encoding in which the file was read.
    """

    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...]
    encoding: str


def read_table(path: Path) -> Table:
    """Read a CSV file.

    Raises:
        InputError: The file cannot be read, is not CSV, or lacks a required column.
    """
    text, encoding, notes = _read_text(path)
    separator = _find_separator(text)
    lines = _read_lines(text, separator, path)
    try:
        _, header = next(lines)
    except StopIteration:
        raise InputError(f"{path} is empty. Choose a CSV file with a header and one row for each task.") from None
    columns = [_normalise_column(name) for name in header]
    missing = [name for name in REQUIRED_COLUMNS if name not in columns]
    if missing:
        raise InputError(
            f"{path} has no column {' and no column '.join(missing)}; it has: {', '.join(columns)[:500]}. "
            "The paper's format has question_id, file_location, preset_start, question, expected_answer, eval_category, ..."
        )
    if repeated := sorted({name for name in columns if name and columns.count(name) > 1}):
        notes.append(f"columns that occur more than once (the first one is used): {', '.join(repeated)}")
    rows = tuple(_parse_row(line, cells, columns) for line, cells in lines)
    if _has_open_quote(text, separator):
        notes.append("a quotation mark is never closed; the rows after it may have been read as one cell")
    return Table(tuple(columns), rows, tuple(notes), encoding)


def _read_text(path: Path) -> tuple[str, str, list[str]]:
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise InputError(
                f"{path} is larger than {MAX_FILE_BYTES // 2**20} MB, the maximum for a task file. Check that it is the right file."
            )
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    bom_encoding = next((name for mark, name in _ENCODINGS if data.startswith(mark)), None)
    if bom_encoding is None and b"\0" in data[:65536]:
        raise InputError(f"{path} is not a CSV file: it contains null bytes. Save it as CSV in UTF-8.")
    try:
        name = bom_encoding or "utf-8"
        return data.decode(name), name, []
    except UnicodeDecodeError as error:
        if bom_encoding:
            raise InputError(
                f"{path} has the byte order mark of {name}, but is not valid {name}: {error.reason} at byte {error.start}. "
                "Save it as CSV in UTF-8."
            ) from error
        return (
            data.decode("cp1252", errors="replace"),
            "cp1252",
            ["the file is not UTF-8 and was read as Windows-1252; check accented letters"],
        )


def _find_separator(text: str) -> str:
    """Return the separator that splits the header into the most columns."""
    header = next((line for line in text.splitlines() if line.strip()), "")
    return max(_SEPARATORS, key=lambda mark: (header.count(mark), -_SEPARATORS.index(mark)))


def _read_lines(text: str, separator: str, path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the rows that are not blank, each with the line number at which it begins."""
    csv.field_size_limit(_MAX_CELL_CHARS)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    first_line = 1
    while True:
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            raise InputError(f"{path}, line {reader.line_num}: {error}.") from error
        if any(cell.strip() for cell in cells):
            yield first_line, cells
        first_line = reader.line_num + 1


def _has_open_quote(text: str, separator: str) -> bool:
    """Return whether a quotation mark is never closed."""
    try:
        for _ in csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True):
            pass
    except csv.Error as error:
        return "unexpected end" in str(error)
    return False


def _normalise_column(name: str) -> str:
    """Return a column name in lower case, with underscores instead of spaces, hyphens, slashes and dots."""
    return re.sub(r"[\s\-/.]+", "_", name.strip().lower()).strip("_")


def _parse_row(line: int, cells: list[str], columns: list[str]) -> Row:
    named: dict[str, str] = {}
    for name, cell in zip(columns, cells, strict=False):
        if name:
            named.setdefault(name, cell.strip())
    extra = tuple(cell for cell in cells[len(columns) :] if cell.strip())
    return Row(line, {name: named.get(name, "") for name in columns if name}, extra, max(0, len(columns) - len(cells)))
