"""``scope doctor`` and ``scope profile`` with good and faulty servers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.planner.chat.planning_checks import PICTURE_INSTRUCTION, TURN_INSTRUCTION
from tests.cli.conftest import SCENE, Scope
from tests.support.misbehaving import (
    MODEL,
    Behaviour,
    Exchange,
    Misbehaving,
    Request,
    Say,
    body,
    good,
    nobody_listens,
    status,
)

MOONDREAM: dict[str, dict[str, Any]] = {
    "query": {"answer": "A yard."},
    "caption": {"caption": "A yard."},
    "detect": {"objects": []},
    "point": {"points": []},
}


def capable_model(request: Request) -> Say:
    """Reply as a model that passes the checks."""
    messages = request.data["messages"]
    if not request.data.get("tools"):
        return Say(text="Hello.")
    if messages[-1]["role"] == "tool":
        return Say(text="The picture is saved.")
    instruction = str(messages[-1]["content"])
    if PICTURE_INSTRUCTION in instruction:
        return Say(text="", tool_calls=(("take_image", {}),))
    if TURN_INSTRUCTION in instruction or "pan right 20" in instruction:
        return Say(text="", tool_calls=(("adjust_ptz", {"pan_deg": 20}),))
    return Say(text="", tool_calls=(("adjust_ptz", {"pan_deg": "far"}),))


def calls_in_text(request: Request) -> Say:
    """Reply as a model that passes the checks, on a server that leaves its calls in the text."""
    reply = capable_model(request)
    if not reply.tool_calls:
        return reply
    ((name, arguments),) = reply.tool_calls
    return Say(text=f"<tool_call>\n{json.dumps({'name': name, 'arguments': arguments})}\n</tool_call>")


def checks(scope: Scope, *options: str) -> tuple[int, dict[str, str]]:
    result = scope("doctor", "--json", *options)
    return result.code, {check["what"]: check["verdict"] for check in result.json}


def strict_about_model(behaviour: Behaviour) -> Behaviour:
    """Return a server that accepts only the name of its model."""

    async def behave(x: Exchange) -> None:
        wrong = x.request.chat and x.request.data["model"] != MODEL
        await (status(404, "no such model") if wrong else behaviour)(x)

    return behave


def test_a_good_server_passes_every_check(scope: Scope) -> None:
    with Misbehaving(then=strict_about_model(good(capable_model))) as server:
        code, verdicts = checks(scope, "--planner-url", server.url)
    assert code == 0
    assert set(verdicts.values()) == {"ok"}
    assert len(verdicts) == 11


def test_calls_in_the_text_are_a_warning_and_not_a_failure(scope: Scope) -> None:
    with Misbehaving(then=good(calls_in_text)) as server:
        code, verdicts = checks(scope, "--planner-url", server.url)
    assert code == 0
    assert verdicts["a tool call"] == verdicts["a tool call, streamed"] == "partly"


def test_a_model_without_tools_fails(scope: Scope) -> None:
    with Misbehaving(then=good(Say("I am only a chat bot."))) as server:
        code, verdicts = checks(scope, "--planner-url", server.url)
        assert scope("doctor", "--planner-url", server.url).out.count("!!") == 2
    assert code == 1
    assert verdicts["reply"] == "ok"
    assert verdicts["a tool call"] == "failed"


def test_an_unreachable_server_is_reported_once_and_immediately(scope: Scope) -> None:
    with nobody_listens() as url:
        code, verdicts = checks(scope, "--planner-url", url, "--planner-model", "x")
    assert code == 1
    assert verdicts == {"list of models": "failed", "reply": "failed"}


@pytest.mark.full
@pytest.mark.parametrize("behaviour", [status(500), body("<html>", "text/html"), body('{"choices": []}'), body("{")])
def test_bad_servers_fail_checks_without_a_crash(scope: Scope, behaviour: Behaviour) -> None:
    with Misbehaving(then=behaviour) as server:
        code, verdicts = checks(scope, "--planner-url", server.url, "--planner-model", "x")
    assert code == 1
    assert verdicts["a tool call"] == "failed"


def test_models_without_a_server_cannot_be_checked(scope: Scope) -> None:
    result = scope("doctor", "--planner", "grammar")
    assert (result.code, result.err.count("\n")) == (2, 1)


@pytest.mark.full
def test_perception_is_checked_on_a_frame(scope: Scope) -> None:
    with Misbehaving(then=good(moondream=MOONDREAM)) as server:
        code, verdicts = checks(scope, "--perception", "moondream2", "--perception-url", server.url)
    assert code == 0
    assert verdicts["a question"] == "ok"
    assert verdicts["boxes of 'purple elephant'"] == "ok"
    assert verdicts["boxes of 'traffic cone'"] == "partly"


def profile(scope: Scope, *options: str, code: int = 0) -> Any:
    result = scope("profile", "--scene", SCENE, "--frames", "2", "--json", *options)
    assert result.code == code, result.err
    return result.json


def test_a_profile_reports_speed_validity_and_the_verdict(scope: Scope, tmp_path: Path) -> None:
    file = tmp_path / "instructions.jsonl"
    lines = [
        {"instruction": "pan right 20 degrees", "calls": [{"name": "adjust_ptz", "arguments": {"pan_deg": 20}}]},
        {"instruction": "pan left 20 degrees", "calls": [{"name": "adjust_ptz", "arguments": {"pan_deg": -20}}]},
        {"instruction": "florp", "calls": []},
    ]
    file.write_text("\n".join(map(json.dumps, lines)))
    with Misbehaving(then=good(capable_model)) as server:
        url = server.url
        report = profile(
            scope, "qwen3-30b-a3b+moondream3", "--planner-url", url, "--perception-url", url, "--instructions", str(file)
        )  # fmt: skip
        text = scope("profile", "--planner-url", url, "--instructions", str(file), "--prompts").out
    planner, perception = report["planner"], report["perception"]
    assert planner["planner"]["turns"] == 2
    assert (planner["planner"]["valid"]["count"], planner["planner"]["valid"]["of"]) == (1, 2)
    assert planner["planner"]["first_token_s"]["median"] > 0
    assert planner["planner"]["tokens_per_s"]["median"] > 0
    assert planner["computed_memory_gb"] > 60
    assert planner["serving"]["/v1/models id"] == MODEL
    assert set(perception["perception"]["by_skill"]) == {"query", "caption", "detect", "point"}
    assert report["real_time"] == "met"
    assert "Real-time criterion" in text
    assert "tools changed by prompt edits" in text


def test_failures_are_counted_and_no_verdict_is_invented(scope: Scope) -> None:
    with Misbehaving(then=status(401)) as server:
        report = profile(scope, "--perception", "moondream2", "--perception-url", server.url, code=1)
        assert report["perception"]["perception"]["failures"] == {"unauthorised": 8}
    assert report["real_time"] == "unknown"


def test_perception_that_fails_at_one_request_does_not_pass(scope: Scope) -> None:
    with Misbehaving(then=good(moondream={**MOONDREAM, "detect": {"error": "out of memory"}})) as server:
        report = profile(scope, "--perception", "moondream2", "--perception-url", server.url, code=1)
    perception = report["perception"]["perception"]
    assert (set(perception["by_skill"]), perception["never_worked"]) == ({"query", "caption", "point"}, ["detect"])
    assert "out of memory" in perception["first_failure"]
    assert report["real_time"] == "unknown"


def test_server_failures_do_not_count_as_wrong_choices(scope: Scope) -> None:
    with Misbehaving(then=status(503, "loading")) as server:
        report = profile(scope, "--planner-url", server.url, "--prompts", "--limit", "3", code=1)
    planner = report["planner"]["planner"]
    assert planner["failures"] == {"circuit-open": 3}
    assert "loading" in planner["first_failure"]
    assert [planner[rate]["of"] for rate in ("valid", "right", "inverted")] == [0, 0, 0]
    assert "prompts" not in report


@pytest.mark.parametrize(
    "options", [(), ("grammar+moondream2",), ("--planner-url", "http://127.0.0.1:9/v1", "--instructions", "/none")]
)
def test_models_that_cannot_be_profiled(scope: Scope, options: tuple[str, ...]) -> None:
    result = scope("profile", *options)
    assert (result.code, result.err.count("\n")) == (2, 1)
