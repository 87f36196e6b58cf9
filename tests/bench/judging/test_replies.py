"""Verdicts are parsed strictly: invalid replies are never accepted."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.judging.judge_replies import MAX_REASON_CHARS, REPLY_SCHEMA, JudgeReply, parse_judge_reply
from scope_ptz.bench.scoring.error_modes import ErrorMode
from tests.bench.judging.runs import CORRECT, MISCOUNTED, json_text


@pytest.mark.parametrize(
    "text",
    [
        json_text(MISCOUNTED),
        f"```json\n{json_text(MISCOUNTED)}\n```",
        f"The count differs. {json_text(MISCOUNTED)} That is all.",
        json_text({**MISCOUNTED, "confidence": 0.9}),
        json_text({**MISCOUNTED, "verdict": " Incorrect", "error_mode": "VLM_COUNTING"}),
        f"{json_text(MISCOUNTED)}\n{json_text(MISCOUNTED)}",
        f'I would not say {{this}} or {{"a": 1}}. {json_text(MISCOUNTED)}',
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
        (json_text([CORRECT, {**CORRECT, "verdict": "wrong"}]), "verdict"),
        (json_text({**CORRECT, "error_mode": "scope"}), "a correct run has no error mode"),
        (json_text({**MISCOUNTED, "error_mode": "none"}), "exactly one error mode"),
        (json_text({**MISCOUNTED, "error_mode": None}), "exactly one error mode"),
        (json_text({**MISCOUNTED, "error_mode": ["scope", "tool_args"]}), "error_mode"),
        (json_text({**MISCOUNTED, "error_mode": "bad luck"}), "error_mode"),
        (json_text({"verdict": "correct", "reason": "fine"}), "error_mode"),
        (json_text({**CORRECT, "verdict": True}), "verdict"),
        (json_text({**CORRECT, "verdict": "partially correct"}), "verdict"),
        (json_text({**CORRECT, "reason": " "}), "reason"),
        (json_text({"verdict": "correct", "error_mode": "none"}), "reason"),
        (f"{json_text(CORRECT)} or rather {json_text(MISCOUNTED)}", "several different verdicts"),
        ('{"verdict": "incorrect", "verdict": "correct", "error_mode": "none", "reason": "x"}', "no JSON object"),
        ("{" * 5000, "no JSON object"),
        ('{"verdict":' * 3000, "no JSON object"),
    ],
)
def test_invalid_verdicts(text: str, problem: str) -> None:
    parsed = parse_judge_reply(text)
    assert isinstance(parsed, str)
    assert problem in parsed


def test_a_long_reason_is_truncated() -> None:
    parsed = parse_judge_reply(json_text({**CORRECT, "reason": "very " * 1000}))
    assert isinstance(parsed, JudgeReply)
    assert len(parsed.reason) == MAX_REASON_CHARS


@given(st.text())
def test_text_alone_never_gives_a_verdict(text: str) -> None:
    assert isinstance(parse_judge_reply(text), str)


@given(st.sampled_from([*ErrorMode, None]), st.sampled_from(["correct", "incorrect"]), st.text(min_size=1))
def test_any_reply_within_the_schema_is_parsed_or_refused_for_one_reason(mode: ErrorMode | None, verdict: str, reason: str) -> None:
    parsed = parse_judge_reply(json.dumps({"reason": reason, "verdict": verdict, "error_mode": mode.value if mode else "none"}))
    consistent = (mode is None) == (verdict == "correct")
    assert isinstance(parsed, JudgeReply) == (consistent and bool(" ".join(reason.split())))


def test_the_schema_lists_all_modes_and_forbids_additional_fields() -> None:
    modes = REPLY_SCHEMA["properties"]["error_mode"]["enum"]
    assert modes == [*ErrorMode, "none"]
    assert REPLY_SCHEMA["additionalProperties"] is False
    assert set(REPLY_SCHEMA["required"]) == set(REPLY_SCHEMA["properties"])
