"""Base class of network cameras: moves that wait for arrival, continuous moves with a timeout, stops, and pictures with poses."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import AsyncGenerator, Awaitable, Callable
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import anyio
from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame
from scope_ptz.camera.capabilities import check_drive
from scope_ptz.camera.clocks import WallClock
from scope_ptz.camera.network.drive_watch import DriveWatch
from scope_ptz.camera.network.errors import CameraSignInError, PositionNotReachedError
from scope_ptz.camera.network.settling import Settling, is_stationary, wait_for_still_picture, wait_until_stationary
from scope_ptz.errors import CameraError, InputError
from scope_ptz.geometry import angle_between_deg, direction

if TYPE_CHECKING:
    from scope_ptz.camera.network.device_pictures import DevicePictures
    from scope_ptz.camera.network.stop_process import StopProcess
    from scope_ptz.geometry import Axis, Pose

STOP_CHECKS = 40
"""Number of position readings after a stop before the stop is sent again."""

MAX_OFF_CENTRE = 0.05
"""Maximum error of a centred point, as a fraction of the picture's width, and maximum relative error of the zoom."""

Command = Callable[[], Awaitable[None]]
"""A function that sends a command to the device."""


class NetworkCamera(Camera):
    """A camera on the network. Drivers implement how commands are sent; this class decides when, and waits for their effect.

    Every command gets a number. If a newer command exists, an older one is not sent, or its effect is no longer awaited.

    Args:
        info: The camera's properties and capabilities.
        pictures: The source of its pictures.
        settling: The criteria for when the camera counts as settled.
        watchdog: The process that stops the camera if this program is killed.
    """

    def __init__(self, info: CameraInfo, pictures: DevicePictures, settling: Settling, watchdog: StopProcess) -> None:
        self.clock = WallClock()
        self._info, self._pictures, self._settling = info, pictures, settling
        self._commands = self._sent = 0
        self._sending: anyio.CancelScope | None = None
        self._watch = DriveWatch(info.name, self._send_stop_blocking, watchdog=watchdog)

    @property
    def info(self) -> CameraInfo:
        return self._info

    @abstractmethod
    async def _start_move(self, pose: Pose) -> None:
        """Send the command that moves the camera to a pose, which is within the limits."""

    @abstractmethod
    async def _start_home(self) -> None:
        """Send the command that moves the camera to its home position."""

    @abstractmethod
    async def _start_drive(self, number: int, pan_dps: float, tilt_dps: float, zoom_rate: float, timeout_s: float) -> None:
        """Send the velocities with ``_send``, and pass ``number``, the number of the command, to it."""

    @abstractmethod
    async def _send_stop(self) -> None:
        """Send the commands that stop all axes."""

    @abstractmethod
    def _send_stop_blocking(self) -> None:
        """Stop all axes from a thread, over a separate connection, and return when the device has acknowledged it."""

    @abstractmethod
    async def _disconnect(self) -> None:
        """Close the connections. It must not raise ``CameraError``."""

    def _check_may_move(self) -> None:
        """Raise ``CameraError`` if the device is known to refuse moves."""

    def _centring_command(self, here: Pose, target: Pose, x: float, y: float) -> Command | None:  # noqa: ARG002 - for drivers
        """Return the device's own command that centres a point of the picture; None if the device has none.

        Args:
            here: The current pose.
            target: The pose that the command should reach, computed from the camera's optics.
            x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
            y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).
        """
        return None

    async def _explain_miss(self, reached: Pose, target: Pose) -> tuple[Axis, ...]:
        """Return the axes that stopped at a limit that the device had not reported before.

        Raises:
            PositionNotReachedError: No limit explains the camera's position.
        """
        axis = self._settling.farthest(reached, target)
        raise self._not_reached(reached, target, f"The {axis} motor may be blocked or limited, or somebody else moved the camera.")

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self._info.limits.clamp(pose)
        reached = await self._travel(lambda: self._start_move(target), target)
        if reached is None:  # another command has replaced this one
            return Arrival(await self.pose(), clamped)
        if not self._settling.near(reached, target):
            stopped = {*clamped, *await self._explain_miss(reached, target)}
            clamped = tuple(axis for axis in ("pan", "tilt", "zoom") if axis in stopped)
        return Arrival(reached, clamped)

    async def centre_on(self, x: float, y: float, *, zoom_factor: float = 1.0) -> Arrival:
        """Centre a point of the picture with the device's own command, and check the resulting pose.

        The device knows its lens best. If the resulting pose is wrong, the camera is moved to the pose computed from its optics.
        """
        here = await self.pose()
        requested = self._info.towards(here, x, y, zoom_factor)
        target, clamped = self._info.limits.clamp(requested)
        command = None if clamped else self._centring_command(here, target, x, y)
        if command is None:
            return await self.move(requested)
        reached = await self._travel(command, None)
        if reached is None:
            return Arrival(await self.pose())
        optics = self._info.optics
        off_deg = float(angle_between_deg(direction(reached.pan_deg, reached.tilt_deg), direction(target.pan_deg, target.tilt_deg)))
        near = off_deg <= MAX_OFF_CENTRE * optics.hfov_deg(target.zoom) and abs(reached.zoom / target.zoom - 1) <= MAX_OFF_CENTRE
        return Arrival(reached) if near else await self.move(requested)

    async def go_home(self) -> Arrival:
        return await self._go(self._start_home)

    async def frame(self) -> Frame:
        return await self._pictures.frame(self.pose, self._info, self.clock)

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        if not 0 < rate_hz < float("inf"):
            raise InputError(f"The frame rate must be above 0 frames per second; got {rate_hz}.")
        stream = self._pictures.live(rate_hz, self.pose, self._info, self.clock)
        try:
            async for frame in stream:
                yield frame
        finally:
            with anyio.CancelScope(shield=True):
                await stream.aclose()

    @property
    def frames_problem(self) -> str:
        return self._pictures.problem

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        if not self._info.capabilities.drives:
            raise CameraError(f"{self._info.name} cannot be driven at a velocity; move it to a pose.")
        self._check_may_move()
        driven, sent = self._watch.armed, self._sent
        self._watch.arm(timeout_s)  # before the command, because a command whose reply is lost must be stopped too
        number = self._next()
        try:
            await self._start_drive(number, pan_dps, tilt_dps, zoom_rate, timeout_s)
        except CameraSignInError:
            # An account that may not move the camera may not stop it either, but then nothing is moving.
            if driven or self._sent != sent:
                self._watch.stop_now()
            else:
                self._watch.disarm()
            raise
        except BaseException:
            self._watch.stop_now()
            raise
        if self._commands == number:
            self._watch.arm(timeout_s)  # the timeout starts when the camera has received the command

    async def stop(self) -> None:
        """Stop any motion and return when the camera is stationary.

        Raises:
            CameraError: The stop command did not reach the camera, or the camera does not stop. The dead man's switch still stops a
                driven camera as soon as it can be reached.
        """
        number = self._next()
        if self._sending is not None:
            self._sending.cancel()  # commands in flight must not delay the stop
        try:
            for _ in range(3):
                await self._send_stop()
                if await self._has_stopped() or self._commands != number:
                    if self._commands == number:
                        self._watch.disarm()
                    return
        except BaseException:
            self._watch.stop_now()
            raise
        self._watch.stop_now()
        raise CameraError(f"{self._info.name} does not stop. Check that nobody else is moving it and that no tour is running.")

    async def close(self) -> None:
        with anyio.CancelScope(shield=True):
            try:
                await to_thread.run_sync(self._watch.close)
                await self._pictures.close()
            finally:
                await self._disconnect()

    async def _go(self, start: Command) -> Arrival:
        """Go to a pose that only the device knows, such as a preset."""
        reached = await self._travel(start, None)
        return Arrival(await self.pose() if reached is None else reached)

    async def _travel(self, start: Command, target: Pose | None) -> Pose | None:
        """Start a move and wait until the camera has settled. Return None if another command has replaced the move."""
        self._check_may_move()
        number = self._next()

        def superseded() -> bool:
            return self._commands != number

        try:
            if self._watch.armed:  # the dead man's switch must not stop the move
                await self._send_stop()
                self._watch.disarm()
                await to_thread.run_sync(self._watch.join)
            if await self._send(number, start):
                reached = await wait_until_stationary(self.pose, self._settling, target, superseded)
                if not superseded():
                    await wait_for_still_picture(lambda: self._pictures.settling_picture(reached), self._settling, superseded)
                    return None if superseded() else reached
        except BaseException:
            if not superseded():
                with anyio.move_on_after(3.0, shield=True), suppress(CameraError):
                    await self.stop()
            raise
        with suppress(PositionNotReachedError):
            await wait_until_stationary(self.pose, replace(self._settling, start_s=2 * self._settling.poll_s))
        return None

    async def _send(self, number: int, command: Command) -> bool:
        """Send a command unless another one has replaced it. Return whether it was sent."""
        if self._commands != number:
            return False
        with anyio.CancelScope() as scope:
            self._sending = scope
            try:
                await command()
                self._sent += 1
            finally:
                if self._sending is scope:
                    self._sending = None
        return not scope.cancelled_caught

    def _next(self) -> int:
        self._commands += 1
        return self._commands

    async def _has_stopped(self) -> bool:
        before = await self.pose()
        for _ in range(STOP_CHECKS):
            await anyio.sleep(self._settling.poll_s)
            now = await self.pose()
            if is_stationary(before, now):
                return True
            before = now
        return False

    def _not_reached(self, reached: Pose, target: Pose, reason: str) -> PositionNotReachedError:
        return PositionNotReachedError(
            f"{self._info.name} is at {_text(reached)} but was sent to {_text(target)}: the position never arrived. {reason}"
        )


def _text(pose: Pose) -> str:
    return f"pan {pose.pan_deg:.1f}, tilt {pose.tilt_deg:.1f}, zoom {pose.zoom:.2f}x"
