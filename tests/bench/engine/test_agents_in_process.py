"""External agents are traced and checked like the built-in agent."""

from __future__ import annotations

import asyncio
import importlib
import re
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.bench.agents.in_process import InProcessChannel
from scope_ptz.bench.agents.planner import ChannelPlanner
from scope_ptz.bench.agents.source import find_module_source
from scope_ptz.bench.engine.external_agents import AgentReply, AgentSession
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.sample_files import open_sample
from scope_ptz.bench.scoring.verdict import AGENT_FAILURES
from scope_ptz.errors import PlannerError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Exchange, Finish, State, ToolOutcome
from tests.cli.conftest import CommandResult, Scope

MODULE = """
import re

class Agent:
    sees = True

    async def run(self, session):
        assert "adjust_ptz" in [tool["function"]["name"] for tool in session.tools]
        assert session.presets == ("yard", "board", "from-the-roof") and session.limits.max_zoom == 5.0
        assert session.view()[:2] == b"\\xff\\xd8"
        if turn := re.search(r"right (\\d+)", session.instruction):
            wrong = await session.call("adjust_ptz", {"sideways": 1})
            assert "sideways" in wrong["error"], wrong
            done = await session.call("adjust_ptz", {"pan_deg": float(turn[1])})
            return f"The camera is at {done['pose']['pan_deg']:g} degrees."
        seen = await session.call("count_objects", {"description": "balls"})
        return f"There are {seen['count']} balls."
"""


