"""Independent perception calls run concurrently, server failures are counted, and planners with vision get frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anyio
import pytest

from scope_ptz.agent.records import Budgets, Called, Decided, RunResult
from scope_ptz.agent.replay import replay
from scope_ptz.agent.store import NoImages, RunFolder
from scope_ptz.agent.tool_calls import MAX_CONCURRENT_CALLS, batches
from scope_ptz.agent.trace import TraceWriter, read_trace
from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.errors import CameraError, PerceptionError, PlannerError
from scope_ptz.perception.base import Answer, Detections
from scope_ptz.planner.base import ToolCall
from tests.agent.scripted import ScriptedCamera, ScriptedPerception, ScriptedPlanner, answer, calls, make_agent

MOVE = ("adjust_ptz", {"pan_deg": 15.0})
CONES = ("count_objects", {"description": "cones"})
CARS = ("count_objects", {"description": "cars", "view": "current"})
COLOUR = ("query_answer", {"question": "which colour?"})
SWEEP = ("count_objects", {"description": "cars", "view": "full"})
WRONG = ("count_objects", {"thing": "cars"})
PAUSE_S = 0.15


class SlowPerception(ScriptedPerception):
    """Slow perception that records concurrent calls and their frames. Each count is the length of the description."""

    def __init__(self) -> None:
        super().__init__(1)
        self.active = self.max_active = 0
        self.frames: list[Frame] = []

    async def _count(self, frame: Frame, text: str) -> int:
        self.frames.append(frame)
        self.active += 1
        self.max_active = max(self.max_active, self.active)
        try:
            # The first request is answered last.
            await anyio.sleep(PAUSE_S * (1.5 if text == "cones" else 1.0))
        finally:
            self.active -= 1
        if text == "nothing":
            raise PerceptionError("the server is gone", kind="refused", attempts=(Attempt(kind=FailureKind.REFUSED),) * 2)
        return len(text)

    async def detect(self, frame: Frame, description: str) -> Detections:
        detections = await ScriptedPerception(await self._count(frame, description)).detect(frame, description)
        return detections.model_copy(update={"attempts": (Attempt(kind=FailureKind.RATE_LIMITED), Attempt())})

    async def query(self, frame: Frame, question: str) -> Answer:
        return Answer(source=self.name, text=str(await self._count(frame, question)))


def run(*script: Any, perception: Any = None, **options: Any) -> tuple[RunResult, list[Any]]:
    records: list[Any] = []
    agent = make_agent(*script, **options)
    agent.perception = perception or SlowPerception()
    return anyio.run(lambda: agent.run("do it", listener=records.append)), records


def batches_of(*requests: tuple[str, dict[str, Any]]) -> list[list[int]]:
    return list(batches(calls(*requests).calls))


def test_only_adjacent_calls_on_the_current_view_run_concurrently() -> None:
    assert batches_of(CONES, CARS, COLOUR) == [[0, 1, 2]]
    assert batches_of(CONES, MOVE, CARS, COLOUR) == [[0], [1], [2, 3]]
    assert batches_of(CONES, SWEEP, CARS) == [[0], [1], [2]]
    assert batches_of(CONES, WRONG, ("nonsense", {}), CARS) == [[0], [1], [2], [3]]
    assert batches_of(*[CONES] * (MAX_CONCURRENT_CALLS + 2)) == [
        list(range(MAX_CONCURRENT_CALLS)),
        [MAX_CONCURRENT_CALLS, MAX_CONCURRENT_CALLS + 1],
    ]
    malformed_call = ToolCall(id="a", name="count_objects", arguments={"description": "cones"}, problem="cut off")
    assert list(batches([malformed_call, *calls(CARS).calls])) == [[0], [1]]


def test_concurrent_calls_share_a_frame_and_return_in_order() -> None:
    perception, camera = SlowPerception(), ScriptedCamera()
    result, records = run(calls(CONES, CARS, COLOUR), answer(), perception=perception, camera=camera)
    assert perception.max_active == 3
    assert len({id(frame) for frame in perception.frames}) == 1
    called = [r for r in records if isinstance(r, Called)]
    assert [r.outcome.call.name for r in called] == ["count_objects", "count_objects", "query_answer"]
    assert [r.index for r in called] == [0, 1, 2]
    assert [[reply.asked for reply in r.replies] for r in called] == [["cones"], ["cars"], ["which colour?"]]
    results = [o.result for o in result.exchanges[0].outcomes]
    assert [r and r.get("count") for r in results] == [5, 4, None]
    # Overlapping time is counted once in the run's timings.
    timings = result.ended.timings
    assert timings.perception_s < 2 * PAUSE_S
    assert timings.planner_s + timings.perception_s + timings.camera_s + timings.render_s <= timings.total_s
    assert all(r.timings.perception_s >= PAUSE_S * 0.9 for r in called)


def test_a_failed_call_skips_later_calls_but_not_concurrent_ones() -> None:
    nothing = ("count_objects", {"description": "nothing"})
    result, records = run(calls(nothing, CARS, MOVE), answer())
    first, second, third = result.exchanges[0].outcomes
    assert (first.error, first.result) == ("the server is gone", None)
    assert second.result is not None
    assert second.result["count"] == 4
    assert third.error == "Not done, because the call before it failed."
    assert [r.fault for r in records if isinstance(r, Called)] == ["perception", None, "skipped"]
    assert (result.ended.perception_failures, result.ended.pose.pan_deg) == (1, 0.0)
    assert result.ended.server_events == {"rate-limited": 1, "refused": 2}


def test_a_camera_that_fails_ends_the_run_once() -> None:
    camera = ScriptedCamera()
    agent = make_agent(lambda _: camera.failures.update(frame=CameraError("no picture")) or calls(CONES, CARS), camera=camera)
    result = anyio.run(agent.run, "look")
    assert (result.ended.outcome, result.ended.text) == ("camera_error", "no picture")


def test_interrupted_perception_calls_are_recorded() -> None:
    result, records = run(calls(CONES, CARS), budgets=Budgets(time_s=PAUSE_S * 1.2))
    assert result.ended.outcome == "budget"
    called = [r for r in records if isinstance(r, Called)]
    assert [(r.index, r.fault) for r in called] == [(0, "cancelled"), (1, None)]
    assert [o.call.arguments["description"] for o in result.exchanges[0].outcomes] == ["cars"]


def test_runs_with_concurrent_perception_calls_can_be_replayed(tmp_path: Path) -> None:
    agent = make_agent(calls(COLOUR, CONES, CARS), calls(MOVE), calls(CONES, COLOUR), answer())
    agent.perception = SlowPerception()
    folder = RunFolder.create(tmp_path, "look")
    agent.images = folder

    async def record() -> None:
        with TraceWriter(folder.trace) as trace:
            await agent.run("look", listener=trace)

    anyio.run(record)
    replayed_run = anyio.run(replay, read_trace(folder.path), ScriptedCamera())
    assert replayed_run.matches, [c.difference for c in replayed_run.comparisons] + [replayed_run.outcome_difference]
    assert len(replayed_run.comparisons) == 6


def test_failed_requests_of_a_planner_are_counted_and_its_error_has_a_kind() -> None:
    attempts = (Attempt(kind=FailureKind.SERVER_ERROR), Attempt(kind=FailureKind.CONTEXT_OVERFLOW))
    result, _ = run(PlannerError("too long", kind="context-overflow", attempts=attempts))
    assert (result.ended.outcome, result.ended.kind) == ("planner_error", "context-overflow")
    assert result.ended.server_events == {"context-overflow": 1, "server-error": 1}
    result, _ = run(PlannerError("empty", kind="empty", attempts=(Attempt(),)))
    assert result.ended.server_events == {"empty": 1}


@pytest.mark.parametrize("sees", [True, False])
def test_planners_with_vision_get_the_newest_view_and_the_pictures(sees: bool) -> None:
    agent = make_agent(calls(("take_image", {}), MOVE), calls(CONES), answer(), counts=[1], images=NoImages())
    planner = agent.planner
    assert isinstance(planner, ScriptedPlanner)
    planner.sees = sees
    records: list[Any] = []
    result = anyio.run(lambda: agent.run("look", listener=records.append))
    views = [state.view for state in planner.states]
    pictures = [outcome.picture for outcome in result.exchanges[0].outcomes]
    if not sees:
        assert (views, pictures) == ([None] * 3, [None, None])
        return
    first, second, _ = views
    assert first is not None
    assert second is not None
    assert first.data_url.startswith("data:image/jpeg;base64,")
    assert (first.data_url != second.data_url, "pan 15" in second.caption) == (True, True)
    assert pictures[0] is not None
    assert pictures[1] is None
    assert all(r.view for r in records if isinstance(r, Decided))
    assert "base64" not in "".join(r.model_dump_json() for r in records)


def test_a_camera_that_fails_to_provide_a_view_for_the_planner_ends_the_run() -> None:
    camera = ScriptedCamera()
    agent = make_agent(
        lambda _: camera.failures.update(frame=CameraError("no picture")) or calls(("get_presets", {})), camera=camera
    )
    agent.planner.sees = True
    result = anyio.run(agent.run, "look")
    assert (result.ended.outcome, result.ended.text) == ("camera_error", "no picture")
