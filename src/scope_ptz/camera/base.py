"""The camera contract: one small interface for the simulator and for real cameras."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import AsyncGenerator, AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from scope_ptz.camera.capabilities import NO_CAPABILITIES, Capabilities, check_drive, check_preset_name
from scope_ptz.camera.clocks import Clock
from scope_ptz.errors import CameraError, InputError, UnknownNameError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.control import ControlLock
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
        capabilities: What else the camera can do.
        rendering: Version of the simulator's rendering; None for other cameras.
        assumed: What the driver only assumes until somebody measures it, such as "field of view".
    """

    name: str
    limits: Limits
    optics: Optics
    frame_width: int
    frame_height: int
    simulated: bool
    capabilities: Capabilities = NO_CAPABILITIES
    rendering: int | None = None
    assumed: tuple[str, ...] = ()


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
        pose: The camera's pose at exposure; for a stitched panorama the pose at the start of the sweep.
        hfov_deg: Horizontal field of view in degrees.
        time_s: Time of exposure on the camera's clock, in seconds.
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
    """Where a move ended.

    Attributes:
        pose: The pose reached.
        clamped: The axes that a limit stopped.
        limited_by: What held the camera back, as a noun phrase, if it was not a limit of the device.
    """

    pose: Pose
    clamped: tuple[Axis, ...] = field(default=())
    limited_by: str = ""


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

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        """Move at constant velocities until the next command. The call returns at once.

        The camera stops by itself after ``timeout_s`` without another command, so a lost controller cannot leave it moving.
        Velocities above the top speed are reduced to it, and an axis stands still at its limit.

        Args:
            pan_dps: Degrees per second to the right.
            tilt_dps: Degrees per second upwards.
            zoom_rate: Octaves (doublings of magnification) per second, positive to zoom in.
            timeout_s: Seconds after which the camera stops; at most 10.

        Raises:
            InputError: A number is not finite, or the timeout is not between 0 and 10 s.
            CameraError: The camera cannot be driven.
        """
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        raise CameraError(f"{self.info.name} cannot be driven at a velocity; move it to a pose.")

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        """Yield frames as they are taken, at most ``rate_hz`` per second. A slow consumer gets the newest frame, never a queue.

        Use it with ``contextlib.aclosing``, so that a stream is released when its consumer leaves.
        """
        if not (math.isfinite(rate_hz) and rate_hz > 0):
            raise InputError(f"The frame rate must be above 0 frames per second, got {rate_hz}.")
        while True:
            due_s = self.clock.now_s() + 1.0 / rate_hz
            yield await self.frame()
            await self.clock.sleep(due_s - self.clock.now_s())

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:  # noqa: ARG002 - part of the contract
        """Save the current pose as a preset. A preset of the same name is replaced.

        Raises:
            InputError: The name is empty, too long, or has characters that cannot be printed.
            CameraError: The camera cannot save presets.
        """
        check_preset_name(name)
        raise CameraError(f"{self.info.name} cannot save presets.")

    async def remove_preset(self, name: str) -> None:
        """Remove a preset.

        Raises:
            UnknownNameError: There is no such preset.
            CameraError: The camera cannot remove this preset, or no presets at all.
        """
        if name not in (known := [preset.name for preset in await self.presets()]):
            raise UnknownNameError("preset", name, known)
        raise CameraError(f"{self.info.name} cannot remove presets.")

    control_lock: ControlLock | None = None
    """The lock of ``control``. Whoever opens a camera that others can reach sets one that holds between processes."""

    @asynccontextmanager
    async def control(self, holder: str) -> AsyncIterator[None]:
        """Return a context in which ``holder`` has control of the camera and nobody else can take it.

        Raises:
            ControlHeldError: Somebody else has control. The message says who.
        """
        from scope_ptz.camera.control import ControlLock

        if self.control_lock is None:
            self.control_lock = ControlLock(self.info.name)
        lock = self.control_lock
        lock.acquire(holder)
        try:
            yield
        finally:
            lock.release()

    async def close(self) -> None:
        """Release what the camera holds. The default holds nothing."""

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        """Return a context in which nothing in a simulated world moves, so that a sweep sees one instant.

        Real time cannot be held.
        """
        yield
