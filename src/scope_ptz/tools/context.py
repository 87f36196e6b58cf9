"""What a tool works with: a camera, eyes, and a place for pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from scope_ptz.camera.base import Arrival, Camera, Frame
from scope_ptz.perception.base import Perception


class ImageStore(Protocol):
    """Keeps pictures under names that never collide; the names are relative to the run folder."""

    def save_look(self, frame: Frame) -> str:
        """Keep a frame that perception looked at (compressed)."""
        ...

    def save_picture(self, frame: Frame) -> str:
        """Keep a picture that the user asked for (lossless)."""
        ...


@dataclass(frozen=True, slots=True)
class ToolContext:
    """The two contracts and the store that all tools are written against."""

    camera: Camera
    perception: Perception
    images: ImageStore


def pose_text(arrival: Arrival) -> str:
    """Where the camera is now and what a limit cut, as the end of a sentence."""
    pose = arrival.pose.as_dict()
    text = f"the camera is at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x"
    if arrival.clamped:
        text += f" (stopped by the {' and '.join(arrival.clamped)} limit)"
    return text
