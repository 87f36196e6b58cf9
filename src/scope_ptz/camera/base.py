"""The camera contract: one small interface for the simulator and for real cameras."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Axis, Limits, Optics, Pose, Projection


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """What a planner and a tool may know of a camera before it moves."""

    name: str
    limits: Limits
    optics: Optics
    frame_width: int
    frame_height: int
    simulated: bool


@dataclass(frozen=True, slots=True)
class FrameOrigin:
    """Where a simulated frame comes from. Only ``world`` and the ground-truth perception read it; real cameras have none."""

    scene: str
    viewpoint: str
    pose: Pose
    time_s: float


@dataclass(frozen=True, slots=True)
class Frame:
    """One picture with the geometry to map any of its pixels to a direction.

    ``image`` is ``(H, W, 3) uint8`` RGB, read-only. For a stitched panorama ``pose`` is the camera's pose when the sweep began.
    """

    image: NDArray[np.uint8]
    pose: Pose
    hfov_deg: float
    time_s: float
    projection: Projection
    origin: FrameOrigin | None = None

    def __post_init__(self) -> None:
        if self.image.ndim != 3 or self.image.shape[2] != 3 or self.image.dtype != np.uint8:
            raise ValueError(f"a frame needs an (H, W, 3) uint8 image, got {self.image.shape} {self.image.dtype}")
        self.image.flags.writeable = False

    @property
    def width(self) -> int:
        return int(self.image.shape[1])

    @property
    def height(self) -> int:
        return int(self.image.shape[0])


@dataclass(frozen=True, slots=True)
class PresetInfo:
    """A named pose. ``description`` may be empty."""

    name: str
    description: str = ""


@dataclass(frozen=True, slots=True)
class Arrival:
    """Where a move ended, and which of "pan", "tilt", "zoom" a limit cut."""

    pose: Pose
    clamped: tuple[Axis, ...] = field(default=())


class Clock(Protocol):
    """Time as the camera's world knows it, in seconds."""

    def now_s(self) -> float: ...

    async def sleep(self, seconds: float) -> None:
        """Let that much time of the camera's world go by."""
        ...


class Camera(ABC):
    """A pan-tilt-zoom camera. All methods raise ``CameraError`` when the camera does not do what it was told."""

    clock: Clock

    @property
    @abstractmethod
    def info(self) -> CameraInfo:
        """Limits, optics, name, frame size."""

    @abstractmethod
    async def pose(self) -> Pose:
        """Where the camera looks now."""

    @abstractmethod
    async def move(self, pose: Pose) -> Arrival:
        """Go to an absolute pose within the limits; returns when settled. ``pose.pan_deg`` is not wrapped before it is clamped."""

    @abstractmethod
    async def presets(self) -> list[PresetInfo]:
        """The named poses, in a stable order."""

    @abstractmethod
    async def go_to_preset(self, name: str) -> Arrival:
        """Go to a named pose. In a simulated scene this may change the optical centre. Unknown names raise ``UnknownNameError``."""

    @abstractmethod
    async def go_home(self) -> Arrival:
        """Go to the home pose, known from the start."""

    @abstractmethod
    async def frame(self) -> Frame:
        """A picture taken now."""

    @abstractmethod
    async def stop(self) -> None:
        """Stop any motion at once."""

    async def close(self) -> None:
        """Release what the camera holds. The default holds nothing."""

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        """While this is open nothing in a simulated world moves, so that a sweep sees one instant. Real time cannot be held."""
        yield
