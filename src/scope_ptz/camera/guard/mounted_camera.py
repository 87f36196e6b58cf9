"""A camera whose base hangs from a ceiling or leans. Its poses and pictures are converted to upright ones."""

from __future__ import annotations

import math
from collections.abc import AsyncGenerator
from contextlib import aclosing
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame
from scope_ptz.camera.guard.rules import Mounting
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Axis, Limits, Perspective, Pose, direction
from scope_ptz.geometry.sphere import camera_axes, pan_tilt_deg

_LEVEL_DEG = 0.05
"""A picture that is rolled by less than this many degrees is not rotated."""


class MountedCamera(CameraWrapper):
    """A camera in world coordinates: pan turns about the vertical, and tilt 0 is the horizon.

    Args:
        camera: The camera in its own coordinates.
        mounting: How its base is mounted.
    """

    def __init__(self, camera: Camera, mounting: Mounting) -> None:
        super().__init__(camera)
        upside_down = np.diag([-1.0, 1.0, -1.0]) if mounting.position == "ceiling" else np.eye(3)
        lean = math.radians(mounting.tilt_deg)
        leaned = np.array([[1.0, 0.0, 0.0], [0.0, math.cos(lean), -math.sin(lean)], [0.0, math.sin(lean), math.cos(lean)]])
        self._to_world: NDArray[np.float64] = leaned @ upside_down
        self._ceiling, self._lean_deg = mounting.position == "ceiling", abs(mounting.tilt_deg)

    @property
    def info(self) -> CameraInfo:
        """Information about the camera. If the base leans, the tilt limits are those that hold at every pan."""
        info = self.inner.info
        own = info.limits
        tilts = (-own.max_tilt_deg, -own.min_tilt_deg) if self._ceiling else (own.min_tilt_deg, own.max_tilt_deg)
        pans = (-own.max_pan_deg, -own.min_pan_deg) if self._ceiling else (own.min_pan_deg, own.max_pan_deg)
        middle = (tilts[0] + tilts[1]) / 2
        low, high = min(tilts[0] + self._lean_deg, middle), max(tilts[1] - self._lean_deg, middle)
        return replace(info, limits=Limits(*pans, low, high, own.min_zoom, own.max_zoom, own.pan_endless))

    async def pose(self) -> Pose:
        return self.world_pose(await self.inner.pose())

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self.info.limits.clamp(pose)
        arrival = await self.inner.move(self._device_pose(target))
        # If the base leans, the device's axes are not those of the world, so the distance from the target shows which
        # axes were clamped.
        world = self._world_arrival(arrival)
        if self._lean_deg and arrival.clamped:
            return replace(world, clamped=tuple(dict.fromkeys((*clamped, *_differences(target, world.pose)))))
        return replace(world, clamped=tuple(dict.fromkeys((*clamped, *arrival.clamped))))

    async def go_to_preset(self, name: str) -> Arrival:
        return self._world_arrival(await self.inner.go_to_preset(name))

    async def go_home(self) -> Arrival:
        return self._world_arrival(await self.inner.go_home())

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        """Drive the device's own axes, with signs as in world coordinates. If the base leans, they are not exactly pan and tilt."""
        sign = -1.0 if self._ceiling else 1.0
        await self.inner.drive(sign * pan_dps, sign * tilt_dps, zoom_rate, timeout_s=timeout_s)

    async def frame(self) -> Frame:
        return self._world_frame(await self.inner.frame())

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        async with aclosing(self.inner.frames(rate_hz=rate_hz)) as stream:
            async for frame in stream:
                yield self._world_frame(frame)

    def world_pose(self, device: Pose) -> Pose:
        """Convert a pose of the device to world coordinates."""
        pan, tilt = pan_tilt_deg(self._to_world @ direction(device.pan_deg, device.tilt_deg))
        return Pose(float(pan), float(tilt), device.zoom)

    def _device_pose(self, world: Pose) -> Pose:
        pan, tilt = pan_tilt_deg(self._to_world.T @ direction(world.pan_deg, world.tilt_deg))
        return Pose(float(pan), float(tilt), world.zoom)

    def _world_arrival(self, arrival: Arrival) -> Arrival:
        return replace(arrival, pose=self.world_pose(arrival.pose))

    def _world_frame(self, frame: Frame) -> Frame:
        if not isinstance(frame.projection, Perspective):
            raise CameraError(
                f"{self.inner.info.name} returned a frame that is not a perspective view, so it cannot be turned upright."
            )
        pose = self.world_pose(frame.pose)
        up = self._to_world @ camera_axes(frame.pose.pan_deg, frame.pose.tilt_deg)[1]
        right, level_up, _ = camera_axes(pose.pan_deg, pose.tilt_deg)
        roll_deg = math.degrees(math.atan2(float(up @ right), float(up @ level_up)))
        view = Perspective(pose.pan_deg, pose.tilt_deg, frame.hfov_deg, frame.width, frame.height)
        return replace(frame, image=_rotate(frame.image, roll_deg), pose=pose, projection=view, origin=None)


def _rotate(image: NDArray[np.uint8], roll_deg: float) -> NDArray[np.uint8]:
    """Rotate a picture clockwise about its centre. Corners without content become black."""
    if abs(roll_deg) < _LEVEL_DEG:
        return image
    if abs(abs(roll_deg) - 180.0) < _LEVEL_DEG:
        return np.ascontiguousarray(image[::-1, ::-1])
    height, width = image.shape[:2]
    turn = cv2.getRotationMatrix2D(((width - 1) / 2, (height - 1) / 2), -roll_deg, 1.0)
    return np.asarray(cv2.warpAffine(image, turn, (width, height), flags=cv2.INTER_LINEAR), np.uint8)


def _differences(target: Pose, reached: Pose) -> tuple[Axis, ...]:
    found: list[Axis] = []
    if abs(target.pan_deg - reached.pan_deg) > 1e-3:
        found.append("pan")
    if abs(target.tilt_deg - reached.tilt_deg) > 1e-3:
        found.append("tilt")
    if abs(target.zoom - reached.zoom) > 1e-3:
        found.append("zoom")
    return tuple(found)
