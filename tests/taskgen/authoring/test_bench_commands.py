"""``scope bench build``, ``validate`` and ``browse`` on the synthetic scene."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.bench.tasks.files import dump_tasks, load_tasks
from scope_ptz.taskgen.authoring.assembly import BuiltTasks
from tests.cli.conftest import Scope, scenes, scope

__all__ = ["scenes", "scope"]


@pytest.fixture
def few(built: BuiltTasks, tmp_path: Path) -> Path:
    """A file with four tasks without twins."""
    core = [task for task in built.tasks if task.stratum == "core" and task.pair is None]
    path = tmp_path / "tasks.jsonl"
    dump_tasks([core[0], core[-1], next(t for t in core if t.category == "ocr"), next(t for t in core if not t.evidence)], path)
    return path


@pytest.mark.full
def test_build_writes_tasks_and_reports_the_shortfall(scope: Scope, tmp_path: Path) -> None:
    out = tmp_path / "made" / "tasks.jsonl"
    done = scope("bench", "build", "--scene", "analytic-yard", "--share", "0.03", "--out", str(out))
    assert len(load_tasks(out)) > 8
    assert "tasks in" in done.out
    assert (done.code == 1) == ("too few" in done.err)


@pytest.mark.full
def test_validate_prints_counts_and_passes(scope: Scope, few: Path) -> None:
    done = scope("bench", "validate", "--tasks", str(few))
    assert done.code == 0, done.out
    assert "sound" in done.out and "counting" in done.out and "stay" in done.out


def test_validate_fails_on_a_wrong_value(scope: Scope, few: Path) -> None:
    rows = [json.loads(line) for line in few.read_text().splitlines()]
    row = next(row for row in rows if row["category"] == "counting")
    row["expected"]["value"] = row["expected"].get("value", 0) + 3
    few.write_text("".join(json.dumps(row) + "\n" for row in rows))
    done = scope("bench", "validate", "--json", "--tasks", str(few))
    assert done.code == 1
    assert not done.json["sound"]
    assert done.json["faults"][0]["attempt"] == "truth"


def test_browse_shows_instruction_run_and_frames(scope: Scope, few: Path, tmp_path: Path) -> None:
    task = load_tasks(few)[0]
    done = scope("bench", "browse", task.id, "--tasks", str(few), "--out", str(tmp_path / "frames"))
    assert done.code == 0, done.err
    assert task.instruction in done.out and "verdict    correct" in done.out
    assert len(list((tmp_path / "frames").glob("*.png"))) == 1 + len(task.evidence)


def test_browse_rejects_an_unknown_task(scope: Scope, few: Path) -> None:
    done = scope("bench", "browse", "counting-999", "--tasks", str(few))
    assert done.code == 2
    assert "no task" in done.err


def test_a_missing_file_is_reported(scope: Scope, tmp_path: Path) -> None:
    done = scope("bench", "validate", "--tasks", str(tmp_path / "none.jsonl"))
    assert done.code == 2
    assert "cannot be read" in done.err
