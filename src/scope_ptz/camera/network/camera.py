"""The base class for network cameras: moves that wait for arrival, continuous moves with a timeout, stops, and frames."""

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
from scope_ptz.camera.network.dead_mans_switch import DeadMansSwitch
from scope_ptz.camera.network.errors import CameraSignInError, PositionNotReachedError
from scope_ptz.camera.network.settling import SettlingCriteria, is_stationary, wait_for_still_picture, wait_until_stationary
from scope_ptz.errors import CameraError, InputError
from scope_ptz.geometry import angle_between_deg, direction

if TYPE_CHECKING:
    from scope_ptz.camera.network.device_pictures import DevicePictures
    from scope_ptz.camera.network.watchdog_process import WatchdogProcess
    from scope_ptz.geometry import Axis, Pose

MAX_STOP_READINGS = 40
"""Maximum number of position readings after a stop command before the command is sent again."""

MAX_CENTRING_ERROR = 0.05
"""Maximum error of a centred point as a fraction of the field of view, and maximum relative error of the zoom."""

Command = Callable[[], Awaitable[None]]
"""A function that sends a command to the device."""


class NetworkCamera(Camera):
    """A camera on the network. Drivers send the commands; this class decides when to send them and waits for their effect.

    Commands are numbered. Once there is a newer command, an older one is not sent, or its effect is no longer awaited.

    Args:
        info: The camera's properties and capabilities.
        pictures: The source of its pictures.
        settling: The criteria for deciding that the camera has settled.
        watchdog: The watchdog process, which stops the camera if the current process is killed.
    """

    def __init__(self, info: CameraInfo, pictures: DevicePictures, settling: SettlingCriteria, watchdog: WatchdogProcess) -> None:
        self.clock = WallClock()
        self._info, self._pictures, self._settling = info, pictures, settling
        self._commands = self._sent = 0
        self._send_scope: anyio.CancelScope | None = None
        self._dead_mans_switch = DeadMansSwitch(info.name, self._send_stop_blocking, watchdog=watchdog)

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
        """Send the velocities with ``_send``, passing the command number on to it."""

    @abstractmethod
    async def _send_stop(self) -> None:
        """Send the commands that stop all axes."""

    @abstractmethod
    def _send_stop_blocking(self) -> None:
        """Stop all axes from a thread, over a separate connection, and return once the device has acknowledged the command."""

    @abstractmethod
    async def _disconnect(self) -> None:
        """Close the connections. Implementations must not raise ``CameraError``."""

    def _check_may_move(self) -> None:
        """Raise ``CameraError`` if the device is known to refuse moves."""

    def _centring_command(self, current: Pose, target: Pose, x: float, y: float) -> Command | None:  # noqa: ARG002 - for drivers
        """Return the device's own command for centring a point in the picture; None if it has none.

        Args:
            current: The current pose.
            target: The pose that the command should reach, computed from the camera's optics.
            x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
            y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).
        """
        return None

    async def _axes_at_limits(self, reached: Pose, target: Pose) -> tuple[Axis, ...]:
        """Return the axes that stopped at a limit that ``info`` does not include.

        Raises:
            PositionNotReachedError: No limit explains the camera's position.
        """
        axis = self._settling.farthest_axis(reached, target)
        reason = f"The {axis} motor may be blocked or limited, or someone else may have moved the camera."
        raise self._not_reached(reached, target, reason)

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self._info.limits.clamp(pose)
        reached = await self._move_and_settle(lambda: self._start_move(target), target)
        if reached is None:  # another command has replaced this one
            return Arrival(await self.pose(), clamped)
        if not self._settling.is_near(reached, target):
            stopped = {*clamped, *await self._axes_at_limits(reached, target)}
            clamped = tuple(axis for axis in ("pan", "tilt", "zoom") if axis in stopped)
        return Arrival(reached, clamped)

    async def centre_on(self, x: float, y: float, *, zoom_factor: float = 1.0) -> Arrival:
        """Centre a point in the picture with the device's own command, which is based on exact knowledge of the lens.

        If the device has no such command, or the resulting pose is wrong, the camera moves to the pose computed from its optics.
        """
        current = await self.pose()
        requested = self._info.towards(current, x, y, zoom_factor)
        target, clamped = self._info.limits.clamp(requested)
        command = None if clamped else self._centring_command(current, target, x, y)
        if command is None:
            return await self.move(requested)
        reached = await self._move_and_settle(command, None)
        if reached is None:
            return Arrival(await self.pose())
        optics = self._info.optics
        off_deg = float(angle_between_deg(direction(reached.pan_deg, reached.tilt_deg), direction(target.pan_deg, target.tilt_deg)))
        near = (
            off_deg <= MAX_CENTRING_ERROR * optics.hfov_deg(target.zoom)
            and abs(reached.zoom / target.zoom - 1) <= MAX_CENTRING_ERROR
        )
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
        driven, sent = self._dead_mans_switch.is_armed, self._sent
        self._dead_mans_switch.arm(timeout_s)  # before the command, because a drive must be stopped even if its reply is lost
        number = self._next_number()
        try:
            await self._start_drive(number, pan_dps, tilt_dps, zoom_rate, timeout_s)
        except CameraSignInError:
            # An account without permission to move the camera cannot stop it either, but then nothing is moving.
            if driven or self._sent != sent:
                self._dead_mans_switch.stop_now()
            else:
                self._dead_mans_switch.disarm()
            raise
        except BaseException:
            self._dead_mans_switch.stop_now()
            raise
        if self._commands == number:
            self._dead_mans_switch.arm(timeout_s)  # the timeout starts once the camera has received the command

    async def stop(self) -> None:
        """Stop any motion and return once the camera is stationary.

        Raises:
            CameraError: The stop command did not reach the camera, or the camera did not stop. If the camera is being driven, the
                dead man's switch keeps trying to stop it.
        """
        number = self._next_number()
        if self._send_scope is not None:
            self._send_scope.cancel()  # commands in flight must not delay the stop
        try:
            for _ in range(3):
                await self._send_stop()
                if await self._has_stopped() or self._commands != number:
                    if self._commands == number:
                        self._dead_mans_switch.disarm()
                    return
        except BaseException:
            self._dead_mans_switch.stop_now()
            raise
        self._dead_mans_switch.stop_now()
        raise CameraError(f"{self._info.name} did not stop. Check that no one else is moving it and that no guard tour is running.")

    async def close(self) -> None:
        with anyio.CancelScope(shield=True):
            try:
                await to_thread.run_sync(self._dead_mans_switch.close)
                await self._pictures.close()
            finally:
                await self._disconnect()

    async def _go(self, start: Command) -> Arrival:
        """Go to a pose that only the device knows, such as a preset."""
        reached = await self._move_and_settle(start, None)
        return Arrival(await self.pose() if reached is None else reached)

    async def _move_and_settle(self, start: Command, target: Pose | None) -> Pose | None:
        """Start a move and wait until the camera has settled. Return None if another command has replaced the move."""
        self._check_may_move()
        number = self._next_number()

        def is_superseded() -> bool:
            return self._commands != number

        try:
            if self._dead_mans_switch.is_armed:  # the dead man's switch must not stop this move
                await self._send_stop()
                self._dead_mans_switch.disarm()
                await to_thread.run_sync(self._dead_mans_switch.join)
            if await self._send(number, start):
                reached = await wait_until_stationary(self.pose, self._settling, target, is_superseded)
                if not is_superseded():
                    await wait_for_still_picture(lambda: self._pictures.settling_picture(reached), self._settling, is_superseded)
                    return None if is_superseded() else reached
        except BaseException:
            if not is_superseded():
                with anyio.move_on_after(3.0, shield=True), suppress(CameraError):
                    await self.stop()
            raise
        with suppress(PositionNotReachedError):
            await wait_until_stationary(self.pose, replace(self._settling, start_s=2 * self._settling.poll_s))
        return None

    async def _send(self, number: int, command: Command) -> bool:
        """Send a command unless a newer one exists. Return whether it was sent."""
        if self._commands != number:
            return False
        with anyio.CancelScope() as scope:
            self._send_scope = scope
            try:
                await command()
                self._sent += 1
            finally:
                if self._send_scope is scope:
                    self._send_scope = None
        return not scope.cancelled_caught

    def _next_number(self) -> int:
        self._commands += 1
        return self._commands

    async def _has_stopped(self) -> bool:
        before = await self.pose()
        for _ in range(MAX_STOP_READINGS):
            await anyio.sleep(self._settling.poll_s)
            now = await self.pose()
            if is_stationary(before, now):
                return True
            before = now
        return False

    def _not_reached(self, reached: Pose, target: Pose, reason: str) -> PositionNotReachedError:
        return PositionNotReachedError(
            f"{self._info.name} was sent to {_pose_text(target)} but stopped at {_pose_text(reached)}. {reason}"
        )


def _pose_text(pose: Pose) -> str:
    return f"pan {pose.pan_deg:.1f}, tilt {pose.tilt_deg:.1f}, zoom {pose.zoom:.2f}x"
