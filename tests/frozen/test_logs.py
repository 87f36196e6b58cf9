"""Reading, rescoring, reporting and submitting the evaluation logs of version 0.1.0 gives the results of version 0.1.0."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest

from tests.frozen import adapter, cases

FAST_RESCORED_LOGS = ("agent",)


def with_current_error_modes(stored: dict[str, Any]) -> Any:
    """Return the stored evaluation with the error modes of the current rules, which do not blame exact perception."""
    modes = stored.get("rescored_error_modes", {})
    for trial in stored["evaluation"]["trials"]:
        trial["error_mode"] = modes.get(trial["task"]["id"], trial["error_mode"])
    return stored["evaluation"]


@pytest.mark.parametrize("name", cases.LOG_NAMES)
def test_reading_a_log_gives_the_stored_content(name: str) -> None:
    expected = cases.stored_result(f"logs/{name}.json")
    content = cases.log_content(name)
    assert content["evaluation"] == with_current_error_modes(expected)
    assert content["scores"] == expected["scores"]


@pytest.mark.parametrize(
    "name",
    [name if name in FAST_RESCORED_LOGS else pytest.param(name, marks=pytest.mark.full) for name in cases.LOG_NAMES],
)
def test_rescoring_checks_gives_the_stored_scores(name: str, tmp_path: Path) -> None:
    expected = cases.stored_result(f"logs/{name}.json")
    rescored = cases.rescored_log(name, tmp_path)
    assert rescored["scores"] == expected["rescored"]
    assert rescored["evaluation"] == with_current_error_modes(expected)


def test_a_judge_gets_the_stored_requests(tmp_path: Path) -> None:
    expected, found = cases.stored_result("judging.json"), cases.judge_results(tmp_path)
    assert found["systems"] == expected["systems"]
    assert found["requests"] == expected["requests"]
    assert found["judgements"] == expected["judgements"]
    assert found["scores"] == expected["scores"]


def test_report_tables_have_the_stored_cells(tmp_path: Path) -> None:
    """Later versions may add tables, and columns after the stored ones."""
    tables = cases.tables(tmp_path)
    stored = {path.name: path.read_text("utf-8") for path in (cases.DATA / "tables").glob("*.csv")}
    assert stored.keys() <= tables.keys()
    for name, text in stored.items():
        rows = list(csv.reader(io.StringIO(text)))
        assert [row[: len(rows[0])] for row in csv.reader(io.StringIO(tables[name]))] == rows, name


def test_making_a_submission_gives_the_stored_lines(tmp_path: Path) -> None:
    expected = [json.loads(line) for line in cases.SUBMISSION.read_text("utf-8").splitlines()]
    assert cases.submission(tmp_path / "submission.jsonl") == expected
    assert (tmp_path / "submission.jsonl").read_bytes() == cases.SUBMISSION.read_bytes()


def test_validating_a_submission_gives_the_stored_result(tmp_path: Path) -> None:
    assert cases.submission_checks(tmp_path) == cases.stored_result("submission.json")


def test_names_in_logs_are_registered() -> None:
    names = cases.names()
    assert names == cases.stored_result("names.json")
    for kind in ("task", "solver", "scorer", "metric"):
        for name in names[kind]:
            known = name if "/" in name else f"{adapter.PACKAGE}/{name}"
            assert adapter.resolves(kind, known), f"{kind} {known}"
    assert {name.partition("/")[0] for name in names["model"]} == {adapter.PACKAGE}
    assert adapter.resolves("modelapi", adapter.MODEL_PROVIDER)
