"""The records of a run. The loop emits them, a trace file stores them, and listeners receive them."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from typing import Annotated, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from scope_ptz.agent.timing import PerceptionReply, Timings
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import CallTools, Exchange, Finish, PastTurn, ToolOutcome, Usage

FORMAT_VERSION = 1
"""Version of the trace format. It is incremented when a change could make an older program misread traces."""

Outcome = Literal["answered", "clarification", "refused", "step_limit", "budget", "planner_error", "camera_error", "cancelled"]
OUTCOMES: tuple[str, ...] = get_args(Outcome)

CallFault = Literal["bad_call", "perception", "camera", "skipped", "cancelled"]
"""The reason why a call failed.

- ``bad_call``: the name or the arguments were invalid.
- ``perception``: a perception call failed.
- ``camera``: the camera failed.
- ``skipped``: an earlier call in the same step failed.
- ``cancelled``: the run was cancelled or ran out of time during the call.
"""


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class RecordedPose(_Record):
    """A pose at full precision, so that a replay starts from exactly the same pose."""

    pan_deg: float
    tilt_deg: float
    zoom: float

    @classmethod
    def of(cls, pose: Pose) -> RecordedPose:
        """Return the record of a pose."""
        return cls(pan_deg=pose.pan_deg, tilt_deg=pose.tilt_deg, zoom=pose.zoom)

    def pose(self) -> Pose:
        """Return the recorded pose."""
        return Pose(self.pan_deg, self.tilt_deg, self.zoom)


class Budgets(_Record):
    """Limits on a run: planner steps (T_max), wall-clock seconds, and input plus output tokens of the planner."""

    max_steps: int = Field(default=60, ge=1)
    time_s: float | None = Field(default=None, gt=0)
    tokens: int | None = Field(default=None, gt=0)


class RunLabels(_Record):
    """Information about a run that its trace stores but the loop cannot determine.

    Attributes:
        perception_note: A sentence about the perception backend, shown with the answer.
        seed: Seed for the run's random choices.
        home_viewpoint: The requested viewpoint of the camera, if it is not the scene's home viewpoint.
    """

    perception_note: str = ""
    seed: int | None = None
    home_viewpoint: str | None = None


class Started(_Record):
    """The header of a trace.

    Attributes:
        planner_details: Settings that determine the planner's decisions, such as the exact prompt.
        dry_run: Whether commands were reported instead of executed. False in traces of version 0.1.0.
        scene: The scene of a simulated camera; otherwise None.
        viewpoint: The viewpoint of a simulated camera; otherwise None.
        rendering: Version of the simulator's rendering; None for other cameras and in traces of version 0.1.0.
        perception_version: Version of ground-truth perception; None for other backends and in traces of version 0.1.0.
        frame: Name of the picture that was taken before the first step.
    """

    event: Literal["start"] = "start"
    format: Literal[1] = 1
    version: str
    python: str
    started: datetime
    instruction: str
    planner: str
    planner_details: dict[str, str] = {}
    perception: str
    camera: str
    simulated: bool
    dry_run: bool = False
    frame_width: int
    frame_height: int
    scene: str | None
    viewpoint: str | None
    rendering: int | None = None
    perception_version: int | None = None
    scene_time_s: float
    pose: RecordedPose
    presets: tuple[str, ...]
    budgets: Budgets
    labels: RunLabels
    conversation: tuple[PastTurn, ...] = ()
    frame: str | None = None


class Decided(_Record):
    """The planner's decision at a step. ``view`` is the name of the picture that a planner with vision received."""

    event: Literal["decision"] = "decision"
    step: int
    decision: Annotated[CallTools | Finish, Field(discriminator="kind")]
    planner_s: float
    view: str | None = None


class Called(_Record):
    """A tool call and its outcome.

    Attributes:
        step: Number of the step, from 1.
        index: Position of the call in the step, from 0.
        scene_time_s: Scene time at the start of the call.
        pose: Pose of the camera after the call.
        frame: Name of the picture of the view after the call; it is stored only if the pose changed.
    """

    event: Literal["call"] = "call"
    step: int
    index: int
    outcome: ToolOutcome
    fault: CallFault | None = None
    scene_time_s: float
    pose: RecordedPose
    timings: Timings
    replies: tuple[PerceptionReply, ...] = ()
    frame: str | None = None

    @property
    def perception_s(self) -> float:
        """Wall-clock seconds spent in this call's own perception calls, excluding those of concurrent calls."""
        return sum(reply.wall_s for reply in self.replies)


class Ended(_Record):
    """The end of a run.

    Attributes:
        text: The answer, the clarifying question, or the reason why there is no answer.
        detail: A traceback or other details for debugging.
        kind: Failure kind of the planner's model server (``endpoints.FailureKind``, such as "refused"), if it failed.
        server_events: Number of failed requests to model servers by failure kind, including those that succeeded on retry.
    """

    event: Literal["end"] = "end"
    outcome: Outcome
    text: str
    detail: str = ""
    kind: str | None = None
    steps: int
    bad_calls: int
    perception_failures: int
    server_events: dict[str, int] = {}
    usage: Usage
    pose: RecordedPose
    scene_time_s: float
    timings: Timings
    ended: datetime


Record = Annotated[Started | Decided | Called | Ended, Field(discriminator="event")]
RECORD: TypeAdapter[Started | Decided | Called | Ended] = TypeAdapter(Record)
Listener = Callable[[Started | Decided | Called | Ended], None]


class RunResult(_Record):
    """A finished run as the loop returns it. ``start`` and ``viewpoint`` are where the camera was at the beginning."""

    instruction: str
    start: RecordedPose
    viewpoint: str | None = None
    exchanges: tuple[Exchange, ...]
    ended: Ended

    def past_turn(self) -> PastTurn:
        """Return the run as an earlier turn of a conversation."""
        return PastTurn(
            instruction=self.instruction,
            exchanges=self.exchanges,
            reply=self.ended.text,
            start=self.start.pose(),
            viewpoint=self.viewpoint,
        )
