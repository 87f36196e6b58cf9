"""Repeating a run without models: the same loop with the recorded planner and the recorded eyes on a fresh simulated camera.

What must come out again are the results of every call (poses, counts, answers, what was clamped) and its errors.
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

_Looked = TypeVar("_Looked", Caption, Answer, Detections, Points)

REPEATABLE = ("answered", "clarification", "refused", "step_limit")
"""Outcomes that a replay must reach again. The others came from outside: a budget, a failure, a hand on the keyboard."""

_NAMES_OF_FILES = ("frames", "file")
_TOLERANCE = 0.011
"""Numbers in results are rounded to hundredths and finer; two that differ by less than this are the same."""


@dataclass(frozen=True, slots=True)
class CallComparison:
    """One recorded call beside its repetition; ``difference`` is empty when they agree."""

    recorded: Called
    difference: str


@dataclass(frozen=True, slots=True)
class Replay:
    """What a replay found."""

    comparisons: tuple[CallComparison, ...]
    outcome_difference: str

    @property
    def equal(self) -> bool:
        return not self.outcome_difference and not any(c.difference for c in self.comparisons)


async def replay(trace: Trace, camera: Camera) -> Replay:
    """Repeat a recorded run on a camera that stands where the recorded one stood, at the same scene time.

    Raises ``TraceError`` for a run of a real camera: its world cannot be had again.
    """
    if not trace.started.simulated:
        raise TraceError("This run was made with a real camera: it can be shown, not repeated.")
    # A call that failed for a reason outside the scene cannot fail again; what came before it can be repeated.
    calls = tuple(call for call in trace.calls if call.fault not in ("camera", "cancelled"))
    script = _Script(replace(trace, calls=calls), camera)
    agent = Agent(
        _RecordedPlanner(script),
        _PacedCamera(camera, script),
        _RecordedPerception(script),
        NoImages(),
        budgets=Budgets(max_steps=trace.started.budgets.max_steps),
        snapshots=False,
    )
    made: list[Called] = []

    def listen(record: Started | Decided | Called | Ended) -> None:
        if isinstance(record, Called):
            made.append(record)

    run = await agent.run(trace.started.instruction, listener=listen)
    pairs = [(recorded, made[i] if i < len(made) else None) for i, recorded in enumerate(calls)]
    comparisons = tuple(CallComparison(recorded, _difference(recorded, again)) for recorded, again in pairs)
    return Replay(comparisons, _outcome_difference(trace.ended, run.ended))


class _Script:
    """The recorded decisions and replies, and how far the replay has come."""

    def __init__(self, trace: Trace, camera: Camera) -> None:
        self.decisions = _complete_decisions(trace)
        self.times_s = {call.step: call.scene_time_s for call in reversed(trace.calls)}
        self.replies: deque[tuple[int, PerceptionReply]] = deque(
            (call.step, reply) for call in trace.calls for reply in call.replies
        )
        self.end = trace.ended.text if trace.ended else "The recording was cut off."
        self._camera = camera

    async def wait_until(self, time_s: float) -> None:
        """Let scene time go on to where it was when this happened; the recorded run may have been slower."""
        behind_s = time_s - self._camera.clock.now_s()
        if behind_s > 0:
            await self._camera.clock.sleep(behind_s)


def _complete_decisions(trace: Trace) -> list[Decision]:
    """The recorded decisions; of a step that was broken off only the calls that were made."""
    made = {(call.step, call.index) for call in trace.calls}
    decisions: list[Decision] = []
    for record in trace.decisions:
        decision = record.decision
        if isinstance(decision, CallTools):
            calls = tuple(call for index, call in enumerate(decision.calls) if (record.step, index) in made)
            if not calls:
                break
            decision = decision.model_copy(update={"calls": calls})
        decisions.append(decision)
    return decisions


class _RecordedPlanner(Planner):
    name = "recorded"

    def __init__(self, script: _Script) -> None:
        self._script = script

    async def step(self, state: State) -> Decision:
        done = len(state.history)
        if done >= len(self._script.decisions):
            raise PlannerError(self._script.end)
        await self._script.wait_until(self._script.times_s.get(done + 1, 0.0))
        return self._script.decisions[done]


class _RecordedPerception(Perception):
    name = "recorded"

    def __init__(self, script: _Script) -> None:
        self._replies = script.replies

    async def caption(self, frame: Frame) -> Caption:
        return self._next(frame, "caption", "", Caption)

    async def query(self, frame: Frame, question: str) -> Answer:
        return self._next(frame, "query", question, Answer)

    async def detect(self, frame: Frame, description: str) -> Detections:
        return self._next(frame, "detect", description, Detections)

    async def point(self, frame: Frame, description: str) -> Points:
        return self._next(frame, "point", description, Points)

    def _next(self, frame: Frame, kind: PerceptionMethod, asked: str, as_type: type[_Looked]) -> _Looked:
        # Looks that were made at the same time may ask in another order now; they are all of one step.
        step = self._replies[0][0] if self._replies else 0
        fitting = (i for i, (at, reply) in enumerate(self._replies) if at == step and (reply.kind, reply.asked) == (kind, asked))
        index = next(fitting, None)
        if index is None:
            raise PerceptionError(f"The recording holds no reply to {kind} '{asked}' at {frame.time_s:.2f} s.")
        _, reply = self._replies[index]
        del self._replies[index]
        return reply.restore(as_type)


class _PacedCamera(TimedCamera):
    """Takes each frame that perception will look at no earlier than the recorded one was taken: it paces what is tracked."""

    def __init__(self, camera: Camera, script: _Script) -> None:
        super().__init__(camera, Stopwatch())
        self._script = script

    async def frame(self) -> Frame:
        if self._script.replies:
            await self._script.wait_until(self._script.replies[0][1].frame_time_s)
        return await super().frame()


def _difference(recorded: Called, again: Called | None) -> str:
    """What differs between a call and its repetition, in words; empty when nothing does."""
    if again is None:
        return "not reached"
    before, now = recorded.outcome, again.outcome
    if before.error != now.error:
        return f"error was {before.error!r}, now {now.error!r}"
    old, new = before.result or {}, now.result or {}
    keys = [key for key in sorted(old.keys() | new.keys()) if key not in _NAMES_OF_FILES]
    changed = [key for key in keys if not _same(old.get(key), new.get(key))]
    # Sentences repeat the numbers beside them; they are named only when nothing else says what changed.
    named = [key for key in changed if key != "message"]
    return "; ".join(f"{key} was {old.get(key)}, now {new.get(key)}" for key in named[:3])


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, float | int) and isinstance(b, float | int) and not isinstance(a, bool) and not isinstance(b, bool):
        return abs(a - b) <= _TOLERANCE
    return bool(a == b)


def _outcome_difference(before: Ended | None, now: Ended) -> str:
    if before is None or before.outcome not in REPEATABLE:
        return ""
    if (before.outcome, before.text) == (now.outcome, now.text):
        return ""
    return f"it ended {before.outcome} ('{before.text}'), now {now.outcome} ('{now.text}')"
