"""The context of a tool call: a camera, a perception backend, and a picture store."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from scope_ptz.camera.base import Arrival, Camera, Frame
from scope_ptz.perception.base import Perception
from scope_ptz.tools.results import MoveResult, PoseData


class ImageStore(Protocol):
    """A store that saves pictures under unique names relative to the run folder."""

    async def save_frame(self, frame: Frame) -> str:
        """Save a frame with lossy compression, such as one that perception received, and return its name."""
        ...

    async def save_picture(self, frame: Frame) -> str:
        """Save a picture that the user requested, losslessly, and return its name."""
        ...


@dataclass(frozen=True, slots=True)
class ToolContext:
    """The camera, perception backend and picture store of a run."""

    camera: Camera
    perception: Perception
    images: ImageStore


def move_result(camera: Camera, action: str, arrival: Arrival, preset: str | None = None) -> MoveResult:
    """Return the result of a move.

    Args:
        camera: The camera.
        action: The completed action as the start of a sentence, such as "At home".
        arrival: Where and how the move ended.
        preset: The preset to which the camera moved; None for other moves.
    """
    # In a dry run, every move is held back, and the answer to the user says so once.
    held_back_by = None if camera.info.dry_run else arrival.limited_by or None
    return MoveResult(
        message=f"{action}; {pose_text(arrival)}.", pose=PoseData.of(arrival.pose), clamped=arrival.clamped, preset=preset,
        held_back_by=held_back_by,
    )  # fmt: skip


def pose_text(arrival: Arrival) -> str:
    """Return the camera's pose, and the limits that stopped the move, as the last clause of a sentence."""
    pose = arrival.pose.as_dict()
    text = f"the camera is at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x"
    if arrival.limited_by:
        text += f" (held back by {arrival.limited_by})"
    elif arrival.clamped:
        text += f" (stopped by the {' and '.join(arrival.clamped)} limit)"
    return text
