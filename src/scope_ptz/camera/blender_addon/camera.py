"""A camera in the scene that is open in a Blender window. The add-on sets the pose and renders the frames."""

from __future__ import annotations

import struct
from typing import Any

import anyio
import cv2
import numpy as np
from anyio import to_thread
from numpy.typing import NDArray
from pydantic import ValidationError

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.blender_addon.connection import AddOnConnection, AddOnSlot, Picture
from scope_ptz.camera.blender_addon.scene import SceneDescription, WindowPreset, WindowScene, window_scene
from scope_ptz.camera.capabilities import Capabilities, Velocity, check_drive, check_preset_name
from scope_ptz.camera.clocks import WallClock
from scope_ptz.camera.head_motion import HeadMotion
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, top_speed
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Perspective, Pose

COMMAND_TIMEOUT_S = 30.0
"""Maximum time in seconds to wait for a command, because Blender's main thread may be busy."""

FRAME_TIMEOUT_S = 600.0
"""Maximum time in seconds to wait for a picture."""

_PNG_START = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"


class BlenderWindowCamera(Camera):
    """A pan-tilt-zoom camera in the scene that is open in a Blender window. Moves to a pose are instantaneous.

    As with ``BlenderCamera`` and a .blend file, each camera in the scene is a viewpoint and a preset. Saved presets are stored in
    the scene. If Blender disconnects, all methods raise ``CameraError`` until a Blender instance connects again.

    Args:
        slot: The slot that holds the connection to a Blender instance.

    Raises:
        CameraError: No Blender instance is connected.
    """

    clock: WallClock

    def __init__(self, slot: AddOnSlot) -> None:
        self.clock = WallClock()
        self._slot = slot
        self._frame_lock = anyio.Lock()
        self._last: tuple[tuple[str, str, Perspective, SceneDescription], str, NDArray[np.uint8]] | None = None
        self._scene = window_scene(slot.connection.description)
        self._info = _info(self._scene)
        self._viewpoint = self._scene.home.viewpoint
        self._motion = HeadMotion(AXIS_M5075_G_HEAD, self._info.limits, self._scene.home.pose)

    @property
    def info(self) -> CameraInfo:
        if self._slot.current is not None:
            self._current_connection()  # another file may have been opened
        return self._info

    @property
    def viewpoint(self) -> str:
        """Name of the current viewpoint."""
        return self._viewpoint

    async def pose(self) -> Pose:
        self._current_connection()
        return self._motion.pose(self.clock.now_s())

    async def move(self, pose: Pose) -> Arrival:
        connection = self._current_connection()
        return await self._go(connection, self._viewpoint, pose)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        self._current_connection()
        self._motion.drive(Velocity(pan_dps, tilt_dps, zoom_rate), self.clock.now_s(), timeout_s)

    async def presets(self) -> list[PresetInfo]:
        self._current_connection()
        return [preset.info for preset in self._scene.presets.values()]

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        check_preset_name(name)
        connection = self._current_connection()
        existing = self._scene.presets.get(name)
        if existing is not None and not existing.saved:
            raise CameraError(f"The preset '{name}' is a camera in the scene and cannot be replaced. Choose another name.")
        view = self._view(self._viewpoint, await self.pose())
        await self._edit(connection, "save_preset", {"name": name, "description": description, **view})
        return self._preset(name).info

    async def remove_preset(self, name: str) -> None:
        connection = self._current_connection()
        if not self._preset(name).saved:
            raise CameraError(f"The preset '{name}' is a camera in the scene. Remove the camera in Blender instead.")
        await self._edit(connection, "remove_preset", {"name": name})

    async def go_to_preset(self, name: str) -> Arrival:
        connection = self._current_connection()
        preset = self._preset(name)
        return await self._go(connection, preset.viewpoint, preset.pose)

    async def go_home(self) -> Arrival:
        connection = self._current_connection()
        return await self._go(connection, self._scene.home.viewpoint, self._scene.home.pose)

    async def frame(self) -> Frame:
        async with self._frame_lock:
            connection = self._current_connection()
            pose, time_s, info = await self.pose(), self.clock.now_s(), self._info
            hfov_deg = info.optics.hfov_deg(pose.zoom)
            view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, info.frame_width, info.frame_height)
            image = await self._image(connection, view, self._view(self._viewpoint, pose))
        return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view)

    async def stop(self) -> None:
        connection = self._current_connection()
        await self._go(connection, self._viewpoint, await self.pose())

    async def close(self) -> None:
        self._slot.end()

    def _current_connection(self) -> AddOnConnection:
        """Return the connection. If its scene has changed, adopt the new scene.

        The pose is kept if the viewpoint still exists and the optics have not changed.
        """
        connection = self._slot.connection
        if connection.description is not self._scene.description:
            before, self._scene = self._scene, window_scene(connection.description)
            self._info = _info(self._scene)
            pose = self._motion.pose(self.clock.now_s())
            if self._viewpoint not in self._scene.presets or self._scene.optics != before.optics:
                self._viewpoint, pose = self._scene.home.viewpoint, self._scene.home.pose
            self._motion = HeadMotion(AXIS_M5075_G_HEAD, self._info.limits, self._info.limits.clamp(pose)[0])
        return connection

    async def _go(self, connection: AddOnConnection, viewpoint: str, pose: Pose) -> Arrival:
        end, clamped = self._info.limits.clamp(pose)
        # Update the pose first, so that concurrent commands such as ``stop`` use it while Blender is still busy.
        self._viewpoint = viewpoint
        self._motion.jump_to(end, self.clock.now_s())
        await connection.request("look", self._view(viewpoint, end), timeout_s=COMMAND_TIMEOUT_S)
        return Arrival(end, clamped)

    def _preset(self, name: str) -> WindowPreset:
        if name not in self._scene.presets:
            raise UnknownNameError("preset", name, self._scene.presets)
        return self._scene.presets[name]

    def _view(self, viewpoint: str, pose: Pose) -> dict[str, Any]:
        """Return a view in scene coordinates, in the form that the add-on expects."""
        viewpoint_camera = self._scene.viewpoint(viewpoint)
        return {
            "viewpoint": viewpoint,
            "position_m": list(viewpoint_camera.position_m),
            "bearing_deg": viewpoint_camera.bearing_deg + pose.pan_deg,
            "tilt_deg": pose.tilt_deg,
            "hfov_deg": self._info.optics.hfov_deg(pose.zoom),
        }

    async def _edit(self, connection: AddOnConnection, operation: str, arguments: dict[str, Any]) -> None:
        """Edit the presets in the scene, and adopt the scene description that the add-on returns."""
        reply = await connection.request(operation, arguments, timeout_s=COMMAND_TIMEOUT_S)
        try:
            description = SceneDescription.model_validate(reply)
        except (ValidationError, InputError) as error:
            raise CameraError("Blender's description of the scene is invalid. Update the add-on.") from error
        self._slot.update(connection, description)
        self._current_connection()

    async def _image(self, connection: AddOnConnection, view: Perspective, view_fields: dict[str, Any]) -> NDArray[np.uint8]:
        """Request a picture from Blender, or return the last one if neither the view nor the scene has changed."""
        key = (connection.id, self._viewpoint, view, self._scene.description)
        version = self._last[1] if self._last is not None and self._last[0] == key else ""
        arguments = {**view_fields, "width": view.width, "height": view.height, "version": version}
        reply = await connection.request("frame", arguments, timeout_s=FRAME_TIMEOUT_S)
        if isinstance(reply, Picture):
            image = await to_thread.run_sync(_decode, reply.png, view.width, view.height)
            self._last = key, reply.version, image
            return image
        if self._last is None or not version or reply.get("unchanged") != version:
            raise CameraError("Blender sent no picture. Update the add-on.")
        return self._last[2]


def _info(scene: WindowScene) -> CameraInfo:
    description = scene.description
    return CameraInfo(
        name=f"camera in {description.title or 'an unsaved file'}, open in Blender {description.blender_version}",
        limits=scene.limits,
        optics=scene.optics,
        frame_width=description.width,
        frame_height=description.height,
        simulated=True,
        capabilities=Capabilities(top_speed(AXIS_M5075_G_HEAD), edits_presets=True),
    )


def _decode(png: bytes, width: int, height: int) -> NDArray[np.uint8]:
    """Decode a picture. Its dimensions are checked first, so that a small file cannot exhaust memory.

    Raises:
        CameraError: The picture is damaged or has the wrong size.
    """
    if not png.startswith(_PNG_START) or struct.unpack(">II", png[16:24]) != (width, height):
        raise CameraError(f"Blender sent a picture that is not a {width} x {height} pixel PNG file.")
    image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    if image is None:
        raise CameraError("Blender sent a damaged picture.")
    return np.ascontiguousarray(image[:, :, ::-1])
