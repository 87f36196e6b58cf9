"""Fakes for tests of the loop: a planner that follows a script, and perception and a camera with predefined replies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import anyio
import numpy as np

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, RunLabels
from scope_ptz.agent.store import NoImages
from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall, Usage
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.tools.context import ImageStore

Step = Decision | BaseException | Callable[[State], Decision]


def calls(*requests: tuple[str, dict[str, Any]], tokens: int = 0) -> CallTools:
    """Return a decision to make tool calls."""
    tool_calls = tuple(ToolCall(id=f"c{i}", name=name, arguments=arguments) for i, (name, arguments) in enumerate(requests))
    return CallTools(calls=tool_calls, usage=Usage(input_tokens=tokens))


def answer(text: str = "Done.") -> Finish:
    return Finish(kind="answered", text=text)


class ScriptedPlanner(Planner):
    """Returns the steps of its script in order, and then repeats the last one. The index is the length of the history."""

    name = "scripted"

    def __init__(self, *script: Step) -> None:
        self.script, self.states = script, list[State]()

    async def step(self, state: State) -> Decision:
        await anyio.lowlevel.checkpoint()
        self.states.append(state)
        step = self.script[min(len(state.history), len(self.script) - 1)]
        if isinstance(step, BaseException):
            raise step
        return step(state) if callable(step) else step


class ScriptedPerception(Perception):
    """Returns as many boxes or points as the next count of its script; the last count repeats. Raises scripted exceptions."""

    name = "scripted-perception"

    def __init__(self, *counts: int | BaseException) -> None:
        self._counts = list(counts) or [0]

    def _next(self) -> int:
        count = self._counts.pop(0) if len(self._counts) > 1 else self._counts[0]
        if isinstance(count, BaseException):
            raise count
        return count

    async def caption(self, frame: Frame) -> Caption:
        return Caption(source=self.name, text="a test pattern")

    async def query(self, frame: Frame, question: str) -> Answer:
        return Answer(source=self.name, text=str(self._next()))

    async def detect(self, frame: Frame, description: str) -> Detections:
        left_edges = [0.1 + 0.8 * i / 10 for i in range(self._next())]
        boxes = tuple(Box(x_min=x, x_max=x + 0.05, y_min=0.4, y_max=0.5, label=description) for x in left_edges)
        return Detections(source=self.name, boxes=boxes)

    async def point(self, frame: Frame, description: str) -> Points:
        return Points(source=self.name, points=tuple(Point(x=0.5, y=0.5) for _ in range(self._next())))


class ScriptedCamera(Camera):
    """A camera without a scene. Its grey pictures encode the pan angle. ``failures`` maps method names to errors."""

    def __init__(self, presets: Sequence[str] = ("gate", "highway"), failures: dict[str, BaseException] | None = None) -> None:
        self.clock = SceneClock()
        self.failures = failures or {}
        self.log: list[str] = []
        self._pose, self._presets = Pose(), tuple(presets)
        self._info = CameraInfo("scripted camera", Limits(), AXIS_M5075_G, 64, 36, simulated=True)

    @property
    def info(self) -> CameraInfo:
        return self._info

    def _enter(self, name: str) -> None:
        self.log.append(name)
        if name in self.failures:
            raise self.failures[name]

    async def pose(self) -> Pose:
        return self._pose

    async def move(self, pose: Pose) -> Arrival:
        self._enter("move")
        await self.clock.sleep(0.5)
        self._pose, clamped = self._info.limits.clamp(pose)
        return Arrival(self._pose, clamped)

    async def presets(self) -> list[PresetInfo]:
        return [PresetInfo(name) for name in self._presets]

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in self._presets:
            raise UnknownNameError("preset", name, self._presets)
        return await self.move(Pose(10.0 * (1 + self._presets.index(name)), -5.0, 1.0))

    async def go_home(self) -> Arrival:
        return await self.move(Pose())

    async def frame(self) -> Frame:
        self._enter("frame")
        image = np.full((36, 64, 3), round(self._pose.pan_deg) % 256, np.uint8)
        hfov_deg = self._info.optics.hfov_deg(self._pose.zoom)
        view = Perspective(self._pose.pan_deg, self._pose.tilt_deg, hfov_deg, 64, 36)
        return Frame(image, self._pose, hfov_deg, self.clock.now_s(), view)

    async def stop(self) -> None:
        self._enter("stop")


def make_agent(
    *script: Step,
    counts: Iterable[int | BaseException] = (),
    camera: Camera | None = None,
    images: ImageStore | None = None,
    budgets: Budgets | None = None,
) -> Agent:
    """Create an agent from scripted parts."""
    planner, perception = ScriptedPlanner(*script), ScriptedPerception(*counts)
    labels = RunLabels(perception_note="scripted, for tests", seed=7)
    return Agent(planner, camera or ScriptedCamera(), perception, images or NoImages(), budgets=budgets, labels=labels)
