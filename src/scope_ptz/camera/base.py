"""The camera contract: one small interface for the simulator and for real cameras."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.geometry import Axis, Limits, Optics, Pose, Projection


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """What is known about a camera before it moves.

    Attributes:
        name: The camera's name, as traces show it.
        limits: Limits of pan, tilt and zoom.
        optics: Field of view by zoom.
        frame_width: Width of a frame in pixels.
        frame_height: Height of a frame in pixels.
        simulated: Whether the pictures are computed.
        rendering: Version of the simulator's rendering; None for other cameras.
    """

    name: str
    limits: Limits
    optics: Optics
    frame_width: int
    frame_height: int
    simulated: bool
    rendering: int | None = None


@dataclass(frozen=True, slots=True)
class FrameOrigin:
    """Where a simulated frame comes from.

    Only the simulator and ground-truth perception read it; frames of real cameras have none.
    """

    scene: str
    viewpoint: str
    pose: Pose
    time_s: float


@dataclass(frozen=True, slots=True)
class Frame:
    """A picture with the geometry that maps any of its pixels to a direction.

    Attributes:
        image: Read-only array of shape ``(H, W, 3)``, uint8, RGB.
        pose: The camera's pose; for a stitched panorama the pose at the start of the sweep.
        hfov_deg: Horizontal field of view in degrees.
        time_s: Scene time in seconds.
        projection: The mapping between pixels and directions.
        origin: Where a simulated frame comes from, None for real cameras.
    """

    image: NDArray[np.uint8]
    pose: Pose
    hfov_deg: float
    time_s: float
    projection: Projection
    origin: FrameOrigin | None = None

    def __post_init__(self) -> None:
        if self.image.ndim != 3 or self.image.shape[2] != 3 or self.image.dtype != "uint8":
            raise ValueError(f"a frame needs an (H, W, 3) uint8 image, got {self.image.shape} {self.image.dtype}")
        self.image.flags.writeable = False

    @property
    def width(self) -> int:
        return int(self.image.shape[1])

    @property
    def height(self) -> int:
        return int(self.image.shape[0])

    def _repr_html_(self) -> str:
        """Return the frame as a notebook shows it: the picture, with pose and field of view below."""
        from scope_ptz.camera.notebook import figure_html

        pose = self.pose.as_dict()
        where = f"pan {pose['pan_deg']:+.1f}° · tilt {pose['tilt_deg']:+.1f}° · zoom {pose['zoom']:.1f}x"
        place = f"{self.origin.scene} / {self.origin.viewpoint} · " if self.origin else ""
        return figure_html(self.image, f"{place}{where} · {self.hfov_deg:.0f}° wide · {self.time_s:.1f} s")


@dataclass(frozen=True, slots=True)
class PresetInfo:
    """A named pose. ``description`` may be empty."""

    name: str
    description: str = ""


@dataclass(frozen=True, slots=True)
class Arrival:
    """Where a move ended, and the axes that a limit stopped."""

    pose: Pose
    clamped: tuple[Axis, ...] = field(default=())


class Clock(Protocol):
    """The time of the camera's world, in seconds."""

    def now_s(self) -> float: ...

    async def sleep(self, seconds: float) -> None:
        """Wait for this much time of the camera's world."""
        ...


class WallClock:
    """A clock for cameras in the real world. It starts at zero and follows the wall clock."""

    def __init__(self) -> None:
        self._started_s = monotonic()

    def now_s(self) -> float:
        """Return the seconds since the clock was made."""
        return monotonic() - self._started_s

    async def sleep(self, seconds: float) -> None:
        """Wait."""
        import anyio

        await anyio.sleep(max(0.0, seconds))


class Camera(ABC):
    """A pan-tilt-zoom camera. All methods raise ``CameraError`` when the camera fails.

    Attributes:
        clock: The time of the camera's world.
    """

    clock: Clock

    @property
    @abstractmethod
    def info(self) -> CameraInfo:
        """Name, limits, optics and frame size."""

    @abstractmethod
    async def pose(self) -> Pose:
        """Return the current pose."""

    @abstractmethod
    async def move(self, pose: Pose) -> Arrival:
        """Go to an absolute pose within the limits and return when the picture has settled.

        ``pose.pan_deg`` is clamped without being wrapped first: 190 stops at 179 and never turns the long way.
        """

    @abstractmethod
    async def presets(self) -> list[PresetInfo]:
        """Return the presets in a stable order."""

    @abstractmethod
    async def go_to_preset(self, name: str) -> Arrival:
        """Go to a preset. In a simulated scene this may change the optical centre.

        Raises:
            UnknownNameError: There is no such preset.
        """

    @abstractmethod
    async def go_home(self) -> Arrival:
        """Go to the home pose."""

    @abstractmethod
    async def frame(self) -> Frame:
        """Take a picture."""

    @abstractmethod
    async def stop(self) -> None:
        """Stop any motion at once."""

    async def close(self) -> None:
        """Release what the camera holds. The default holds nothing."""

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        """Return a context in which nothing in a simulated world moves, so that a sweep sees one instant.

        Real time cannot be held.
        """
        yield
