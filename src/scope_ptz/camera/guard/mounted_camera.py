"""A camera wrapper that corrects poses and pictures for an upside-down mounting or a leaning base."""

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
"""Minimum roll in degrees at which a picture is rotated."""


class MountedCamera(CameraWrapper):
    """A camera in world coordinates: pan is a rotation about the vertical, and tilt 0 is the horizon.

    Args:
        camera: The wrapped camera, in its own coordinates.
        mounting: How the camera is mounted.
    """

    def __init__(self, camera: Camera, mounting: Mounting) -> None:
        super().__init__(camera)
        upside_down = np.diag([-1.0, 1.0, -1.0]) if mounting.position == "ceiling" else np.eye(3)
        lean_rad = math.radians(mounting.tilt_deg)
        lean_rotation = np.array(
            [[1.0, 0.0, 0.0], [0.0, math.cos(lean_rad), -math.sin(lean_rad)], [0.0, math.sin(lean_rad), math.cos(lean_rad)]]
        )
        self._to_world: NDArray[np.float64] = lean_rotation @ upside_down
        self._upside_down, self._lean_deg = mounting.position == "ceiling", abs(mounting.tilt_deg)

    @property
    def info(self) -> CameraInfo:
        """Information about the camera. If the base leans, the tilt limits are those that apply at every pan."""
        info = self.inner.info
        device_limits = info.limits
        tilts = (
            (-device_limits.max_tilt_deg, -device_limits.min_tilt_deg)
            if self._upside_down
            else (device_limits.min_tilt_deg, device_limits.max_tilt_deg)
        )
        pans = (
            (-device_limits.max_pan_deg, -device_limits.min_pan_deg)
            if self._upside_down
            else (device_limits.min_pan_deg, device_limits.max_pan_deg)
        )
        middle = (tilts[0] + tilts[1]) / 2
        low, high = min(tilts[0] + self._lean_deg, middle), max(tilts[1] - self._lean_deg, middle)
        return replace(
            info, limits=Limits(*pans, low, high, device_limits.min_zoom, device_limits.max_zoom, device_limits.pan_endless)
        )

    async def pose(self) -> Pose:
        return self.world_pose(await self.inner.pose())

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self.info.limits.clamp(pose)
        arrival = await self.inner.move(self._device_pose(target))
        # If the base leans, the device's axes differ from the world's, so the differences from the target show which axes were
        # clamped.
        world = self._world_arrival(arrival)
        if self._lean_deg and arrival.clamped:
            return replace(world, clamped=tuple(dict.fromkeys((*clamped, *_different_axes(target, world.pose)))))
        return replace(world, clamped=tuple(dict.fromkeys((*clamped, *arrival.clamped))))

    async def go_to_preset(self, name: str) -> Arrival:
        return self._world_arrival(await self.inner.go_to_preset(name))

    async def go_home(self) -> Arrival:
        return self._world_arrival(await self.inner.go_home())

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        """Drive the device's own axes, with signs as in world coordinates. On a leaning base, they are not exactly pan and tilt."""
        sign = -1.0 if self._upside_down else 1.0
        await self.inner.drive(sign * pan_dps, sign * tilt_dps, zoom_rate, timeout_s=timeout_s)

    async def frame(self) -> Frame:
        return self._world_frame(await self.inner.frame())

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        async with aclosing(self.inner.frames(rate_hz=rate_hz)) as stream:
            async for frame in stream:
                yield self._world_frame(frame)

    def world_pose(self, device: Pose) -> Pose:
        """Convert a device pose to world coordinates."""
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
    """Rotate a picture clockwise about its centre. Empty corners become black."""
    if abs(roll_deg) < _LEVEL_DEG:
        return image
    if abs(abs(roll_deg) - 180.0) < _LEVEL_DEG:
        return np.ascontiguousarray(image[::-1, ::-1])
    height, width = image.shape[:2]
    turn = cv2.getRotationMatrix2D(((width - 1) / 2, (height - 1) / 2), -roll_deg, 1.0)
    return np.asarray(cv2.warpAffine(image, turn, (width, height), flags=cv2.INTER_LINEAR), np.uint8)


def _different_axes(target: Pose, reached: Pose) -> tuple[Axis, ...]:
    axes: list[Axis] = []
    if abs(target.pan_deg - reached.pan_deg) > 1e-3:
        axes.append("pan")
    if abs(target.tilt_deg - reached.tilt_deg) > 1e-3:
        axes.append("tilt")
    if abs(target.zoom - reached.zoom) > 1e-3:
        axes.append("zoom")
    return tuple(axes)
