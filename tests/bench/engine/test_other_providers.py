"""A planner and a judge that use another provider of the engine: its client for OpenAI-compatible servers."""

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
from tests.bench.engine.test_resuming import turning_model
from tests.bench.engine.yard_tasks import counting_task, turning_task
from tests.support.misbehaving import Misbehaving, Request, Say, good, status

pytestmark = pytest.mark.anyio
CORRECT = {"reason": "It turned as asked.", "verdict": "correct", "error_mode": "none"}


def planner(request: Request) -> Say:
    """Reply as a planner: turn when instructed to, otherwise call an unknown tool and answer without an observation."""
    if "pan right" in str(request.data["messages"]):
        return turning_model(request)
    return Say("There are 3 balls.") if request.data["messages"][-1]["role"] == "tool" else Say("", tool_calls=(("look", {}),))


def judge(request: Request) -> Say:
    """Reply as a judge: give no verdict at first; when corrected, give verdicts on turns only."""
    messages = request.data["messages"]
    assert request.data["response_format"]["type"] == "json_schema"
    corrected = "no valid verdict" in str(messages[-1]["content"])
    return Say(json.dumps(CORRECT)) if corrected and "pan right" in str(messages) else Say("It went well.")


def model(server: Misbehaving, name: str) -> Model:
    return get_model(f"openai-api/local/{name}", base_url=server.url, api_key="none", memoize=False)


async def run(tasks: Path, planner_server: Misbehaving, judge_server: Misbehaving) -> Path:
    planner_model, judge_model = model(planner_server, "p"), model(judge_server, "j")
    (log,) = await eval_async(
        bench(split=str(tasks), judgements=2, pictures=False),
        model="none/none",
        model_roles={"planner": planner_model, "eyes": "scope_ptz/ground-truth", "judge": judge_model},
        log_dir=str(tasks.parent / "logs"),
        ctl_server=False,
    )
    for engine_model in (planner_model, judge_model):
        await engine_model.api.aclose()
    return Path(log.location)


async def test_planner_and_judge_of_another_provider(scope: object, tmp_path: Path) -> None:
    dump_tasks((turning_task(1, 20.0), counting_task(1, "ball", 3)), tmp_path / "tasks.jsonl")
    with Misbehaving(then=good(planner)) as planner_server, Misbehaving(then=good(judge)) as judge_server:
        log = await run(tmp_path / "tasks.jsonl", planner_server, judge_server)
        judge_requests = [r for r in judge_server.requests if r.chat]
    evaluation = read_evaluation(log)
    assert (evaluation.card.planner.name, evaluation.card.perception.deterministic) == ("local/p", True)
    turn_trial, count_trial = evaluation.trials
    assert (turn_trial.headline, turn_trial.tool_calls, turn_trial.steps) == ("correct", {"adjust_ptz": 1}, 2)
    assert (count_trial.headline, count_trial.bad_calls) == ("incorrect", 1)
    assert turn_trial.input_tokens == 22  # two calls of 11, of which 4 came from the server's cache
    assert [(j.judge, j.repeat, j.verdict, j.attempts) for j in turn_trial.judgements] == [
        ("local/j", 0, "correct", 2), ("local/j", 1, "correct", 2),
    ]  # fmt: skip
    assert {(j.verdict, j.attempts, j.input_tokens) for j in count_trial.judgements} == {("unparseable", ATTEMPTS, 11 * ATTEMPTS)}
    assert {r.data["seed"] for r in judge_requests} == {1, 2}


async def test_providers_that_fail_are_infrastructure(scope: object, tmp_path: Path) -> None:
    dump_tasks((turning_task(1, 20.0),), tmp_path / "tasks.jsonl")
    with Misbehaving(then=status(400)) as planner_server, Misbehaving() as judge_server:
        log = await run(tmp_path / "tasks.jsonl", planner_server, judge_server)
        assert not judge_server.requests
    (trial,) = read_evaluation(log).trials
    assert trial.headline == "infrastructure"
    assert "the planner's server failed" in trial.reason
