"""Drafts of a scripted model server: valid ones are kept, wrong and malicious ones are dropped with a reason."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.agent.records import RunLabels
from scope_ptz.bench.tasks.files import load_tasks
from scope_ptz.errors import InputError
from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
from scope_ptz.taskgen.generating.draft_schema import Draft, parse_draft, parse_reply, reply_schema
from scope_ptz.taskgen.generating.operator_runs import read_runs
from tests.cli.conftest import Scope, scenes, scope
from tests.support import misbehaving as m

__all__ = ["scenes", "scope"]

TO_YARD = {"moves": [{"preset": "yard"}]}
BALL, BLOCK, BOARD = {"category": "ball"}, {"category": "block"}, {"category": "board"}


def draft(instruction: str, category: str, program: str, expected: str, **extra: Any) -> dict[str, Any]:
    defaults: dict[str, Any] = {"start": "board", "views": [TO_YARD], "things": [BALL]}
    return {"instruction": instruction, "category": category, "program": program, "expected": expected, **defaults, **extra}


COUNT = draft("Go to the yard preset and count the balls.", "counting", "count", "3")
TURN_FROM_YARD = {"moves": [{"preset": "yard"}, {"pan_deg": 30.0}]}
GOOD = [
    COUNT,
    draft("From the yard preset turn thirty degrees right: how many balls?", "counting", "count", "two", views=[TURN_FROM_YARD]),
    draft(
        "Bring up the board preset and tell me what the board says.", "ocr", "text", "NO ENTRY",
        start="yard", views=[{"moves": [{"preset": "board"}]}], things=[BOARD],
    ),
    draft("In the yard view, are there more balls or more blocks?", "comparative", "most", "balls", things=[BALL, BLOCK]),
    draft("Pan left by 12 degrees.", "single_call", "action", "", start="yard", views=[{"moves": [{"pan_deg": -12.0}]}], things=[]),
]  # fmt: skip
BAD = {
    "the ground truth says": {**COUNT, "expected": "4"},
    "has no preset 'attic'": {**COUNT, "instruction": "Count the balls at attic.", "views": [{"moves": [{"preset": "attic"}]}]},
    "moves.0.preset": {**COUNT, "views": [{"moves": [{"preset": "../../etc/passwd"}]}]},
    "Extra inputs are not permitted": {**COUNT, "code": "__import__('os').system('touch owned')"},
    "cannot be printed": {**COUNT, "instruction": "Count the balls at yard.\x1b]0;owned\x07"},
    "does not say 25": {**COUNT, "views": [{"moves": [{"preset": "yard"}, {"pan_deg": 25.0}]}]},
    "does not name the preset 'yard'": {**COUNT, "instruction": "Count the balls there."},
    "does not name the ball": {**COUNT, "instruction": "Count the cars at yard."},
    "no 'dragon'": {**COUNT, "instruction": "Count the dragons at yard.", "things": [{"category": "dragon"}]},
    "is not allowed in the category": {**COUNT, "category": "ocr"},
    "either name a preset": {**COUNT, "views": [{"moves": [{"preset": "yard", "pan_deg": 3.0}]}]},
    "beyond the camera's limits": {
        **COUNT, "instruction": "Tilt down 60 at yard and count the balls.",
        "views": [{"moves": [{"preset": "yard"}, {"tilt_deg": -60.0}]}],
    },
    "program: Input should be": {**COUNT, "program": "exec"},
    "contains its answer": draft(
        "At the board preset, read the board that says NO ENTRY.", "ocr", "text", "NO ENTRY",
        start="yard", views=[{"moves": [{"preset": "board"}]}], things=[BOARD],
    ),
    "a sum would count it twice": draft(
        "Add up the blocks at yard and those seen after a turn of 30 degrees to the right.", "multi_step_reasoning", "sum", "3",
        views=[TO_YARD, {"moves": [{"pan_deg": 30.0}]}], things=[BLOCK],
    ),
    "does not say that it is about everything around": {**COUNT, "views": [{**TO_YARD, "sweep": True}]},
    "Input should be": "count the balls",
}  # fmt: skip
NEAR_DUPLICATE = {**COUNT, "instruction": "Please go to the yard preset and count the balls."}
WANT_OPTIONS = ("--want", "counting=2", "--want", "ocr=1", "--want", "comparative=1", "--want", "single_call=1")


def reply_with_drafts(*drafts: Any) -> m.Behaviour:
    return m.good(m.Say(json.dumps({"drafts": drafts})))


@pytest.mark.full
def test_good_drafts_are_kept_and_no_request_is_repeated(scope: Scope, tmp_path: Path) -> None:
    out = tmp_path / "made"
    more = [draft("Look at the yard preset: is there a ball?", "descriptor", "exists", "yes")]
    with m.Misbehaving(
        [reply_with_drafts(*GOOD, NEAR_DUPLICATE, COUNT), m.good(m.Say("Sorry, no.")), reply_with_drafts(*more)]
    ) as server:
        options = ("bench", "generate", "--scene", "analytic-yard", "--url", server.url, "--model", "drafter", "--out", str(out))
        first = scope(*options, *WANT_OPTIONS, "--requests", "1")
        assert first.code == 0, first.err
        second = scope(*options, *WANT_OPTIONS, "--want", "descriptor=1", "--requests", "3")
        assert second.code == 0, second.err
        third = scope(*options, *WANT_OPTIONS, "--requests", "3")
        assert third.code == 0 and len(server.requests) == 3
    tasks = load_tasks(out / "tasks.jsonl")
    assert [task.category for task in tasks] == ["counting", "counting", "ocr", "comparative", "single_call", "descriptor"]
    assert [task.expected.model_dump().get("value") for task in tasks] == [3.0, 2.0, None, "balls", None, True]
    assert all(task.scene == "analytic-yard" and "generated" in task.tags for task in tasks)
    fates = [entry.fate for entry in DraftLedger(out).entries]
    assert fates == ["kept"] * 5 + ["dropped", "dropped", "no reply", "kept"]
    review = (out / "review.md").read_text()
    assert "- [ ] scope1-analytic-yard-generated-ocr-003" in review and "no more tasks of the category counting" in review
    assert "generate" not in first.err or "request 1: 5 kept, 2 dropped" in first.err


def test_content_of_the_prompt(scope: Scope, tmp_path: Path) -> None:
    with m.Misbehaving([reply_with_drafts(GOOD[4])]) as server:
        result = scope(
            "bench", "generate", "--scene", "analytic-yard", "--url", server.url, "--out", str(tmp_path / "made"),
            "--model", "drafter", "--want", "single_call=1",
        )  # fmt: skip
    assert result.code == 0, result.err
    (request,) = server.requests
    content = json.loads(request.data["messages"][1]["content"])
    assert content["inventory"]["ball"] == {"no colour": 5}
    assert content["absent from the whole scene"] == ["zebra"]
    (yard,) = [view for view in content["views"] if view["preset"] == "yard"]
    assert yard["surely shows"]["ball"] == 3 and yard["changes"]["pan +30"]["ball"] == "3 -> 2"
    assert yard["texts that can be read"] == ["NO ENTRY"]
    assert content["wanted"] == {"single_call": {"drafts": 1, "programs": ["action"]}}
    assert request.data["response_format"]["json_schema"]["schema"] == reply_schema()


def test_wrong_and_malicious_drafts_are_dropped_with_a_reason(scope: Scope, tmp_path: Path) -> None:
    out, rows = tmp_path / "made", list(BAD.values())
    with m.Misbehaving([reply_with_drafts(COUNT, *rows[:9]), reply_with_drafts(NEAR_DUPLICATE, *rows[9:])]) as server:
        result = scope(
            "bench", "generate", "--scene", "analytic-yard", "--url", server.url, "--model", "drafter", "--out", str(out),
            "--want", "counting=5", "--want", "ocr=5", "--want", "multi_step_reasoning=5", "--requests", "2",
        )  # fmt: skip
        content = json.loads(server.requests[1].data["messages"][1]["content"])
    assert result.code == 1 and "still missing: 4 of counting" in result.err
    entries = DraftLedger(out).entries
    assert [entry.fate for entry in entries] == ["kept", *["dropped"] * 9, "near-duplicate", *["dropped"] * (len(rows) - 9)]
    reasons = [entry.reason for entry in entries if entry.fate == "dropped"]
    assert [expected_reason for expected_reason, reason in zip(BAD, reasons, strict=True) if expected_reason not in reason] == []
    assert any("does not name the ball" in reason for reason in content["why earlier drafts were dropped"])
    assert {path.name for path in out.iterdir()} == {"drafts.jsonl", "tasks.jsonl", "review.md"}
    assert not (tmp_path / "owned").exists()
    assert "\x1b" not in (out / "review.md").read_text()


def test_unusable_replies_end_generation_without_losing_tasks(scope: Scope, tmp_path: Path) -> None:
    out = tmp_path / "made"
    with m.Misbehaving(
        [reply_with_drafts(COUNT), m.good(m.Say("no")), m.good(m.Say("[")), m.good(m.Say('{"drafts": 3}'))]
    ) as server:
        result = scope(
            "bench", "generate", "--scene", "analytic-yard", "--url", server.url, "--model", "drafter", "--out", str(out),
            "--want", "counting=5",
        )  # fmt: skip
    assert result.code == 1 and "3 consecutive requests returned no drafts" in result.err
    assert len(load_tasks(out / "tasks.jsonl")) == 1


@pytest.mark.parametrize("want", ["counting", "sums=3", "counting=0", "counting=-1"])
def test_an_invalid_number_of_tasks_is_reported(scope: Scope, tmp_path: Path, want: str) -> None:
    result = scope(
        "bench", "generate", "--scene", "analytic-yard", "--url", "http://127.0.0.1:9/v1", "--out", str(tmp_path), "--want", want
    )
    assert result.code == 2 and "counting=5" in result.err


def test_replies_may_be_fenced_or_a_bare_list() -> None:
    assert parse_reply(f"```json\n{json.dumps([COUNT])}\n```") == [COUNT]
    assert isinstance(parse_draft(COUNT), Draft)
    with pytest.raises(ValueError, match="not JSON"):
        parse_reply("[" * 100_000)
    with pytest.raises(ValueError, match="longer"):
        parse_reply("x" * 300_000)
    assert "instruction" in str(parse_draft({**COUNT, "instruction": ["a"]}))
    assert "pan_deg" in str(parse_draft({**COUNT, "views": [{"moves": [{"pan_deg": float("nan")}]}]}))


def test_operator_runs_are_summarised_with_their_feedback(scope: Scope, tmp_path: Path) -> None:
    result = scope("ask", "count the balls", "--scene", "analytic-yard", "--json")
    assert result.code == 0, result.err
    (run,) = (tmp_path / "runs").iterdir()
    feedback = tmp_path / "feedback.jsonl"
    feedback.write_text(json.dumps({"run": run.name, "rating": "bad", "note": "It missed one."}) + "\n")
    (operator_run,) = read_runs(tmp_path / "runs", feedback)
    assert operator_run.summary()["asked"] == "count the balls" and operator_run.summary()["operator said"] == "bad: It missed one."
    assert operator_run.trace.started.labels == RunLabels(perception_note=operator_run.trace.started.labels.perception_note, seed=0)
    feedback.write_text(json.dumps({"run": "../elsewhere", "rating": "bad"}) + "\n")
    with pytest.raises(InputError, match="not in"):
        read_runs(tmp_path / "runs", feedback)
    feedback.write_text('{"run": "x", "rating": "fine"}\n')
    with pytest.raises(InputError, match="line 1: rating"):
        read_runs(tmp_path / "runs", feedback)
