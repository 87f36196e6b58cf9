"""Operators' runs become drafts: a rated run is exported and becomes a task, or is dropped with a reason."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.bench.tasks.files import load_tasks
from scope_ptz.store.feedback import add_feedback
from scope_ptz.store.run_store import RunStore
from scope_ptz.taskgen.generating.draft_schema import Draft, parse_draft
from tests.cli.conftest import Scope, scenes, scope

__all__ = ["scenes", "scope"]

CAMERA = "sim:analytic-yard"


def run_and_rate(scope: Scope, tmp_path: Path, *instructions: str, rating: int = 1) -> None:
    """Execute instructions, each from the home pose, and rate the runs."""
    for instruction in instructions:
        scope("ask", instruction, "--camera", CAMERA, "--json")
    with RunStore(tmp_path / "runs") as store:
        store.index()
        for run in store.runs().runs:
            if run.instruction in instructions:
                add_feedback(store.database, run.id, rating, "just right", actor="anna")


def export_drafts(scope: Scope, tmp_path: Path) -> list[dict[str, Any]]:
    """Export the drafts of all runs, oldest first."""
    result = scope("runs", "export", "--format", "drafts", "-o", str(tmp_path / "drafts.jsonl"), "--json")
    assert result.code == 0, result.err
    rows = [json.loads(line) for line in (tmp_path / "drafts.jsonl").read_text().splitlines()]
    assert result.json["runs"] == len(rows)
    return rows[::-1]


def test_a_good_run_becomes_a_task(scope: Scope, tmp_path: Path) -> None:
    run_and_rate(scope, tmp_path, "pan right by 30 degrees and count the balls", "pan left by 12 degrees")
    run_and_rate(scope, tmp_path, "go to the board preset", rating=-1)
    scope("ask", "go to the yard preset", "--camera", CAMERA, "--json")  # without feedback
    count, pan = export_drafts(scope, tmp_path)
    draft = parse_draft(count["draft"])
    assert isinstance(draft, Draft) and (draft.program, draft.category, count["note"]) == ("count", "counting", "just right")
    assert [move.pan_deg for move in draft.views[0].moves] == [30.0] and draft.things[0].category == "ball"
    assert pan["draft"]["program"] == "action" and pan["draft"]["category"] == "single_call"

    out = tmp_path / "made"
    result = scope("bench", "drafts", str(tmp_path / "drafts.jsonl"), "--out", str(out))
    assert result.code == 0, result.out + result.err
    tasks = {task.category: task for task in load_tasks(out / "tasks.jsonl")}
    assert set(tasks) == {"counting", "single_call"}
    assert tasks["counting"].expected.model_dump()["value"] == 2.0 and tasks["counting"].scene == "analytic-yard"
    assert "- [ ] scope1-analytic-yard-generated-counting-" in (out / "review.md").read_text()
    second = scope("bench", "drafts", str(tmp_path / "drafts.jsonl"), "--out", str(out), "--json")
    assert (second.code, second.json["new"], second.json["accepted"]) == (0, 0, 2)


def test_unusable_runs_are_dropped_with_a_reason(scope: Scope, tmp_path: Path) -> None:
    pointless = "go to the yard preset and count the balls"  # the camera is already there
    run_and_rate(scope, tmp_path, "take a picture", "go home", pointless)
    lines = {row["instruction"]: row for row in export_drafts(scope, tmp_path)}
    assert lines["take a picture"]["draft"] is None and "take_image" in lines["take a picture"]["reason"]
    assert "home" in lines["go home"]["reason"]
    wrong: dict[str, Any] = {"instruction": "Go to the yard preset and count the balls.", "category": "counting", "start": "board"}
    wrong |= {"views": [{"moves": [{"preset": "yard"}]}], "program": "count", "things": [{"category": "ball"}], "expected": "4"}
    with (tmp_path / "drafts.jsonl").open("a") as file:
        file.write(json.dumps({"run": "r", "scene": "analytic-yard", "draft": wrong}) + "\n")
        file.write(json.dumps({"run": "s", "scene": "elsewhere", "draft": {**wrong, "expected": "3"}}) + "\n")
    result = scope("bench", "drafts", str(tmp_path / "drafts.jsonl"), "--out", str(tmp_path / "made"), "--json")
    assert result.code == 1 and result.json["accepted"] == 0
    reasons = " | ".join(entry["reason"] for entry in result.json["drafts"])
    for text in ("no draft program calls take_image", "validation failed: stay", "the ground truth says", "no scene 'elsewhere'"):
        assert text in reasons


def test_a_rated_run_is_an_example_for_the_generator(scope: Scope, tmp_path: Path) -> None:
    """An export contains the feedback in the format that ``scope bench generate --feedback`` reads."""
    import zipfile

    from scope_ptz.taskgen.generating.operator_runs import read_runs

    run_and_rate(scope, tmp_path, "pan left by 12 degrees")
    assert scope("runs", "export", "--format", "zip", "-o", str(tmp_path / "runs.zip")).code == 0
    with zipfile.ZipFile(tmp_path / "runs.zip") as archive:
        archive.extractall(tmp_path / "out")
    (run,) = read_runs(tmp_path / "out", tmp_path / "out" / "feedback.jsonl")
    assert run.summary()["operator said"] == "good: just right"


@pytest.mark.parametrize("content", ["not json", '{"run": "x", "code": "y"}', '{"scene": "a"}'])
def test_a_wrong_file_is_reported(scope: Scope, tmp_path: Path, content: str) -> None:
    (tmp_path / "wrong.jsonl").write_text(content)
    result = scope("bench", "drafts", str(tmp_path / "wrong.jsonl"), "--out", str(tmp_path / "made"))
    assert result.code == 2 and "line 1" in result.err and "scope runs export --format drafts" in result.err
