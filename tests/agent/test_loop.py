"""The agent loop: outcomes, attribution of failures, budgets, and the state that the planner gets."""

from __future__ import annotations

from typing import Any

import anyio
import pytest

from scope_ptz.agent.records import Budgets, Called, Ended, RunResult, Started
from scope_ptz.camera.base import Arrival
from scope_ptz.errors import CameraError, InputError, PackError, PerceptionError, PlannerError
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import Finish, PastTurn, State
from tests.agent.scripted import ScriptedCamera, ScriptedPlanner, answer, calls, make_agent

MOVE = ("adjust_ptz", {"pan_deg": 15.0})
COUNT = ("count_objects", {"description": "cones"})


def run(*script: Any, **options: Any) -> tuple[RunResult, list[Any]]:
    records: list[Any] = []
    conversation = options.pop("conversation", ())

    async def work() -> RunResult:
        return await make_agent(*script, **options).run("do it", conversation=conversation, listener=records.append)

    return anyio.run(work), records


def test_results_are_appended_until_the_planner_answers() -> None:
    result, records = run(calls(MOVE), calls(COUNT), answer("Four."), counts=[4])
    assert (result.ended.outcome, result.ended.text, result.ended.steps) == ("answered", "Four.", 3)
    assert [e.outcomes[0].call.name for e in result.exchanges] == ["adjust_ptz", "count_objects"]
    count_result = result.exchanges[1].outcomes[0].result
    assert count_result is not None
    assert count_result["count"] == 4
    assert [r.event for r in records] == ["start", "decision", "call", "decision", "call", "decision", "end"]
    assert result.ended.pose.pan_deg == 15.0


def test_the_planner_sees_instruction_history_conversation_and_tools() -> None:
    earlier = PastTurn(instruction="hello", exchanges=(), reply="hi")
    agent = make_agent(calls(MOVE), answer())
    planner = agent.planner
    assert isinstance(planner, ScriptedPlanner)
    anyio.run(lambda: agent.run("  look right ", conversation=(earlier,)))
    first, second = planner.states
    assert first.instruction == "look right"
    assert first.conversation == (earlier,)
    assert first.briefing.presets == ("gate", "highway")
    assert len(first.tools) == 9
    assert (first.history, len(second.history)) == ((), 1)


@pytest.mark.parametrize("kind", ["answered", "clarification", "refused"])
def test_a_planner_can_finish_in_three_ways(kind: Any) -> None:
    result, _ = run(Finish(kind=kind, text="words"))
    assert (result.ended.outcome, result.ended.text) == (kind, "words")


def test_step_limit() -> None:
    camera = ScriptedCamera()
    result, _ = run(calls(MOVE), camera=camera, budgets=Budgets(max_steps=3))
    assert (result.ended.outcome, result.ended.steps, len(result.exchanges)) == ("step_limit", 3, 3)
    assert camera.log[-1] == "stop"


def test_time_budget_also_ends_a_planner_that_hangs() -> None:
    class HangingPlanner(ScriptedPlanner):
        async def step(self, state: State) -> Any:
            await anyio.sleep(30)

    agent = make_agent(answer(), budgets=Budgets(time_s=0.05))
    agent.planner = HangingPlanner()
    result = anyio.run(agent.run, "wait")
    assert result.ended.outcome == "budget"
    assert "time" in result.ended.text


def test_token_budget_is_checked_before_the_calls_are_made() -> None:
    result, _ = run(calls(MOVE, tokens=60), calls(MOVE, tokens=60), budgets=Budgets(tokens=100))
    assert (result.ended.outcome, len(result.exchanges), result.ended.usage.input_tokens) == ("budget", 1, 120)


def test_an_answer_that_spends_the_last_tokens_still_counts() -> None:
    result, _ = run(
        calls(MOVE, tokens=90), Finish(kind="answered", text="x", usage=calls(MOVE, tokens=50).usage), budgets=Budgets(tokens=100)
    )
    assert result.ended.outcome == "answered"


@pytest.mark.parametrize(
    "bad",
    [
        ("pan_camera", {}),
        ("adjust_ptz", {"pan_deg": "a lot"}),
        ("adjust_ptz", {"pan_deg": float("nan")}),
        ("adjust_ptz", {"speed": 3}),
        ("go_to_preset", {"name": "nowhere"}),
        ("go_to_preset", {"name": "../../etc/passwd"}),
    ],
)
def test_bad_calls_go_back_to_the_planner_and_are_counted(bad: tuple[str, dict[str, Any]]) -> None:
    result, records = run(calls(bad), answer())
    assert (result.ended.outcome, result.ended.bad_calls) == ("answered", 1)
    outcome = result.exchanges[0].outcomes[0]
    assert outcome.error
    assert outcome.result is None
    assert [r.fault for r in records if isinstance(r, Called)] == ["bad_call"]


def test_calls_after_a_failed_call_are_not_made() -> None:
    result, _ = run(calls(("go_to_preset", {"name": "nowhere"}), MOVE), answer())
    first, second = result.exchanges[0].outcomes
    assert first.error is not None
    assert second.error == "Not done, because the call before it failed."
    assert result.ended.pose.pose() == Pose()
    assert result.ended.bad_calls == 1


