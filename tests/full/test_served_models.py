"""The whole agent with real serving code: tiny checkpoints behind ``transformers serve``, with and without streaming."""

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
    pytest.mark.timeout(1800),  # the first test trains and serves the models of all tests
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]

GREETING = "Say hello."
COUNT = "how many balls are visible?"
SQUARE = "Is there a square?"
ODD = "florp the lens right by 20"
"""An instruction that the grammar does not understand, and that contains the arguments of its call."""
VAGUE = "florp the lens somewhere nice"
"""An instruction that the grammar does not understand, and that does not contain the arguments of its call."""
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
    question = next(q for q in (*TOOL_CALLS, GREETING) if any(q in str(m["content"]) for m in messages if m["role"] == "user"))
    if question == GREETING:
        return Say(text="Hello.")
    if messages[-1]["role"] == "tool":
        return Say(text=ANSWERS[question])
    return Say(text="", tool_calls=(TOOL_CALLS[question],))


@dataclass(frozen=True)
class ServedModel:
    """A checkpoint behind `transformers serve`, which serves only this model under the name of its folder."""

    url: str
    model: str


@pytest.fixture(scope="session")
def planner_server(tmp_path_factory: pytest.TempPathFactory, scenes: Path) -> Iterator[ServedModel]:
    """A server with a Qwen3 model that is trained on the prompts of the program."""
    from tests.full.tiny_models import tiny_planner

    folder = tmp_path_factory.mktemp("tiny")
    checkpoint = tiny_planner(folder / "planner", _lessons(folder, scenes))
    with transformers_serve(checkpoint, folder / "serve.log") as url:
        yield ServedModel(url, str(checkpoint))


def _lessons(folder: Path, scenes: Path) -> Sequence[Any]:
    """Run the program with a scripted server and return its requests with the replies."""
    import os
    import subprocess
    import sys

    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_RUNS_DIR": str(folder / "runs")}
    with Misbehaving(then=good(teacher)) as server:
        runs = [["ask", question, "--scene", SCENE] for question in (COUNT, SQUARE, ODD, VAGUE)]
        for arguments in ([*command, "--planner-url", server.url] for command in (["doctor"], *runs)):
            subprocess.run([sys.executable, "-m", "scope_ptz.cli", *arguments], env=environment, check=True, capture_output=True)
        requests = [r for r in server.requests if r.chat]
    return [lesson_of(request, teacher(request)) for request in requests]


def lesson_of(request: Request, reply: Say) -> Any:
    """Return a recorded request and the reply to train, as a lesson."""
    from tests.full.tiny_models import Lesson

    calls = (f"<tool_call>\n{json.dumps({'name': n, 'arguments': a})}\n</tool_call>" for n, a in reply.tool_calls)
    return Lesson(request.data["messages"], request.data.get("tools", ()), reply.text or "\n".join(calls))


@pytest.mark.parametrize("stream", ["true", "false"])
def test_the_agent_runs_on_a_served_checkpoint(scope: Scope, planner_server: ServedModel, stream: str) -> None:
    run_result = scope(
        "ask", COUNT, "--scene", SCENE, "--json", "--planner-url", planner_server.url, "--planner-model", planner_server.model,
        "--planner-option", f"stream={stream}",
    )  # fmt: skip
    assert run_result.code == 0, run_result.err
    output = run_result.json
    assert output["answer"] == ANSWERS[COUNT]
    (call,) = output["tool_calls"]
    assert (call["name"], call["result"]["count"]) == ("count_objects", 3)
    records = [json.loads(line) for line in (Path(output["run_dir"]) / "trace.jsonl").read_text().splitlines()]
    decisions = [r["decision"] for r in records if r["event"] == "decision"]
    assert [d["served"]["calls_from"] for d in decisions if d["kind"] == "call"] == ["native"]
    assert all((d["served"]["first_token_s"] is not None) == (stream == "true") for d in decisions)
    assert all(d["usage"]["output_tokens"] > 0 for d in decisions)


def hybrid(scope: Scope, server: ServedModel, instruction: str) -> tuple[Any, list[str]]:
    """Run an instruction with the hybrid planner. Return the result, and the part that planned each step."""
    run_result = scope(
        "ask", instruction, "--scene", SCENE, "--json", "--planner", "hybrid:chat", "--planner-url", server.url,
        "--planner-model", server.model,
    )  # fmt: skip
    records = [json.loads(line) for line in (Path(run_result.json["run_dir"]) / "trace.jsonl").read_text().splitlines()]
    return run_result.json, [record["decision"]["planned_by"] for record in records if record["event"] == "decision"]


