"""A camera in a running Blender process: Cycles renders each frame on request."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.requests import perspective_request
from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, FrameOrigin, PresetInfo
from scope_ptz.camera.capabilities import Capabilities, Velocity, check_drive
from scope_ptz.camera.head_motion import HeadMotion
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, top_speed
from scope_ptz.camera.scene_presets import ScenePresets, preset_pose
from scope_ptz.errors import BlenderError, CameraError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Optics, Perspective, Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.layers import read_colour
from scope_ptz.simulator.models import SceneFile


class BlenderCamera(Camera):
    """A pan-tilt-zoom camera in a scene that a Blender process has loaded. Moves to a pose are instantaneous.

    Moving actors appear at their positions at the clock's time. The caller closes the worker.

    Args:
        worker: The running Blender process, with the scene loaded.
        scene: The scene's viewpoints and presets.
        viewpoint: The initial viewpoint; by default, that of the home preset.
        samples: Cycles samples per pixel. Packs are baked with 16.
        clock: The scene's clock.
        width: Width of a frame in pixels.
        height: Height of a frame in pixels.
        optics: The optics; by default, those of the simulated camera, an AXIS M5075-G.
        limits: Limits of motion; by default, those of the simulated camera.
        has_truth: Whether frames record their origin, so that a pack's ground truth can be applied to them.
    """

    clock: SceneClock

    def __init__(
        self,
        worker: BlenderWorker,
        scene: SceneFile,
        *,
        viewpoint: str | None = None,
        samples: int = 16,
        clock: SceneClock | None = None,
        width: int = 1280,
        height: int = 720,
        optics: Optics = AXIS_M5075_G,
        limits: Limits | None = None,
        has_truth: bool = True,
    ) -> None:
        self.clock = clock or SceneClock()
        self._worker, self._scene, self._samples, self._has_truth = worker, scene, samples, has_truth
        self._presets = ScenePresets(scene, viewpoint)
        self._viewpoint = self._presets.home.viewpoint
        self._last: tuple[tuple[str, Perspective, float], NDArray[np.uint8]] | None = None
        kind = "AXIS M5075-G" if optics is AXIS_M5075_G else "camera"
        self._info = CameraInfo(
            name=f"{kind} in {scene.title}, live in Blender {worker.version}",
            limits=limits or Limits(),
            optics=optics,
            frame_width=width,
            frame_height=height,
            simulated=True,
            capabilities=Capabilities(top_speed(AXIS_M5075_G_HEAD), edits_presets=True),
        )
        self._motion = HeadMotion(AXIS_M5075_G_HEAD, self._info.limits, preset_pose(self._presets.home))

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

    async def pose(self) -> Pose:
        return self._motion.pose(self.clock.elapsed_s())

    async def move(self, pose: Pose) -> Arrival:
        end, clamped = self._info.limits.clamp(pose)
        self._motion.jump_to(end, self.clock.elapsed_s())
        return Arrival(end, clamped)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        self._motion.drive(Velocity(pan_dps, tilt_dps, zoom_rate), self.clock.elapsed_s(), timeout_s)

    async def presets(self) -> list[PresetInfo]:
        return self._presets.infos()

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        return self._presets.save(name, description, self.viewpoint, await self.pose())

    async def remove_preset(self, name: str) -> None:
        self._presets.remove(name)

    async def go_to_preset(self, name: str) -> Arrival:
        preset = self._presets.find(name)
        self._viewpoint = preset.viewpoint
        return await self.move(preset_pose(preset))

    async def go_home(self) -> Arrival:
        self._viewpoint = self._presets.home.viewpoint
        return await self.move(preset_pose(self._presets.home))

    async def frame(self) -> Frame:
        pose, time_s, viewpoint = await self.pose(), self.clock.now_s(), self.viewpoint
        hfov_deg = self._info.optics.hfov_deg(pose.zoom)
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, self._info.frame_width, self._info.frame_height)
        image = await self._image(viewpoint, view, time_s)
        origin = FrameOrigin(self._scene.name, viewpoint, pose, time_s) if self._has_truth else None
        return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view, origin=origin)

    async def stop(self) -> None:
        self._motion.jump_to(await self.pose(), self.clock.elapsed_s())

    async def _image(self, viewpoint: str, view: Perspective, time_s: float) -> NDArray[np.uint8]:
        """Render a view, or return the last picture if nothing has changed since it was rendered."""
        key = (viewpoint, view, time_s)
        if self._last is None or self._last[0] != key:
            # Rendering takes seconds. A cancelled render is abandoned; it keeps running until it finishes or the worker is closed.
            self._last = key, await to_thread.run_sync(self._render, viewpoint, view, time_s, abandon_on_cancel=True)
        return self._last[1]

    def _render(self, viewpoint: str, view: Perspective, time_s: float) -> NDArray[np.uint8]:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "frame.png"
            parameters = {
                "viewpoint": viewpoint,
                "projection": perspective_request(view),
                "samples": self._samples,
                "seed": 1,
                "out": str(out),
                "time_s": time_s,
            }
            try:
                self._worker.request("colour", parameters)
            except BlenderError as error:
                raise CameraError(f"The live Blender camera returned no picture: {error}") from error
            return read_colour(out)
