"""The agent loop: the paper's recurrence over S_t = (U, H_t, O_t), with budgets and typed outcomes.

There is one code path. Who wants to watch passes a listener, who does not simply awaits the end.
"""

from __future__ import annotations

import platform
import traceback
from contextlib import suppress
from datetime import UTC, datetime
from typing import NamedTuple

import anyio

from scope_ptz import __version__
from scope_ptz.agent.records import Budgets, Called, Decided, Ended, Fault, Labels, Listener, Outcome, Place, Run, Started
from scope_ptz.agent.timing import Stopwatch, TimedCamera, TimedPerception, Timings
from scope_ptz.camera.base import Camera
from scope_ptz.errors import (
    CameraError,
    InputError,
    OutputError,
    PackError,
    PerceptionError,
    PlannerError,
    ToolCallError,
    UnknownNameError,
)
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import (
    Briefing,
    CallTools,
    Decision,
    Exchange,
    Finish,
    PastTurn,
    Planner,
    State,
    ToolCall,
    ToolOutcome,
    Usage,
)
from scope_ptz.tools.context import ImageStore, ToolContext
from scope_ptz.tools.registry import run_tool, schemas

MAX_INSTRUCTION_CHARS = 4000
STOP_TIMEOUT_S = 5.0


class Agent:
    """A planner, a camera and perception put together. Holds nothing between runs."""

    def __init__(
        self,
        planner: Planner,
        camera: Camera,
        perception: Perception,
        images: ImageStore,
        *,
        budgets: Budgets | None = None,
        labels: Labels | None = None,
        snapshots: bool = True,
    ) -> None:
        """``snapshots``: keep the first view and the view after each move; tools keep what perception looks at in any case."""
        self.planner, self.camera, self.perception, self.images = planner, camera, perception, images
        self.budgets, self.labels, self.snapshots = budgets or Budgets(), labels or Labels(), snapshots

    async def run(self, instruction: str, *, conversation: tuple[PastTurn, ...] = (), listener: Listener = lambda _: None) -> Run:
        """Carry out an instruction.

        Raises:
            InputError: the instruction is empty or too long, or a file cannot be written.
            PackError: the scene's files are damaged.
            CameraError: the camera does not answer before the first step. Later failures are outcomes of the run.
        """
        instruction = instruction.strip()
        if not instruction:
            raise InputError("The instruction is empty. Say what the camera should do.")
        if len(instruction) > MAX_INSTRUCTION_CHARS:
            raise InputError(f"The instruction is longer than {MAX_INSTRUCTION_CHARS} characters.")
        return await _Episode(self, instruction, conversation, listener).run()


class _End(NamedTuple):
    outcome: Outcome
    text: str
    detail: str = ""


