"""``scope runs``: lists, export and pruning from the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, Scope


@pytest.fixture
def run_id(scope: Scope) -> str:
    """Return the id of a run."""
    return Path(scope("ask", "count the balls", "--scene", SCENE, "--json").json["run_dir"]).name


def test_runs_are_listed_shown_exported_and_pruned(scope: Scope, run_id: str, tmp_path: Path) -> None:
    assert run_id in scope("runs", "list").out
    listed = scope("runs", "list", "--text", "balls", "--outcome", "answered", "--since", "2020-01-01", "--json").json
    assert [run["id"] for run in listed["runs"]] == [run_id]
    assert scope("runs", "list", "--rating", "good").out == "No runs found.\n"
    summary = scope("runs", "show", run_id)
    assert summary.out.startswith("count the balls\n")
    assert "count_objects(description=" in summary.out
    assert scope("runs", "show", run_id, "--json").json["step_list"][0]["tool"] == "count_objects"
    out = tmp_path / "out.jsonl"
    assert scope("runs", "export", "--format", "chat", "-o", str(out), "--json").json == {"runs": 1, "file": str(out)}
    assert json.loads(out.read_text())["run"] == run_id
    assert "Would remove 1 runs" in scope("runs", "prune", "--newest", "0").out
    assert scope("runs", "prune", "--newest", "0", "--yes", "--json").json["runs"] == [run_id]
    assert scope("runs", "list").out == "No runs found.\n"


def test_indexing_reports_damage_and_audit_logs(scope: Scope, run_id: str, tmp_path: Path) -> None:
    (tmp_path / "audit.jsonl").write_text(
        '{"time": "2026-01-01T00:00:00+00:00", "camera": "dock", "actor": "ben", "event": "move"}\n'
    )
    result = scope("runs", "index", "--audit", str(tmp_path / "audit.jsonl"), "--json")
    assert (result.code, result.json["added"], result.json["audit_entries"]) == (0, 1, 1)
    listed = scope("runs", "audit", "--camera", "dock").out
    assert re.fullmatch(r"\S+ \S+ +dock +ben +move\n", listed)
    (entry,) = scope("runs", "audit", "--since", "2025-12-31", "--json").json
    assert (entry["actor"], entry["event"]) == ("ben", "move")
    assert "No entries" in scope("runs", "audit", "--until", "2025-12-31").out
    copy = tmp_path / "runs" / "damaged"
    copy.mkdir()
    (copy / "trace.jsonl").write_text("{]\n")
    result = scope("runs", "index")
    assert result.code == 1
    assert "line 1 is damaged" in result.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("show", "nothing"), "There is no run 'nothing'"),
        (("list", "--since", "yesterday"), "--since must be a time"),
        (("list", "--rating", "fine"), "--rating must be good or bad"),
        (("prune",), "Specify at least one limit"),
        (("export", "-o", "x", "--format", "pdf"), "no export format 'pdf'"),
        (("list", "--runs-dir", "/nowhere"), "The runs folder /nowhere does not exist"),
    ],
)
def test_wrong_input_gives_one_clear_line(scope: Scope, run_id: str, arguments: tuple[str, ...], message: str) -> None:
    result = scope("runs", *arguments)
    assert result.code == 2
    assert message in result.err
    assert len(result.err.splitlines()) == 1