def test_a_failed_perception_call_is_an_error_and_not_a_count() -> None:
    result, _ = run(calls(COUNT), answer(), counts=[PerceptionError("the model timed out")])
    outcome = result.exchanges[0].outcomes[0]
    assert (outcome.result, outcome.error) == (None, "the model timed out")
    assert (result.ended.outcome, result.ended.perception_failures, result.ended.bad_calls) == ("answered", 1, 0)


@pytest.mark.parametrize("failure", [CameraError("no route to the camera"), RuntimeError("a bug")])
def test_a_camera_that_fails_ends_the_run(failure: Exception) -> None:
    result, records = run(calls(MOVE), answer(), camera=ScriptedCamera(failures={"move": failure}))
    assert result.ended.outcome == "camera_error"
    assert str(failure) in result.ended.text
    assert len(result.exchanges) == 1
    assert [r.fault for r in records if isinstance(r, Called)] == ["camera"]
    assert bool(result.ended.detail) == isinstance(failure, RuntimeError)


@pytest.mark.parametrize("failure", [PlannerError("no decision"), ZeroDivisionError("a bug")])
def test_a_planner_that_fails_ends_the_run(failure: Exception) -> None:
    result, _ = run(failure)
    assert result.ended.outcome == "planner_error"
    assert str(failure) in result.ended.text


def test_an_invalid_decision_is_a_planner_error() -> None:
    result, _ = run(lambda _: "42")
    assert result.ended.outcome == "planner_error"


def test_damaged_packs_are_recorded_and_raised() -> None:
    records: list[Any] = []
    camera = ScriptedCamera()
    agent = make_agent(calls(MOVE), answer(), camera=camera)
    camera.failures["move"] = PackError("ids.png is damaged")

    async def work() -> None:
        await agent.run("go", listener=records.append)

    with pytest.raises(PackError):
        anyio.run(work)
    assert isinstance(records[-1], Ended)
    assert records[-1].outcome == "camera_error"


def test_cancelling_stops_the_camera_and_completes_the_trace() -> None:
    records: list[Any] = []
    camera = ScriptedCamera()

    async def work() -> None:
        with anyio.CancelScope() as scope:

            def listener(record: Any) -> None:
                records.append(record)
                if isinstance(record, Called):
                    scope.cancel()

            await make_agent(calls(MOVE), camera=camera).run("keep panning", listener=listener)
            raise AssertionError("a cancelled run must not return")

    anyio.run(work)
    assert (records[-1].event, records[-1].outcome) == ("end", "cancelled")
    assert camera.log[-1] == "stop"
    assert records[-1].pose.pan_deg == 15.0


@pytest.mark.parametrize("instruction", ["", "  \n\t", "x" * 5000])
def test_invalid_instructions_are_rejected(instruction: str) -> None:
    with pytest.raises(InputError):
        anyio.run(make_agent(answer()).run, instruction)


def test_times_of_the_stages_add_up() -> None:
    result, records = run(calls(MOVE), calls(COUNT), answer(), counts=[2])
    timings = result.ended.timings
    parts = timings.planner_s + timings.perception_s + timings.camera_s + timings.render_s
    assert 0 < parts <= timings.total_s
    count_call = next(r for r in records if isinstance(r, Called) and r.outcome.call.name == "count_objects")
    assert count_call.timings.render_s > 0
    assert count_call.timings.total_s >= count_call.timings.perception_s > 0
    assert [(r.kind, r.asked) for r in count_call.replies] == [("detect", "cones")]
    header = records[0]
    assert isinstance(header, Started)
    assert header.labels.seed == 7


def test_runs_share_no_state() -> None:
    agent = make_agent(calls(MOVE), answer())
    first, second = anyio.run(agent.run, "one"), anyio.run(agent.run, "two")
    assert len(first.exchanges) == len(second.exchanges) == 1
    assert second.ended.pose.pan_deg == 30.0  # The camera keeps its pose between runs; the loop keeps no state.


def test_an_interrupted_call_is_recorded() -> None:
    class Slow(ScriptedCamera):
        async def move(self, pose: Pose) -> Arrival:
            await anyio.sleep(30)
            return await super().move(pose)

    result, records = run(calls(MOVE), camera=Slow(), budgets=Budgets(time_s=0.05))
    assert result.ended.outcome == "budget"
    (call,) = [r for r in records if isinstance(r, Called)]
    assert (call.fault, call.outcome.error) == ("cancelled", "Broken off.")


def test_a_camera_that_does_not_answer_before_the_first_step_is_an_error() -> None:
    records: list[Any] = []
    agent = make_agent(answer(), camera=ScriptedCamera(failures={"frame": CameraError("no route")}))

    async def work() -> None:
        await agent.run("go", listener=records.append)

    with pytest.raises(CameraError, match="no route"):
        anyio.run(work)
    assert records == []
