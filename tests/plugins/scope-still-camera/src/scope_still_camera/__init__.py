"""A camera that shows a grey room with one bright lamp: ``--camera still:lamp``."""

from __future__ import annotations

import numpy as np

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import CameraError, UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, direction
from scope_ptz.simulator.clock import SceneClock

WIDTH, HEIGHT = 320, 180
HOME = Pose(0.0, 0.0, 1.0)
LAMP = direction(30.0, 5.0)


class StillCamera(Camera):
    """A room that never changes: only the camera moves."""

    def __init__(self) -> None:
        self.clock = SceneClock()
        self._pose = HOME

    @property
    def info(self) -> CameraInfo:
        return CameraInfo("still camera", Limits(), AXIS_M5075_G, WIDTH, HEIGHT, simulated=False)

    async def pose(self) -> Pose:
        return self._pose

    async def move(self, pose: Pose) -> Arrival:
        self._pose, clamped = self.info.limits.clamp(pose)
        return Arrival(self._pose, clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo("door", "straight ahead")]

    async def go_to_preset(self, name: str) -> Arrival:
        if name != "door":
            raise UnknownNameError("preset", name, ["door"])
        return await self.move(HOME)

    async def go_home(self) -> Arrival:
        return await self.move(HOME)

    async def frame(self) -> Frame:
        hfov_deg = self.info.optics.hfov_deg(self._pose.zoom)
        view = Perspective(self._pose.pan_deg, self._pose.tilt_deg, hfov_deg, WIDTH, HEIGHT)
        image = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
        x, y = view.points(LAMP)
        if 0 <= x <= 1 and 0 <= y <= 1:
            column, row = int(x * WIDTH), int(y * HEIGHT)
            image[max(0, row - 4) : row + 5, max(0, column - 4) : column + 5] = 255
        return Frame(image, self._pose, hfov_deg, self.clock.now_s(), view)

    async def stop(self) -> None:
        """Moves take no time."""


async def make(spec: CameraSpec) -> Camera:
    """Open the camera that a spec names."""
    if spec.address != "lamp":
        raise CameraError(f"There is no still camera '{spec.address}'. Known: lamp.")
    return StillCamera()


make.example = "lamp"  # type: ignore[attr-defined]
