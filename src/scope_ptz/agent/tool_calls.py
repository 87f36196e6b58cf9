"""Run the tool calls in a step. Calls run in order; consecutive perception calls on the current view run concurrently."""

from __future__ import annotations

import traceback
from collections import Counter
from collections.abc import Awaitable, Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import anyio

from scope_ptz.agent.planner_views import PictureStore, SharedFrameCamera
from scope_ptz.agent.records import Called, CallFault, Listener, Outcome, RecordedPose
from scope_ptz.agent.timing import PerceptionReply, Stopwatch, TimedCamera, TimedPerception, Timings
from scope_ptz.camera.base import Camera
from scope_ptz.errors import (
    CameraError,
    NotUnderstoodError,
    OutputError,
    PackError,
    PerceptionError,
    ToolCallError,
    UnknownNameError,
)
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import CallTools, Exchange, ToolCall, ToolOutcome
from scope_ptz.tools.context import ImageStore, ToolContext
from scope_ptz.tools.registry import TOOLS, ToolRegistry
from scope_ptz.tools.results import Result

MAX_CONCURRENT_CALLS = 8  # maximum number of concurrent perception calls

RunTool = Callable[[ToolContext, str, Any], Awaitable[Result]]
"""The function that runs a call: ``ToolRegistry.run`` or a wrapper around it."""

_NOT_DONE = "Not done, because the call before it failed."


class RunEnd(NamedTuple):
    """Why a run ends. ``kind`` is the failure kind of the planner's model server, if it failed."""

    outcome: Outcome
    text: str
    detail: str = ""
    kind: str | None = None


@dataclass(frozen=True, slots=True)
class _FinishedCall:
    """A finished or cancelled call.

    Attributes:
        time_s: Scene time at the start of the call.
        end: Why the run ends, if the call ends it.
        raised: An error that propagates to the run's caller: a damaged scene, or a file that cannot be written.
    """

    outcome: ToolOutcome
    fault: CallFault | None
    time_s: float
    timings: Timings
    replies: tuple[PerceptionReply, ...] = ()
    frame: str | None = None
    end: RunEnd | None = None
    raised: Exception | None = None


