"""The driver for ONVIF cameras."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.base import Arrival, CameraInfo, PresetInfo
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState, check_focus, check_iris
from scope_ptz.camera.network.camera import Command, NetworkCamera
from scope_ptz.camera.network.settling import SettlingCriteria
from scope_ptz.camera.network.watchdog_process import WatchdogProcess
from scope_ptz.camera.onvif.client import OnvifClient, stop_device
from scope_ptz.camera.onvif.device import OnvifDevice, read_device
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.camera.onvif.lens import OnvifLens, open_lens
from scope_ptz.camera.onvif.mapping import OnvifMapping
from scope_ptz.camera.onvif.motors import OnvifMotors
from scope_ptz.camera.onvif.pictures import OnvifPictures, OnvifStream, open_pictures
from scope_ptz.camera.onvif.presets import OnvifPresets
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Pose

if TYPE_CHECKING:
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.network.http import DeviceHttp


class OnvifCamera(NetworkCamera):
    """An ONVIF camera on the network. Open it with ``open``.

    Args:
        client: The connection.
        device: The device's properties and capabilities.
        pictures: The source of its pictures.
        lens: Its focus and iris.
        settling: The criteria for deciding that the camera has settled.
    """

    def __init__(
        self, client: OnvifClient, device: OnvifDevice, pictures: OnvifPictures, lens: OnvifLens, settling: SettlingCriteria
    ) -> None:
        self.device, self.pictures, self._client, self._lens = device, pictures, client, lens
        self._motors, self._presets = OnvifMotors(client, device), OnvifPresets(client, device.ptz_profile)
        info = CameraInfo(
            f"{device.name} at {client.address}", device.limits, device.zoom.optics, pictures.width, pictures.height,
            simulated=False, capabilities=replace(device.capabilities, focus=lens.focus_actions, iris=lens.iris_actions),
            assumed=device.assumed, firmware=device.firmware,
        )  # fmt: skip
        watchdog = WatchdogProcess(client.http, stop_device, {"profile": device.ptz_profile})
        super().__init__(info, pictures, settling, watchdog)

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
        settling: SettlingCriteria | None = None,
    ) -> OnvifCamera:
        """Connect to a camera and read its capabilities. ``http`` is closed when the camera is closed, or if opening it fails.

        Args:
            http: The HTTP connection to the device.
            credentials: The credentials for signing in.
            mapping: Configured or measured values that ONVIF does not report, such as fields of view.
            assume: Whether to assume values that are neither reported nor known, for example so that they can then be measured.
            profile: Token or name of the ONVIF profile; by default, a suitable one is chosen.
            width: Width of a frame in pixels; by default, that of the device's pictures.
            height: Height of a frame in pixels; by default, that of the device's pictures.
            stream: The transport that ``frames`` uses.
            rtsp_port: Port of the RTSP server; None for the port that the device reports.
            latency_s: Seconds from the exposure of a streamed frame to its arrival.
            settling: The criteria for deciding that the camera has settled.

        Raises:
            CameraError: The camera cannot be reached, rejects the credentials, is not an ONVIF camera, or does not report a
                required value.
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
            lens = await open_lens(client, device.video_source)
            return cls(client, device, pictures, lens, settling or SettlingCriteria())
        except BaseException:
            with anyio.CancelScope(shield=True):
                await client.close()
            raise

    async def pose(self) -> Pose:
        return await self._motors.pose()

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(name) for name in await self._presets.tokens()]

    async def go_to_preset(self, name: str) -> Arrival:
        token = await self._presets.token(name)
        try:
            return await self._go(lambda: self._presets.go_to(token))
        except OnvifFaultError:
            await self._presets.token(name)  # it may have been removed in the meantime
            raise

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:  # noqa: ARG002 - devices keep names only
        await self._presets.save(name)
        return PresetInfo(name)

    async def remove_preset(self, name: str) -> None:
        await self._presets.remove(name)

    async def lens(self) -> LensState:
        return await self._lens.state(self._info.name)

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        check_focus(self._info.name, action, self._lens.focus_actions, step)
        return await self._lens.set_focus(action, step, self._settling.poll_s)

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        check_iris(self._info.name, action, self._lens.iris_actions, step)
        return await self._lens.set_iris(action, step)

    async def _start_move(self, pose: Pose) -> None:
        await self._motors.move(pose)

    def _centring_command(self, current: Pose, target: Pose, x: float, y: float) -> Command | None:
        return self._motors.centring_command(current, target, x, y)

    async def _start_home(self) -> None:
        await self._motors.go_home()

    async def _start_drive(self, number: int, pan_dps: float, tilt_dps: float, zoom_rate: float, timeout_s: float) -> None:
        await self._send(number, partial(self._motors.drive, pan_dps, tilt_dps, zoom_rate, timeout_s))

    async def _send_stop(self) -> None:
        await self._motors.stop()

    def _send_stop_blocking(self) -> None:
        self._client.stop_blocking()

    async def _disconnect(self) -> None:
        await self._client.close()


def _check_known(device: OnvifDevice, address: str) -> None:
    if device.assumed:
        raise CameraError(
            f"The {device.name} at {address} does not report its {' and '.join(device.assumed)} over ONVIF. Calibrate the camera "
            "with `scope camera calibrate`, or add options such as hfov_wide and hfov_tele to the camera spec."
        )
