"""Fakes for tests of the tools: a camera and perception of a world of points on a sphere, with all views known in closed form.

The camera draws a smooth colour field over all directions. Objects are clouds of directions, and perception returns the box of
those directions that are in the frame. There are no packs and no re-projection, so results of tools can be compared with exact
numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.errors import PerceptionError, UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, direction
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points

WIDTH, HEIGHT = 320, 180


def colour_of(directions: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return a smooth colour for every direction (..., 3)."""
    waves = np.stack([np.sin(5 * directions[..., 0]), np.cos(7 * directions[..., 1]), np.sin(6 * directions[..., 2] + 1)], axis=-1)
    return np.asarray(127.5 + 120 * waves).round().astype(np.uint8)


@dataclass
class StepClock:
    """A clock that is advanced only by moves and waits."""

    time_s: float = 0.0
    held: bool = False

    def now_s(self) -> float:
        return self.time_s

    async def sleep(self, seconds: float) -> None:
        self.time_s += seconds


@dataclass
class AnalyticCamera(Camera):
    """A camera that moves instantly and draws the colour field."""

    start: Pose = field(default_factory=Pose)
    limits: Limits = field(default_factory=Limits)
    move_s: float = 0.1
    clock: StepClock = field(default_factory=StepClock)
    places: dict[str, Pose] = field(default_factory=lambda: {"gate": Pose(40, -5, 2)})
    visited: list[Pose] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.now = self.start

    @property
    def info(self) -> CameraInfo:
        return CameraInfo("analytic", self.limits, AXIS_M5075_G, WIDTH, HEIGHT, simulated=True)

    async def pose(self) -> Pose:
        return self.now

    async def move(self, pose: Pose) -> Arrival:
        self.now, clamped = self.limits.clamp(pose)
        self.visited.append(self.now)
        if not self.clock.held:
            self.clock.time_s += self.move_s
        return Arrival(self.now, clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(name) for name in self.places]

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in self.places:
            raise UnknownNameError("preset", name, self.places)
        return await self.move(self.places[name])

    async def go_home(self) -> Arrival:
        return await self.move(self.start)

    async def frame(self) -> Frame:
        hfov = AXIS_M5075_G.hfov_deg(self.now.zoom)
        view = Perspective(self.now.pan_deg, self.now.tilt_deg, hfov, WIDTH, HEIGHT)
        xs, ys = np.meshgrid((np.arange(WIDTH) + 0.5) / WIDTH, (np.arange(HEIGHT) + 0.5) / HEIGHT)
        image = colour_of(view.directions(np.stack([xs, ys], axis=-1)))
        return Frame(image, self.now, hfov, self.clock.now_s(), view)

    async def stop(self) -> None:
        """Do nothing, because moves are instant."""


@dataclass(frozen=True)
class Thing:
    """An object as a cloud of directions (n, 3) that drifts by ``rate`` degrees of pan and tilt per second."""

    name: str
    cloud: NDArray[np.float64]
    pan_deg: float
    tilt_deg: float
    rate: tuple[float, float] = (0.0, 0.0)

    def at(self, time_s: float) -> NDArray[np.float64]:
        if self.rate == (0.0, 0.0):
            return self.cloud
        moved = direction(self.pan_deg + self.rate[0] * time_s, self.tilt_deg + self.rate[1] * time_s)
        turned = self.cloud + (moved - direction(self.pan_deg, self.tilt_deg))
        return np.asarray(turned / np.linalg.norm(turned, axis=-1, keepdims=True))


def solid(
    name: str, pan_deg: float, tilt_deg: float, size_m: tuple[float, float, float], distance_m: float, spin_deg: float = 0
) -> Thing:
    """Return an upright box, seen from the origin, as the directions of points along its edges."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    pairs = [(a, b) for a in range(8) for b in range(a + 1, 8) if np.sum(signs[a] != signs[b]) == 1]
    t = np.linspace(0, 1, 7)[:, None]
    edges = np.concatenate([signs[a] * (1 - t) + signs[b] * t for a, b in pairs]) * np.array(size_m) / 2
    s, c = np.sin(np.radians(spin_deg)), np.cos(np.radians(spin_deg))
    turned = edges @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    points = turned + direction(pan_deg, tilt_deg) * distance_m
    return Thing(name, points / np.linalg.norm(points, axis=-1, keepdims=True), pan_deg, tilt_deg)


@dataclass
class AnalyticPerception(Perception):
    """Perception that finds the things whose name equals the description."""

    things: list[Thing]
    name: str = "analytic"
    fail: bool = False
    asked: list[str] = field(default_factory=list)

    async def detect(self, frame: Frame, description: str) -> Detections:
        if self.fail:
            raise PerceptionError("Perception is switched off.")
        self.asked.append(description)
        boxes = []
        for thing in self.things:
            if thing.name != description:
                continue
            points = frame.projection.points(thing.at(frame.time_s))
            points = points[~np.isnan(points).any(axis=-1)]
            if not len(points):
                continue
            low, high = points.min(axis=0).clip(0, 1), points.max(axis=0).clip(0, 1)
            if (high - low).min() * WIDTH > 1.0:
                boxes.append(Box(x_min=low[0], y_min=low[1], x_max=high[0], y_max=high[1], label=thing.name))
        return Detections(source=self.name, boxes=tuple(boxes))

    async def point(self, frame: Frame, description: str) -> Points:
        boxes = (await self.detect(frame, description)).boxes
        return Points(source=self.name, points=tuple(Point(x=b.centre[0], y=b.centre[1]) for b in boxes))

    async def query(self, frame: Frame, question: str) -> Answer:
        if self.fail:
            raise PerceptionError("Perception is switched off.")
        return Answer(source=self.name, text=f"{len(self.things)} things", known=True)

    async def caption(self, frame: Frame) -> Caption:
        return Caption(source=self.name, text="points on a sphere")


class MemoryStore:
    """An image store in memory."""

    def __init__(self) -> None:
        self.frames: list[Frame] = []

    async def save_frame(self, frame: Frame) -> str:
        self.frames.append(frame)
        return f"look-{len(self.frames)}.jpg"

    async def save_picture(self, frame: Frame) -> str:
        self.frames.append(frame)
        return f"picture-{len(self.frames)}.png"


def moving_object(name: str, pan_deg: float, tilt_deg: float, rate: tuple[float, float]) -> Thing:
    """Return a small solid that drifts."""
    return replace(solid(name, pan_deg, tilt_deg, (1.0, 1.0, 2.0), 20.0), rate=rate)
