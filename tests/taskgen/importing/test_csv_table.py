"""CSV files: everything readable is read, and everything else is reported."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.errors import InputError
from scope_ptz.taskgen.importing.csv_table import read_table
from scope_ptz.taskgen.importing.structured_cells import parse_cell

HEADER = "question_id,question,expected_answer"


def table(tmp_path: Path, content: bytes | str) -> Any:
    path = tmp_path / "tasks.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_table(path)


@pytest.mark.parametrize(
    "content",
    [
        f"{HEADER}\n1,How many?,5\n",
        f"\ufeff{HEADER}\r\n1,How many?,5\r\n".encode(),
        f"{HEADER}\n1,How many?,5\n".encode("utf-16"),
        "Question ID;Question;Expected-Answer\n1;How many?;5",
        "question_id\tquestion\texpected_answer\n1\tHow many?\t5\n",
        f'\n\n{HEADER}\n\n,,\n1,"How many?", 5 \n\n',
        '"question_id","question","expected_answer"\n"1","How many?","5"\n',
    ],
)
def test_many_formats_give_the_same_rows(tmp_path: Path, content: bytes | str) -> None:
    (row,) = table(tmp_path, content).rows
    assert row.cells == {"question_id": "1", "question": "How many?", "expected_answer": "5"}


def test_line_numbers_are_those_of_the_file(tmp_path: Path) -> None:
    parsed = table(tmp_path, f'{HEADER}\n\n1,"two\nlines, ""quoted""",5\n\n2,one,6\n')
    assert [row.line for row in parsed.rows] == [3, 6]
    assert parsed.rows[0].cells["question"] == 'two\nlines, "quoted"'


def test_ragged_rows_keep_all_cells(tmp_path: Path) -> None:
    long, short = table(tmp_path, f"{HEADER}\n1,a,b,c,d\n2,a\n").rows
    assert (long.extra, long.missing) == (("c", "d"), 0)
    assert (short.extra, short.missing) == ((), 1)
    assert short.cells["expected_answer"] == ""


def test_another_encoding_is_reported(tmp_path: Path) -> None:
    parsed = table(tmp_path, f"{HEADER}\n1,caf\xe9?,5\n".encode("cp1252"))
    assert parsed.rows[0].cells["question"] == "café?"
    assert parsed.encoding == "cp1252"
    assert any("Windows-1252" in note for note in parsed.notes)


def test_an_open_quotation_mark_is_reported(tmp_path: Path) -> None:
    parsed = table(tmp_path, f'{HEADER}\n1,"never closed,5\n2,x,6\n')
    assert any("never closed" in note for note in parsed.notes)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b"\n \n", "is empty"),
        (b"a,b\n1,2\n", "no column question"),
        (b"PK\x03\x04\0\0\0", "null bytes"),
        (b"\xff\xfe\xd8", "not valid utf-16"),
        (b"question,expected_answer\n" + b"x" * (5 * 2**20) + b",y\n", "line 2"),
    ],
)
def test_files_that_are_not_tables_of_tasks_are_rejected(tmp_path: Path, content: bytes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        table(tmp_path, content)


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_table(tmp_path / "none.csv")


CELL = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0\r\v\f\x1c\x1d\x1e\x85\u2028\u2029"), max_size=30)


@given(st.lists(st.tuples(CELL, CELL), max_size=6))
@settings(deadline=None, max_examples=60)
def test_output_of_a_csv_writer_is_read_back(tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[str, str]]) -> None:
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow(("question", "expected_answer"))
    writer.writerows(rows)
    parsed = table(tmp_path_factory.mktemp("csv"), out.getvalue())
    expected = [(a.strip(), b.strip()) for a, b in rows if a.strip() or b.strip()]
    assert [(row.cells["question"], row.cells["expected_answer"]) for row in parsed.rows] == expected
    assert len({row.line for row in parsed.rows}) == len(expected)


@given(st.binary(max_size=400))
@settings(deadline=None, max_examples=150)
def test_any_bytes_give_rows_or_one_clear_error(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    for start in (b"", b"question,expected_answer\n"):
        try:
            parsed = table(tmp_path_factory.mktemp("csv"), start + content)
        except InputError:
            continue
        assert {"question", "expected_answer"} <= set(parsed.columns)


@pytest.mark.parametrize(
    ("cell", "content"),
    [
        ("", None), ("[]", None), ("None", None), ("N/A", None), ("null", None),
        ('["a", "b"]', ["a", "b"]),
        ("['a', 'b']", ["a", "b"]),
        ("('a', 'b')", ["a", "b"]),
        ("{'a': {'x': 1, 'y': None, 'z': True}}", {"a": {"x": 1, "y": None, "z": True}}),
        ("{'a': true, 'b': null}", {"a": True, "b": None}),
        ('"[\\"a\\"]"', ["a"]),
        ("a -> b", ["a", "b"]), ("a, b", ["a", "b"]), ("a; b|c", ["a", "b", "c"]), ("a", ["a"]),
    ],
)  # fmt: skip
def test_structured_cells(cell: str, content: Any) -> None:
    assert parse_cell(cell) == content


@pytest.mark.parametrize(
    "cell", ["[broken", "{'a': }", "[__import__('os')]", "[" * 5000, "{'a': 1e999}", "[NaN]", "['a' for a in 'b']"]
)
def test_unreadable_cells_are_rejected(cell: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        parse_cell(cell)


LEAF = st.none() | st.booleans() | st.integers() | CELL


@given(st.recursive(LEAF, lambda inner: st.lists(inner) | st.dictionaries(CELL, inner), max_leaves=8))
def test_json_is_read_as_json_and_as_python(content: Any) -> None:
    if not isinstance(content, list | dict) or not content:
        return
    assert parse_cell(json.dumps(content)) == content
    assert parse_cell(repr(content)) == content
