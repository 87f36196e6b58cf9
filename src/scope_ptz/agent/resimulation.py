"""Repeat the calls of a recorded run with a simulated camera, and compare the records.

``agent.replay`` compares rounded results. This module is stricter: poses, scene times, perception replies, results
and errors must equal the recorded ones, and numbers may differ only by ``NUMBER_TOLERANCE``. Measured times, retries and picture
names are not compared.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, Called, Decided, Ended, RecordedPose, Started
from scope_ptz.agent.replay import REPRODUCIBLE_OUTCOMES, RecordedPerception, complete_decisions, recorded_replies
from scope_ptz.agent.timing import PerceptionReply
from scope_ptz.agent.trace import Trace, trace_of
from scope_ptz.agent.trace_faults import trace_faults
from scope_ptz.camera.base import Camera
from scope_ptz.errors import PlannerError
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.tools.context import ImageStore
from scope_ptz.version import __version__

NUMBER_TOLERANCE = 1e-6
"""Tolerance for rounding differences between processors and math libraries: degrees for poses, fractions of the frame for boxes."""
_MEASURED_FIELDS = frozenset({"latency_s", "attempts", "wall_s", "server_events"})
"""Fields of perception replies that are measured, such as times and retries. They differ whenever a call is repeated."""
_FILE_NAME_FIELDS = frozenset({"frames", "file"})
"""Result fields that contain picture names. The pictures are compared instead of their names."""
_START_FIELDS = ("camera", "simulated", "frame_width", "frame_height", "scene", "viewpoint", "scene_time_s", "pose", "presets")


@dataclass(frozen=True, slots=True)
class Resimulation:
    """The result of repeating a run.

    Attributes:
        repeated: The trace of the repeated run.
        differences: The differences from the recorded run, as sentences without a final full stop; empty if the runs agree.
    """

    repeated: Trace
    differences: tuple[str, ...]


async def resimulate(
    trace: Trace, camera: Camera, perception: Perception | None, images: ImageStore, *, snapshots: bool
) -> Resimulation:
    """Repeat a recorded run with its recorded decisions, and compare all records.

    Args:
        trace: The recorded run.
        camera: A simulated camera in the state in which the recorded run began.
        perception: A backend that gives the same replies as the recorded one; None to repeat the recorded replies.
        images: Stores the frames of the repeated run.
        snapshots: Whether the recorded run stored its views.
    """
    # Calls that failed for a reason outside the simulation would not fail again, so the comparison ends before them.
    calls = tuple(call for call in trace.calls if call.fault not in ("camera", "cancelled"))
    repeatable = replace(trace, calls=calls)
    sees = any(decided.view is not None for decided in trace.decisions)
    agent = Agent(
        _RecordedPlanner(complete_decisions(repeatable), trace.ended.text if trace.ended else "", sees=sees),
        camera,
        perception or RecordedPerception(recorded_replies(repeatable)),
        images,
        budgets=Budgets(max_steps=trace.started.budgets.max_steps),
        labels=trace.started.labels,
        snapshots=snapshots,
        enforce_call_limits=False,
    )
    records: list[Started | Decided | Called | Ended] = []
    await agent.run(trace.started.instruction, listener=records.append)
    repeated = trace_of(records, trace.folder)
    differences = [*trace_faults(trace), *_start_differences(trace.started, repeated.started)]
    differences += _call_differences(calls, repeated.calls, messages=trace.started.version == __version__)
    if trace.ended is not None and repeated.ended is not None:
        differences += _end_differences(trace.ended, repeated.ended)
    return Resimulation(repeated, tuple(differences))


class _RecordedPlanner(Planner):
    """A planner that returns the recorded decisions in order and then fails with the recorded text."""

    name = "recorded"

    def __init__(self, decisions: list[Decision], end: str, *, sees: bool) -> None:
        self._decisions, self._end, self.sees = decisions, end, sees

    async def step(self, state: State) -> Decision:
        if len(state.history) >= len(self._decisions):
            raise PlannerError(self._end or "The recording was cut off.")
        return self._decisions[len(state.history)]


def _start_differences(recorded: Started, repeated: Started) -> Iterator[str]:
    for name in _START_FIELDS:
        before, now = _to_plain(getattr(recorded, name)), _to_plain(getattr(repeated, name))
        if not is_equal(before, now):
            yield f"the run began with {name} {before}, but the simulator gives {now}"


def _call_differences(recorded: tuple[Called, ...], repeated: tuple[Called, ...], *, messages: bool) -> Iterator[str]:
    for before, now in zip(recorded, repeated, strict=False):
        where = f"call {before.index + 1} of step {before.step} ({before.outcome.call.name})"
        if (before.step, before.index) != (now.step, now.index):
            yield f"{where} was made in a different order"
            return
        yield from (f"{where}: {difference}" for difference in _differences_in_call(before, now, messages=messages))
    for call in recorded[len(repeated) :]:
        yield f"call {call.index + 1} of step {call.step} ({call.outcome.call.name}) was recorded, but not made in the repeated run"
    for call in repeated[len(recorded) :]:
        yield f"call {call.index + 1} of step {call.step} ({call.outcome.call.name}) was made in the repeated run, but not recorded"


def _differences_in_call(before: Called, now: Called, *, messages: bool) -> Iterator[str]:
    if not _is_same_pose(before.pose, now.pose):
        yield f"the pose was recorded as {_to_plain(before.pose)}, but is {_to_plain(now.pose)}"
    if not is_equal(before.scene_time_s, now.scene_time_s):
        yield f"the scene time was recorded as {before.scene_time_s:g} s, but is {now.scene_time_s:g} s"
    if (before.outcome.error, before.fault) != (now.outcome.error, now.fault):
        yield f"the error was recorded as {before.outcome.error!r}, but is {now.outcome.error!r}"
    omitted = _FILE_NAME_FIELDS if messages else _FILE_NAME_FIELDS | {"message"}
    yield from _field_differences("result", _drop_fields(before.outcome.result, omitted), _drop_fields(now.outcome.result, omitted))
    if len(before.replies) != len(now.replies):
        yield f"{len(before.replies)} perception replies were recorded, but {len(now.replies)} were given"
        return
    for recorded, given in zip(before.replies, now.replies, strict=True):
        yield from _field_differences("perception reply", _comparable_reply(recorded), _comparable_reply(given))


def _comparable_reply(reply: PerceptionReply) -> dict[str, Any]:
    content = _drop_fields(reply.model_dump(mode="json"), _MEASURED_FIELDS)
    return {**content, "result": _drop_fields(content["result"], _MEASURED_FIELDS) if content["result"] is not None else None}


def _field_differences(what: str, before: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for name in sorted({*before, *now}):
        if not is_equal(before.get(name), now.get(name)):
            yield f"{name} in the {what} was recorded as {_abbreviate(before.get(name))}, but is {_abbreviate(now.get(name))}"


def _end_differences(recorded: Ended, repeated: Ended) -> Iterator[str]:
    if recorded.outcome not in REPRODUCIBLE_OUTCOMES:
        return
    if recorded.outcome != repeated.outcome:
        yield f"the outcome was recorded as {recorded.outcome}, but is {repeated.outcome}"
    elif recorded.text != repeated.text:
        yield f"the answer was recorded as {_abbreviate(recorded.text)}, but is {_abbreviate(repeated.text)}"
    if not _is_same_pose(recorded.pose, repeated.pose):
        yield f"the pose at the end was recorded as {_to_plain(recorded.pose)}, but is {_to_plain(repeated.pose)}"
    if not is_equal(recorded.scene_time_s, repeated.scene_time_s):
        yield f"the scene time at the end was recorded as {recorded.scene_time_s:g} s, but is {repeated.scene_time_s:g} s"


def picture_pairs(recorded: Trace, repeated: Trace) -> Iterator[tuple[str, str, str]]:
    """Yield, for each picture in a recorded run, where it was taken, its name, and the name of its counterpart in the repeated run.

    Concurrent calls can store their pictures in a different order, and thus under different names. Pictures are therefore matched
    by the call that took them. The counterpart's name is empty if the repeated run has no such picture.
    """
    if recorded.started.frame is not None:
        yield "at the start", recorded.started.frame, repeated.started.frame or ""
    for before, now in zip(recorded.decisions, repeated.decisions, strict=False):
        if before.view is not None:
            yield f"before step {before.step}", before.view, now.view or ""
    for call, repeated_call in zip(recorded.calls, repeated.calls, strict=False):
        where = f"in call {call.index + 1} of step {call.step}"
        names = _picture_names(call)
        repeated_names = _picture_names(repeated_call)
        for number, name in enumerate(names):
            yield where, name, repeated_names[number] if number < len(repeated_names) else ""


def _picture_names(call: Called) -> list[str]:
    result = call.outcome.result or {}
    names = [*(result.get("frames") or ()), result.get("file"), call.frame]
    return [name for name in names if isinstance(name, str) and name]


def is_equal(one: Any, other: Any) -> bool:
    """Return whether two JSON values are equal. Numbers may differ by ``NUMBER_TOLERANCE``."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(is_equal(one[key], other[key]) for key in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(is_equal(a, b) for a, b in zip(one, other, strict=True))
    if isinstance(one, bool) or isinstance(other, bool):
        return one is other
    if isinstance(one, int | float) and isinstance(other, int | float):
        return abs(one - other) <= NUMBER_TOLERANCE
    return bool(one == other)


def _is_same_pose(one: RecordedPose, other: RecordedPose) -> bool:
    return is_equal(one.model_dump(), other.model_dump())


def _drop_fields(content: Mapping[str, Any] | None, names: frozenset[str]) -> dict[str, Any]:
    return {name: value for name, value in (content or {}).items() if name not in names}


def _to_plain(value: Any) -> Any:
    return value.model_dump() if isinstance(value, RecordedPose) else value


def _abbreviate(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 120 else text[:117] + "..."
