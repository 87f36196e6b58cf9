"""Verdicts are parsed strictly: invalid replies are never accepted."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.judging.judge_replies import MAX_REASON_CHARS, REPLY_SCHEMA, JudgeReply, parse_judge_reply
from scope_ptz.bench.scoring.error_modes import ErrorMode
from tests.bench.judging.runs import CORRECT, MISCOUNTED, written


@pytest.mark.parametrize(
    "text",
    [
        written(MISCOUNTED),
        f"```json\n{written(MISCOUNTED)}\n```",
        f"The count differs. {written(MISCOUNTED)} That is all.",
        written({**MISCOUNTED, "confidence": 0.9}),
        written({**MISCOUNTED, "verdict": " Incorrect", "error_mode": "VLM_COUNTING"}),
        f"{written(MISCOUNTED)}\n{written(MISCOUNTED)}",
        f'I would not say {{this}} or {{"a": 1}}. {written(MISCOUNTED)}',
    ],
)
def test_verdicts_with_surrounding_text(text: str) -> None:
    assert parse_judge_reply(text) == JudgeReply(
        verdict="incorrect", error_mode=ErrorMode.VLM_COUNTING, reason="The tool counted 4, expected 5."
    )


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "empty"),
        ("  \n", "empty"),
        ("The run is correct.", "no JSON object with a verdict"),
        ('{"verdict": "correct", "error_mode": "none", "reason": "cut o', "no JSON object"),
        ("[]", "no JSON object"),
        (written([CORRECT, {**CORRECT, "verdict": "wrong"}]), "verdict"),
        (written({**CORRECT, "error_mode": "scope"}), "a correct run has no error mode"),
        (written({**MISCOUNTED, "error_mode": "none"}), "exactly one error mode"),
        (written({**MISCOUNTED, "error_mode": None}), "exactly one error mode"),
        (written({**MISCOUNTED, "error_mode": ["scope", "tool_args"]}), "error_mode"),
        (written({**MISCOUNTED, "error_mode": "bad luck"}), "error_mode"),
        (written({"verdict": "correct", "reason": "fine"}), "error_mode"),
        (written({**CORRECT, "verdict": True}), "verdict"),
        (written({**CORRECT, "verdict": "partially correct"}), "verdict"),
        (written({**CORRECT, "reason": " "}), "reason"),
        (written({"verdict": "correct", "error_mode": "none"}), "reason"),
        (f"{written(CORRECT)} or rather {written(MISCOUNTED)}", "several different verdicts"),
        ('{"verdict": "incorrect", "verdict": "correct", "error_mode": "none", "reason": "x"}', "no JSON object"),
        ("{" * 5000, "no JSON object"),
        ('{"verdict":' * 3000, "no JSON object"),
    ],
)
def test_invalid_verdicts(text: str, problem: str) -> None:
    read = parse_judge_reply(text)
    assert isinstance(read, str)
    assert problem in read


def test_a_long_reason_is_truncated() -> None:
    read = parse_judge_reply(written({**CORRECT, "reason": "very " * 1000}))
    assert isinstance(read, JudgeReply)
    assert len(read.reason) == MAX_REASON_CHARS


@given(st.text())
def test_text_alone_never_gives_a_verdict(text: str) -> None:
    assert isinstance(parse_judge_reply(text), str)


@given(st.sampled_from([*ErrorMode, None]), st.sampled_from(["correct", "incorrect"]), st.text(min_size=1))
def test_any_reply_within_the_schema_is_parsed_or_refused_for_one_reason(mode: ErrorMode | None, verdict: str, reason: str) -> None:
    read = parse_judge_reply(json.dumps({"reason": reason, "verdict": verdict, "error_mode": mode.value if mode else "none"}))
    consistent = (mode is None) == (verdict == "correct")
    assert isinstance(read, JudgeReply) == (consistent and bool(" ".join(reason.split())))


def test_the_schema_lists_all_modes_and_forbids_additional_fields() -> None:
    modes = REPLY_SCHEMA["properties"]["error_mode"]["enum"]
    assert modes == [*ErrorMode, "none"]
    assert REPLY_SCHEMA["additionalProperties"] is False
    assert set(REPLY_SCHEMA["required"]) == set(REPLY_SCHEMA["properties"])
