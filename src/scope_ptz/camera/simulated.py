"""A simulated camera: it shows the stored sphere of a viewpoint and moves like a motorised head."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, FrameOrigin, PresetInfo
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD
from scope_ptz.camera.scene_presets import preset_pose, starting_preset
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.models import ScenePreset
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.prefetch import Prefetch
from scope_ptz.simulator.views import RENDERING_VERSION, picture

TICK_S = 0.05
"""Interval at which a moving camera checks for a new command."""

CUT_S = 0.5
"""Time of a switch to another optical centre, like a switch between two cameras of an installation."""


@dataclass(frozen=True, slots=True)
class _Motion:
    start: Pose
    end: Pose
    since_s: float


class SimulatedCamera(Camera):
    """An AXIS M5075-G in a scene. Many cameras can share one scene.

    Moves take the time of a real head on the given clock: at once in evaluation, where only scene time passes, and in real time for
    a person who watches.

    Args:
        scene: The scene.
        viewpoint: Where the camera stands; the default is the viewpoint of the scene's home preset.
        clock: The scene's clock.
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
    """

    clock: SceneClock

    def __init__(
        self, scene: Scene, *, viewpoint: str | None = None, clock: SceneClock | None = None, width: int = 1280, height: int = 720
    ) -> None:
        self.clock = clock or SceneClock()
        self._scene = scene
        self._presets = {p.name: p for p in scene.file.presets}
        self._home = starting_preset(scene.file, viewpoint)
        self._viewpoint = scene.viewpoint(self._home.viewpoint)
        self._info = CameraInfo(
            name=f"simulated AXIS M5075-G in {scene.file.title}",
            limits=Limits(),
            optics=AXIS_M5075_G,
            frame_width=width,
            frame_height=height,
            simulated=True,
            rendering=RENDERING_VERSION,
        )
        at_home = preset_pose(self._home)
        self._motion = _Motion(at_home, at_home, 0.0)

    @property
    def info(self) -> CameraInfo:
        return self._info

    @property
    def viewpoint(self) -> str:
        """Name of the current optical centre."""
        return self._viewpoint.name

    def prefetch(self) -> Prefetch:
        """Read the current viewpoint in the background, so that no later frame from there has to wait for a file."""
        return Prefetch(self._viewpoint, self._info.frame_width, self._info.optics, self._info.limits)

    async def pose(self) -> Pose:
        return self._pose_now()

    async def move(self, pose: Pose) -> Arrival:
        end, clamped = self._info.limits.clamp(pose)
        await self._run(_Motion(self._pose_now(), end, self.clock.elapsed_s()))
        return Arrival(self._pose_now(), clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(p.name, p.description) for p in self._presets.values()]

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in self._presets:
            raise UnknownNameError("preset", name, self._presets)
        return await self._go_to(self._presets[name])

    async def go_home(self) -> Arrival:
        return await self._go_to(self._home)

    async def frame(self) -> Frame:
        pose, time_s, viewpoint = self._pose_now(), self.clock.now_s(), self._viewpoint.name
        hfov_deg = self._info.optics.hfov_deg(pose.zoom)
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, self._info.frame_width, self._info.frame_height)
        image = await to_thread.run_sync(picture, self._scene, viewpoint, view, time_s)
        origin = FrameOrigin(self._scene.name, viewpoint, pose, time_s)
        return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view, origin=origin)

    async def stop(self) -> None:
        here = self._pose_now()
        self._motion = _Motion(here, here, self.clock.elapsed_s())

    @contextmanager
    def hold_time(self) -> Iterator[None]:
        with self.clock.hold():
            yield

    def _pose_now(self) -> Pose:
        motion = self._motion
        return AXIS_M5075_G_HEAD.at(motion.start, motion.end, self.clock.elapsed_s() - motion.since_s)

    async def _go_to(self, preset: ScenePreset) -> Arrival:
        if preset.viewpoint == self._viewpoint.name:
            return await self.move(preset_pose(preset))
        end, clamped = self._info.limits.clamp(preset_pose(preset))
        self._viewpoint = self._scene.viewpoint(preset.viewpoint)
        self._motion = _Motion(end, end, self.clock.elapsed_s())
        await self.clock.sleep(CUT_S)
        return Arrival(end, clamped)

    async def _run(self, motion: _Motion) -> None:
        """Move until the picture has settled or another command arrives. A cancelled move stops where it is.

        While time is held, moves take no time: a watched sweep takes only as long as its pictures.
        """
        if self.clock.held:
            motion = _Motion(motion.end, motion.end, motion.since_s)
        self._motion = motion
        ends_s = motion.since_s + AXIS_M5075_G_HEAD.duration_s(motion.start, motion.end)
        try:
            while self._motion is motion and (left_s := ends_s - self.clock.elapsed_s()) > 1e-9:
                await self.clock.sleep(min(left_s, TICK_S))
        except BaseException:
            if self._motion is motion:
                await self.stop()
            raise
