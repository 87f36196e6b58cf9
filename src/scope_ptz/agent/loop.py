"""The agent loop: the paper's recurrence over S_t = (U, H_t, O_t), with budgets and a defined outcome for every run.

A listener receives each record of a run as it is created; the caller receives the finished run.
"""

from __future__ import annotations

import platform
import traceback
from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime

import anyio

from scope_ptz.agent.planner_views import picture_of_view
from scope_ptz.agent.records import Budgets, Decided, Ended, Listener, RecordedPose, RunLabels, RunResult, Started
from scope_ptz.agent.timing import Stopwatch, failures_of, usage_of_failures
from scope_ptz.agent.tool_calls import CallRunner, RunEnd, RunTool, error_text
from scope_ptz.camera.base import Camera, PresetInfo
from scope_ptz.endpoints.failures import count_failures
from scope_ptz.errors import CameraError, InputError, OutputError, PackError, PlannerError
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
    Usage,
    Viewpoints,
)
from scope_ptz.planner.limits import MAX_INSTRUCTION_CHARS
from scope_ptz.tools.context import ImageStore
from scope_ptz.tools.registry import TOOLS, ToolRegistry
from scope_ptz.version import __version__

STOP_TIMEOUT_S = 5.0  # seconds allowed for stopping the camera and reading its pose at the end of a run
MAX_CALLS_PER_STEP = 32  # further calls in a decision are dropped, and the planner receives an error
MAX_REPEATED_BAD_CALLS = 5  # a run ends with a planner error after this many consecutive steps with the same wrong call


class Agent:
    """An agent: a planner, a camera and a perception backend. It carries out instructions and keeps no state between runs."""

    def __init__(
        self,
        planner: Planner,
        camera: Camera,
        perception: Perception,
        images: ImageStore,
        *,
        budgets: Budgets | None = None,
        labels: RunLabels | None = None,
        snapshots: bool = True,
        tools: ToolRegistry = TOOLS,
        run_tool: RunTool | None = None,
        enforce_call_limits: bool = True,
    ) -> None:
        """Create an agent.

        Args:
            planner: Makes the decision at each step.
            camera: Carries out the moves and takes the frames.
            perception: Answers questions about frames.
            images: Stores the pictures of the run.
            budgets: Limits on steps, time and tokens; the default is ``Budgets()``.
            labels: Information for the trace that the loop itself cannot determine.
            snapshots: Whether to store the first view and the view after each move. Frames that perception receives are always
                stored.
            tools: The tools that the planner can call.
            run_tool: A function that runs the calls instead of ``tools.run``, for example a wrapper that observes them.
            enforce_call_limits: Whether to end the run when the planner keeps repeating a wrong call, and to limit the calls in a
                step. False for replays, because traces from older versions may contain such steps.
        """
        self.planner, self.camera, self.perception, self.images = planner, camera, perception, images
        self.budgets, self.labels, self.snapshots = budgets or Budgets(), labels or RunLabels(), snapshots
        self.tools, self.run_tool, self.enforce_call_limits = tools, run_tool, enforce_call_limits

    async def run(
        self, instruction: str, *, conversation: tuple[PastTurn, ...] = (), listener: Listener = lambda _: None
    ) -> RunResult:
        """Carry out an instruction.

        Args:
            instruction: The instruction in plain language.
            conversation: Earlier turns that the instruction may refer to.
            listener: Receives each record of the run as it is created.

        Returns:
            The finished run. If the planner or the camera fails during the run, the outcome records the failure; no exception is
            raised.

        Raises:
            InputError: The instruction is empty or too long, or a file cannot be written.
            PackError: The scene's files are damaged.
            CameraError: The camera fails before the first step.
        """
        # Undecodable bytes from the command line become "?", because neither files nor servers accept them.
        instruction = instruction.encode("utf-8", "replace").decode().strip()
        if not instruction:
            raise InputError("The instruction is empty. State what the camera should do.")
        if len(instruction) > MAX_INSTRUCTION_CHARS:
            raise InputError(f"The instruction is longer than {MAX_INSTRUCTION_CHARS} characters. Shorten it.")
        return await _ActiveRun(self, instruction, conversation, listener).run()