def test_the_grammar_plans_before_the_model(scope: Scope, planner_server: ServedModel) -> None:
    output, parts = hybrid(scope, planner_server, COUNT)
    assert parts == ["grammar", "grammar"]
    assert "3 balls" in output["answer"]
    output, parts = hybrid(scope, planner_server, ODD)
    assert parts == ["model", "model"]
    assert [(call["name"], call["arguments"]) for call in output["tool_calls"]] == [TOOL_CALLS[ODD]]


def test_an_unsupported_call_of_the_served_model_needs_confirmation(scope: Scope, planner_server: ServedModel) -> None:
    output, parts = hybrid(scope, planner_server, VAGUE)
    assert (parts, output["outcome"], output["tool_calls"]) == (["model"], "clarification", [])
    assert "Shall I do this: pan left 35 degrees?" in output["answer"]


def test_the_server_passes_the_checks_of_doctor(scope: Scope, planner_server: ServedModel) -> None:
    run_result = scope("doctor", "--json", "--planner-url", planner_server.url, "--planner-model", planner_server.model)
    verdicts = {check["what"]: check["verdict"] for check in run_result.json}
    assert run_result.code == 0, run_result.out
    assert verdicts.pop("list of models") == "partly"  # it lists the models in its cache, not the model that it serves
    assert set(verdicts.values()) == {"ok"}


def test_a_wrong_model_name_is_reported_by_the_real_server(scope: Scope, planner_server: ServedModel) -> None:
    run_result = scope("ask", COUNT, "--scene", SCENE, "--json", "--planner-url", planner_server.url, "--planner-model", "another")
    assert (run_result.code, run_result.json["outcome"]) == (1, "planner_error")
    assert "pinned" in run_result.json["answer"]


def test_the_profile_of_a_served_checkpoint(scope: Scope, planner_server: ServedModel, tmp_path: Path) -> None:
    file = tmp_path / "one.jsonl"
    file.write_text(json.dumps({"instruction": TURN_INSTRUCTION, "calls": [{"name": "adjust_ptz", "arguments": {"pan_deg": 20}}]}))
    run_result = scope(
        "profile", "--json", "--planner-url", planner_server.url, "--planner-model", planner_server.model,
        "--instructions", str(file),
    )  # fmt: skip
    speed = run_result.json["planner"]["planner"]
    assert (speed["valid"]["share"], speed["right"]["share"]) == (1.0, 1.0)
    assert speed["first_token_s"]["median"] > 0


@pytest.fixture(scope="session")
def perception_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServedModel]:
    """A server with a vision model that is trained on the prompts of perception."""
    from tests.full import vision

    folder = tmp_path_factory.mktemp("vision")
    checkpoint = vision.train_detector(folder / "model")
    with transformers_serve(checkpoint, folder / "serve.log") as url:
        yield ServedModel(url, str(checkpoint))


MODELS_YAML = """
models:
  tiny-vision: {{repo: {vision.model}, url: '{vision.url}', roles: [perception], backend: openai_vision, coordinates: qwen3-vl,
    size_b: 0.001,
    active_b: 0.001, precision: fp32, context: 2048, licence: none}}
  tiny-owl: {{repo: {owl}, roles: [perception], backend: zero_shot, coordinates: pixels,
    size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 0, licence: none}}
"""


def test_planner_perception_and_detector_are_checkpoints(
    scope: Scope, planner_server: ServedModel, perception_server: ServedModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tests.full.tiny_vision_models import tiny_owlv2

    models_file = tmp_path / "models.yaml"
    models_file.write_text(MODELS_YAML.format(vision=perception_server, owl=tiny_owlv2(tmp_path / "owl")))
    monkeypatch.setenv("SCOPE_MODELS", str(models_file))
    planner_options = ("--planner-url", planner_server.url, "--planner-model", planner_server.model, "--scene", SCENE, "--json")
    output = scope("ask", SQUARE, *planner_options, "--perception", "tiny-vision").json
    assert (output["outcome"], output["answer"]) == ("answered", ANSWERS[SQUARE])
    assert output["tool_calls"][0]["result"]["answer"].startswith(("Yes, ", "No."))
    output = scope("ask", COUNT, *planner_options, "--perception", "tiny-vision", "--detector", "tiny-owl").json
    assert (output["outcome"], output["answer"]) == ("answered", ANSWERS[COUNT])
    (call,) = output["tool_calls"]
    assert call["error"] is None
    assert call["result"]["count"] >= 0
