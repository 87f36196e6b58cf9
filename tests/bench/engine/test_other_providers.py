"""Planner and judge as models of another provider of the engine, its client for OpenAI-compatible servers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from inspect_ai import eval_async
from inspect_ai.model import Model, get_model

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.judging.judge import ATTEMPTS
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.factory.inspect_plugin import bench
from tests.bench.engine.making import counting, turning
from tests.bench.engine.test_resuming import turner
from tests.support.misbehaving import Misbehaving, Request, Say, good, status

pytestmark = pytest.mark.anyio
PASSED = {"reason": "It turned as asked.", "verdict": "correct", "error_mode": "none"}


def planner(request: Request) -> Say:
    """Turns when instructed to; otherwise it calls an unknown tool and answers without an observation."""
    if "pan right" in str(request.data["messages"]):
        return turner(request)
    return Say("There are 3 balls.") if request.data["messages"][-1]["role"] == "tool" else Say("", tool_calls=(("look", {}),))


def judge(request: Request) -> Say:
    """Gives no verdict first, then verdicts on turns, and none on other tasks."""
    messages = request.data["messages"]
    assert request.data["response_format"]["type"] == "json_schema"
    told_back = "no valid verdict" in str(messages[-1]["content"])
    return Say(json.dumps(PASSED)) if told_back and "pan right" in str(messages) else Say("It went well.")


def model(server: Misbehaving, name: str) -> Model:
    return get_model(f"openai-api/local/{name}", base_url=server.url, api_key="none", memoize=False)


async def run(tasks: Path, plans: Misbehaving, judges: Misbehaving) -> Path:
    planner_model, judge_model = model(plans, "p"), model(judges, "j")
    (log,) = await eval_async(
        bench(split=str(tasks), judgements=2, pictures=False),
        model="none/none",
        model_roles={"planner": planner_model, "eyes": "scope_ptz/ground-truth", "judge": judge_model},
        log_dir=str(tasks.parent / "logs"),
        ctl_server=False,
    )
    for held in (planner_model, judge_model):
        await held.api.aclose()
    return Path(log.location)


async def test_planner_and_judge_of_another_provider(scope: object, tmp_path: Path) -> None:
    dump_tasks((turning(1, 20.0), counting(1, "ball", 3)), tmp_path / "tasks.jsonl")
    with Misbehaving(then=good(planner)) as plans, Misbehaving(then=good(judge)) as judges:
        log = await run(tmp_path / "tasks.jsonl", plans, judges)
        asked = [r for r in judges.requests if r.chat]
    evaluation = read_evaluation(log)
    assert (evaluation.card.planner.name, evaluation.card.perception.deterministic) == ("local/p", True)
    turned, guessed = evaluation.trials
    assert (turned.headline, turned.tool_calls, turned.steps) == ("correct", {"adjust_ptz": 1}, 2)
    assert (guessed.headline, guessed.bad_calls) == ("incorrect", 1)
    assert turned.input_tokens == 22  # two calls of 11, of which 4 came from the server's cache
    assert [(j.judge, j.repeat, j.verdict, j.attempts) for j in turned.judgements] == [
        ("local/j", 0, "correct", 2), ("local/j", 1, "correct", 2),
    ]  # fmt: skip
    assert {(j.verdict, j.attempts, j.input_tokens) for j in guessed.judgements} == {("unparseable", ATTEMPTS, 11 * ATTEMPTS)}
    assert {r.data["seed"] for r in asked} == {1, 2}


async def test_providers_that_fail_are_infrastructure(scope: object, tmp_path: Path) -> None:
    dump_tasks((turning(1, 20.0),), tmp_path / "tasks.jsonl")
    with Misbehaving(then=status(400)) as plans, Misbehaving() as judges:
        log = await run(tmp_path / "tasks.jsonl", plans, judges)
        assert not judges.requests
    (trial,) = read_evaluation(log).trials
    assert trial.headline == "infrastructure"
    assert "the planner's server failed" in trial.reason
