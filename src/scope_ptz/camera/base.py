"""The camera contract: one small interface for simulated and real cameras."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import AsyncGenerator, AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from typing import TYPE_CHECKING

from scope_ptz.camera.capabilities import check_drive, check_preset_name
from scope_ptz.camera.clocks import Clock, elapsed_s
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState, check_focus, check_iris
from scope_ptz.camera.values import Arrival as Arrival
from scope_ptz.camera.values import CameraInfo as CameraInfo
from scope_ptz.camera.values import Frame as Frame
from scope_ptz.camera.values import FrameOrigin as FrameOrigin
from scope_ptz.camera.values import PresetInfo as PresetInfo
from scope_ptz.errors import CameraError, InputError, UnknownNameError

if TYPE_CHECKING:
    from scope_ptz.camera.control import ControlLock
    from scope_ptz.geometry import Pose


class Camera(ABC):
    """A pan-tilt-zoom camera. All methods raise ``CameraError`` when the camera fails.

    Attributes:
        clock: The camera's clock: real time, or the time of a simulated scene.
    """

    clock: Clock

    @property
    @abstractmethod
    def info(self) -> CameraInfo:
        """The camera's name, limits, optics, frame size and capabilities."""

    @abstractmethod
    async def pose(self) -> Pose:
        """Return the current pose."""

    @abstractmethod
    async def move(self, pose: Pose) -> Arrival:
        """Move to an absolute pose, clamped to the limits, and return when the picture has settled.

        Pan is clamped without being wrapped first. With limits of -179 and 179, a request for 190 stops at 179 instead of turning
        the long way round to -170.
        """

    @abstractmethod
    async def presets(self) -> list[PresetInfo]:
        """Return the presets in a stable order."""

    @abstractmethod
    async def go_to_preset(self, name: str) -> Arrival:
        """Go to a preset. In a simulated scene, this may change the optical centre.

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
        """Stop any motion immediately."""

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        """Start moving at constant velocities, and return immediately.

        The camera stops on its own after ``timeout_s`` without another command, so it cannot keep moving after its controller is
        lost. Velocities are capped at the top speed, and an axis stops at its limit.

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

    async def centre_on(self, x: float, y: float, *, zoom_factor: float = 1.0) -> Arrival:
        """Centre a point in the current picture, and zoom by a factor (click-to-centre and area zoom).

        Args:
            x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
            y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).
            zoom_factor: Factor by which to change the focal length; 2.0 shows half of the picture's width.

        Raises:
            InputError: The point is outside the picture, or the factor is not above 0.
        """
        return await self.move(self.info.towards(await self.pose(), x, y, zoom_factor))

    async def lens(self) -> LensState:
        """Return the focus and iris settings that the lens reports.

        Raises:
            CameraError: Neither the focus nor the iris can be set.
        """
        raise CameraError(f"The focus and the iris of {self.info.name} cannot be set.")

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        """Set the focus and return when it has settled.

        Args:
            action: A focus action from ``info.capabilities.focus``.
            step: Length of a step as a fraction of the range, for "near" and "far".

        Raises:
            InputError: The action is unknown, or the step is not above 0 and at most 1.
            CameraError: The camera does not offer the action.
        """
        check_focus(self.info.name, action, self.info.capabilities.focus, step)
        raise CameraError(f"The driver of {self.info.name} cannot set the focus.")

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        """Set the iris.

        Args:
            action: An iris action from ``info.capabilities.iris``.
            step: Length of a step as a fraction of the range, for "open" and "close".

        Raises:
            InputError: The action is unknown, or the step is not above 0 and at most 1.
            CameraError: The camera does not offer the action.
        """
        check_iris(self.info.name, action, self.info.capabilities.iris, step)
        raise CameraError(f"The driver of {self.info.name} cannot set the iris.")

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        """Yield frames as they are taken, at most ``rate_hz`` per second. A slow consumer skips frames and always gets the newest.

        Wrap the generator in ``contextlib.aclosing``, so that the stream is released even if the consumer stops early.
        """
        if not (math.isfinite(rate_hz) and rate_hz > 0):
            raise InputError(f"The frame rate must be above 0 frames per second; got {rate_hz}.")
        while True:
            due_s = elapsed_s(self.clock) + 1.0 / rate_hz
            yield await self.frame()
            await self.clock.sleep(due_s - elapsed_s(self.clock))

    @property
    def frames_problem(self) -> str:
        """The reason why ``frames`` is interrupted, such as a network outage; empty while frames are arriving."""
        return ""

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:  # noqa: ARG002 - part of the contract
        """Save the current pose as a preset. An existing preset with the same name is replaced.

        Raises:
            InputError: The name is empty or too long, or contains unprintable characters.
            CameraError: The camera cannot save presets.
        """
        check_preset_name(name)
        raise CameraError(f"{self.info.name} cannot save presets.")

    async def remove_preset(self, name: str) -> None:
        """Remove a preset.

        Raises:
            UnknownNameError: There is no such preset.
            CameraError: The camera cannot remove this preset, or does not support removing presets.
        """
        if name not in (known := [preset.name for preset in await self.presets()]):
            raise UnknownNameError("preset", name, known)
        raise CameraError(f"{self.info.name} cannot remove presets.")

    control_lock: ControlLock | None = None
    """The lock that ``control`` acquires. If it is None, ``control`` creates one that applies to this object only.

    If other processes can reach the camera, the code that opens it must set a lock that works across processes.
    """

    @asynccontextmanager
    async def control(self, holder: str) -> AsyncIterator[None]:
        """Return a context manager that gives ``holder`` exclusive control of the camera.

        Raises:
            ControlHeldError: Someone else has control. The message names the holder if known.
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
        """Release the camera's resources. The default implementation does nothing."""

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        """Return a context manager that freezes scene time, so that all frames of a sweep show the same instant.

        It has no effect on a real camera.
        """
        yield
