"""The whole agent with misbehaving model servers: every failure is a counted event, never a crash and never a zero."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from pydantic import SecretStr

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Called, Ended, RunResult
from scope_ptz.agent.store import NoImages
from scope_ptz.agent.trace import TraceWriter
from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.endpoints.failures import FailureKind
from scope_ptz.endpoints.retries import Caller
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner
from scope_ptz.planner.chat.planner import ChatOptions, ChatPlanner
from tests.agent.scripted import ScriptedCamera, ScriptedPerception, ScriptedPlanner, answer, calls
from tests.support.faults import FAULTS, LONG_TIMEOUTS, Fault
from tests.support.misbehaving import MOONDREAM, Behaviour, Misbehaving, Say, body, good, never_accepts, nobody_listens, say
from tests.support.misbehaving import status as http_status

pytestmark = pytest.mark.anyio

KEY = "sk-very-secret-0123456789"
COUNT = ("count_objects", {"description": "cones"})
ASK = ("query_answer", {"question": "what colour is the van?"})
K = FailureKind


def endpoint(url: str, patience: Timeouts = LONG_TIMEOUTS, retries: int = 0) -> Endpoint:
    return Endpoint(url=url, model="m", key=SecretStr(KEY), timeouts=patience, retries=retries)


def planner_at(url: str, *, stream: bool, patience: Timeouts = LONG_TIMEOUTS, retries: int = 0) -> ChatPlanner:
    at = endpoint(url, patience, retries)
    return ChatPlanner(at, ChatOptions(stream=stream), client=ChatClient(at, caller=Caller(at, sleep=_no_sleep)))


async def _no_sleep(_: float) -> None:
    return None


def perception_at(url: str, backend: str, patience: Timeouts = LONG_TIMEOUTS) -> Perception:
    return make_backend(BackendSpec(name="eyes", backend=backend, model="m", endpoint=endpoint(url, patience)))


class FinishedRun:
    """A finished run, its records, and its trace."""

    def __init__(self, run: RunResult, records: list[Any], trace: str) -> None:
        self.run, self.ended, self.trace = run, run.ended, trace
        self.calls = [record for record in records if isinstance(record, Called)]


async def run(planner: Planner, perception: Perception, folder: Path) -> FinishedRun:
    """Run an agent and return the result, after checking that the trace does not contain the key."""
    records: list[Any] = []
    path = folder / "trace.jsonl"
    agent = Agent(planner, camera := ScriptedCamera(), perception, NoImages())
    with TraceWriter(path) as writer:

        def both(record: Any) -> None:
            records.append(record)
            writer(record)

        done = await agent.run("how many cones are there?", listener=both)
    await planner.close()
    await perception.close()
    trace = path.read_text()
    assert KEY not in trace
    assert isinstance(records[-1], Ended)
    assert camera.log[-1] in ("frame", "move", "stop")
    return FinishedRun(done, records, trace)


@pytest.mark.parametrize("stream", [False, True], ids=["whole", "streaming"])
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
async def test_a_planner_whose_server_fails_ends_the_run_with_the_failure_kind(fault: Fault, stream: bool, tmp_path: Path) -> None:
    with Misbehaving(then=fault.make()) as server:
        told = await run(planner_at(server.url, stream=stream, patience=fault.timeouts), ScriptedPerception(3), tmp_path)
    kind = fault.expected(stream)
    assert (told.ended.outcome, told.ended.kind) == ("planner_error", kind.value)
    assert set(told.ended.server_events) == {kind.value}
    assert told.ended.server_events[kind.value] == len(server.requests)
    assert server.url in told.ended.text


@pytest.mark.parametrize("stream", [False, True], ids=["whole", "streaming"])
async def test_a_planner_whose_server_is_unreachable(stream: bool, tmp_path: Path) -> None:
    with nobody_listens() as url:
        told = await run(planner_at(url, stream=stream), ScriptedPerception(3), tmp_path)
    assert (told.ended.outcome, told.ended.kind, told.ended.server_events) == ("planner_error", "refused", {"refused": 1})


@pytest.mark.parametrize("stream", [False, True], ids=["whole", "streaming"])
@pytest.mark.parametrize("fault", [f for f in FAULTS if f.name in ("503", "cut off", "no choices", "401")], ids=lambda f: f.name)
async def test_a_planner_whose_server_fails_midway_keeps_the_completed_steps(fault: Fault, stream: bool, tmp_path: Path) -> None:
    with Misbehaving([say("", COUNT)], then=fault.make()) as server:
        told = await run(planner_at(server.url, stream=stream), ScriptedPerception(3), tmp_path)
    assert (told.ended.outcome, told.ended.kind, told.ended.steps) == ("planner_error", fault.expected(stream).value, 2)
    assert [exchange.outcomes[0].result["count"] for exchange in told.run.exchanges if exchange.outcomes[0].result] == [3]


@pytest.mark.parametrize("stream", [False, True], ids=["whole", "streaming"])
async def test_failures_repaired_by_a_retry_are_counted(stream: bool, tmp_path: Path) -> None:
    script = [http_status(503), say("", COUNT), http_status(429), body("{"), say("Three cones.")]
    with Misbehaving(script) as server:
        told = await run(planner_at(server.url, stream=stream, retries=2), ScriptedPerception(3), tmp_path)
    # Where a stream was wanted, JSON is taken all the same: half a JSON is malformed either way.
    assert (told.ended.outcome, told.ended.text) == ("answered", "Three cones.")
    assert told.ended.server_events == {"server-error": 1, "rate-limited": 1, "malformed": 1}


ODD_CALLS: list[tuple[str, tuple[str, Any]]] = [
    ("a tool that does not exist", ("launch_rocket", {})),
    ("a tool without a name", ("", {})),
    ("an argument of a wrong type", ("adjust_ptz", {"pan_deg": "to the right"})),
    ("an argument that is a list", ("adjust_ptz", {"pan_deg": [15]})),
    ("an unknown argument", ("adjust_ptz", {"pan_deg": 15, "speed": 3})),
    ("a missing argument", ("go_to_preset", {})),
    ("an unknown preset", ("go_to_preset", {"name": "../../etc/passwd"})),
    ("NaN", ("adjust_ptz", '{"pan_deg": NaN}')),
    ("infinity", ("adjust_ptz", '{"tilt_deg": -Infinity}')),
    ("a number beyond all floats", ("adjust_ptz", '{"pan_deg": 1e999}')),
    ("a number of many digits", ("adjust_ptz", '{"pan_deg": %s}' % ("9" * 6000))),
    ("half a JSON", ("adjust_ptz", '{"pan_deg": 1')),
    ("no JSON", ("adjust_ptz", "pan right, please")),
    ("a list for arguments", ("adjust_ptz", "[15]")),
    ("an abyss", ("adjust_ptz", "[" * 50_000)),
    ("an endless description", ("count_objects", {"description": "cone " * 50_000})),
    ("lone surrogates", ("query_answer", '{"question": "\\ud800", "view": "sideways"}')),
]


@pytest.mark.parametrize("stream", [False, True], ids=["whole", "streaming"])
@pytest.mark.parametrize("call", [call for _, call in ODD_CALLS], ids=[name for name, _ in ODD_CALLS])
async def test_invalid_calls_are_returned_to_the_planner_as_errors(call: tuple[str, Any], stream: bool, tmp_path: Path) -> None:
    with Misbehaving([say("", call), say("I give up.")]) as server:
        told = await run(planner_at(server.url, stream=stream), ScriptedPerception(3), tmp_path)
    assert (told.ended.outcome, told.ended.text, told.ended.bad_calls) == ("answered", "I give up.", 1)
    assert told.calls[0].fault == "bad_call"
    assert told.calls[0].outcome.error
    assert told.ended.pose.pan_deg == told.ended.pose.tilt_deg == 0
    last = server.requests[-1].data["messages"][-1]
    assert last["role"] == "tool"
    assert told.calls[0].outcome.error[:40] in last["content"]


async def test_an_endless_answer_is_truncated(tmp_path: Path) -> None:
    with Misbehaving(then=say("a" * 200_000)) as server:
        told = await run(planner_at(server.url, stream=True), ScriptedPerception(3), tmp_path)
    assert told.ended.outcome == "answered"
    assert told.ended.text.startswith("aaa")
    assert len(told.ended.text) <= 200_000


@pytest.mark.parametrize("text", ["Drei Kegel.", "三个锥桶。", "ثلاثة أقماع", "🚧🚧🚧"])
async def test_answers_in_any_language_are_answers(text: str, tmp_path: Path) -> None:
    with Misbehaving(then=say(text)) as server:
        told = await run(planner_at(server.url, stream=True), ScriptedPerception(3), tmp_path)
    assert (told.ended.outcome, told.ended.text) == ("answered", text)


@pytest.mark.parametrize("tool", [pytest.param(COUNT, id="count"), pytest.param(ASK, id="question", marks=pytest.mark.full)])
@pytest.mark.parametrize(
    ("backend", "fault"),
    [(backend, f) for f in FAULTS for backend in ("moondream", "openai_vision") if backend != "moondream" or not f.chat_only],
    ids=lambda value: value.name if isinstance(value, Fault) else value,
)
async def test_a_failing_perception_server_is_an_error_for_the_planner(
    backend: str, fault: Fault, tool: tuple[str, dict[str, Any]], tmp_path: Path
) -> None:
    planner = ScriptedPlanner(calls(tool), answer("I could not see."))
    with Misbehaving(then=fault.make()) as server:
        told = await run(planner, perception_at(server.url, backend, fault.timeouts), tmp_path)
    assert (told.ended.outcome, told.ended.perception_failures) == ("answered", 1)
    outcome = planner.states[-1].history[0].outcomes[0]
    assert outcome.result is None
    assert outcome.error
    assert told.calls[0].fault == "perception"
    assert set(told.ended.server_events) == {fault.kind.value}
    assert '"count":0' not in told.trace.replace(" ", "")


@pytest.mark.parametrize("backend", ["moondream", "openai_vision"])
async def test_an_unreachable_perception_server_opens_the_breaker(backend: str, tmp_path: Path) -> None:
    planner = ScriptedPlanner(*[calls(COUNT)] * 8, answer("I could not see."))
    with never_accepts() as url:
        told = await run(planner, perception_at(url, backend, Timeouts(connect_s=0.2)), tmp_path)
    assert told.ended.outcome == "answered"
    assert told.ended.perception_failures == 8
    assert told.ended.server_events == {"connect-timeout": 3, "circuit-open": 5}


@pytest.mark.parametrize("backend", ["moondream", "openai_vision"])
async def test_perception_recovers(backend: str, tmp_path: Path) -> None:
    found = say(json.dumps([{"bbox_2d": [1, 1, 9, 9], "label": "cone"}])) if backend == "openai_vision" else good()
    planner = ScriptedPlanner(calls(COUNT), calls(COUNT), answer("One."))
    with Misbehaving([http_status(500)], then=found) as server:
        told = await run(planner, perception_at(server.url, backend), tmp_path)
    failed, worked = (call.outcome for call in told.calls)
    assert failed.error
    assert worked.result is not None
    assert worked.result["count"] == 1
    assert told.ended.server_events == {"server-error": 1}


def moondream_reply(**changes: Any) -> Behaviour:
    return good(moondream={**MOONDREAM, **changes})


def boxes(*corners: Any) -> dict[str, Any]:
    return {"objects": [dict(zip(("x_min", "y_min", "x_max", "y_max"), c, strict=True)) for c in corners]}


ODD_PLACES: list[tuple[str, Behaviour, int | None]] = [
    ("no field", moondream_reply(detect={"things": []}), None),
    ("null", moondream_reply(detect={"objects": None}), None),
    ("a number", moondream_reply(detect={"objects": 4}), None),
    ("text", moondream_reply(detect={"objects": "four cones"}), None),
    ("boxes as text", moondream_reply(detect={"objects": ["left", "right"]}), None),
    ("none", moondream_reply(detect={"objects": []}), 0),
    ("outside", moondream_reply(detect=boxes((-0.5, 0.2, 1.7, 0.6))), 1),
    ("500", moondream_reply(detect=boxes(*[(i / 1000, 0.1, i / 1000 + 0.2, 0.1 + (i % 7) / 10 + 0.05) for i in range(500)])), -1),
]
"""What a Moondream server answers, and the count that must come of it: None is an error, -1 any count above 0."""


@pytest.mark.parametrize(("name", "behaviour", "count"), ODD_PLACES, ids=[name for name, _, _ in ODD_PLACES])
async def test_unusual_coordinates(name: str, behaviour: Behaviour, count: int | None, tmp_path: Path) -> None:
    planner = ScriptedPlanner(calls(COUNT), answer("So."))
    with Misbehaving(then=behaviour) as server:
        told = await run(planner, perception_at(server.url, "moondream"), tmp_path)
    assert told.ended.outcome == "answered"
    outcome = told.calls[0].outcome
    if count is None:
        assert outcome.error
        assert told.calls[0].fault == "perception"
        assert told.ended.server_events == {"malformed": 1}
    else:
        assert outcome.result is not None
        assert outcome.result["count"] == count if count >= 0 else outcome.result["count"] > 0


NOT_FINITE = [
    '{"objects": [{"x_min": NaN, "y_min": 0.1, "x_max": 0.5, "y_max": 0.5}]}',
    '{"objects": [{"x_min": 0.1, "y_min": 0.1, "x_max": Infinity, "y_max": 0.5}]}',
]


@pytest.mark.parametrize("text", NOT_FINITE, ids=["NaN", "infinity"])
@pytest.mark.parametrize("backend", ["moondream", "openai_vision"])
async def test_coordinates_that_are_not_numbers_are_errors(text: str, backend: str, tmp_path: Path) -> None:
    """An unreadable box does not mean that nothing was found, so the perception call fails."""
    reply = body(text) if backend == "moondream" else say(text)
    planner = ScriptedPlanner(calls(COUNT), answer("So."))
    with Misbehaving(then=reply) as server:
        told = await run(planner, perception_at(server.url, backend), tmp_path)
    assert told.calls[0].outcome.error
    assert told.ended.server_events == {"malformed": 1}


ODD_WORDS = [
    ("prose", "I see four cones in the picture.", None),
    ("another language", "画面中有四个锥桶。", None),
    ("a refusal", "I'm sorry, but I can't help with that.", None),
    ("half a fence", '```json\n[{"bbox_2d": [100, 100, 300, 300], "label": "cone"}, {"bbox_2d": [5', 1),
    ("an empty list", "[]", 0),
    ("a label that UTF-8 cannot carry", '[{"bbox_2d": [100, 100, 300, 300], "label": "\\ud800\\u001b[2J"}]', 1),
    ("a box outside", '[{"bbox_2d": [-400, 100, 2300, 300], "label": "cone"}]', 1),
    ("infinite corners", '[{"bbox_2d": [100, 100, Infinity, 300], "label": "cone"}]', None),
    ("corners as words", '[{"bbox_2d": ["left", "top", "right", "bottom"], "label": "cone"}]', None),
    ("no box, only labels", '[{"label": "cone"}, {"label": "cone"}]', None),
    ("a list in prose", 'Here: [{"bbox_2d": [100, 100, 300, 300], "label": "锥桶"}] - that is all.', 1),
]


@pytest.mark.parametrize(("text", "count"), [odd[1:] for odd in ODD_WORDS], ids=[odd[0] for odd in ODD_WORDS])
async def test_unusual_names_of_coordinates(text: str, count: int | None, tmp_path: Path) -> None:
    perception = BackendSpec(name="eyes", backend="openai_vision", model="m", coordinates="qwen3-vl")
    planner = ScriptedPlanner(calls(COUNT), answer("So."))
    with Misbehaving(then=good(Say(text))) as server:
        perception = perception.model_copy(update={"endpoint": endpoint(server.url)})
        told = await run(planner, make_backend(perception), tmp_path)
    outcome = told.calls[0].outcome
    if count is None:
        assert outcome.error
        assert told.ended.server_events == {"malformed": 1}
    else:
        assert outcome.result is not None
        assert outcome.result["count"] == count


def _many(number: int) -> list[tuple[float, float]]:
    return [(0.02 + (i % 25) * 0.038, 0.02 + (i // 25) * 0.045) for i in range(number)]


@pytest.mark.parametrize("backend", ["moondream", "openai_vision"])
async def test_500_points_are_limited_and_incomplete(backend: str) -> None:
    frame = await ScriptedCamera().frame()
    if backend == "moondream":
        reply = moondream_reply(point={"points": [{"x": x, "y": y} for x, y in _many(500)]})
    else:
        reply = say(json.dumps([{"point_2d": [1000 * x, 1000 * y], "label": "cone"} for x, y in _many(500)]))
    with Misbehaving(then=reply) as server:
        spec = BackendSpec(name="eyes", backend=backend, model="m", endpoint=endpoint(server.url), coordinates="qwen3-vl")
        perception = make_backend(spec)
        seen = await perception.point(frame, "cones")
        await perception.close()
    assert 50 <= len(seen.points) <= 500
    assert all(0 <= point.x <= 1 and 0 <= point.y <= 1 for point in seen.points)
    assert len(seen.points) == 500 or not seen.complete
