"""A camera on a ``scope serve`` server."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any
from urllib.parse import quote

import cv2
import numpy as np

from scope_ptz.api.remote.connection import Connection
from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import Capabilities, Velocity, check_drive, check_preset_name
from scope_ptz.camera.clocks import WallClock
from scope_ptz.camera.control import ControlHeldError, Holder
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Limits, Optics, Perspective, Pose


class RemoteCamera(Camera):
    """A camera on a server. ``RemoteCamera.open`` reads its properties from the server.

    As with any network camera, frames have no ground truth.
    """

    def __init__(self, connection: Connection, info: CameraInfo) -> None:
        self._connection, self._info = connection, info
        self.clock = WallClock()

    @classmethod
    async def open(cls, connection: Connection) -> RemoteCamera:
        """Open the camera of a connection.

        Raises:
            UnknownNameError: The server has no such camera.
            CameraError: The server cannot be reached, or its camera fails.
        """
        state = await connection.request("GET", "~")
        try:
            info = CameraInfo(
                name=f"{state['name']} at {connection.server}",
                limits=Limits(**state["limits"]),
                optics=Optics(tuple((float(zoom), float(hfov_deg)) for zoom, hfov_deg in state["fields_of_view"])),
                frame_width=int(state["frame_width"]),
                frame_height=int(state["frame_height"]),
                simulated=False,
                capabilities=Capabilities(Velocity(**state["top_speed"]), edits_presets=bool(state["edits_presets"])),
                assumed=tuple(state["assumed"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise CameraError(
                f"{connection.server} describes its camera in an unknown format. Use the same version of scope-ptz on both sides."
            ) from error
        return cls(connection, info)

    @property
    def info(self) -> CameraInfo:
        return self._info

    async def pose(self) -> Pose:
        return _pose(await self._connection.request("GET", "~/pose"))

    async def move(self, pose: Pose) -> Arrival:
        body = {"pan_deg": float(pose.pan_deg), "tilt_deg": float(pose.tilt_deg), "zoom": float(pose.zoom)}
        return _arrival(await self._connection.request("POST", "~/move", body, no_timeout=True))

    async def presets(self) -> list[PresetInfo]:
        presets = await self._connection.request("GET", "~/presets")
        return [PresetInfo(preset["name"], preset["description"]) for preset in presets]

    async def go_to_preset(self, name: str) -> Arrival:
        return _arrival(await self._connection.request("POST", f"~/presets/{quote(name, safe='')}/go", no_timeout=True))

    async def go_home(self) -> Arrival:
        return _arrival(await self._connection.request("POST", "~/home", no_timeout=True))

    async def frame(self) -> Frame:
        data, facts = await self._connection.picture("~/frame?format=png")
        picture: Any = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        if picture is None or "pose" not in facts:
            raise CameraError("The server's picture cannot be decoded. Use the same version of scope-ptz on both sides.")
        image = cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)
        pose, hfov_deg = _pose(facts["pose"]), float(facts["hfov_deg"])
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, image.shape[1], image.shape[0])
        return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=self.clock.now_s(), projection=view)

    async def stop(self) -> None:
        await self._connection.request("POST", "~/stop")

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        body = {"pan_dps": pan_dps, "tilt_dps": tilt_dps, "zoom_rate": zoom_rate, "timeout_s": timeout_s}
        await self._connection.request("POST", "~/drive", body)

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        check_preset_name(name)
        saved = await self._connection.request("PUT", f"~/presets/{quote(name, safe='')}", {"description": description})
        return PresetInfo(saved["name"], saved["description"])

    async def remove_preset(self, name: str) -> None:
        await self._connection.request("DELETE", f"~/presets/{quote(name, safe='')}")

    @asynccontextmanager
    async def control(self, holder: str) -> AsyncIterator[None]:
        """Control the camera within a context. Raises ``ControlHeldError`` if someone else has control."""
        state = await self._connection.request("POST", "~/control")
        if not state["mine"]:
            await self._connection.request("DELETE", "~/control")
            raise ControlHeldError(self._info.name, Holder(str(state["holder"]), self._connection.server, str(state["since"])))
        async with super().control(holder):
            try:
                yield
            finally:
                await self._connection.request("DELETE", "~/control")


def _pose(reply: dict[str, Any]) -> Pose:
    return Pose(float(reply["pan_deg"]), float(reply["tilt_deg"]), float(reply["zoom"]))


def _arrival(reply: dict[str, Any]) -> Arrival:
    return Arrival(_pose(reply["pose"]), tuple(reply["clamped"]), str(reply["limited_by"]))