class _Episode:
    """One run's state."""

    def __init__(self, agent: Agent, instruction: str, conversation: tuple[PastTurn, ...], listener: Listener) -> None:
        self.agent, self.instruction, self.conversation, self.emit = agent, instruction, conversation, listener
        self.watch = Stopwatch()
        self.camera = TimedCamera(agent.camera, self.watch)
        self.perception = TimedPerception(agent.perception, self.watch)
        self.context = ToolContext(self.camera, self.perception, agent.images)
        self.history: list[Exchange] = []
        self.pose = Pose()
        self.steps = self.bad_calls = self.perception_failures = 0
        self.usage = Usage()

    async def run(self) -> Run:
        briefing = await self._start()
        try:
            with anyio.move_on_after(self.agent.budgets.time_s) as time_limit:
                end = await self._steps(briefing)
            if time_limit.cancelled_caught:
                end = _End("budget", f"The time budget of {self.agent.budgets.time_s:g} s is spent.")
        except anyio.get_cancelled_exc_class():
            await self._finish(_End("cancelled", "The run was cancelled."))
            raise
        except (PackError, OutputError) as error:
            # Not the agent's doing and not to be tried again: it is recorded and whoever started the run hears of it.
            with suppress(OutputError):
                await self._finish(_End("camera_error", str(error)))
            raise
        ended = await self._finish(end)
        return Run(instruction=self.instruction, exchanges=tuple(self.history), ended=ended)

    async def _start(self) -> Briefing:
        agent, info = self.agent, self.camera.info
        presets = tuple(p.name for p in await self.camera.presets())
        self.pose = await self.camera.pose()
        # The first frame tells scene and viewpoint, and shows before anything moves that pictures can be had.
        frame = await self.camera.frame()
        self.emit(
            Started(
                version=__version__,
                python=platform.python_version(),
                started=datetime.now(UTC),
                instruction=self.instruction,
                planner=agent.planner.name,
                perception=agent.perception.name,
                camera=info.name,
                simulated=info.simulated,
                frame_width=info.frame_width,
                frame_height=info.frame_height,
                scene=frame.origin.scene if frame.origin else None,
                viewpoint=frame.origin.viewpoint if frame.origin else None,
                scene_time_s=self.camera.clock.now_s(),
                pose=Place.of(self.pose),
                presets=presets,
                budgets=agent.budgets,
                labels=agent.labels,
                conversation=self.conversation,
                frame=agent.images.save_look(frame) if agent.snapshots else None,
            )
        )
        return Briefing(presets=presets, pose=self.pose, limits=info.limits)

    async def _steps(self, briefing: Briefing) -> _End:
        budgets, tools = self.agent.budgets, tuple(schemas())
        for self.steps in range(1, budgets.max_steps + 1):
            state = State(
                instruction=self.instruction,
                briefing=briefing,
                history=tuple(self.history),
                conversation=self.conversation,
                tools=tools,
            )
            try:
                decision = await self._decide(state)
            except PlannerError as error:
                return _End("planner_error", str(error))
            except Exception as error:  # The episode's border: a planner's fault is an outcome, not a crash
                return _End("planner_error", f"The planner failed: {_in_words(error)}", traceback.format_exc())
            if isinstance(decision, Finish):
                return _End(decision.kind, decision.text)
            spent = self.usage.input_tokens + self.usage.output_tokens
            if budgets.tokens is not None and spent > budgets.tokens:
                return _End("budget", f"The token budget of {budgets.tokens} is spent ({spent}).")
            failure = await self._carry_out(decision)
            if failure is not None:
                return failure
        return _End("step_limit", f"No answer within {budgets.max_steps} steps.")

    async def _decide(self, state: State) -> Decision:
        before = self.watch.read()
        with self.watch.measure("planner"):
            decision = await self.agent.planner.step(state)
        if not isinstance(decision, CallTools | Finish):
            raise PlannerError(f"The planner answered with {type(decision).__name__}, which is no decision.")
        used = decision.usage
        self.usage = Usage(
            input_tokens=self.usage.input_tokens + used.input_tokens, output_tokens=self.usage.output_tokens + used.output_tokens
        )
        self.emit(Decided(step=self.steps, decision=decision, planner_s=(self.watch.read() - before).planner_s))
        return decision

    async def _carry_out(self, decision: CallTools) -> _End | None:
        """Run the calls of a step in order. After one that failed the rest is not done: it was planned for another state."""
        outcomes: list[ToolOutcome] = []
        failure: _End | None = None
        try:
            for index, call in enumerate(decision.calls):
                if outcomes and outcomes[-1].error is not None:
                    outcome = ToolOutcome(call=call, error="Not done, because the call before it failed.")
                    self._record(index, outcome, "skipped")
                else:
                    outcome, failure = await self._call(index, call)
                outcomes.append(outcome)
        finally:
            # Also when the run is cancelled between two calls: what was done is history.
            self.history.append(Exchange(outcomes=tuple(outcomes), thought=decision.thought))
        return failure

    async def _call(self, index: int, call: ToolCall) -> tuple[ToolOutcome, _End | None]:
        time_s, before, pose = self.camera.clock.now_s(), self.watch.read(), self.pose
        fault: Fault | None = None
        failure: _End | None = None
        frame: str | None = None
        try:
            result = await run_tool(self.context, call.name, call.arguments)
            outcome = ToolOutcome(call=call, result=result.model_dump(mode="json"))
            self.pose = await self.camera.pose()
            if self.agent.snapshots and self.pose != pose and not getattr(result, "frames", ()):
                frame = self.agent.images.save_look(await self.camera.frame())
        except (ToolCallError, UnknownNameError) as error:
            outcome, fault = ToolOutcome(call=call, error=str(error)), "bad_call"
            self.bad_calls += 1
        except PerceptionError as error:
            outcome, fault = ToolOutcome(call=call, error=str(error)), "perception"
            self.perception_failures += 1
        except anyio.get_cancelled_exc_class():
            self._record(index, ToolOutcome(call=call, error="Broken off."), "cancelled", time_s, before)
            raise
        except (PackError, OutputError):
            raise
        except CameraError as error:
            outcome, fault, failure = ToolOutcome(call=call, error=str(error)), "camera", _End("camera_error", str(error))
        except Exception as error:  # The episode's border: what breaks below the tools ends the run, recorded
            words = f"{call.name} broke down: {_in_words(error)}"
            outcome, fault = ToolOutcome(call=call, error=words), "camera"
            failure = _End("camera_error", words, traceback.format_exc())
        self._record(index, outcome, fault, time_s, before, frame)
        return outcome, failure

    def _record(
        self, index: int, outcome: ToolOutcome, fault: Fault | None, time_s: float | None = None, before: Timings | None = None,
        frame: str | None = None,
    ) -> None:  # fmt: skip
        now = self.watch.read()
        self.emit(
            Called(
                step=self.steps,
                index=index,
                outcome=outcome,
                fault=fault,
                scene_time_s=self.camera.clock.now_s() if time_s is None else time_s,
                pose=Place.of(self.pose),
                timings=now - (before or now),
                replies=self.perception.drain(),
                frame=frame,
            )
        )

    async def _finish(self, end: _End) -> Ended:
        with anyio.CancelScope(shield=True), anyio.move_on_after(STOP_TIMEOUT_S), suppress(CameraError):
            if end.outcome not in ("answered", "clarification", "refused"):
                await self.camera.stop()
            self.pose = await self.camera.pose()
        ended = Ended(
            outcome=end.outcome,
            text=end.text,
            detail=end.detail,
            steps=self.steps,
            bad_calls=self.bad_calls,
            perception_failures=self.perception_failures,
            usage=self.usage,
            pose=Place.of(self.pose),
            scene_time_s=self.camera.clock.now_s(),
            timings=self.watch.read(),
            ended=datetime.now(UTC),
        )
        self.emit(ended)
        return ended


def _in_words(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
