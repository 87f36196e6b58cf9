"""Carrying out the calls of a step: one after the other, looks that do not depend on each other at the same time."""

from __future__ import annotations

import traceback
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import anyio

from scope_ptz.agent.planner_views import OneView, PictureStore
from scope_ptz.agent.records import Called, CallFault, Listener, Outcome, RecordedPose
from scope_ptz.agent.timing import PerceptionReply, Stopwatch, TimedCamera, TimedPerception, Timings
from scope_ptz.camera.base import Camera
from scope_ptz.errors import CameraError, OutputError, PackError, PerceptionError, ToolCallError, UnknownNameError
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import CallTools, Exchange, ToolCall, ToolOutcome
from scope_ptz.tools.context import ImageStore, ToolContext
from scope_ptz.tools.registry import TOOLS, ToolRegistry
from scope_ptz.tools.results import Result

MOST_AT_ONCE = 8
"""Looks. A model server answers more of them no sooner."""

RunTool = Callable[[ToolContext, str, Any], Awaitable[Result]]
"""How a checked call is made: ``tools.registry.run_tool``, or something around it that watches."""

_NOT_DONE = "Not done, because the call before it failed."


class RunEnd(NamedTuple):
    """How a run ends. ``kind``: the way in which a planner's server failed."""

    outcome: Outcome
    text: str
    detail: str = ""
    kind: str | None = None


@dataclass(frozen=True, slots=True)
class _Done:
    """A call that was made or broken off. ``end``: it ends the run; ``raised``: it ends the run and whoever started it hears of
    it."""

    outcome: ToolOutcome
    fault: CallFault | None
    time_s: float
    timings: Timings
    replies: tuple[PerceptionReply, ...] = ()
    frame: str | None = None
    end: RunEnd | None = None
    raised: Exception | None = None


