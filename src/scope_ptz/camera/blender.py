"""A camera in live Blender: the contract of the simulated one, every frame rendered with Cycles when it is asked for."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.requests import perspective_request
from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, FrameOrigin, PresetInfo
from scope_ptz.errors import BlenderError, CameraError, UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.layers import read_colour
from scope_ptz.simulator.models import SceneFile, ScenePreset


class BlenderCamera(Camera):
    """An AXIS M5075-G in a scene that a worker has loaded. Moves take no time; the worker is the caller's to close.

    ``samples`` a pixel: 16 is what packs are baked with. The moving actors stand where they are at the clock's time.
    """

    clock: SceneClock

    def __init__(
        self,
        worker: BlenderWorker,
        scene: SceneFile,
        *,
        samples: int = 16,
        clock: SceneClock | None = None,
        width: int = 1280,
        height: int = 720,
    ) -> None:
        self.clock = clock or SceneClock()
        self._worker, self._scene, self._samples = worker, scene, samples
        self._presets = {p.name: p for p in scene.presets}
        self._at = self._presets[scene.home_preset]
        self._pose = _pose(self._at)
        self._info = CameraInfo(
            name=f"AXIS M5075-G in {scene.title}, live in Blender {worker.version}",
            limits=Limits(),
            optics=AXIS_M5075_G,
            frame_width=width,
            frame_height=height,
            simulated=True,
        )

    @property
    def info(self) -> CameraInfo:
        return self._info

    @property
    def viewpoint(self) -> str:
        """Name of the optical centre that the camera is at."""
        return self._at.viewpoint

    async def pose(self) -> Pose:
        return self._pose

    async def move(self, pose: Pose) -> Arrival:
        self._pose, clamped = self._info.limits.clamp(pose)
        return Arrival(self._pose, clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(p.name, p.description) for p in self._scene.presets]

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in self._presets:
            raise UnknownNameError("preset", name, self._presets)
        self._at = self._presets[name]
        return await self.move(_pose(self._at))

    async def go_home(self) -> Arrival:
        return await self.go_to_preset(self._scene.home_preset)

    async def frame(self) -> Frame:
        pose, time_s, viewpoint = self._pose, self.clock.now_s(), self.viewpoint
        hfov_deg = self._info.optics.hfov_deg(pose.zoom)
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, self._info.frame_width, self._info.frame_height)
        image = await to_thread.run_sync(self._render, viewpoint, view, time_s)
        origin = FrameOrigin(self._scene.name, viewpoint, pose, time_s)
        return Frame(image=image, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view, origin=origin)

    async def stop(self) -> None:
        """Nothing is ever under way."""

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
                raise CameraError(f"The live Blender camera gave no picture: {error}") from error
            return read_colour(out)


def _pose(preset: ScenePreset) -> Pose:
    return Pose(preset.pan_deg, preset.tilt_deg, preset.zoom)
