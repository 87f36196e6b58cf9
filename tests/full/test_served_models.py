"""The whole agent against real serving code: tiny checkpoints behind `transformers serve`, over HTTP, streamed and not."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.planner.chat.planning_checks import PICTURE_INSTRUCTION, TURN_INSTRUCTION
from tests.cli.conftest import SCENE, Scope
from tests.full.serving import transformers_serve
from tests.support.misbehaving import Misbehaving, Request, Say, good

pytestmark = [
    pytest.mark.full,
    pytest.mark.timeout(1800),  # the first test trains and serves the models of all
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]

GREETING = "Say hello."
COUNT = "how many balls are visible?"
SQUARE = "Is there a square?"
ODD = "florp the lens right by 20"
"""An instruction that the grammar does not understand, and whose call stands in it."""
VAGUE = "florp the lens somewhere nice"
"""One whose call does not stand in it."""
TOOL_CALLS: dict[str, tuple[str, dict[str, Any]]] = {
    PICTURE_INSTRUCTION: ("take_image", {}),
    TURN_INSTRUCTION: ("adjust_ptz", {"pan_deg": 20}),
    COUNT: ("count_objects", {"description": "balls", "view": "current"}),
    SQUARE: ("query_answer", {"question": SQUARE, "view": "current"}),
    ODD: ("adjust_ptz", {"pan_deg": 20}),
    VAGUE: ("adjust_ptz", {"pan_deg": -35}),
}
ANSWERS = {
    PICTURE_INSTRUCTION: "The picture is saved.",
    TURN_INSTRUCTION: "The camera has turned.",
    COUNT: "I counted the balls.",
    SQUARE: "I looked for it.",
    ODD: "The lens is florped.",
    VAGUE: "It looks nice now.",
}


def teacher(request: Request) -> Say:
    """Return the reply that the tiny planner is trained to give."""
    messages = request.data["messages"]
    asked = next(q for q in (*TOOL_CALLS, GREETING) if any(q in str(m["content"]) for m in messages if m["role"] == "user"))
    if asked == GREETING:
        return Say(text="Hello.")
    if messages[-1]["role"] == "tool":
        return Say(text=ANSWERS[asked])
    return Say(text="", tool_calls=(TOOL_CALLS[asked],))


@dataclass(frozen=True)
class Served:
    """A checkpoint behind `transformers serve`, which serves only this model under the name of its folder."""

    url: str
    model: str


@pytest.fixture(scope="session")
def planner_server(tmp_path_factory: pytest.TempPathFactory, scenes: Path) -> Iterator[Served]:
    """A server with a Qwen3 model that is trained on the prompts of the program."""
    from tests.full.tiny_models import tiny_planner

    folder = tmp_path_factory.mktemp("tiny")
    checkpoint = tiny_planner(folder / "planner", _lessons(folder, scenes))
    with transformers_serve(checkpoint, folder / "serve.log") as url:
        yield Served(url, str(checkpoint))


def _lessons(folder: Path, scenes: Path) -> Sequence[Any]:
    """Run the program with a scripted server and return its requests with the replies."""
    import os
    import subprocess
    import sys

    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(folder / "runs")}
    with Misbehaving(then=good(teacher)) as server:
        runs = [["ask", asked, "--scene", SCENE] for asked in (COUNT, SQUARE, ODD, VAGUE)]
        for arguments in ([*command, "--planner-url", server.url] for command in (["doctor"], *runs)):
            subprocess.run([sys.executable, "-m", "scope_ptz.cli", *arguments], env=environment, check=True, capture_output=True)
        asked = [r for r in server.requests if r.chat]
    return [lesson_of(request, teacher(request)) for request in asked]


def lesson_of(request: Request, said: Say) -> Any:
    """Return a recorded request and the reply to train, as a lesson."""
    from tests.full.tiny_models import Lesson

    calls = (f"<tool_call>\n{json.dumps({'name': n, 'arguments': a})}\n</tool_call>" for n, a in said.tool_calls)
    return Lesson(request.data["messages"], request.data.get("tools", ()), said.text or "\n".join(calls))


@pytest.mark.parametrize("stream", ["true", "false"])
def test_the_agent_runs_on_a_served_checkpoint(scope: Scope, planner_server: Served, stream: str) -> None:
    done = scope(
        "ask", COUNT, "--scene", SCENE, "--json", "--planner-url", planner_server.url, "--planner-model", planner_server.model,
        "--planner-option", f"stream={stream}",
    )  # fmt: skip
    assert done.code == 0, done.err
    said = done.json
    assert said["answer"] == ANSWERS[COUNT]
    (call,) = said["tool_calls"]
    assert (call["name"], call["result"]["count"]) == ("count_objects", 3)
    records = [json.loads(line) for line in (Path(said["run_dir"]) / "trace.jsonl").read_text().splitlines()]
    decisions = [r["decision"] for r in records if r["event"] == "decision"]
    assert [d["served"]["calls_from"] for d in decisions if d["kind"] == "call"] == ["native"]
    assert all((d["served"]["first_token_s"] is not None) == (stream == "true") for d in decisions)
    assert all(d["usage"]["output_tokens"] > 0 for d in decisions)


def hybrid(scope: Scope, server: Served, instruction: str) -> tuple[Any, list[str]]:
    """Run an instruction with the hybrid planner. Return the result, and the part that planned each step."""
    done = scope(
        "ask", instruction, "--scene", SCENE, "--json", "--planner", "hybrid:chat", "--planner-url", server.url,
        "--planner-model", server.model,
    )  # fmt: skip
    records = [json.loads(line) for line in (Path(done.json["run_dir"]) / "trace.jsonl").read_text().splitlines()]
    return done.json, [record["decision"]["planned_by"] for record in records if record["event"] == "decision"]


def test_the_grammar_plans_before_the_model(scope: Scope, planner_server: Served) -> None:
    said, parts = hybrid(scope, planner_server, COUNT)
    assert parts == ["grammar", "grammar"]
    assert "3 balls" in said["answer"]
    said, parts = hybrid(scope, planner_server, ODD)
    assert parts == ["model", "model"]
    assert [(call["name"], call["arguments"]) for call in said["tool_calls"]] == [TOOL_CALLS[ODD]]


def test_a_call_of_the_served_model_without_grounds_is_asked_about(scope: Scope, planner_server: Served) -> None:
    said, parts = hybrid(scope, planner_server, VAGUE)
    assert (parts, said["outcome"], said["tool_calls"]) == (["model"], "clarification", [])
    assert "Shall I do this: pan left 35 degrees?" in said["answer"]


def test_the_server_passes_the_checks_of_doctor(scope: Scope, planner_server: Served) -> None:
    done = scope("doctor", "--json", "--planner-url", planner_server.url, "--planner-model", planner_server.model)
    verdicts = {check["what"]: check["verdict"] for check in done.json}
    assert done.code == 0, done.out
    assert verdicts.pop("list of models") == "partly"  # It lists what is in its cache, and not what it is pinned to
    assert set(verdicts.values()) == {"ok"}


def test_a_wrong_model_name_is_reported_by_the_real_server(scope: Scope, planner_server: Served) -> None:
    done = scope("ask", COUNT, "--scene", SCENE, "--json", "--planner-url", planner_server.url, "--planner-model", "another")
    assert (done.code, done.json["outcome"]) == (1, "planner_error")
    assert "pinned" in done.json["answer"]


def test_the_profile_of_a_served_checkpoint(scope: Scope, planner_server: Served, tmp_path: Path) -> None:
    file = tmp_path / "one.jsonl"
    file.write_text(json.dumps({"instruction": TURN_INSTRUCTION, "calls": [{"name": "adjust_ptz", "arguments": {"pan_deg": 20}}]}))
    done = scope(
        "profile", "--json", "--planner-url", planner_server.url, "--planner-model", planner_server.model,
        "--instructions", str(file),
    )  # fmt: skip
    speed = done.json["planner"]["planner"]
    assert (speed["valid"]["share"], speed["right"]["share"]) == (1.0, 1.0)
    assert speed["first_token_s"]["median"] > 0


@pytest.fixture(scope="session")
def perception_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server with a vision model that is trained on the prompts of perception."""
    from tests.full import vision

    folder = tmp_path_factory.mktemp("eyes")
    checkpoint = vision.train_detector(folder / "eyes")
    with transformers_serve(checkpoint, folder / "serve.log") as url:
        yield Served(url, str(checkpoint))