class _ActiveRun:
    """A run in progress, with its state."""

    def __init__(self, agent: Agent, instruction: str, conversation: tuple[PastTurn, ...], listener: Listener) -> None:
        self.agent, self.instruction, self.conversation, self.emit = agent, instruction, conversation, listener
        self.watch = Stopwatch()
        self.calls = CallRunner(
            agent.camera,
            agent.perception,
            agent.images,
            self.watch,
            listener,
            snapshots=agent.snapshots,
            accepts_images=agent.planner.sees,
            tools=agent.tools,
            run_tool=agent.run_tool,
        )
        self.camera = self.calls.camera
        self.history: list[Exchange] = []
        self.start = Pose()
        self.viewpoint: str | None = None
        self.steps = 0
        self.usage = Usage()

    async def run(self) -> RunResult:
        briefing = await self._start()
        try:
            with anyio.move_on_after(self.agent.budgets.time_s) as time_limit:
                end = await self._steps(briefing)
            if time_limit.cancelled_caught:
                end = RunEnd("budget", f"The time budget of {self.agent.budgets.time_s:g} s is spent.")
        except anyio.get_cancelled_exc_class():
            await self._finish(RunEnd("cancelled", "The run was cancelled."))
            raise
        except (PackError, OutputError) as error:
            # The agent cannot recover from a damaged scene or a full disk, so the error is recorded and raised.
            with suppress(OutputError):
                await self._finish(RunEnd("camera_error", str(error)))
            raise
        ended = await self._finish(end)
        start = RecordedPose.of(self.start)
        return RunResult(
            instruction=self.instruction, start=start, viewpoint=self.viewpoint, exchanges=tuple(self.history), ended=ended
        )

    async def _start(self) -> Briefing:
        agent, info = self.agent, self.camera.info
        infos = await self.camera.presets()
        presets = tuple(preset.name for preset in infos)
        self.start = self.calls.pose = await self.camera.pose()
        # The first frame states the scene and the viewpoint, and taking it ensures that the camera works before anything moves.
        frame = await self.camera.frame()
        self.viewpoint = frame.origin.viewpoint if frame.origin else None
        self.emit(
            Started(
                version=__version__,
                python=platform.python_version(),
                started=datetime.now(UTC),
                instruction=self.instruction,
                planner=agent.planner.name,
                planner_details=agent.planner.details,
                perception=agent.perception.name,
                camera=info.name,
                simulated=info.simulated,
                dry_run=info.dry_run,
                frame_width=info.frame_width,
                frame_height=info.frame_height,
                scene=frame.origin.scene if frame.origin else None,
                viewpoint=self.viewpoint,
                rendering=info.rendering,
                perception_version=agent.perception.version,
                scene_time_s=self.camera.clock.now_s(),
                pose=RecordedPose.of(self.start),
                presets=presets,
                budgets=agent.budgets,
                labels=agent.labels,
                conversation=self.conversation,
                frame=await agent.images.save_frame(frame) if agent.snapshots else None,
            )
        )
        return Briefing(
            presets=presets,
            pose=self.start,
            limits=info.limits,
            simulated=info.simulated,
            viewpoints=_viewpoints(self.viewpoint, infos),
        )

    async def _steps(self, briefing: Briefing) -> RunEnd:
        budgets, tools = self.agent.budgets, tuple(self.agent.tools.schemas())
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
            except CameraError as error:
                return RunEnd("camera_error", str(error))
            except PlannerError as error:
                self.calls.events.update(failures_of(error))
                self.usage += usage_of_failures(error.attempts)
                return RunEnd("planner_error", str(error), kind=error.kind)
            except Exception as error:  # any failure of a planner becomes an outcome of the run
                return RunEnd("planner_error", f"The planner failed: {error_text(error)}", traceback.format_exc())
            if isinstance(decision, Finish):
                return RunEnd(decision.kind, decision.text)
            used_tokens = self.usage.input_tokens + self.usage.output_tokens
            if budgets.tokens is not None and used_tokens > budgets.tokens:
                return RunEnd("budget", f"The token budget of {budgets.tokens} is spent ({used_tokens}).")
            failure = await self.calls.carry_out(self.steps, decision, self.history)
            if failure is not None:
                return failure
            if self.agent.enforce_call_limits and self.calls.bad_call_repeats >= MAX_REPEATED_BAD_CALLS:
                return RunEnd("planner_error", f"The planner made the same wrong call {MAX_REPEATED_BAD_CALLS} times in a row.")
        return RunEnd("step_limit", f"No answer within {budgets.max_steps} steps.")

    async def _decide(self, state: State) -> Decision:
        planner, view_name = self.agent.planner, None
        if planner.sees:
            frame = await self.camera.frame()
            view_name = await self.agent.images.save_frame(frame) if self.agent.snapshots else None
            state = state.model_copy(update={"view": await picture_of_view(frame)})
        before = self.watch.read()
        with self.watch.measure("planner"):
            decision = await planner.step(state)
        if not isinstance(decision, CallTools | Finish):
            raise PlannerError(f"A planner must return CallTools or Finish; this one returned {type(decision).__name__}.")
        if self.agent.enforce_call_limits:
            decision = _limit_calls(decision)
        self.usage += decision.usage
        if decision.served is not None:
            self.calls.events.update(count_failures(decision.served.attempts))
            self.usage += usage_of_failures(decision.served.attempts)
            self.watch.add_first_token_wait(decision.served.first_token_s or 0.0)
        self.emit(Decided(step=self.steps, decision=decision, planner_s=(self.watch.read() - before).planner_s, view=view_name))
        return decision

    async def _finish(self, end: RunEnd) -> Ended:
        with anyio.CancelScope(shield=True), anyio.move_on_after(STOP_TIMEOUT_S), suppress(CameraError):
            if end.outcome not in ("answered", "clarification", "refused"):
                await self.camera.stop()
            self.calls.pose = await self.camera.pose()
        ended = Ended(
            outcome=end.outcome,
            text=end.text,
            detail=end.detail,
            kind=end.kind,
            steps=self.steps,
            bad_calls=self.calls.bad_calls,
            perception_failures=self.calls.perception_failures,
            server_events=dict(sorted(self.calls.events.items())),
            usage=self.usage,
            pose=RecordedPose.of(self.calls.pose),
            scene_time_s=self.camera.clock.now_s(),
            timings=self.watch.read(),
            ended=datetime.now(UTC),
        )
        self.emit(ended)
        return ended


def _limit_calls(decision: Decision) -> Decision:
    """Limit the calls of a decision to ``MAX_CALLS_PER_STEP``. The first excess call is kept as a bad call with a message."""
    if not isinstance(decision, CallTools) or len(decision.calls) <= MAX_CALLS_PER_STEP:
        return decision
    dropped = decision.calls[MAX_CALLS_PER_STEP]
    problem = (
        f"A step may have at most {MAX_CALLS_PER_STEP} calls and this one had {len(decision.calls)}. "
        "This call and those after it were dropped."
    )
    calls = (*decision.calls[:MAX_CALLS_PER_STEP], dropped.model_copy(update={"problem": problem}))
    return decision.model_copy(update={"calls": calls})


def _viewpoints(current: str | None, presets: Sequence[PresetInfo]) -> Viewpoints | None:
    """Return the viewpoints of a camera's presets; None for a camera that has a single viewpoint."""
    if current is None:
        return None
    return Viewpoints(
        current=current,
        of_presets={preset.name: preset.viewpoint for preset in presets if preset.viewpoint is not None},
        home=next((preset.viewpoint for preset in presets if preset.is_home), None),
    )
