"""An AXIS camera."""

from __future__ import annotations

from collections.abc import AsyncGenerator, Awaitable, Callable
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import anyio
from anyio import to_thread

from scope_ptz.camera.axis import requests
from scope_ptz.camera.axis.client import VapixClient
from scope_ptz.camera.axis.device import RTSP_PORT, AxisDevice, read_device, read_rtsp_port
from scope_ptz.camera.axis.lens import LensControls
from scope_ptz.camera.axis.pictures import AxisPictures, StreamKind
from scope_ptz.camera.axis.replies import VapixError, check_done, parse_limits
from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import Capabilities, check_drive
from scope_ptz.camera.clocks import WallClock
from scope_ptz.camera.network.drive_watch import DriveWatch
from scope_ptz.camera.network.errors import PositionNotReachedError
from scope_ptz.camera.network.settling import Settling, stands, wait_for_still_picture, wait_until_standing
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Axis, Pose, wrap_pan_deg

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.network.http import DeviceHttp

STOP_CHECKS = 40
"""Readings of the position after a stop, until it is sent again."""


class AxisCamera(LensControls, Camera):
    """An AXIS camera on the network. Open it with ``open``.

    Args:
        client: The connection.
        device: What the device is and can do.
        pictures: Its pictures.
        settling: When it counts as settled.
    """

    def __init__(self, client: VapixClient, device: AxisDevice, pictures: AxisPictures, settling: Settling) -> None:
        super().__init__(client, device)
        self.clock = WallClock()
        self._pictures, self._settling = pictures, settling
        self._commands = 0
        self._sending: anyio.CancelScope | None = None
        self._zoom_driven = False
        name = f"{device.model or 'AXIS camera'} at {client.address}"
        self._watch = DriveWatch(name, self._send_stop_blocking)
        self._info = CameraInfo(
            name, device.limits, device.optics, pictures.width, pictures.height, simulated=False, capabilities=device.capabilities
        )

    @classmethod
    async def open(
        cls,
        http: DeviceHttp,
        credentials: Credentials,
        *,
        channel: int = 1,
        width: int = 1280,
        height: int = 720,
        stream: StreamKind = "mjpeg",
        rtsp_port: int | None = None,
        latency_s: float = 0.1,
        fields_deg: tuple[float, float] | None = None,
        settling: Settling | None = None,
    ) -> AxisCamera:
        """Connect to a camera and read what it can do. ``http`` is closed with the camera, or if opening fails.

        Args:
            http: The device.
            credentials: The account, for RTSP.
            channel: The video channel.
            width: Width of a frame in pixels.
            height: Height of a frame in pixels.
            stream: How ``frames`` are transported.
            rtsp_port: Port of the RTSP server; None for the one that the device reports.
            latency_s: Seconds from the exposure of a streamed frame to its arrival.
            fields_deg: Horizontal fields of view at the widest and the closest zoom, in place of what the device reports.
            settling: When the camera counts as settled.

        Raises:
            CameraError: The camera cannot be reached, refuses the account, or is none.
        """
        client = VapixClient(http, channel)
        try:
            device = await read_device(client, fields_deg=fields_deg)
            client.queueing = device.queueing
            if rtsp_port is None:
                rtsp_port = await read_rtsp_port(client) if stream == "rtsp" else RTSP_PORT
            pictures = AxisPictures(
                client, credentials, width, height, sizes=device.sizes, stream=stream, rtsp_port=rtsp_port, latency_s=latency_s
            )
            return cls(client, device, pictures, settling or Settling())
        except BaseException:
            with anyio.CancelScope(shield=True):
                await http.close()
            raise

    @property
    def info(self) -> CameraInfo:
        return self._info

    async def pose(self) -> Pose:
        position = await self._client.position()
        zoom = self._device.zoom.to_zoom(position.zoom_units)
        pan_deg = wrap_pan_deg(position.pan_deg) if self._info.limits.pan_endless else position.pan_deg
        return Pose(pan_deg, position.tilt_deg, zoom)

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self._info.limits.clamp(pose)
        request = requests.absolute(self._client.channel, target.pan_deg, target.tilt_deg, self._device.zoom.to_units(target.zoom))
        reached = await self._travel(request, target)
        if reached is None:  # another command has replaced this one
            return Arrival(await self.pose(), clamped)
        if not self._settling.near(reached, target):
            clamped = await self._explain(reached, target, clamped)
        return Arrival(reached, clamped)

    async def presets(self) -> list[PresetInfo]:
        # Two presets of one name can be distinguished by number only, and only the first one can be reached by name.
        return [PresetInfo(name) for name in dict.fromkeys((await self._client.presets()).values())]

    async def go_to_preset(self, name: str) -> Arrival:
        await self._find_preset(name)
        try:
            return await self._go(requests.go_to_preset(self._client.channel, name))
        except VapixError:
            await self._find_preset(name)  # somebody may have removed it meanwhile
            raise

    async def go_home(self) -> Arrival:
        return await self._go(requests.home(self._client.channel))

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:  # noqa: ARG002 - devices keep names only
        request = requests.save_preset(self._client.channel, name)
        await self._client.command(request)
        if name not in (await self._client.presets()).values():
            raise CameraError(f"{self._info.name} did not save the preset. Its account may lack administrator rights.")
        return PresetInfo(name)

    async def remove_preset(self, name: str) -> None:
        await self._find_preset(name)
        await self._client.command(requests.remove_preset(self._client.channel, name))

    async def frame(self) -> Frame:
        return await self._pictures.frame(self.pose, self._info, self.clock)

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        if not (rate_hz > 0 and rate_hz < float("inf")):
            raise InputError(f"The frame rate is a number of frames per second above 0, got {rate_hz}.")
        stream = self._pictures.live(rate_hz, self.pose, self._info, self.clock)
        try:
            async for frame in stream:
                yield frame
        finally:
            with anyio.CancelScope(shield=True):
                await stream.aclose()

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        capabilities = self._info.capabilities
        if not capabilities.drives:
            raise CameraError(f"{self._info.name} cannot be driven at a velocity; move it to a pose.")
        self._check_unlocked()
        channel, speeds = self._client.channel, self._device.speeds
        zoom = _zoom_speed(zoom_rate, capabilities)
        proportional = "ProportionalSpeed" in self._device.supported
        self._watch.arm(timeout_s)  # before the command: one that arrives without its reply must end, too
        number = self._next()
        try:
            move = requests.continuous_pan_tilt(
                channel, speeds.to_speed(pan_dps), speeds.to_speed(tilt_dps), proportional=proportional
            )  # fmt: skip
            await self._send(number, replace(move, repeat=False))
            if zoom or self._zoom_driven:
                await self._send(number, replace(requests.continuous_zoom(channel, zoom), repeat=False))
                self._zoom_driven = bool(zoom)
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
                await self._send_stop()
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
                await self._client.drop_control()
            except CameraError:
                pass  # the connection is gone, and the queue forgets a silent client
            finally:
                await self._client.http.close()

    async def _send_stop(self) -> None:
        """Send the stop of every axis. A device may refuse one of the commands, but not all."""
        self._zoom_driven, refused = False, []
        for request in requests.stop(self._client.channel):
            try:
                check_done((await self._client.send(request)).body)
            except VapixError as error:
                refused.append(error)
        if len(refused) == len(requests.stop(self._client.channel)):
            raise refused[0]

    async def _end_drive(self) -> None:
        """End a drive before a move, so that the dead man's switch does not stop the move."""
        if self._watch.armed:
            await self._send_stop()
            self._watch.disarm()
            await to_thread.run_sync(self._watch.join)

    async def _go(self, request: requests.VapixRequest) -> Arrival:
        """Go to a place that only the device knows."""
        reached = await self._travel(request, None)
        return Arrival(await self.pose() if reached is None else reached)

    async def _travel(self, request: requests.VapixRequest, target: Pose | None) -> Pose | None:
        """Send a move and wait until the camera has settled. Return None if another command has replaced the move."""
        self._check_unlocked()
        number = self._next()

        def superseded() -> bool:
            return self._commands != number

        try:
            await self._end_drive()
            if await self._send(number, request):
                reached = await wait_until_standing(self.pose, self._settling, target, superseded)
                if not superseded():
                    await wait_for_still_picture(self._take_small(reached), self._settling, superseded)
                    return None if superseded() else reached
        except BaseException:
            if not superseded():
                with anyio.move_on_after(3.0, shield=True), suppress(CameraError):
                    await self.stop()
            raise
        with suppress(PositionNotReachedError):
            await wait_until_standing(self.pose, replace(self._settling, start_s=2 * self._settling.poll_s))
        return None

    async def _send(self, number: int, request: requests.VapixRequest) -> bool:
        """Send a command unless another one has replaced it. Return whether it was sent."""
        if self._commands != number:
            return False
        with anyio.CancelScope() as scope:
            self._sending = scope
            try:
                await self._client.command(request)
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

    def _take_small(self, pose: Pose) -> Callable[[], Awaitable[NDArray[np.uint8]]]:
        return lambda: self._pictures.small(pose)

    async def _explain(self, reached: Pose, target: Pose, clamped: tuple[Axis, ...]) -> tuple[Axis, ...]:
        """Return the axes that a limit stopped, one that the device did not report before included.

        Raises:
            PositionNotReachedError: No limit explains where the camera stands.
        """
        reported = parse_limits((await self._client.send(requests.query(self._client.channel, "limits"))).body)
        scale, tolerance = self._device.zoom, self._settling
        bounds: dict[Axis, tuple[float, float, float, float]] = {
            "pan": (reached.pan_deg, target.pan_deg, reported.min_pan_deg, reported.max_pan_deg),
            "tilt": (reached.tilt_deg, target.tilt_deg, reported.min_tilt_deg, reported.max_tilt_deg),
            "zoom": (reached.zoom, target.zoom, scale.to_zoom(reported.min_zoom_units), scale.to_zoom(reported.max_zoom_units)),
        }
        stopped = list(clamped)
        for axis, (at, wanted, low, high) in bounds.items():
            allowed = tolerance.zoom_tolerance * wanted if axis == "zoom" else tolerance.angle_tolerance_deg
            off = abs(wrap_pan_deg(at - wanted)) if axis == "pan" else abs(at - wanted)
            if off <= allowed:
                continue
            at_limit = (wanted > high and abs(at - high) <= allowed) or (wanted < low and abs(at - low) <= allowed)
            if not at_limit:
                raise PositionNotReachedError(
                    f"{self._info.name} stands at {_text(reached)} and was sent to {_text(target)}: the position never arrived. "
                    f"The {axis} motor may be blocked, or somebody else moved the camera."
                )
            stopped.append(axis)
        return tuple(axis for axis in bounds if axis in stopped)

    async def _find_preset(self, name: str) -> None:
        known = (await self._client.presets()).values()
        if name not in known:
            raise UnknownNameError("preset", name, known)

    def _check_unlocked(self) -> None:
        if self._device.locked:
            raise CameraError(f"The position of {self._info.name} is locked. Unlock it in the camera's PTZ settings.")

    def _send_stop_blocking(self) -> None:
        self._client.http.send_blocking(requests.PTZ_PATH, tuple(r.query for r in requests.stop(self._client.channel)))


def _zoom_speed(rate: float, capabilities: Capabilities) -> int:
    """Return the zoom speed of -100 to 100. VAPIX reports no rates, so 100 is taken for the top speed."""
    top = capabilities.top_speed.zoom_rate
    if not rate or not top:
        return 0
    speed = max(-100, min(100, round(100 * rate / top)))
    return speed or (1 if rate > 0 else -1)


def _text(pose: Pose) -> str:
    return f"pan {pose.pan_deg:.1f}, tilt {pose.tilt_deg:.1f}, zoom {pose.zoom:.2f}x"
