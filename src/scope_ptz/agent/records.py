"""What happens in a run, as records: the loop emits them, a trace is a file of them, and whoever watches listens to them."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from typing import Annotated, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from scope_ptz.agent.timing import PerceptionReply, Timings
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import CallTools, Exchange, Finish, PastTurn, ToolOutcome, Usage

FORMAT_VERSION = 1
"""Raised when an older program could misread a trace."""

Outcome = Literal["answered", "clarification", "refused", "step_limit", "budget", "planner_error", "camera_error", "cancelled"]
OUTCOMES: tuple[str, ...] = get_args(Outcome)

CallFault = Literal["bad_call", "perception", "camera", "skipped", "cancelled"]
"""Why a call failed: it was wrong, the view could not be read, the camera failed, a call before it in the step had failed, or the
run was cancelled or out of time while it went on."""


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class RecordedPose(_Record):
    """A pose in full precision, so that a replay starts exactly there."""

    pan_deg: float
    tilt_deg: float
    zoom: float

    @classmethod
    def of(cls, pose: Pose) -> RecordedPose:
        return cls(pan_deg=pose.pan_deg, tilt_deg=pose.tilt_deg, zoom=pose.zoom)

    def pose(self) -> Pose:
        return Pose(self.pan_deg, self.tilt_deg, self.zoom)


class Budgets(_Record):
    """When a run is over without an answer: planner steps (T_max), wall seconds, tokens in and out together."""

    max_steps: int = Field(default=60, ge=1)
    time_s: float | None = Field(default=None, gt=0)
    tokens: int | None = Field(default=None, gt=0)


class RunLabels(_Record):
    """What a trace should say about a run beyond what the loop can see.

    ``home_viewpoint``: the viewpoint that the camera was put at, when that is not where the scene's home is.
    """

    perception_note: str = ""
    seed: int | None = None
    home_viewpoint: str | None = None


class Started(_Record):
    """The header. ``scene`` and ``viewpoint``: simulated cameras only. ``frame``: the picture before the first step.

    ``planner_details``: what made the planner plan as it did, such as the exact prompt.
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
    frame_width: int
    frame_height: int
    scene: str | None
    viewpoint: str | None
    scene_time_s: float
    pose: RecordedPose
    presets: tuple[str, ...]
    budgets: Budgets
    labels: RunLabels
    conversation: tuple[PastTurn, ...] = ()
    frame: str | None = None


class Decided(_Record):
    """What the planner wants at a step. ``view``: the picture that it was shown, for planners that see."""

    event: Literal["decision"] = "decision"
    step: int
    decision: Annotated[CallTools | Finish, Field(discriminator="kind")]
    planner_s: float
    view: str | None = None


class Called(_Record):
    """A call and what came back. ``scene_time_s``: when it began; ``frame``: the view after it, kept when the pose changed."""

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
        """Wall seconds that perception took for what this call asked it; what other calls asked meanwhile is not in it."""
        return sum(reply.wall_s for reply in self.replies)


class Ended(_Record):
    """How it ended. ``text``: the answer, question or reason; ``detail``: for whoever has to find a fault.

    ``kind``: in which way a planner's model server failed (``endpoints.FailureKind``: "context-overflow", "refused", ...),
    where one did; ``server_events``: how often servers failed in the run, by kind, also where a further attempt made it good.
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
    """A finished run. ``start``: where the camera looked when it began."""

    instruction: str
    start: RecordedPose
    exchanges: tuple[Exchange, ...]
    ended: Ended

    def past_turn(self) -> PastTurn:
        """The run as an earlier turn of a conversation."""
        return PastTurn(instruction=self.instruction, exchanges=self.exchanges, reply=self.ended.text, start=self.start.pose())
