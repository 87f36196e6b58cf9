"""Replay a run without models: the recorded decisions and perception replies drive a new simulated camera.

A replay matches its recording if every call gives the same result (poses, counts, answers, clamped axes) or the same error.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, Called, Decided, Ended, Started
from scope_ptz.agent.store import NoImages
from scope_ptz.agent.timing import PerceptionMethod, PerceptionReply, Stopwatch, TimedCamera
from scope_ptz.agent.trace import Trace
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.errors import PerceptionError, PlannerError, TraceError
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.planner.base import CallTools, Decision, Planner, State

_PerceptionResult = TypeVar("_PerceptionResult", Caption, Answer, Detections, Points)

REPRODUCIBLE_OUTCOMES = ("answered", "clarification", "refused", "step_limit")
"""Outcomes that a replay must reproduce. Other outcomes, such as an exhausted budget or a failure, have external causes."""

_FILE_NAME_FIELDS = ("frames", "file")  # not compared, because a replay stores no pictures
_TOLERANCE = 0.011  # largest difference between numbers that are considered equal; results are rounded to hundredths or finer


@dataclass(frozen=True, slots=True)
class CallComparison:
    """The comparison of a recorded call with its replay. ``difference`` is empty if they agree."""

    recorded: Called
    difference: str


@dataclass(frozen=True, slots=True)
class Replay:
    """The result of a replay. ``outcome_difference`` is empty if the outcomes agree."""

    comparisons: tuple[CallComparison, ...]
    outcome_difference: str

    @property
    def matches(self) -> bool:
        """Whether the outcome and all calls agree."""
        return not self.outcome_difference and not any(c.difference for c in self.comparisons)


async def replay(trace: Trace, camera: Camera) -> Replay:
    """Replay a recorded run.

    Args:
        trace: The recorded run.
        camera: A simulated camera at the recorded start pose and scene time.

    Returns:
        The differences between the recorded and the replayed calls.

    Raises:
        TraceError: The run used a real camera and cannot be replayed.
    """
    if not trace.started.simulated:
        raise TraceError("This run used a real camera, so it cannot be replayed.")
    # Calls that failed for a reason outside the simulation would not fail again, so they are omitted.
    calls = tuple(call for call in trace.calls if call.fault not in ("camera", "cancelled"))
    script = _Script(replace(trace, calls=calls), camera)
    agent = Agent(
        _RecordedPlanner(script),
        _PacedCamera(camera, script),
        RecordedPerception(script.replies),
        NoImages(),
        budgets=Budgets(max_steps=trace.started.budgets.max_steps),
        snapshots=False,
        enforce_call_limits=False,
    )
    repeated: list[Called] = []

    def listen(record: Started | Decided | Called | Ended) -> None:
        if isinstance(record, Called):
            repeated.append(record)

    run = await agent.run(trace.started.instruction, listener=listen)
    pairs = [(recorded, repeated[i] if i < len(repeated) else None) for i, recorded in enumerate(calls)]
    comparisons = tuple(CallComparison(recorded, _difference(recorded, repeated_call)) for recorded, repeated_call in pairs)
    return Replay(comparisons, _outcome_difference(trace.ended, run.ended))


class _Script:
    """The recorded decisions, and the recorded perception replies that the replay has not used yet."""

    def __init__(self, trace: Trace, camera: Camera) -> None:
        self.decisions = complete_decisions(trace)
        self.times_s = {call.step: call.scene_time_s for call in reversed(trace.calls)}
        self.replies = recorded_replies(trace)
        self.end = trace.ended.text if trace.ended else "The recording was cut off."
        self._camera = camera

    async def wait_until(self, time_s: float) -> None:
        """Advance scene time to a recorded time, because the replay may be faster than the recorded run."""
        behind_s = time_s - self._camera.clock.now_s()
        if behind_s > 0:
            await self._camera.clock.sleep(behind_s)


def recorded_replies(trace: Trace) -> deque[tuple[int, PerceptionReply]]:
    """Return the recorded perception replies, each with its step, in order."""
    return deque((call.step, reply) for call in trace.calls for reply in call.replies)


def complete_decisions(trace: Trace) -> list[Decision]:
    """Return the recorded decisions, without the calls that an interrupted step did not make."""
    recorded = {(call.step, call.index) for call in trace.calls}
    decisions: list[Decision] = []
    for record in trace.decisions:
        decision = record.decision
        if isinstance(decision, CallTools):
            calls = tuple(call for index, call in enumerate(decision.calls) if (record.step, index) in recorded)
            if not calls:
                break
            decision = decision.model_copy(update={"calls": calls})
        decisions.append(decision)
    return decisions


class _RecordedPlanner(Planner):
    """A planner that returns the recorded decisions in order."""

    name = "recorded"

    def __init__(self, script: _Script) -> None:
        self._script = script

    async def step(self, state: State) -> Decision:
        steps = len(state.history)
        if steps >= len(self._script.decisions):
            raise PlannerError(self._script.end)
        await self._script.wait_until(self._script.times_s.get(steps + 1, 0.0))
        return self._script.decisions[steps]


class RecordedPerception(Perception):
    """A perception backend that returns the recorded replies.

    Args:
        replies: The recorded replies, each with its step, in order. Each reply is removed when it is returned.
    """

    name = "recorded"

    def __init__(self, replies: deque[tuple[int, PerceptionReply]]) -> None:
        self._replies = replies

    async def caption(self, frame: Frame) -> Caption:
        return self._next_reply(frame, "caption", "", Caption)

    async def query(self, frame: Frame, question: str) -> Answer:
        return self._next_reply(frame, "query", question, Answer)

    async def detect(self, frame: Frame, description: str) -> Detections:
        return self._next_reply(frame, "detect", description, Detections)

    async def point(self, frame: Frame, description: str) -> Points:
        return self._next_reply(frame, "point", description, Points)

    def _next_reply(self, frame: Frame, kind: PerceptionMethod, asked: str, as_type: type[_PerceptionResult]) -> _PerceptionResult:
        # Concurrent calls may arrive in an order that differs from the recorded one, but they all belong to one step.
        step = self._replies[0][0] if self._replies else 0
        matches = (
            i
            for i, (recorded_step, reply) in enumerate(self._replies)
            if recorded_step == step and (reply.kind, reply.asked) == (kind, asked)
        )
        index = next(matches, None)
        if index is None:
            raise PerceptionError(f"The recording contains no reply to {kind} '{asked}' at {frame.time_s:.2f} s.")
        _, reply = self._replies[index]
        del self._replies[index]
        return reply.restore(as_type)


class _PacedCamera(TimedCamera):
    """A camera that takes each frame no earlier than the recorded one, so that tracking sees the same motion."""

    def __init__(self, camera: Camera, script: _Script) -> None:
        super().__init__(camera, Stopwatch())
        self._script = script

    async def frame(self) -> Frame:
        if self._script.replies:
            await self._script.wait_until(self._script.replies[0][1].frame_time_s)
        return await super().frame()


def _difference(recorded: Called, repeated_call: Called | None) -> str:
    """Describe how the replayed call differs from the recorded one. The description is empty if they agree."""
    if repeated_call is None:
        return "not reached"
    before, now = recorded.outcome, repeated_call.outcome
    if before.error != now.error:
        return f"error was {before.error!r}, now {now.error!r}"
    recorded_result, replayed_result = before.result or {}, now.result or {}
    keys = [key for key in sorted(recorded_result.keys() | replayed_result.keys()) if key not in _FILE_NAME_FIELDS]
    changed = [key for key in keys if not _is_equal(recorded_result.get(key), replayed_result.get(key))]
    # The message repeats the other fields, so it is not compared separately.
    named = [key for key in changed if key != "message"]
    return "; ".join(f"{key} was {recorded_result.get(key)}, now {replayed_result.get(key)}" for key in named[:3])


def _is_equal(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_is_equal(a[key], b[key]) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_is_equal(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, float | int) and isinstance(b, float | int) and not isinstance(a, bool) and not isinstance(b, bool):
        return abs(a - b) <= _TOLERANCE
    return bool(a == b)


def _outcome_difference(before: Ended | None, now: Ended) -> str:
    if before is None or before.outcome not in REPRODUCIBLE_OUTCOMES:
        return ""
    if (before.outcome, before.text) == (now.outcome, now.text):
        return ""
    return f"the outcome was {before.outcome} ('{before.text}'), now {now.outcome} ('{now.text}')"
