"""A simulated camera, which renders views from a viewpoint's stored panorama and moves like a motorised head."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from anyio import CapacityLimiter, to_thread
from anyio.lowlevel import RunVar

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, FrameOrigin, PresetInfo
from scope_ptz.camera.capabilities import Capabilities, Velocity, check_drive
from scope_ptz.camera.head_motion import HeadMotion
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, Head, top_speed
from scope_ptz.camera.scene_presets import ScenePresets, preset_pose
from scope_ptz.geometry import Perspective, Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.models import ScenePreset
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.prefetch import Prefetch
from scope_ptz.simulator.views import RENDERING_VERSION, picture

COMMAND_POLL_S = 0.05
"""Interval in seconds at which a moving camera checks for a new command."""

VIEWPOINT_SWITCH_S = 0.5
"""Time in seconds to switch to another viewpoint, as an operator would switch between two cameras."""


_RENDER_LIMITER: RunVar[CapacityLimiter] = RunVar("scope_ptz_rendering")


def _render_limiter() -> CapacityLimiter:
    """Return the limiter for concurrent rendering. Without it, many simultaneous requests would slow each other down."""
    try:
        return _RENDER_LIMITER.get()
    except LookupError:
        limiter = CapacityLimiter(2 * (os.cpu_count() or 1))
        _RENDER_LIMITER.set(limiter)
        return limiter


class SimulatedCamera(Camera):
    """An AXIS M5075-G in a scene, or a twin of the camera from which a scene was captured. Many cameras can share a scene.

    On the scene clock, moves take as long as with a real head. In evaluations, a move only advances the clock; in interactive use,
    it also takes real time.

    Args:
        scene: The scene.
        viewpoint: The initial viewpoint; by default, that of the scene's home preset.
        clock: The scene's clock.
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
        head: The motors; by default, those of the AXIS M5075-G.
    """

    clock: SceneClock

    def __init__(
        self,
        scene: Scene,
        *,
        viewpoint: str | None = None,
        clock: SceneClock | None = None,
        width: int = 1280,
        height: int = 720,
        head: Head = AXIS_M5075_G_HEAD,
    ) -> None:
        self.clock = clock or SceneClock()
        self._scene = scene
        self._presets = ScenePresets(scene.file, viewpoint)
        # Only the name is stored, because opening a viewpoint would release the layers of another, and moving requires no layers.
        self._viewpoint = self._presets.home.viewpoint
        self._info = CameraInfo(
            name=f"{_device_name(scene)} in {scene.file.title}",
            limits=scene.file.limits,
            optics=scene.file.optics,
            frame_width=width,
            frame_height=height,
            simulated=True,
            capabilities=Capabilities(top_speed(head), edits_presets=True),
            rendering=RENDERING_VERSION,
        )
        self._motion = HeadMotion(head, self._info.limits, preset_pose(self._presets.home))

    @property
    def info(self) -> CameraInfo:
        return self._info

    @property
    def viewpoint(self) -> str:
        """Name of the current viewpoint."""
        return self._viewpoint

    @property
    def scene_presets(self) -> ScenePresets:
        """The presets with their viewpoints and poses."""
        return self._presets

    def prefetch(self) -> Prefetch:
        """Start reading the current viewpoint's files in the background, so that later frames do not have to wait for them."""
        return Prefetch(self._scene.viewpoint(self._viewpoint), self._info.frame_width, self._info.optics, self._info.limits)

    async def pose(self) -> Pose:
        return self._pose_now()

    async def move(self, pose: Pose) -> Arrival:
        end, clamped = self._info.limits.clamp(pose)
        await self._move_to(end)
        return Arrival(self._pose_now(), clamped)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        self._motion.drive(Velocity(pan_dps, tilt_dps, zoom_rate), self.clock.elapsed_s(), timeout_s)

    async def presets(self) -> list[PresetInfo]:
        return self._presets.infos()

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        return self._presets.save(name, description, self.viewpoint, self._pose_now())

    async def remove_preset(self, name: str) -> None:
        self._presets.remove(name)

    async def go_to_preset(self, name: str) -> Arrival:
        return await self._go_to(self._presets.find(name))

    async def go_home(self) -> Arrival:
        return await self._go_to(self._presets.home)

    async def frame(self) -> Frame:
        pose, time_s, viewpoint = self._pose_now(), self.clock.now_s(), self._viewpoint
        hfov_deg = self._info.optics.hfov_deg(pose.zoom)
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, self._info.frame_width, self._info.frame_height)
        image = await to_thread.run_sync(picture, self._scene, viewpoint, view, time_s, limiter=_render_limiter())
        origin = FrameOrigin(self._scene.name, viewpoint, pose, time_s)
        return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view, origin=origin)

    async def stop(self) -> None:
        """Stop any motion immediately, without a braking distance."""
        self._motion.jump_to(self._pose_now(), self.clock.elapsed_s())

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        with self.clock.hold():
            yield

    def _pose_now(self) -> Pose:
        return self._motion.pose(self.clock.elapsed_s())

    async def _go_to(self, preset: ScenePreset) -> Arrival:
        if preset.viewpoint == self._viewpoint:
            return await self.move(preset_pose(preset))
        end, clamped = self._info.limits.clamp(preset_pose(preset))
        self._viewpoint = preset.viewpoint
        self._motion.jump_to(end, self.clock.elapsed_s())
        await self.clock.sleep(VIEWPOINT_SWITCH_S)
        return Arrival(end, clamped)

    async def _move_to(self, end: Pose) -> None:
        """Move, and wait until the picture has settled or another command arrives. If cancelled, the camera stops where it is.

        While time is frozen, moves are instantaneous, so an interactive sweep takes only as long as its pictures.
        """
        motion = self._motion
        if self.clock.held:
            motion.jump_to(end, self.clock.elapsed_s())
            return
        motion.move(end, self.clock.elapsed_s())
        command = motion.commands
        try:
            while motion.commands == command and (remaining_s := motion.end_time_s() - self.clock.elapsed_s()) > 1e-9:
                await self.clock.sleep(min(remaining_s, COMMAND_POLL_S))
        except BaseException:
            if motion.commands == command:
                await self.stop()
            raise


def _device_name(scene: Scene) -> str:
    captured = scene.file.captured
    return "simulated AXIS M5075-G" if captured is None else f"twin of {captured.camera}"