class CallRunner:
    """Makes the calls of one run and keeps count of what went wrong. ``pose``: where the camera looks, as far as calls have
    told."""

    def __init__(
        self,
        camera: Camera,
        perception: Perception,
        images: ImageStore,
        watch: Stopwatch,
        emit: Listener,
        *,
        snapshots: bool,
        sees: bool,
        tools: ToolRegistry = TOOLS,
        run_tool: RunTool | None = None,
    ) -> None:
        self._raw_camera, self._perception, self._images, self._watch, self._emit = camera, perception, images, watch, emit
        self._snapshots, self._sees, self._tools, self._run_tool = snapshots, sees, tools, run_tool or tools.run
        self.camera = TimedCamera(camera, watch)
        self.pose = Pose()
        self.bad_calls = self.perception_failures = 0
        self.events: Counter[str] = Counter()

    async def carry_out(self, step: int, decision: CallTools, history: list[Exchange]) -> RunEnd | None:
        """Run the calls of a step in order. After one that failed the rest is not done: it was planned for another state."""
        done: dict[int, _Done] = {}
        try:
            for batch in batches(decision.calls, self._tools):
                await self._batch(step, decision.calls, batch, done)
                failed = [done[index] for index in batch if done[index].outcome.error is not None]
                if failed:
                    self._skip(step, decision.calls, batch[-1] + 1, done)
                    return next((d.end for d in failed if d.end is not None), None)
        finally:
            # Also when the run is cancelled between two calls: what was done is history.
            outcomes = tuple(d.outcome for _, d in sorted(done.items()) if d.fault != "cancelled")
            history.append(Exchange(outcomes=outcomes, thought=decision.thought))
        return None

    async def _batch(self, step: int, calls: Sequence[ToolCall], batch: Sequence[int], done: dict[int, _Done]) -> None:
        made: dict[int, _Done] = {}
        try:
            if len(batch) == 1:
                await self._make(calls[batch[0]], batch[0], self.camera, made)
            else:
                camera = OneView(self._raw_camera, self._watch)
                async with anyio.create_task_group() as group:
                    for index in batch:
                        group.start_soon(self._make, calls[index], index, camera, made)
        finally:
            for index, call in sorted(made.items()):
                done[index] = call
                if call.raised is None:
                    self._record(step, index, call)
        for call in made.values():
            if call.raised is not None:
                raise call.raised

    async def _make(self, call: ToolCall, index: int, camera: TimedCamera, made: dict[int, _Done]) -> None:
        """Make a call and put down what came of it. Nothing but a cancellation gets out."""
        time_s, before, pose = camera.clock.now_s(), self._watch.read(), self.pose
        eyes, images = TimedPerception(self._perception, self._watch), PictureStore(self._images)
        fault: CallFault | None = None
        end: RunEnd | None = None
        raised: Exception | None = None
        frame: str | None = None
        try:
            result = await self._run(call, ToolContext(camera, eyes, images))
            self.pose = await camera.pose()
            if self._snapshots and self.pose != pose and not getattr(result, "frames", ()):
                frame = self._images.save_look(await camera.frame())
            shown = await images.shown() if self._sees else None
            outcome = ToolOutcome(call=call, result=result.model_dump(mode="json"), picture=shown)
        except (ToolCallError, UnknownNameError) as error:
            outcome, fault = ToolOutcome(call=call, error=str(error)), "bad_call"
            self.bad_calls += 1
        except PerceptionError as error:
            outcome, fault = ToolOutcome(call=call, error=str(error)), "perception"
            self.perception_failures += 1
        except anyio.get_cancelled_exc_class():
            outcome = ToolOutcome(call=call, error="Broken off.")
            made[index] = _Done(outcome, "cancelled", time_s, self._watch.read() - before, eyes.drain())
            raise
        except (PackError, OutputError) as error:
            outcome, raised = ToolOutcome(call=call, error=str(error)), error
        except CameraError as error:
            outcome, fault, end = ToolOutcome(call=call, error=str(error)), "camera", RunEnd("camera_error", str(error))
        except Exception as error:  # The episode's border: what breaks below the tools ends the run, recorded
            words = f"{call.name} broke down: {in_words(error)}"
            outcome, fault = ToolOutcome(call=call, error=words), "camera"
            end = RunEnd("camera_error", words, traceback.format_exc())
        made[index] = _Done(outcome, fault, time_s, self._watch.read() - before, eyes.drain(), frame, end, raised)

    async def _run(self, call: ToolCall, context: ToolContext) -> Result:
        if call.problem is not None:
            raise ToolCallError(call.problem)
        return await self._run_tool(context, call.name, call.arguments)

    def _skip(self, step: int, calls: Sequence[ToolCall], first: int, done: dict[int, _Done]) -> None:
        now = self._watch.read()
        for index in range(first, len(calls)):
            outcome = ToolOutcome(call=calls[index], error=_NOT_DONE)
            done[index] = _Done(outcome, "skipped", self.camera.clock.now_s(), now - now)
            self._record(step, index, done[index])

    def _record(self, step: int, index: int, done: _Done) -> None:
        for reply in done.replies:
            self.events.update(reply.server_events)
        self._emit(
            Called(
                step=step,
                index=index,
                outcome=done.outcome,
                fault=done.fault,
                scene_time_s=done.time_s,
                pose=RecordedPose.of(self.pose),
                timings=done.timings,
                replies=done.replies,
                frame=done.frame,
            )
        )


def batches(calls: Sequence[ToolCall], tools: ToolRegistry = TOOLS) -> Iterator[list[int]]:
    """The calls by index, those together that can be made at the same time: neighbours that only look, at the view of now."""
    together: list[int] = []
    for index, call in enumerate(calls):
        if _only_reads(call, tools):
            together.append(index)
            if len(together) == MOST_AT_ONCE:
                yield together
                together = []
            continue
        if together:
            yield together
            together = []
        yield [index]
    if together:
        yield together


def _only_reads(call: ToolCall, tools: ToolRegistry) -> bool:
    if call.problem is not None:
        return False
    try:
        tool, arguments = tools.parse_call(call.name, call.arguments)
    except ToolCallError:
        return False
    return tool.only_reads(arguments)


def in_words(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
