"""The driver for AXIS cameras."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import anyio

from scope_ptz.camera.axis import requests
from scope_ptz.camera.axis.client import VapixClient
from scope_ptz.camera.axis.device import RTSP_PORT, AxisDevice, read_device, read_rtsp_port
from scope_ptz.camera.axis.lens import AxisLens
from scope_ptz.camera.axis.pictures import AxisPictures, StreamKind
from scope_ptz.camera.axis.replies import VapixError, check_done, parse_limits
from scope_ptz.camera.base import Arrival, CameraInfo, PresetInfo
from scope_ptz.camera.capabilities import Capabilities
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState
from scope_ptz.camera.network.camera import Command, NetworkCamera
from scope_ptz.camera.network.settling import SettlingCriteria
from scope_ptz.camera.network.watchdog_process import WatchdogProcess
from scope_ptz.errors import CameraError, UnknownNameError
from scope_ptz.geometry import Axis, Pose, wrap_pan_deg

if TYPE_CHECKING:
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.network.http import DeviceHttp


class AxisCamera(NetworkCamera):
    """An AXIS camera on the network. Open it with ``open``.

    Args:
        client: The connection to the device.
        device: The device's properties and capabilities.
        pictures: The source of its pictures.
        settling: The criteria for deciding that the camera has settled.
    """

    def __init__(self, client: VapixClient, device: AxisDevice, pictures: AxisPictures, settling: SettlingCriteria) -> None:
        name = f"{device.model or 'AXIS camera'} at {client.address}"
        info = CameraInfo(
            name, device.limits, device.optics, pictures.width, pictures.height, simulated=False,
            capabilities=device.capabilities, firmware=device.firmware,
        )  # fmt: skip
        watchdog = WatchdogProcess(client.http, stop_device, {"channel": client.channel})
        super().__init__(info, pictures, settling, watchdog)
        self._client, self._device = client, device
        self._lens = AxisLens(name, client, device.capabilities, settling.poll_s)
        self._zoom_driven = False

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
        measured_fields: tuple[tuple[float, float], ...] | None = None,
        settling: SettlingCriteria | None = None,
    ) -> AxisCamera:
        """Connect to a camera and read its capabilities. Closing the camera closes ``http``, and so does a failure to open it.

        Args:
            http: The HTTP connection to the device.
            credentials: The credentials for the RTSP stream.
            channel: The video channel.
            width: Width of a frame in pixels.
            height: Height of a frame in pixels.
            stream: The transport of ``frames``.
            rtsp_port: Port of the RTSP server; None for the port that the device reports.
            latency_s: Seconds from the exposure of a streamed frame to its arrival.
            fields_deg: Horizontal fields of view in degrees at the widest and the closest zoom; None to use the values that the
                device reports.
            measured_fields: Measured rows of (fraction of the zoom range, horizontal field of view in degrees), widest first.
                They take precedence over the device's values, and ``fields_deg`` takes precedence over them.
            settling: The criteria for deciding that the camera has settled.

        Raises:
            CameraError: The camera cannot be reached, rejects the credentials, or is not an AXIS camera.
        """
        client = VapixClient(http, channel)
        try:
            device = await read_device(client, fields_deg=fields_deg, measured=measured_fields)
            client.control_queue_on = device.control_queue_on
            if rtsp_port is None:
                rtsp_port = await read_rtsp_port(client) if stream == "rtsp" else RTSP_PORT
            pictures = AxisPictures(
                client, credentials, width, height, sizes=device.sizes, stream=stream, rtsp_port=rtsp_port, latency_s=latency_s
            )
            return cls(client, device, pictures, settling or SettlingCriteria())
        except BaseException:
            with anyio.CancelScope(shield=True):
                await http.close()
            raise

    async def pose(self) -> Pose:
        position = await self._client.position()
        zoom = self._device.zoom.to_zoom(position.zoom_units)
        pan_deg = wrap_pan_deg(position.pan_deg) if self._info.limits.pan_endless else position.pan_deg
        return Pose(pan_deg, position.tilt_deg, zoom)

    async def presets(self) -> list[PresetInfo]:
        # Presets may share a name and differ only in number. Only the first of them can be reached by name.
        return [PresetInfo(name) for name in dict.fromkeys((await self._client.presets()).values())]

    async def go_to_preset(self, name: str) -> Arrival:
        await self._require_preset(name)
        try:
            return await self._go(partial(self._client.command, requests.go_to_preset(self._client.channel, name)))
        except VapixError:
            await self._require_preset(name)  # it may have been removed in the meantime
            raise

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:  # noqa: ARG002 - devices keep names only
        request = requests.save_preset(self._client.channel, name)
        await self._client.command(request)
        if name not in (await self._client.presets()).values():
            raise CameraError(f"{self._info.name} did not save the preset. The account may lack administrator rights.")
        return PresetInfo(name)

    async def remove_preset(self, name: str) -> None:
        await self._require_preset(name)
        await self._client.command(requests.remove_preset(self._client.channel, name))

    async def lens(self) -> LensState:
        if not self._info.capabilities.focus and not self._info.capabilities.iris:
            return await super().lens()
        return await self._lens.state()

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        return await self._lens.set_focus(action, step)

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        return await self._lens.set_iris(action, step)

    async def _start_move(self, pose: Pose) -> None:
        zoom_units = self._device.zoom.to_units(pose.zoom)
        await self._client.command(requests.absolute(self._client.channel, pose.pan_deg, pose.tilt_deg, zoom_units))

    def _centring_command(self, current: Pose, target: Pose, x: float, y: float) -> Command | None:
        if "AreaZoom" not in self._device.supported:
            return None
        optics = self._info.optics
        percent = round(100 * optics.focal(target.zoom) / optics.focal(current.zoom))
        size = self._info.frame_width, self._info.frame_height
        return partial(self._client.command, requests.centre(self._client.channel, x, y, percent, size))

    async def _start_home(self) -> None:
        await self._client.command(requests.home(self._client.channel))

    async def _start_drive(self, number: int, pan_dps: float, tilt_dps: float, zoom_rate: float, timeout_s: float) -> None:  # noqa: ARG002 - VAPIX has no timeout
        channel, speeds = self._client.channel, self._device.speeds
        zoom = _zoom_speed(zoom_rate, self._info.capabilities)
        proportional = "ProportionalSpeed" in self._device.supported
        move = requests.continuous_pan_tilt(
            channel, speeds.to_speed(pan_dps), speeds.to_speed(tilt_dps), proportional=proportional
        )  # fmt: skip
        await self._send(number, partial(self._client.command, replace(move, retryable=False)))
        if zoom or self._zoom_driven:
            zooming = replace(requests.continuous_zoom(channel, zoom), retryable=False)
            await self._send(number, partial(self._client.command, zooming))
            self._zoom_driven = bool(zoom)

    async def _send_stop(self) -> None:
        """Send the stop commands for all axes. Raise an error only if the device refuses all of them."""
        self._zoom_driven, refused = False, []
        for request in requests.stop(self._client.channel):
            try:
                check_done((await self._client.send(request)).body)
            except VapixError as error:
                refused.append(error)
        if len(refused) == len(requests.stop(self._client.channel)):
            raise refused[0]

    def _send_stop_blocking(self) -> None:
        stop_device(self._client.http, {"channel": self._client.channel})

    async def _disconnect(self) -> None:
        try:
            await self._client.drop_control()
        except CameraError:
            pass  # the connection is lost, and the control queue drops clients that stop sending requests
        finally:
            await self._client.http.close()

    async def _axes_at_limits(self, reached: Pose, target: Pose) -> tuple[Axis, ...]:
        reported = parse_limits((await self._client.send(requests.query(self._client.channel, "limits"))).body)
        scale, settling = self._device.zoom, self._settling
        bounds: dict[Axis, tuple[float, float, float, float]] = {
            "pan": (reached.pan_deg, target.pan_deg, reported.min_pan_deg, reported.max_pan_deg),
            "tilt": (reached.tilt_deg, target.tilt_deg, reported.min_tilt_deg, reported.max_tilt_deg),
            "zoom": (reached.zoom, target.zoom, scale.to_zoom(reported.min_zoom_units), scale.to_zoom(reported.max_zoom_units)),
        }
        axes_at_limits: list[Axis] = []
        for axis, (at, requested, low, high) in bounds.items():
            allowed = settling.zoom_tolerance * requested if axis == "zoom" else settling.angle_tolerance_deg
            off = abs(wrap_pan_deg(at - requested)) if axis == "pan" else abs(at - requested)
            if off <= allowed:
                continue
            at_limit = (requested > high and abs(at - high) <= allowed) or (requested < low and abs(at - low) <= allowed)
            if not at_limit:
                reason = f"The {axis} motor may be blocked, or someone else may have moved the camera."
                raise self._not_reached(reached, target, reason)
            axes_at_limits.append(axis)
        return tuple(axes_at_limits)

    async def _require_preset(self, name: str) -> None:
        known = (await self._client.presets()).values()
        if name not in known:
            raise UnknownNameError("preset", name, known)

    def _check_may_move(self) -> None:
        if self._device.locked:
            raise CameraError(f"The position of {self._info.name} is locked. Unlock it in the camera's PTZ settings.")


def stop_device(http: DeviceHttp, details: Mapping[str, Any]) -> None:
    """Stop all motion of a device over a separate connection, without asyncio.

    Args:
        http: The HTTP connection to the device.
        details: The video channel, under the key ``channel``.

    Raises:
        CameraError: The stop command did not reach the device.
    """
    http.send_blocking(requests.PTZ_PATH, tuple(request.query for request in requests.stop(details["channel"])))


def _zoom_speed(rate: float, capabilities: Capabilities) -> int:
    """Return the VAPIX zoom speed, from -100 to 100, for a rate in octaves per second.

    VAPIX does not report physical zoom speeds, so a VAPIX speed of 100 is assumed to be the camera's top zoom rate.
    """
    top = capabilities.top_speed.zoom_rate
    if not rate or not top:
        return 0
    speed = max(-100, min(100, round(100 * rate / top)))
    return speed or (1 if rate > 0 else -1)
