"""Run programs, which are sequences of tool calls, with the real tools and a simulated camera, in memory.

The caller provides the perception backend and the image store. Frames are blank, which is sufficient for perception backends that
use the ground truth.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from scope_ptz.bench.scoring.episode import (
    CameraPosition,
    Episode,
    EpisodeCall,
    FrameGeometry,
    Observation,
    SavedPicture,
    observations_of,
)
from scope_ptz.bench.tasks.task import ProgramCall, Task
from scope_ptz.camera.base import Camera, Frame, FrameOrigin
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import NotUnderstoodError, PerceptionError, ToolCallError, UnknownNameError
from scope_ptz.geometry import Perspective
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import run_tool

MakeToolContext = Callable[[Camera], ToolContext]
"""Function that creates the tool context for a camera, with perception and an image store."""


class BlankCamera(SimulatedCamera):
    """A simulated camera that does not render. Its frames are blank, but record where and when they were taken."""

    def __init__(self, scene: Scene, *, clock: SceneClock, width: int, height: int) -> None:
        super().__init__(scene, clock=clock, width=width, height=height)
        self._scene_name = scene.name
        self._blank = np.broadcast_to(np.uint8(0), (height, width, 3))  # uses one byte of memory

    async def frame(self) -> Frame:
        pose, time_s = await self.pose(), self.clock.now_s()
        hfov_deg = self.info.optics.hfov_deg(pose.zoom)
        view = Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, self.info.frame_width, self.info.frame_height)
        origin = FrameOrigin(self._scene_name, self.viewpoint, pose, time_s)
        return Frame(image=self._blank, pose=pose, hfov_deg=hfov_deg, time_s=time_s, projection=view, origin=origin)


class ProgramRunner:
    """Runs programs on a scene.

    Args:
        scene: The scene.
        make_context: Function that creates the tool context for the camera.
        geometry: The geometry of the frames.
    """

    def __init__(self, scene: Scene, make_context: MakeToolContext, geometry: FrameGeometry) -> None:
        self.scene, self.make_context, self.geometry = scene, make_context, geometry

    async def run(self, task: Task, program: Sequence[ProgramCall], text: str, outcome: str = "answered") -> Episode:
        """Run a program at the start position of a task. The program continues after a failed call.

        Args:
            task: The task, which defines the start preset and the start time.
            program: The calls in order.
            text: The final answer to record for the run.
            outcome: The outcome to record for the run.
        """
        clock = SceneClock(task.time_s)
        camera = BlankCamera(self.scene, clock=clock, width=self.geometry.width, height=self.geometry.height)
        with clock.hold():
            await camera.go_to_preset(task.preset)
        recorder = await EpisodeRecorder.begin(task.instruction, camera, self.make_context(camera), self.geometry)
        for step in program:
            await recorder.call(step.tool, step.arguments)
        return recorder.episode(text, outcome)


class EpisodeRecorder:
    """Makes tool calls one at a time, and records them as an episode.

    Attributes:
        position: The camera's current viewpoint and pose.
        calls: The calls in order.
        planner_views: The frames that were shown to the agent.
    """

    def __init__(
        self, instruction: str, camera: SimulatedCamera, context: ToolContext, geometry: FrameGeometry, start: CameraPosition
    ) -> None:
        self.position = start
        self.calls = list[EpisodeCall]()
        self.planner_views = list[Observation]()
        self._instruction, self._camera, self._context, self._geometry, self._start = instruction, camera, context, geometry, start
        self._pictures = list[SavedPicture]()

    @classmethod
    async def begin(
        cls, instruction: str, camera: SimulatedCamera, context: ToolContext, geometry: FrameGeometry
    ) -> EpisodeRecorder:
        """Start an episode at the camera's current position.

        Args:
            instruction: The instruction to record.
            camera: The camera.
            context: The context for the tool calls.
            geometry: The geometry of the frames that the tools take.
        """
        return cls(instruction, camera, context, geometry, CameraPosition(camera.viewpoint, await camera.pose()))

    async def call(self, name: str, arguments: Mapping[str, Any]) -> EpisodeCall:
        """Make and record a tool call. If the call is invalid or perception fails, the record contains the error."""
        time_s, before = self._camera.clock.now_s(), self.position
        result, error, fault = None, None, None
        try:
            result = (await run_tool(self._context, name, dict(arguments))).model_dump(mode="json")
        except (ToolCallError, UnknownNameError, NotUnderstoodError) as exception:
            error, fault = str(exception), "bad_call"
        except PerceptionError as exception:
            error, fault = str(exception), "perception"
        self.position = CameraPosition(self._camera.viewpoint, await self._camera.pose())
        call = add_observations(EpisodeCall(name, arguments, before, self.position, result, error, fault, time_s), self._geometry)
        self.calls.append(call)
        if result is not None and name == "take_image":
            self._pictures.append(SavedPicture(str(result["file"])))
        return call

    def episode(self, text: str, outcome: str | None) -> Episode:
        """Return the episode recorded so far.

        Args:
            text: The final answer to record.
            outcome: The outcome to record; None for an episode that has not ended.
        """
        return Episode(
            self._instruction, self._start, tuple(self.calls), self.position, text, outcome, tuple(self._pictures),
            tuple(self.planner_views), aspect=self._geometry.width / self._geometry.height, optics=self._geometry.optics,
        )  # fmt: skip


def add_observations(call: EpisodeCall, geometry: FrameGeometry) -> EpisodeCall:
    """Return a copy of a call that includes its observations."""
    observations = observations_of(call, geometry) if call.succeeded else ()
    return EpisodeCall(
        call.name, call.arguments, call.before, call.after, call.result, call.error, call.fault, call.time_s, observations
    )