class CallRunner:
    """Runs the tool calls of one run and counts their failures. ``pose`` is the camera's pose after the last call."""

    def __init__(
        self,
        camera: Camera,
        perception: Perception,
        images: ImageStore,
        watch: Stopwatch,
        emit: Listener,
        *,
        snapshots: bool,
        accepts_images: bool,
        tools: ToolRegistry = TOOLS,
        run_tool: RunTool | None = None,
    ) -> None:
        self._raw_camera, self._perception, self._images, self._watch, self._emit = camera, perception, images, watch, emit
        self._snapshots, self._accepts_images, self._tools, self._run_tool = snapshots, accepts_images, tools, run_tool or tools.run
        self.camera = TimedCamera(camera, watch)
        self.pose = Pose()
        self.bad_calls = self.perception_failures = 0
        self.bad_call_repeats = 0  # number of consecutive steps with the same bad call
        self._last_bad_call: tuple[str, dict[str, Any]] | None = None
        self.events: Counter[str] = Counter()

    async def carry_out(self, step: int, decision: CallTools, history: list[Exchange]) -> RunEnd | None:
        """Run the calls in a step in order and append them to the history.

        After a failed call the remaining calls are skipped, because they were planned for a different state.

        Args:
            step: Number of the step, from 1.
            decision: The calls to run.
            history: The exchanges of the run; the step is appended, even if the run is cancelled between two calls.

        Returns:
            Why the run ends, if a call ended it; otherwise None.
        """
        results: dict[int, _FinishedCall] = {}
        try:
            for batch in batches(decision.calls, self._tools):
                await self._run_batch(step, decision.calls, batch, results)
                failed = [results[index] for index in batch if results[index].outcome.error is not None]
                if failed:
                    self._skip(step, decision.calls, batch[-1] + 1, results)
                    return next((call.end for call in failed if call.end is not None), None)
        finally:
            outcomes = tuple(call.outcome for _, call in sorted(results.items()) if call.fault != "cancelled")
            history.append(Exchange(outcomes=outcomes, thought=decision.thought))
            self._count_repetition(results.values())
        return None

    def _count_repetition(self, results: Iterable[_FinishedCall]) -> None:
        bad_calls = (result.outcome.call for result in results if result.fault == "bad_call")
        bad = next(((call.name, call.arguments) for call in bad_calls), None)
        self.bad_call_repeats = 0 if bad is None else self.bad_call_repeats + 1 if bad == self._last_bad_call else 1
        self._last_bad_call = bad

    async def _run_batch(
        self, step: int, calls: Sequence[ToolCall], batch: Sequence[int], results: dict[int, _FinishedCall]
    ) -> None:
        finished: dict[int, _FinishedCall] = {}
        try:
            if len(batch) == 1:
                await self._run_call(calls[batch[0]], batch[0], self.camera, finished)
            else:
                camera = SharedFrameCamera(self._raw_camera, self._watch)
                async with anyio.create_task_group() as group:
                    for index in batch:
                        group.start_soon(self._run_call, calls[index], index, camera, finished)
        finally:
            for index, call in sorted(finished.items()):
                results[index] = call
                if call.raised is None:
                    self._record(step, index, call)
        for call in finished.values():
            if call.raised is not None:
                raise call.raised

    async def _run_call(self, call: ToolCall, index: int, camera: TimedCamera, finished: dict[int, _FinishedCall]) -> None:
        """Run one call and store the result in ``finished``. Only a cancellation is raised."""
        time_s, before, pose = camera.clock.now_s(), self._watch.read(), self.pose
        perception, images = TimedPerception(self._perception, self._watch), PictureStore(self._images)
        fault: CallFault | None = None
        end: RunEnd | None = None
        raised: Exception | None = None
        frame: str | None = None
        try:
            result = await self._check_and_run(call, ToolContext(camera, perception, images))
            self.pose = await camera.pose()
            if self._snapshots and self.pose != pose and not getattr(result, "frames", ()):
                frame = await self._images.save_frame(await camera.frame())
            last_picture = await images.last_picture() if self._accepts_images else None
            outcome = ToolOutcome(call=call, result=result.model_dump(mode="json"), picture=last_picture)
        except (ToolCallError, UnknownNameError, NotUnderstoodError) as error:
            outcome, fault = ToolOutcome(call=call, error=str(error)), "bad_call"
            self.bad_calls += 1
        except PerceptionError as error:
            outcome, fault = ToolOutcome(call=call, error=str(error)), "perception"
            self.perception_failures += 1
        except anyio.get_cancelled_exc_class():
            outcome = ToolOutcome(call=call, error="Broken off.")
            finished[index] = _FinishedCall(outcome, "cancelled", time_s, self._watch.read() - before, perception.drain())
            raise
        except (PackError, OutputError) as error:
            outcome, raised = ToolOutcome(call=call, error=str(error)), error
        except CameraError as error:
            outcome, fault, end = ToolOutcome(call=call, error=str(error)), "camera", RunEnd("camera_error", str(error))
        except Exception as error:  # any other exception inside a tool ends the run and is recorded
            message = f"{call.name} failed: {error_text(error)}"
            outcome, fault = ToolOutcome(call=call, error=message), "camera"
            end = RunEnd("camera_error", message, traceback.format_exc())
        finished[index] = _FinishedCall(outcome, fault, time_s, self._watch.read() - before, perception.drain(), frame, end, raised)

    async def _check_and_run(self, call: ToolCall, context: ToolContext) -> Result:
        if call.problem is not None:
            raise ToolCallError(call.problem)
        return await self._run_tool(context, call.name, call.arguments)

    def _skip(self, step: int, calls: Sequence[ToolCall], first: int, results: dict[int, _FinishedCall]) -> None:
        now = self._watch.read()
        for index in range(first, len(calls)):
            outcome = ToolOutcome(call=calls[index], error=_NOT_DONE)
            results[index] = _FinishedCall(outcome, "skipped", self.camera.clock.now_s(), now - now)
            self._record(step, index, results[index])

    def _record(self, step: int, index: int, call: _FinishedCall) -> None:
        for reply in call.replies:
            self.events.update(reply.server_events)
        self._emit(
            Called(
                step=step,
                index=index,
                outcome=call.outcome,
                fault=call.fault,
                scene_time_s=call.time_s,
                pose=RecordedPose.of(self.pose),
                timings=call.timings,
                replies=call.replies,
                frame=call.frame,
            )
        )


def batches(calls: Sequence[ToolCall], tools: ToolRegistry = TOOLS) -> Iterator[list[int]]:
    """Yield the indices of the calls in batches. The calls of one batch can run concurrently.

    Consecutive calls that only read the current view share a batch. Every other call is a separate batch.
    """
    batch: list[int] = []
    for index, call in enumerate(calls):
        if _is_view_only(call, tools):
            batch.append(index)
            if len(batch) == MAX_CONCURRENT_CALLS:
                yield batch
                batch = []
            continue
        if batch:
            yield batch
            batch = []
        yield [index]
    if batch:
        yield batch


def _is_view_only(call: ToolCall, tools: ToolRegistry) -> bool:
    if call.problem is not None:
        return False
    try:
        tool, arguments = tools.parse_call(call.name, call.arguments)
    except ToolCallError:
        return False
    return tool.only_reads(arguments)


def error_text(error: Exception) -> str:
    """Return the type and the message of an error as text."""
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
