"""The estimate before an evaluation is guessed or measured on earlier runs, and labelled accordingly."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.estimate import Price, estimate
from scope_ptz.bench.engine.estimate_text import estimate_lines, tokens_text
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.runs import earlier_evaluations
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.factory.evaluation_session import prompt_chars
from scope_ptz.planner.chat import ChatPlanner
from tests.bench.engine.yard_tasks import TASKS

ENTRIES = tuple(Entry(facts=facts_of(task, "mast"), world=task.world, task=task) for task in TASKS)
ENDPOINT = Endpoint(url="http://127.0.0.1:1/v1", model="m")
PAIR: dict[str, Any] = {"planner": "m", "perception": "moondream2", "planner_is_free": False}


def test_an_estimate_without_earlier_runs_is_labelled_as_a_guess() -> None:
    # Each of the four tasks makes one call in two steps. Both steps contain the prompt; the second also contains the call.
    forecast = estimate(ENTRIES, 2, 4, (), Price(1.0, 2.0), prompt_chars=4000)
    assert (forecast.runs, forecast.planner_calls, forecast.perception_calls, forecast.seconds) == (8, 16, 4, None)
    assert (forecast.input_tokens, forecast.output_tokens) == (16 * 1000 + 8 * 100, 16 * 40)
    assert forecast.cost_usd == pytest.approx((16_800 + 2 * 640) / 1e6)
    text = "\n".join(estimate_lines(forecast, **PAIR, concurrency=4))
    assert "about 17 thousand input and 640 output tokens for the planner (guessed from the length of the prompt), 0.02 US" in text
    assert "time    unknown" in text


async def test_a_guess_is_based_on_the_prompt_only() -> None:
    planner = ChatPlanner(ENDPOINT)
    assert 4_000 < (prompt_chars(planner) or 0) < 20_000
    await planner.close()
    assert prompt_chars(None) is None
    assert "cost    unknown" in "\n".join(estimate_lines(estimate(ENTRIES, 1, 1, ()), **PAIR, concurrency=1))


def test_an_estimate_with_earlier_runs_is_measured(shared_log: Path) -> None:
    earlier = read_evaluation(shared_log)
    trials = tuple(t.model_copy(update={"input_tokens": 1000, "output_tokens": 100}) for t in earlier.trials)
    forecast = estimate(ENTRIES, 1, 1, [earlier.model_copy(update={"trials": trials})], prompt_chars=4000)
    assert (forecast.measured_on, forecast.guessed) == (4, False)
    share = forecast.planner_calls / sum(t.steps for t in trials)
    assert forecast.input_tokens == round(4000 * share)
    assert "measured on 4 earlier runs of this pair" in "\n".join(estimate_lines(forecast, **PAIR, concurrency=1))


def test_a_run_in_several_logs_counts_once(log_copy: Path) -> None:
    shutil.copy2(log_copy, log_copy.with_name(f"{log_copy.stem}-recovered.eval"))
    earlier = earlier_evaluations(log_copy.parent, "grammar", "ground-truth")
    assert estimate(ENTRIES, 1, 1, earlier).measured_on == 4
    assert not earlier_evaluations(log_copy.parent, "their:Agent", "ground-truth")


@pytest.mark.parametrize(("tokens", "text"), [(340, "340"), (16_800, "17 thousand"), (3_400_000, "3.4 million")])
def test_amounts(tokens: int, text: str) -> None:
    assert tokens_text(tokens) == text


pytestmark = pytest.mark.anyio
