"""``scope ask`` with failing model servers: neither messages nor stored data contain the key."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, CommandResult, Scope
from tests.support.misbehaving import Misbehaving, echo_key, good, nobody_listens, say, status

KEY = "sk-very-secret-0123456789"
ASK = ("ask", "how many cones are there?", "--scene", SCENE, "--fast", "--timeout", "10")
COUNT = ("count_objects", {"description": "cones"})


@pytest.fixture(autouse=True)
def keys(monkeypatch: pytest.MonkeyPatch) -> None:
    for role in ("PLANNER", "PERCEPTION"):
        monkeypatch.setenv(f"SCOPE_{role}_KEY", KEY)


def all_output(result: CommandResult, folder: Path) -> str:
    """Return all output, after checking that it does not contain the key."""
    stored = "".join(
        path.read_text(errors="replace") for path in folder.rglob("*") if path.suffix in (".jsonl", ".json", ".txt", ".md")
    )
    everything = result.out + result.err + stored
    assert KEY not in everything
    assert "Traceback" not in result.err
    return everything


@pytest.mark.parametrize("output", ["text", "json"])
def test_a_refused_key_is_reported_and_not_shown(scope: Scope, tmp_path: Path, output: str) -> None:
    with Misbehaving(then=echo_key()) as server:
        result = scope(*ASK, "--planner-url", server.url, "--planner-model", "m", *(["--json"] if output == "json" else []))
        assert all(request.headers["authorization"] == f"Bearer {KEY}" for request in server.requests)
    assert result.code not in (0, 2)
    output = all_output(result, tmp_path)
    assert "rejected the API key" in output
    assert "***" in output


def test_a_server_that_is_gone(scope: Scope, tmp_path: Path) -> None:
    with nobody_listens() as url:
        result = scope(*ASK, "--planner-url", url, "--planner-model", "m", "--json")
    assert result.code not in (0, 2)
    assert "cannot be reached" in all_output(result, tmp_path)


def test_perception_failures_are_errors_for_the_planner_and_counted(scope: Scope, tmp_path: Path) -> None:
    with (
        Misbehaving([say("", COUNT)], then=say("I could not see.")) as planner,
        Misbehaving(then=status(500, f"bad {KEY}")) as perception,
    ):
        result = scope(
            *ASK,
            "--planner-url",
            planner.url,
            "--planner-model",
            "m",
            "--perception",
            "moondream",
            "--perception-url",
            perception.url,
            "--json",
        )
        last = next(r for r in reversed(planner.requests) if r.chat).data["messages"][-1]
    output = all_output(result, tmp_path)
    assert "I could not see." in output
    assert last["role"] == "tool"
    assert "had an internal error" in last["content"]
    assert KEY not in json.dumps(last)
    ended = json.loads(next(tmp_path.rglob("trace.jsonl")).read_text().splitlines()[-1])
    assert ended["perception_failures"] == 1
    assert ended["server_events"] == {"server-error": 3}


def test_a_count_of_incomplete_detections_is_a_lower_bound(scope: Scope, tmp_path: Path) -> None:
    box = {"x_min": 0.1, "y_min": 0.1, "x_max": 0.2, "y_max": 0.2}
    with Misbehaving(then=good(moondream={"detect": {"objects": [box, {**box, "x_min": "left"}]}})) as perception:
        result = scope(*ASK, "--perception", "moondream", "--perception-url", perception.url, "--json")
    assert "at least 1 cone" in all_output(result, tmp_path)
    assert result.json["tool_calls"][0]["result"]["complete"] is False


def test_an_address_with_a_key_in_it_is_refused(scope: Scope, tmp_path: Path) -> None:
    result = scope(*ASK, "--planner-url", f"http://me:{KEY}@127.0.0.1:1/v1", "--planner-model", "m")
    assert result.code == 2
    all_output(result, tmp_path)


def test_doctor_reports_a_refused_key(scope: Scope, tmp_path: Path) -> None:
    with Misbehaving(then=echo_key()) as server:
        result = scope("doctor", "--planner-url", server.url, "--planner-model", "m", "--json")
    assert result.code != 0
    assert "rejected the API key" in all_output(result, tmp_path)
