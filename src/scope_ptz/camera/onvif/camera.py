"""An ONVIF camera."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Awaitable, Callable
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import anyio
from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import check_drive
from scope_ptz.camera.clocks import WallClock
from scope_ptz.camera.network.drive_watch import DriveWatch
from scope_ptz.camera.network.errors import PositionNotReachedError
from scope_ptz.camera.network.settling import Settling, stands, wait_for_still_picture, wait_until_standing
from scope_ptz.camera.onvif.client import OnvifClient
from scope_ptz.camera.onvif.device import OnvifDevice, read_device
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.camera.onvif.mapping import OnvifMapping
from scope_ptz.camera.onvif.motors import OnvifMotors
from scope_ptz.camera.onvif.pictures import OnvifPictures, OnvifStream, open_pictures
from scope_ptz.camera.onvif.presets import OnvifPresets
from scope_ptz.errors import CameraError, InputError
from scope_ptz.geometry import Pose, wrap_pan_deg

if TYPE_CHECKING:
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.network.http import DeviceHttp

STOP_CHECKS = 40
"""Readings of the position after a stop, until it is sent again."""


class OnvifCamera(Camera):
    """An ONVIF camera on the network. Open it with ``open``.

    Args:
        client: The connection.
        device: What the device is and can do.
        pictures: Its pictures.
        settling: When it counts as settled.
    """

    def __init__(self, client: OnvifClient, device: OnvifDevice, pictures: OnvifPictures, settling: Settling) -> None:
        self.clock = WallClock()
        self.device, self.pictures = device, pictures
        self._client, self._settling = client, settling
        self._motors, self._presets = OnvifMotors(client, device), OnvifPresets(client, device.ptz_profile)
        self._commands = 0
        self._sending: anyio.CancelScope | None = None
        name = f"{device.name} at {client.address}"
        self._watch = DriveWatch(name, client.stop_blocking)
        self._info = CameraInfo(
            name, device.limits, device.zoom.optics, pictures.width, pictures.height, simulated=False,
            capabilities=device.capabilities, assumed=device.assumed,
        )  # fmt: skip

    @classmethod
    async def open(
        cls,
        http: DeviceHttp,
        credentials: Credentials,
        *,
        mapping: OnvifMapping | None = None,
        assume: bool = False,
        profile: str = "",
        width: int | None = None,
        height: int | None = None,
        stream: OnvifStream = "rtsp",
        rtsp_port: int | None = None,
        latency_s: float = 0.1,
        settling: Settling | None = None,
    ) -> OnvifCamera:
        """Connect to a camera and read what it can do. ``http`` is closed with the camera, or if opening fails.

        Args:
            http: The device.
            credentials: The account.
            mapping: What was configured or measured.
            assume: Whether to assume what is neither stated nor known, as for measuring it.
            profile: Token or name of the ONVIF profile; by default one that suits.
            width: Width of a frame in pixels; by default that of the device's pictures.
            height: Height of a frame in pixels; by default that of the device's pictures.
            stream: How ``frames`` are transported.
            rtsp_port: Port of the RTSP server in place of the stated one.
            latency_s: Seconds from the exposure of a streamed frame to its arrival.
            settling: When the camera counts as settled.

        Raises:
            CameraError: The camera cannot be reached, refuses the account, is none, or does not state what is needed.
        """
        client = OnvifClient(http, credentials)
        try:
            await client.connect()
            device = await read_device(client, mapping or OnvifMapping(), width=width or 1280, profile=profile)
            if not assume:
                _check_known(device, str(client.address))
            pictures = await open_pictures(
                client, credentials, device, width=width, height=height, stream=stream, rtsp_port=rtsp_port, latency_s=latency_s
            )
            await client.prepare_stop(device.ptz_profile)
            return cls(client, device, pictures, settling or Settling())
        except BaseException:
            with anyio.CancelScope(shield=True):
                await client.close()
            raise

    @property
    def info(self) -> CameraInfo:
        return self._info

    async def pose(self) -> Pose:
        return await self._motors.pose()

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self._info.limits.clamp(pose)
        reached = await self._travel(lambda: self._motors.move(target), target)
        if reached is None:  # another command has replaced this one
            return Arrival(await self.pose(), clamped)
        if not self._settling.near(reached, target):
            raise PositionNotReachedError(
                f"{self._info.name} stands at {_text(reached)} and was sent to {_text(target)}: the position never arrived. "
                f"The {self._farthest(reached, target)} motor may be blocked or limited, or somebody else moved the camera."
            )
        return Arrival(reached, clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(name) for name in await self._presets.tokens()]

    async def go_to_preset(self, name: str) -> Arrival:
        token = await self._presets.token(name)
        try:
            return await self._go(lambda: self._presets.go_to(token))
        except OnvifFaultError:
            await self._presets.token(name)  # somebody may have removed it meanwhile
            raise

    async def go_home(self) -> Arrival:
        return await self._go(self._motors.go_home)

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:  # noqa: ARG002 - devices keep names only
        await self._presets.save(name)
        return PresetInfo(name)

    async def remove_preset(self, name: str) -> None:
        await self._presets.remove(name)

    async def frame(self) -> Frame:
        return await self.pictures.frame(self.pose, self._info, self.clock)

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        if not 0 < rate_hz < float("inf"):
            raise InputError(f"The frame rate is a number of frames per second above 0, got {rate_hz}.")
        stream = self.pictures.live(rate_hz, self.pose, self._info, self.clock)
        try:
            async for frame in stream:
                yield frame
        finally:
            with anyio.CancelScope(shield=True):
                await stream.aclose()

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        if not self._info.capabilities.drives:
            raise CameraError(f"{self._info.name} cannot be driven at a velocity; move it to a pose.")
        self._watch.arm(timeout_s)  # before the command: one that arrives without its reply must end, too
        number = self._next()
        try:
            await self._send(number, lambda: self._motors.drive(pan_dps, tilt_dps, zoom_rate, timeout_s))
        except BaseException:
            self._watch.stop_now()
            raise

    async def stop(self) -> None:
        """Stop any motion and return when the camera stands.

        Raises:
            CameraError: The stop did not arrive, or the camera does not stop. A driven camera is still stopped by the dead man's
                switch as soon as it can be reached.
        """
        number = self._next()
        if self._sending is not None:
            self._sending.cancel()  # whatever is on its way must not delay the stop
        try:
            for _ in range(3):
                await self._motors.stop()
                if await self._stands() or self._commands != number:
                    if self._commands == number:
                        self._watch.disarm()
                    return
        except BaseException:
            self._watch.stop_now()
            raise
        self._watch.stop_now()
        raise CameraError(f"{self._info.name} does not stop. Check that nobody else moves it and that no tour is running.")

    async def close(self) -> None:
        with anyio.CancelScope(shield=True):
            try:
                if self._watch.armed:
                    self._watch.stop_now()
                    await to_thread.run_sync(self._watch.join)
                await self.pictures.close()
            finally:
                await self._client.close()

    async def _go(self, start: Callable[[], Awaitable[None]]) -> Arrival:
        """Go to a place that only the device knows."""
        reached = await self._travel(start, None)
        return Arrival(await self.pose() if reached is None else reached)

    async def _travel(self, start: Callable[[], Awaitable[None]], target: Pose | None) -> Pose | None:
        """Start a move and wait until the camera has settled. Return None if another command has replaced the move."""
        number = self._next()

        def superseded() -> bool:
            return self._commands != number

        try:
            if self._watch.armed:  # the dead man's switch must not stop the move
                await self._motors.stop()
                self._watch.disarm()
                await to_thread.run_sync(self._watch.join)
            if await self._send(number, start):
                reached = await wait_until_standing(self.pose, self._settling, target, superseded)
                if not superseded():
                    await wait_for_still_picture(lambda: self.pictures.small(reached), self._settling, superseded)
                    return None if superseded() else reached
        except BaseException:
            if not superseded():
                with anyio.move_on_after(3.0, shield=True), suppress(CameraError):
                    await self.stop()
            raise
        with suppress(PositionNotReachedError):
            await wait_until_standing(self.pose, replace(self._settling, start_s=2 * self._settling.poll_s))
        return None

    async def _send(self, number: int, command: Callable[[], Awaitable[None]]) -> bool:
        """Send a command unless another one has replaced it. Return whether it was sent."""
        if self._commands != number:
            return False
        with anyio.CancelScope() as scope:
            self._sending = scope
            try:
                await command()
            finally:
                if self._sending is scope:
                    self._sending = None
        return not scope.cancelled_caught

    def _next(self) -> int:
        self._commands += 1
        return self._commands

    async def _stands(self) -> bool:
        before = await self.pose()
        for _ in range(STOP_CHECKS):
            await anyio.sleep(self._settling.poll_s)
            now = await self.pose()
            if stands(before, now):
                return True
            before = now
        return False

    def _farthest(self, reached: Pose, target: Pose) -> str:
        """Return the axis that is farthest from its target, in tolerances."""
        off = {
            "pan": abs(wrap_pan_deg(reached.pan_deg - target.pan_deg)) / self._settling.angle_tolerance_deg,
            "tilt": abs(reached.tilt_deg - target.tilt_deg) / self._settling.angle_tolerance_deg,
            "zoom": abs(reached.zoom / target.zoom - 1) / self._settling.zoom_tolerance,
        }
        return max(off, key=lambda axis: off[axis])


def _check_known(device: OnvifDevice, where: str) -> None:
    if device.assumed:
        raise CameraError(
            f"ONVIF does not state the {' and the '.join(device.assumed)} of the {device.name} at {where}. "
            "Measure it with `scope camera calibrate`, or add options such as hfov_wide and hfov_tele to the camera."
        )


def _text(pose: Pose) -> str:
    return f"pan {pose.pan_deg:.1f}, tilt {pose.tilt_deg:.1f}, zoom {pose.zoom:.2f}x"
