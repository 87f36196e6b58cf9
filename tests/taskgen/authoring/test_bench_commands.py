"""``scope bench build``, ``validate`` and ``browse`` on the synthetic scene."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.bench.tasks.files import dump_tasks, load_tasks
from scope_ptz.taskgen.authoring.assembly import BuiltTasks
from tests.cli.conftest import Scope, scenes, scope

pytestmark = pytest.mark.full

__all__ = ["scenes", "scope"]


@pytest.fixture
def few_tasks(built_tasks: BuiltTasks, tmp_path: Path) -> Path:
    """Return a file with four tasks without twins."""
    core = [task for task in built_tasks.tasks if task.stratum == "core" and task.pair is None]
    path = tmp_path / "tasks.jsonl"
    dump_tasks([core[0], core[-1], next(t for t in core if t.category == "ocr"), next(t for t in core if not t.evidence)], path)
    return path


@pytest.mark.full
def test_build_writes_tasks_and_reports_the_shortfall(scope: Scope, tmp_path: Path) -> None:
    out = tmp_path / "made" / "tasks.jsonl"
    result = scope("bench", "build", "--scene", "analytic-yard", "--share", "0.03", "--out", str(out))
    assert len(load_tasks(out)) > 8
    assert "tasks in" in result.out
    assert (result.code == 1) == ("too few" in result.err)


@pytest.mark.full
def test_validate_prints_counts_and_passes(scope: Scope, few_tasks: Path) -> None:
    result = scope("bench", "validate", "--tasks", str(few_tasks))
    assert result.code == 0, result.out
    assert "sound" in result.out and "counting" in result.out and "stay" in result.out


def test_validate_fails_on_a_wrong_value(scope: Scope, few_tasks: Path) -> None:
    rows = [json.loads(line) for line in few_tasks.read_text().splitlines()]
    row = next(row for row in rows if row["category"] == "counting")
    row["expected"]["value"] = row["expected"].get("value", 0) + 3
    few_tasks.write_text("".join(json.dumps(row) + "\n" for row in rows))
    result = scope("bench", "validate", "--json", "--tasks", str(few_tasks))
    assert result.code == 1
    assert not result.json["sound"]
    assert result.json["faults"][0]["attempt"] == "truth"


def test_browse_shows_instruction_run_and_frames(scope: Scope, few_tasks: Path, tmp_path: Path) -> None:
    task = load_tasks(few_tasks)[0]
    result = scope("bench", "browse", task.id, "--tasks", str(few_tasks), "--out", str(tmp_path / "frames"))
    assert result.code == 0, result.err
    assert task.instruction in result.out and "verdict    correct" in result.out
    assert len(list((tmp_path / "frames").glob("*.png"))) == 1 + len(task.evidence)


def test_browse_rejects_an_unknown_task(scope: Scope, few_tasks: Path) -> None:
    result = scope("bench", "browse", "counting-999", "--tasks", str(few_tasks))
    assert result.code == 2
    assert "no task" in result.err


def test_a_missing_file_is_reported(scope: Scope, tmp_path: Path) -> None:
    result = scope("bench", "validate", "--tasks", str(tmp_path / "none.jsonl"))
    assert result.code == 2
    assert "cannot be read" in result.err
