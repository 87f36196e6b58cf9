"""The data that the store returns: runs, their steps and frames, feedback, conversations, and audit log entries."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

RunKind = Literal["instruction", "tool", "dry_run"]
"""The kind of run: an instruction, a tool call by a person, or a dry run, which reports moves without making them."""

UNFINISHED = "unfinished"
"""The outcome of a run whose end is not recorded: it is still running, or its program was killed."""


class Row(BaseModel):
    """Base class for the data that the store returns."""

    model_config = ConfigDict(frozen=True)


class RunRow(Row):
    """A run.

    Attributes:
        id: Name of the run folder.
        outcome: The outcome; "unfinished" if the end is not recorded.
        conversation: Id of the conversation; None if the run belongs to none.
        actor: The client that requested the run; empty if unknown.
        calls: Number of tool calls.
        tools_s: Seconds spent in the agent loop and in the tools themselves.
        kept: Whether the run is exempt from ``prune``.
        thumbs_up: Number of good ratings.
        thumbs_down: Number of bad ratings.
    """

    id: str
    kind: RunKind
    conversation: str | None
    actor: str
    started: datetime
    ended: datetime | None
    instruction: str
    answer: str
    outcome: str
    planner: str
    perception: str
    camera: str
    scene: str | None
    simulated: bool
    version: str
    steps: int
    calls: int
    failed_calls: int
    total_s: float
    planner_s: float
    perception_s: float
    camera_s: float
    render_s: float
    input_tokens: int
    output_tokens: int
    kept: bool
    folder_bytes: int
    thumbs_up: int
    thumbs_down: int

    @property
    def tools_s(self) -> float:
        """Seconds spent in the agent loop and in the tools themselves."""
        return max(0.0, self.total_s - self.planner_s - self.perception_s - self.camera_s - self.render_s)


class StepRow(Row):
    """A tool call in a run. ``position`` counts the run's calls from 0."""

    position: int
    step: int
    tool: str
    arguments: dict[str, Any]
    message: str
    fault: str | None
    pan_deg: float
    tilt_deg: float
    zoom: float
    total_s: float
    perception_s: float
    camera_s: float
    render_s: float


class FrameRow(Row):
    """A picture from a run: its path in the run folder, and the position of the call that took it (None for the first view)."""

    name: str
    position: int | None


class FeedbackRow(Row):
    """A person's feedback on a run, or on one of its calls if ``position`` is set."""

    id: int
    run: str
    position: int | None
    rating: Literal[-1, 0, 1]
    comment: str
    actor: str
    created: datetime


class ConversationRow(Row):
    """A conversation: its camera, its pair of models, and the name of its owner."""

    id: str
    camera: str
    pair: str
    owner: str
    title: str
    created: datetime
    updated: datetime


class AuditRow(Row):
    """An entry in an audit log."""

    time: datetime
    camera: str
    actor: str
    event: str
    details: dict[str, Any]


class RunFilter(Row):
    """A filter for runs. All conditions that are set must hold.

    Attributes:
        text: Words that the instruction or the answer contains. The last one may be incomplete.
        rating: 1 for runs with a good rating, -1 for those with a bad one.
        since: Runs that started at this time or later.
        until: Runs that started before this time.
    """

    text: str = Field(default="", max_length=200)
    kind: RunKind | None = None
    camera: str | None = None
    planner: str | None = None
    perception: str | None = None
    outcome: str | None = None
    tool: str | None = None
    conversation: str | None = None
    actor: str | None = None
    rating: Literal[-1, 1] | None = None
    since: datetime | None = None
    until: datetime | None = None