def test_an_external_agent(scope: Scope, tasks_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "their_loop.py").write_text(MODULE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    run_result = scope("bench", "run", "--tasks", str(tasks_file), "--agent", "their_loop:Agent", "--out", "logs", "--json")
    assert run_result.code == 0, run_result.err
    evaluation = read_evaluation(Path(run_result.json["log"]))
    assert (evaluation.card.agent, evaluation.card.isolation) == ("their_loop:Agent", "isolated")
    assert run_result.json["isolation"] == "isolated"
    headlines = {t.task.id.split("yard-")[1]: t.headline for t in evaluation.trials}
    assert headlines == {
        "counting-001": "correct", "counting-002": "unscored", "single-call-001": "correct", "single-call-002": "correct",
    }  # fmt: skip
    turning_trial = next(t for t in evaluation.trials if t.task.category == "single_call")
    assert (turning_trial.bad_calls, turning_trial.tool_calls) == (1, {"adjust_ptz": 2})
    assert open_sample(Path(run_result.json["log"]), turning_trial.sample).trace.started.planner == "their_loop:Agent"


SEEING_AGENT = """
class Agent:
    sees = True

    async def run(self, session):
        {body}
        return "There are 3 balls."
"""


@pytest.mark.parametrize(("body", "headline"), [("session.view()", "correct"), ("pass", "incorrect")])
def test_only_opened_pictures_count_as_observations(
    body: str, headline: str, scope: Scope, tasks_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = f"seeing_loop_{body[:4]}"
    (tmp_path / f"{module}.py").write_text(SEEING_AGENT.format(body=body))
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    options = ("--category", "counting", "--limit", "1", "--out", "logs", "--json")
    run_result = scope("bench", "run", "--tasks", str(tasks_file), "--agent", f"{module}:Agent", *options)
    assert run_result.code == 0, run_result.err
    (trial,) = read_evaluation(Path(run_result.json["log"])).trials
    assert trial.headline == headline


QUICK = """
class Agent:
    async def run(self, session):
        return {answer!r}
"""


@pytest.mark.full
def test_changed_source_is_a_different_evaluation(
    scope: Scope, tasks_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    options = ("--tasks", str(tasks_file), "--agent", "quick_loop:Agent", "--no-pictures", "--limit", "2", "--out", "logs")

    def run_as(answer: str) -> CommandResult:
        (tmp_path / "quick_loop.py").write_text(QUICK.format(answer=answer))
        importlib.invalidate_caches()
        monkeypatch.delitem(sys.modules, "quick_loop", raising=False)
        return scope("bench", "run", *options)

    first = run_as("x")
    assert first.code == 0, first.err
    assert "2 runs of quick_loop:Agent + ground-truth" in first.out
    # The external agent plans, so the output mentions neither a built-in planner nor its costs.
    assert "grammar" not in first.out and "of the planner" not in first.out and "paid server" not in first.out
    assert "cost    unknown: the agent's own model calls are not measured" in first.out
    assert "already complete" in run_as("x").err
    changed = run_as("a longer answer")
    assert "already complete" not in changed.err
    assert re.search(
        r"The source code of quick_loop:Agent differs from that in logs/\S+\.eval, so this is a new evaluation\.", changed.out
    )
    assert "measured on 2 earlier runs of this agent" in changed.out
    # Logs started in the same second cannot be ordered by name.
    evaluations = sorted(map(read_evaluation, Path("logs").glob("*.eval")), key=lambda e: len(e.trials[0].answer))
    assert [{t.answer for t in e.trials} for e in evaluations] == [{"x"}, {"a longer answer"}]
    digests = [e.card.sampling["agent_source"] for e in evaluations]
    assert [len(digest) for digest in digests] == [16, 16] and digests[0] != digests[1]
    assert digests[1] == source_digest("quick_loop:Agent")


def test_the_source_of_a_package_includes_all_its_modules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "their_package" / "parts").mkdir(parents=True)
    for name, text in (("__init__.py", ""), ("loop.py", QUICK.format(answer="x")), ("parts/words.py", "WORD = 1\n")):
        (tmp_path / "their_package" / name).write_text(text)
    before = source_digest("their_package.loop:Agent")
    (tmp_path / "elsewhere.py").write_text("not part of the package")
    assert source_digest("their_package.loop:Agent") == before
    (tmp_path / "their_package" / "parts" / "words.py").write_text("WORD = 2\n")
    assert source_digest("their_package.loop:Agent") != before
    assert source_digest("their_package.loop:Agent") != ""


def source_digest(agent: str) -> str:
    source = find_module_source(agent, Path.cwd(), ())
    assert source is not None
    return source.digest()


STATE = State(instruction="look around", briefing=Briefing(presets=("gate",), pose=Pose(), limits=Limits()))


def state_after(state: State, decision: CallTools, *results: dict[str, Any]) -> State:
    outcomes = tuple(ToolOutcome(call=c, result=r) for c, r in zip(decision.calls, results, strict=True))
    return state.model_copy(update={"history": (*state.history, Exchange(outcomes=outcomes))})


def external(run: Callable[[Any, AgentSession], Any]) -> ChannelPlanner:
    """Return an agent in the scorer's process."""
    return ChannelPlanner(InProcessChannel(type("Agent", (), {"run": run}), "external"))


async def test_calls_that_are_awaited_together_are_one_step() -> None:
    async def run(self: Any, session: AgentSession) -> AgentReply:
        one, two = await asyncio.gather(session.call("count_objects", {"description": "a"}), session.call("take_image"))
        return AgentReply(f"{one['count']} {two['file']}", "clarification")

    planner = external(run)
    decision = await planner.step(STATE)
    assert isinstance(decision, CallTools)
    assert [c.name for c in decision.calls] == ["count_objects", "take_image"]
    end = await planner.step(state_after(STATE, decision, {"count": 2}, {"file": "x.jpg"}))
    assert isinstance(end, Finish)
    assert (end.kind, end.text) == ("clarification", "2 x.jpg")


async def test_a_failing_agent_is_not_an_infrastructure_failure() -> None:
    async def run(self: Any, session: AgentSession) -> str:
        raise ZeroDivisionError("oops")

    with pytest.raises(PlannerError, match="ZeroDivisionError: oops") as excinfo:
        await external(run).step(STATE)
    assert excinfo.value.kind == "agent-error" and excinfo.value.kind in AGENT_FAILURES


async def test_an_agent_without_an_answer() -> None:
    async def run(self: Any, session: AgentSession) -> str:
        return " "

    with pytest.raises(PlannerError, match="without an answer"):
        await external(run).step(STATE)


async def test_an_agent_that_is_stopped_ends() -> None:
    ended = threading.Event()

    async def run(self: Any, session: AgentSession) -> str:
        try:
            await session.call("take_image")
        finally:
            ended.set()
        return "never"

    planner = external(run)
    await planner.step(STATE)
    await planner.close()
    assert ended.is_set()


pytestmark = pytest.mark.anyio
