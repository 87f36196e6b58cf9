"""``--planner hybrid:chat`` in a conversation and for one instruction."""

from __future__ import annotations

import json
from io import StringIO
from pathlib import Path

import pytest

from tests.cli.conftest import SCENE, Scope
from tests.support.misbehaving import Behaviour, Misbehaving, Request, Say, good


def turns_left() -> Behaviour:
    """A model that turns left by 35 degrees, whatever the instruction says."""

    def mind(request: Request) -> Say:
        is_done = request.data["messages"][-1]["role"] == "tool"
        return Say("There you are.") if is_done else Say("", tool_calls=(("adjust_ptz", {"pan_deg": -35}),))

    return good(mind)


def test_a_yes_in_the_conversation_carries_out_the_call(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = ["pan right 5 degrees", "florp the lens somewhere", "yes", "/pose", "florp it again", "no"]
    monkeypatch.setattr("sys.stdin", StringIO("\n".join(lines) + "\n"))
    with Misbehaving(then=turns_left()) as server:
        done = scope("chat", "--scene", SCENE, "--planner", "hybrid:chat", "--planner-url", server.url)
        requests = [request for request in server.requests if request.chat]
    shown = " ".join(done.out.split())
    assert done.code == 0, done.err
    assert "Shall I do this: pan left 35 degrees?" in shown
    assert "There you are." in shown
    assert "pan_deg=-35" in shown.replace(" ", "")
    assert "All right, I did nothing." in shown
    assert len(requests) == 3  # the question, the end after the yes, and the second question; none for the grammar's turn


def test_one_instruction_ends_with_the_question(scope: Scope) -> None:
    with Misbehaving(then=turns_left()) as server:
        done = scope("ask", "florp the lens", "--scene", SCENE, "--json", "--planner", "hybrid:chat", "--planner-url", server.url)
    assert (done.json["outcome"], done.json["tool_calls"]) == ("clarification", [])
    started, decided = (json.loads(line) for line in (Path(done.json["run_dir"]) / "trace.jsonl").read_text().splitlines()[:2])
    assert started["planner"].startswith("hybrid:")
    assert {"hybrid", "grammar", "model"} <= started["planner_details"].keys()
    assert decided["decision"]["planned_by"] == "model"
