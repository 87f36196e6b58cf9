"""Submissions with traces: verdicts follow from traces, forgeries are detected, and private data is not published."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.signatures.detached import sign
from scope_ptz.bench.signatures.keys import generate_key, load_private_key, raw_bytes
from scope_ptz.bench.submissions.submission import remove_secrets, submission_schema
from scope_ptz.bench.submissions.submission_checks import check_submission
from scope_ptz.bench.submissions.submission_traces import MAX_TRACE_BYTES, pack_trace, public_trace, unpack_trace
from scope_ptz.bench.tasks.files import load_tasks
from scope_ptz.errors import InputError
from tests.bench.engine.conftest import log_copy, package_search_cache, scenes, scope, shared_log, tasks_file
from tests.bench.engine.editing import edit_log, records_of, set_trace
from tests.cli.conftest import Scope

__all__ = ["log_copy", "package_search_cache", "scenes", "scope", "shared_log", "tasks_file"]
pytestmark = [
    pytest.mark.full,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]
Rows = list[dict[str, Any]]


@pytest.fixture
def submission(scope: Scope, log_copy: Path, tasks_file: Path, tmp_path: Path) -> Path:
    out = tmp_path / "made.jsonl"
    run_result = scope("bench", "submission", "make", str(log_copy), "--out", str(out), "--tasks", str(tasks_file))
    assert run_result.code == 0, run_result.err
    return out


def rows_of(path: Path) -> Rows:
    return [json.loads(line) for line in path.read_text("utf-8").splitlines()]


def write_rows(rows: Rows, path: Path) -> Path:
    path.write_text("".join(json.dumps(row) + "\n" for row in rows), "utf-8")
    return path


def faults(path: Path, tasks_file: Path) -> str:
    return "\n".join(check_submission(path, load_tasks(tasks_file)).faults)


def test_a_submission_with_traces_is_valid_and_verified(scope: Scope, submission: Path, tasks_file: Path) -> None:
    header, *lines = rows_of(submission)
    assert (header["format"], header["evaluated"]) == (2, "self-reported")
    assert all(line["run"]["trace"] for line in lines)
    for row in (header, *lines):
        jsonschema.validate(row, submission_schema())
    run_result = scope("bench", "submission", "validate", str(submission), "--tasks", str(tasks_file), "--verify")
    assert run_result.code == 0, run_result.err
    assert (
        "valid, self-reported" in run_result.out
        and "4 of 4 runs verified" in run_result.out
        and "frames are not part" in run_result.out
    )


def test_a_submission_without_traces_is_valid_but_not_verifiable(
    scope: Scope, log_copy: Path, tasks_file: Path, tmp_path: Path
) -> None:
    out = tmp_path / "short.jsonl"
    run_result = scope("bench", "submission", "make", str(log_copy), "--out", str(out), "--tasks", str(tasks_file), "--no-traces")
    assert run_result.code == 0, run_result.err
    header, *lines = rows_of(out)
    assert header["format"] == 1 and "evaluated" not in header and not any("run" in line for line in lines)
    run_result = scope("bench", "submission", "validate", str(out), "--tasks", str(tasks_file), "--verify")
    assert run_result.code == 0 and "not verifiable" in run_result.out


def failed_line(rows: Rows) -> dict[str, Any]:
    return next(row for row in rows[1:] if row["headline"] == "incorrect")


def claim_success(rows: Rows) -> None:
    line = failed_line(rows)
    line |= {"headline": "correct", "error_mode": None, "checks": dict.fromkeys(line["checks"], True)}
    rows[0]["totals"] |= {"headlines": {"correct": 4}, "error_modes": {}}


def claim_answer(rows: Rows) -> None:
    failed_line(rows)["answer"] = "I see 7 blocks."


def claim_error_mode(rows: Rows) -> None:
    line = failed_line(rows)
    line["error_mode"] = "scope" if line["error_mode"] != "scope" else "vlm_query"
    rows[0]["totals"]["error_modes"] = {line["error_mode"]: 1}


def claim_speed(rows: Rows) -> None:
    rows[1]["times"] = dict.fromkeys(rows[1]["times"], 0.0)


def claim_another_model(rows: Rows) -> None:
    """Publish ground truth under the name of a model, which would be ranked."""
    rows[0]["card"]["perception"] |= {"name": "moondream3", "registry": "moondream3", "deterministic": False}


def no_trace(rows: Rows) -> None:
    del rows[1]["run"]


def damaged_trace(rows: Rows) -> None:
    rows[1]["run"]["trace"] = rows[1]["run"]["trace"][:-20]


def foreign_trace(rows: Rows) -> None:
    rows[1]["run"] = rows[2]["run"]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (claim_success, "headline does not follow from its trace"),
        (claim_answer, "answer does not follow from its trace"),
        (claim_error_mode, "error_mode does not follow from its trace"),
        (claim_speed, "times does not follow from its trace"),
        (claim_another_model, "the perception is moondream3 on the card, but ground-truth in 4 traces"),
        (no_trace, "it has no trace"),
        (damaged_trace, "its trace cannot be read"),
        (foreign_trace, "contradicts itself or its task"),
    ],
)
def test_lines_must_follow_from_their_traces(
    submission: Path, tasks_file: Path, tmp_path: Path, change: Callable[[Rows], None], text: str
) -> None:
    rows = rows_of(submission)
    change(rows)
    assert text in faults(write_rows(rows, tmp_path / "changed.jsonl"), tasks_file)


def test_the_same_trace_for_two_trials_is_a_fault(submission: Path, tasks_file: Path, tmp_path: Path) -> None:
    rows = rows_of(submission)
    rows[1]["run"] = rows[2]["run"]
    assert "have the same trace" in faults(write_rows(rows, tmp_path / "changed.jsonl"), tasks_file)


def test_verification_detects_a_consistent_forgery(scope: Scope, submission: Path, tasks_file: Path, tmp_path: Path) -> None:
    """The count, the reply, the answer and the line change together, so only repeating the call detects the forgery."""
    rows = rows_of(submission)
    line = failed_line(rows)
    text = unpack_trace(line["run"]["trace"])
    count = next(r for r in map(json.loads, text.splitlines()) if r["event"] == "call")["outcome"]["result"]["count"]
    records = [json.loads(row) for row in text.splitlines()]
    for record in records:
        if record["event"] == "call":
            record["outcome"]["result"]["count"] = 7
            boxes = record["replies"][0]["result"]["boxes"]
            boxes += [boxes[0]] * (7 - count)
        elif record["event"] == "decision" and record["decision"]["kind"] == "answered":
            record["decision"]["text"] = "There are 7 blocks."
        elif record["event"] == "end":
            record["text"] = "There are 7 blocks."
    line["run"]["trace"] = pack_trace("".join(json.dumps(record) + "\n" for record in records))
    line |= {
        "headline": "correct", "error_mode": None, "checks": dict.fromkeys(line["checks"], True), "answer": "There are 7 blocks.",
    }  # fmt: skip
    rows[0]["totals"] |= {"headlines": {"correct": 4}, "error_modes": {}}
    forged = write_rows(rows, tmp_path / "forged.jsonl")
    assert faults(forged, tasks_file) == ""
    run_result = scope("bench", "submission", "validate", str(forged), "--tasks", str(tasks_file), "--verify", "--json")
    assert run_result.code == 1
    result = json.loads(run_result.out)
    assert result["valid"] and result["verified"]["differs"] == 1 and result["verified"]["verified"] == 3


def test_a_log_that_contradicts_its_traces_cannot_be_submitted(
    scope: Scope, log_copy: Path, tasks_file: Path, tmp_path: Path
) -> None:
    log = edit_log(log_copy, tmp_path / "cut.eval", lambda sample: set_trace(sample, records_of(sample)[:-1]), [
        "scope1-analytic-yard-counting-001#1"
    ])  # fmt: skip
    run_result = scope("bench", "submission", "make", str(log), "--out", str(tmp_path / "x.jsonl"), "--tasks", str(tasks_file))
    assert run_result.code == 2 and "contradicts its traces" in run_result.err


SECRETS = (
    "sk-abcdefghijklmnopqrstuvwx", "hf_abcdefghijklmnopqrstuvwx", "http://10.0.0.7:8000/v1", "https://user:secret@host.example/x",
    "Bearer abcdefghijklmnopqrstuvwx",
)  # fmt: skip


@pytest.mark.parametrize("secret", SECRETS)
def test_traces_are_published_without_secrets_and_addresses(
    scope: Scope, log_copy: Path, tasks_file: Path, tmp_path: Path, secret: str
) -> None:
    def leak(sample: dict[str, Any]) -> None:
        records = records_of(sample)
        records[0]["planner_details"] = {"url": secret, "api_key": "hunter2hunter2", "temperature": "0"}
        records[0]["labels"]["perception_note"] = f"served at {secret}"
        records[1]["decision"]["thought"] = f"I use {secret} now"
        records[1]["decision"]["reasoning"] = f"{secret}"
        records[-1]["detail"] = f"Traceback: {secret}"
        set_trace(sample, records)

    log = edit_log(log_copy, tmp_path / "leaky.eval", leak, ["scope1-analytic-yard-counting-001#1"])
    out = tmp_path / "made.jsonl"
    run_result = scope("bench", "submission", "make", str(log), "--out", str(out), "--tasks", str(tasks_file))
    assert run_result.code == 0, run_result.err
    text = "".join(unpack_trace(row["run"]["trace"]) for row in rows_of(out)[1:])
    assert secret not in text and "hunter2" not in text and "10.0.0.7" not in text and "Traceback" not in text
    assert '"temperature": "0"' in text
    assert faults(out, tasks_file) == ""


@given(st.text(st.characters(codec="utf-8"), max_size=300))
def test_packing_keeps_text_without_secrets(text: str) -> None:
    line = json.dumps({"event": "end", "text": text, "detail": "x"}, ensure_ascii=False)
    (record,) = map(json.loads, unpack_trace(pack_trace(public_trace(line))).splitlines())
    assert record == {"event": "end", "text": remove_secrets(text), "detail": ""}


def test_a_trace_that_is_too_large_is_rejected() -> None:
    with pytest.raises(InputError, match="too large"):
        unpack_trace(pack_trace("0" * (MAX_TRACE_BYTES + 1)))
    for text in ("", "not base64!", "AAAA"):
        with pytest.raises(InputError):
            unpack_trace(text)


def test_hosted_needs_a_valid_signature(submission: Path, tasks_file: Path, tmp_path: Path) -> None:
    rows = rows_of(submission)
    rows[0]["evaluated"] = "hosted"
    path, tasks = write_rows(rows, tmp_path / "hosted.jsonl"), load_tasks(tasks_file)
    trusted = {raw_bytes(generate_key(tmp_path / "host.key")): "the operator"}
    check = check_submission(path, tasks, trusted)
    assert check.evaluated == "self-reported" and "no signature" in check.faults[0]
    sign(path, load_private_key(tmp_path / "host.key"))
    check = check_submission(path, tasks, trusted)
    assert (check.evaluated, check.faults) == ("hosted", ())
    assert any("signed by the operator" in note for note in check.notes)
    check = check_submission(path, tasks)
    assert check.evaluated == "self-reported" and "unknown key" in check.faults[0]
    path.write_bytes(path.read_bytes() + b"\n")
    check = check_submission(path, tasks, trusted)
    assert check.evaluated == "self-reported" and any("edited after it was signed" in fault for fault in check.faults)
