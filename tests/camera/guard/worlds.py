"""A deliberate fake: a camera whose picture is known in closed form for every direction, on a base that may lean or hang."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import Capabilities, Velocity, check_drive, check_preset_name
from scope_ptz.camera.head_motion import HeadMotion
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose
from scope_ptz.simulator.clock import SceneClock
from tests.support.analytic import colour_of

WIDTH, HEIGHT = 160, 90


class SphereCamera(Camera):
    """A device in a world of smooth colours. ``to_world`` turns directions of the device into directions of the world."""

    clock: SceneClock

    def __init__(self, to_world: NDArray[np.float64] | None = None) -> None:
        self.clock = SceneClock()
        self.to_world = np.eye(3) if to_world is None else to_world
        self.motion = HeadMotion(AXIS_M5075_G_HEAD, Limits(), Pose(0.0, -5.0, 1.0))
        self.places = {"gate": Pose(40.0, -10.0, 2.0), "yard": Pose(-60.0, -20.0, 1.0)}
        self.moves = 0

    @property
    def info(self) -> CameraInfo:
        can = Capabilities(Velocity(100.0, 100.0, 1.5), edits_presets=True)
        return CameraInfo("sphere", Limits(), AXIS_M5075_G, WIDTH, HEIGHT, simulated=True, capabilities=can)

    async def pose(self) -> Pose:
        return self.motion.pose(self.clock.elapsed_s())

    async def move(self, pose: Pose) -> Arrival:
        end, clamped = self.info.limits.clamp(pose)
        self.motion.jump_to(end, self.clock.elapsed_s())
        self.moves += 1
        return Arrival(end, clamped)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        self.motion.drive(Velocity(pan_dps, tilt_dps, zoom_rate), self.clock.elapsed_s(), timeout_s)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(name) for name in self.places]

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        check_preset_name(name)
        self.places[name] = await self.pose()
        return PresetInfo(name)

    async def remove_preset(self, name: str) -> None:
        if name not in self.places:
            raise UnknownNameError("preset", name, self.places)
        del self.places[name]

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in self.places:
            raise UnknownNameError("preset", name, self.places)
        return await self.move(self.places[name])

    async def go_home(self) -> Arrival:
        return await self.move(Pose(0.0, -5.0, 1.0))

    async def frame(self) -> Frame:
        pose = await self.pose()
        hfov_deg = AXIS_M5075_G.hfov_deg(pose.zoom)
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, WIDTH, HEIGHT)
        image = colour_of(view.directions(pixel_points()) @ self.to_world.T)
        return Frame(image, pose, hfov_deg, self.clock.now_s(), view)

    async def stop(self) -> None:
        self.motion.jump_to(await self.pose(), self.clock.elapsed_s())


def pixel_points() -> NDArray[np.float64]:
    """Return the normalised centres of all pixels, (H, W, 2)."""
    xs, ys = np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH, (np.arange(HEIGHT) + 0.5) / HEIGHT)
    return np.stack([xs, ys], axis=-1)
