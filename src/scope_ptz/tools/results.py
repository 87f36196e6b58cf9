"""What the nine tools give back. Every result states the pose after it and what a limit cut."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict

from scope_ptz.geometry import Axis, Pose
from scope_ptz.perception.base import Box
from scope_ptz.tools.arguments import View


class PoseData(BaseModel):
    model_config = ConfigDict(frozen=True)

    pan_deg: float
    tilt_deg: float
    zoom: float

    @classmethod
    def of(cls, pose: Pose) -> PoseData:
        return cls(**pose.as_dict())


class Result(BaseModel):
    """``message`` is one plain sentence for the planner and the person; ``clamped`` names the axes that a limit cut."""

    model_config = ConfigDict(frozen=True)

    message: str
    pose: PoseData
    clamped: tuple[Axis, ...] = ()


class MoveResult(Result):
    """``adjust_ptz``, ``go_to_preset``, ``go_home``."""

    preset: str | None = None


class PresetsResult(Result):
    presets: tuple[str, ...]


class ImageResult(Result):
    """``file``: name of the saved picture inside the run folder."""

    file: str


class Seen(Result):
    """Results that rest on perception: who looked, at which view, and in which saved pictures (``frames``, run-folder names)."""

    source: str
    view: View = "current"
    frames: tuple[str, ...] = ()


class CountResult(Seen):
    """Not ``complete``: there are at least so many."""

    description: str
    count: int
    complete: bool = True
    boxes: tuple[Box, ...] = ()


class AnswerResult(Seen):
    """``known`` is False when the honest answer is "I cannot tell"."""

    question: str
    answer: str
    known: bool


class ZoomResult(Seen):
    """``fill``: share of its limiting side that the target fills after the move; ``offset``: of its centre from the frame's centre,
    as shares of width and height; ``limited_by``: limits that kept the target from the middle or from its size."""

    description: str
    found: bool
    matches: int
    chosen: str = ""
    fill: float | None = None
    offset: tuple[float, float] | None = None
    limited_by: tuple[Axis, ...] = ()
    box: Box | None = None


class TrackPoint(BaseModel):
    model_config = ConfigDict(frozen=True)

    time_s: float
    pose: PoseData
    seen: bool


class TrackResult(Seen):
    """``held_share``: share of the time asked for that the target was seen; ``path``: where the camera looked while following."""

    description: str
    found: bool
    duration_s: float
    held_share: float
    path: tuple[TrackPoint, ...] = ()
