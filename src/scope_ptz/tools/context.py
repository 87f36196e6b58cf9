"""The context of a tool call: a camera, a perception backend, and a store for pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from scope_ptz.camera.base import Arrival, Camera, Frame
from scope_ptz.perception.base import Perception
from scope_ptz.tools.results import MoveResult, PoseData


class ImageStore(Protocol):
    """A store that saves pictures under unique names, relative to the run folder."""

    async def save_frame(self, frame: Frame) -> str:
        """Save a frame of the run, such as one that perception received, with lossy compression, and return its name."""
        ...

    async def save_picture(self, frame: Frame) -> str:
        """Save a picture that the user requested, losslessly, and return its name."""
        ...


@dataclass(frozen=True, slots=True)
class ToolContext:
    """The camera, the perception backend and the picture store of a run."""

    camera: Camera
    perception: Perception
    images: ImageStore


def move_result(camera: Camera, what: str, arrival: Arrival, preset: str | None = None) -> MoveResult:
    """Return the result of a move.

    Args:
        camera: The camera.
        what: What the camera did, at the beginning of a sentence.
        arrival: Where it arrived.
        preset: The preset that it went to.
    """
    # In a dry run, every move is held back, which its answer states once.
    held_back_by = None if camera.info.dry_run else arrival.limited_by or None
    return MoveResult(
        message=f"{what}; {pose_text(arrival)}.", pose=PoseData.of(arrival.pose), clamped=arrival.clamped, preset=preset,
        held_back_by=held_back_by,
    )  # fmt: skip


def pose_text(arrival: Arrival) -> str:
    """Describe the camera's pose, and the limits that stopped it, in words that end a sentence."""
    pose = arrival.pose.as_dict()
    text = f"the camera is at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x"
    if arrival.limited_by:
        text += f" (held back by {arrival.limited_by})"
    elif arrival.clamped:
        text += f" (stopped by the {' and '.join(arrival.clamped)} limit)"
    return text
