"""``--planner hybrid:chat`` in a conversation and for one instruction."""

from __future__ import annotations

import json
from io import StringIO
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, Scope
from tests.support.misbehaving import Behaviour, Misbehaving, Request, Say, good


def left_turning_model() -> Behaviour:
    """Return a model that turns left by 35 degrees, whatever the instruction is."""

    def reply(request: Request) -> Say:
        is_done = request.data["messages"][-1]["role"] == "tool"
        return Say("There you are.") if is_done else Say("", tool_calls=(("adjust_ptz", {"pan_deg": -35}),))

    return good(reply)


def test_a_yes_in_the_chat_executes_the_call(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = ["pan right 5 degrees", "florp the lens somewhere", "yes", "/pose", "florp it again", "no"]
    monkeypatch.setattr("sys.stdin", StringIO("\n".join(lines) + "\n"))
    with Misbehaving(then=left_turning_model()) as server:
        result = scope("chat", "--scene", SCENE, "--planner", "hybrid:chat", "--planner-url", server.url)
        requests = [request for request in server.requests if request.chat]
    output = " ".join(result.out.split())
    assert result.code == 0, result.err
    assert "Shall I do this: pan left 35 degrees?" in output
    assert "There you are." in output
    assert "pan_deg=-35" in output.replace(" ", "")
    assert "All right, I did nothing." in output
    assert len(requests) == 3  # the question, the end after the yes, and the second question; none for the grammar's turn


def test_one_instruction_ends_with_the_question(scope: Scope) -> None:
    with Misbehaving(then=left_turning_model()) as server:
        result = scope("ask", "florp the lens", "--scene", SCENE, "--json", "--planner", "hybrid:chat", "--planner-url", server.url)
    assert (result.json["outcome"], result.json["tool_calls"]) == ("clarification", [])
    started, decided = (json.loads(line) for line in (Path(result.json["run_dir"]) / "trace.jsonl").read_text().splitlines()[:2])
    assert started["planner"].startswith("hybrid:")
    assert {"hybrid", "grammar", "model"} <= started["planner_details"].keys()
    assert decided["decision"]["planned_by"] == "model"