MINE = """
models:
  tiny-eyes: {{repo: {eyes.model}, url: '{eyes.url}', roles: [perception], backend: openai_vision, coordinates: qwen3-vl,
    size_b: 0.001,
    active_b: 0.001, precision: fp32, context: 2048, licence: none}}
  tiny-owl: {{repo: {owl}, roles: [perception], backend: zero_shot, coordinates: pixels,
    size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 0, licence: none}}
"""


def test_planner_perception_and_detector_are_checkpoints(
    scope: Scope, planner_server: Served, perception_server: Served, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tests.full.tiny_vision_models import tiny_owlv2

    mine = tmp_path / "models.yaml"
    mine.write_text(MINE.format(eyes=perception_server, owl=tiny_owlv2(tmp_path / "owl")))
    monkeypatch.setenv("SCOPE_MODELS", str(mine))
    brain = ("--planner-url", planner_server.url, "--planner-model", planner_server.model, "--scene", SCENE, "--json")
    said = scope("ask", SQUARE, *brain, "--perception", "tiny-eyes").json
    assert (said["outcome"], said["answer"]) == ("answered", ANSWERS[SQUARE])
    assert said["tool_calls"][0]["result"]["answer"].startswith(("Yes, ", "No."))
    said = scope("ask", COUNT, *brain, "--perception", "tiny-eyes", "--detector", "tiny-owl").json
    assert (said["outcome"], said["answer"]) == ("answered", ANSWERS[COUNT])
    (call,) = said["tool_calls"]
    assert call["error"] is None
    assert call["result"]["count"] >= 0
