"""A fake world: a textured sphere, and a camera in it whose poses, fields of view and exposure can be made wrong."""

from __future__ import annotations

import math
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capture.session import CaptureSession
from scope_ptz.camera.clocks import WallClock
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Limits, Optics, Perspective, Pose, direction

WIDTH, HEIGHT = 320, 180
OPTICS = Optics(((1.0, 60.0), (2.5, 26.0)))
LIMITS = Limits(min_pan_deg=-40, max_pan_deg=40, min_tilt_deg=-15, max_tilt_deg=15, min_zoom=1.0, max_zoom=2.5)


@cache
def world() -> NDArray[np.uint8]:
    """Return a deterministic equirectangular picture of blobs of all sizes."""
    random = np.random.default_rng(3)
    picture = np.full((2048, 4096, 3), 120, np.uint8)
    for _ in range(7000):
        x, y, radius = random.integers(0, 4096), random.integers(0, 2048), random.integers(3, 30)
        colour = tuple(int(value) for value in random.integers(30, 225, 3))
        cv2.circle(picture, (int(x), int(y)), int(radius), colour, -1, cv2.LINE_AA)
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 1.0), np.uint8)


def seen(view: Perspective, picture: NDArray[np.uint8] | None = None) -> NDArray[np.uint8]:
    """Return the picture of a perfect camera in the world."""
    source = world() if picture is None else picture
    xs, ys = np.meshgrid((np.arange(view.width) + 0.5) / view.width, (np.arange(view.height) + 0.5) / view.height)
    rays = view.directions(np.stack([xs, ys], axis=-1))
    x = (np.degrees(np.arctan2(rays[..., 0], rays[..., 1])) + 180) / 360 * 4096 - 0.5
    y = (90 - np.degrees(np.arcsin(np.clip(rays[..., 2], -1, 1)))) / 180 * 2048 - 0.5
    found = cv2.remap(source, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    return np.asarray(found, np.uint8)


class BlobCamera(Camera):
    """A camera in the world.

    Attributes:
        noise_deg: Standard error of the reported pan and tilt.
        field_factor: True field of view divided by the reported one.
        gains: Exposure of each frame, repeated.
        textureless: Whether the world is one smooth surface.
        fails_after: Number of frames after which the camera fails.
        walker: Whether a bright thing stands somewhere else in every frame.
        truths: The true view of each frame, in their order.
    """

    def __init__(self) -> None:
        self.clock = WallClock()
        self.at = Pose(5.0, 3.0, 2.0)
        self.noise_deg, self.field_factor = 0.0, 1.0
        self.gains: tuple[float, ...] = (1.0,)
        self.textureless = self.walker = False
        self.fails_after: int | None = None
        self.assumed: tuple[str, ...] = ()
        self.limits = LIMITS
        self.stops = 0
        self.truths: list[Perspective] = []
        self.places = {"gate": Pose(20.0, 0.0, 1.0), "Main Door": Pose(-15.0, 5.0, 2.0), "far away": Pose(90.0, 0.0, 1.0)}
        self._random = np.random.default_rng(1)

    @property
    def info(self) -> CameraInfo:
        return CameraInfo("blob at 10.0.0.7", self.limits, OPTICS, WIDTH, HEIGHT, simulated=False, assumed=self.assumed)

    async def pose(self) -> Pose:
        return self.at

    async def move(self, pose: Pose) -> Arrival:
        self.at, clamped = self.limits.clamp(pose)
        return Arrival(self.at, clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(name) for name in self.places]

    async def go_to_preset(self, name: str) -> Arrival:
        self.at = self.places[name]
        return Arrival(self.at)

    async def go_home(self) -> Arrival:
        return await self.move(Pose())

    async def stop(self) -> None:
        self.stops += 1

    async def frame(self) -> Frame:
        if self.fails_after is not None and len(self.truths) >= self.fails_after:
            raise CameraError("The camera has lost its power.")
        number = len(self.truths)
        reported_deg = OPTICS.hfov_deg(self.at.zoom)
        focal = 1 / math.tan(math.radians(reported_deg) / 2) / self.field_factor
        true = Perspective(self.at.pan_deg, self.at.tilt_deg, math.degrees(2 * math.atan(1 / focal)), WIDTH, HEIGHT)
        self.truths.append(true)
        picture = None
        if self.walker:
            picture = world().copy()
            cv2.rectangle(picture, (1700 + 80 * (number % 9), 900), (1760 + 80 * (number % 9), 1120), (255, 255, 255), -1)
        image = np.full((HEIGHT, WIDTH, 3), 120, np.uint8) if self.textureless else seen(true, picture)
        image = np.clip(image * self.gains[number % len(self.gains)], 0, 255).astype(np.uint8)
        pan, tilt = self._random.normal(0, self.noise_deg, 2).tolist() if self.noise_deg else (0.0, 0.0)
        pose = self.at.turned(pan, tilt)
        view = Perspective(pose.pan_deg, pose.tilt_deg, reported_deg, WIDTH, HEIGHT)
        return Frame(image, pose, reported_deg, self.clock.now_s(), view)


def reported_views(session: CaptureSession) -> list[Perspective]:
    """Return the frames of a session at their reported poses."""
    return [Perspective(shot.pan_deg, shot.tilt_deg, shot.hfov_deg, WIDTH, HEIGHT) for shot in session.shots]


def ray(view: Perspective) -> NDArray[np.float64]:
    """Return the direction of a view."""
    return direction(view.pan_deg, view.tilt_deg)
