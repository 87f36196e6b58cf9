"""Follow moving objects with the simulated camera in process, the AXIS driver and the ONVIF driver, and compare them.

    python benchmarks/driver_tracking.py [--scene SCENE] [--objects 2] [--seconds 6]

No benchmark task of one viewpoint uses the tool ``track_object``, so this program creates its own tasks: for each viewpoint it
selects moving objects, aims the camera at each, and gives the instruction "track the ... for 6 seconds". The drivers connect to a
virtual camera in this process.

A device and a simulated camera do not take the same time for a move, so they would see the objects at different moments and aim
differently, even with perfect drivers. The scene time is therefore stepped: it advances by the tool's own period between two
observations, and stops during moves, pictures and perception. All paths therefore observe at the same moments. The program compares
the pose of the camera and whether the object was seen at every observation, the answer, and the final pose.
"""

from __future__ import annotations

import argparse
import asyncio
import sys
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parent))

from driver_parity import (
    DEFAULT_TIME_SCALE,
    DRIVERS,
    IN_PROCESS,
    OPERATOR,
    SingleViewpointCamera,
    drivers,
    make_settling,
    same_pose,
    without_source,
)
from scope_ptz.agent.loop import Agent
from scope_ptz.agent.store import NoImages
from scope_ptz.camera.base import Arrival, Camera, Frame
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.geometry import Perspective, Pose, pan_tilt_deg, wrap_pan_deg
from scope_ptz.perception.base import Perception
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.served import ServedOrigin, ServedTruthPerception, TruthSource
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.simulator.actors import composited_actors, path_position
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.library import Library
from scope_ptz.simulator.pack import Scene, list_scenes
from scope_ptz.simulator.truth import view_truth
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice

ZOOM = 1.5  # zoom at the start of a run
MIN_SPEED_M_S = 0.4  # slower objects hardly test tracking
TIMES_S = np.arange(1.0, 50.0, 3.0)
"""Scene times at which the program looks for moving objects."""


@dataclass(frozen=True)
class Chase:
    """An object to follow, with the place and time at which the run starts and the instruction."""

    scene: str
    viewpoint: str
    start: Pose
    time_s: float
    instruction: str


@dataclass(frozen=True)
class Observation:
    """The camera's state at one observation of the tool."""

    time_s: float
    pose: Pose
    seen: bool


@dataclass(frozen=True)
class ChaseRun:
    """A chase on one path."""

    observations: tuple[Observation, ...]
    answer: str
    final: Pose


@dataclass
class ChaseComparison:
    """A chase on all paths."""

    chase: Chase
    runs: dict[str, ChaseRun] = field(default_factory=dict)

    def deviations(self) -> list[str]:
        """Return a description of every deviation of a driver from the run in process."""
        own, found = self.runs[IN_PROCESS], []
        for path in DRIVERS:
            run = self.runs[path]
            if [(observation.time_s, observation.seen) for observation in run.observations] != [
                (observation.time_s, observation.seen) for observation in own.observations
            ]:
                found.append(f"{path}: the object is seen at other times: {run.observations} instead of {own.observations}")
            elif wrong := [
                k for k, (a, b) in enumerate(zip(own.observations, run.observations, strict=True)) if not same_pose(a.pose, b.pose)
            ]:
                poses = run.observations[wrong[0]].pose, own.observations[wrong[0]].pose
                found.append(f"{path}: observation {wrong[0]} is at {poses[0]} instead of {poses[1]}")
            if run.answer != own.answer:
                found.append(f"{path}: {run.answer!r} instead of {own.answer!r}")
            if not same_pose(own.final, run.final):
                found.append(f"{path}: ends at {run.final} instead of {own.final}")
        return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", action="append", help="scene to use; repeatable (default: all scenes of the package)")
    parser.add_argument("--objects", type=int, default=2, help="objects per viewpoint (default: %(default)s)")
    parser.add_argument("--seconds", type=int, default=6, help="seconds to follow each object (default: %(default)s)")
    arguments = parser.parse_args()
    compared = asyncio.run(compare(arguments.scene or list_scenes(), arguments.objects, arguments.seconds))
    print("\n".join(report(compared)))
    return 1 if any(each.deviations() for each in compared) else 0


# Objects to follow ----------------------------------------------------------------------------------------------------------
def chases(scenes: Library, scene_name: str, viewpoint: str, objects: int, seconds: int) -> Iterator[Chase]:
    """Yield runs that follow different moving objects which the ground truth sees at the start."""
    scene, found = scenes(scene_name), 0
    opened, known = scene.viewpoint(viewpoint), set[str]()
    for time_s in TIMES_S.tolist():
        for actor in composited_actors(scene, opened, time_s):
            later = path_position(actor.actor, time_s + 1.0)
            now = path_position(actor.actor, time_s)
            if later is None or now is None or float(np.linalg.norm(later.position_m - now.position_m)) < MIN_SPEED_M_S:
                continue
            pan_deg, tilt_deg = (float(angle) for angle in pan_tilt_deg(actor.offset_m))
            start, _ = scene.file.limits.clamp(Pose(pan_deg, tilt_deg, ZOOM))
            view = Perspective(start.pan_deg, start.tilt_deg, scene.file.optics.hfov_deg(ZOOM), 1280, 720)
            name = actor.actor.name
            if name in known or actor.actor.number not in _visible_numbers(scene, viewpoint, view, time_s):
                continue
            known.add(name)
            yield Chase(scene_name, viewpoint, start, time_s, f"track the {name} for {seconds} seconds")
            found += 1
            if found == objects:
                return


def _visible_numbers(scene: Scene, viewpoint: str, view: Perspective, time_s: float) -> set[int]:
    truth = view_truth(scene, viewpoint, view, time_s)
    return {sighting.instance.number for sighting in truth.visible}


# Runs -----------------------------------------------------------------------------------------------------------------------
class SteppedSimulation(SingleViewpointCamera):
    """A simulated camera whose moves take no scene time."""

    async def move(self, pose: Pose) -> Arrival:
        with self.clock.hold():
            return await super().move(pose)


class SteppedDriver(CameraWrapper):
    """A driver whose clock is the stepped clock of its virtual camera. The times of its frames are scene times."""

    def __init__(self, camera: Camera, clock: SceneClock) -> None:
        super().__init__(camera)
        self.clock = clock
        self._taken: deque[tuple[NDArray[np.uint8], float]] = deque(maxlen=4)

    async def frame(self) -> Frame:
        frame = await self.inner.frame()
        self._taken.append((frame.image, frame.time_s))
        return replace(frame, time_s=self.clock.now_s())

    def with_reported_time(self, frame: Frame) -> Frame:
        """Return a frame with the time that the driver reported."""
        return replace(frame, time_s=next(time_s for image, time_s in self._taken if image is frame.image))


class OriginalTimes(TruthSource):
    """Requests the ground truth of frames by the times that the driver reported."""

    def __init__(self, source: TruthSource, camera: SteppedDriver) -> None:
        self._source, self._camera = source, camera

    async def origin(self, frame: Frame) -> ServedOrigin:
        return await self._source.origin(self._camera.with_reported_time(frame))

    async def close(self) -> None:
        """Do nothing: the source belongs to the driver's own perception."""


async def compare(scene_names: list[str], objects: int, seconds: int) -> list[ChaseComparison]:
    """Follow objects in all viewpoints of scenes, on all paths."""
    scenes, compared = Library(), list[ChaseComparison]()
    for scene_name in scene_names:
        for viewpoint in scenes(scene_name).file.viewpoints:
            found = list(chases(scenes, scene_name, viewpoint.name, objects, seconds))
            if not found:
                continue
            account = Account(OPERATOR.user, OPERATOR.password, Role.OPERATOR)
            device = VirtualDevice(scenes(scene_name), viewpoint=viewpoint.name, accounts=[account], time_scale=DEFAULT_TIME_SCALE)
            async with drivers(device, scenes, make_settling(DEFAULT_TIME_SCALE)) as paths:
                for chase in found:
                    compared.append(ChaseComparison(chase))
                    compared[-1].runs[IN_PROCESS] = await _in_process(scenes, chase)
                    for name, (camera, perception) in paths.items():
                        compared[-1].runs[name] = await _with_driver(scenes, chase, device, camera, perception)
                    print(f"{scene_name} {chase.instruction}: {compared[-1].deviations() or 'same'}", file=sys.stderr)
    return compared


async def _in_process(scenes: Library, chase: Chase) -> ChaseRun:
    clock = SceneClock(chase.time_s)
    camera = SteppedSimulation(scenes(chase.scene), viewpoint=chase.viewpoint, clock=clock)
    await camera.move(chase.start)
    return await _follow(camera, GroundTruthPerception(scenes), chase)


async def _with_driver(scenes: Library, chase: Chase, device: VirtualDevice, driver: Camera, perception: Perception) -> ChaseRun:
    assert isinstance(perception, ServedTruthPerception)
    device.clock = SceneClock(chase.time_s)
    camera = SteppedDriver(driver, device.clock)
    await camera.move(chase.start)
    source = OriginalTimes(perception._source, camera)
    return await _follow(camera, ServedTruthPerception(source, scenes), chase)


async def _follow(camera: Camera, perception: Perception, chase: Chase) -> ChaseRun:
    result = await Agent(GrammarPlanner(), camera, perception, NoImages(), snapshots=False).run(chase.instruction)
    outcomes = [outcome for exchange in result.exchanges for outcome in exchange.outcomes]
    for outcome in outcomes:
        if outcome.error is not None:
            print(f"{camera.info.name}, {chase.instruction}, {outcome.call.name}: {outcome.error}", file=sys.stderr)
    path: list[dict[str, Any]] = outcomes[-1].result["path"] if outcomes and outcomes[-1].result is not None else []
    observations = tuple(
        Observation(point["time_s"], Pose(*(point["pose"][axis] for axis in ("pan_deg", "tilt_deg", "zoom"))), point["seen"])
        for point in path
    )
    return ChaseRun(observations, without_source(result.ended.text), result.ended.pose.pose())


# Report ---------------------------------------------------------------------------------------------------------------------
def report(compared: list[ChaseComparison]) -> list[str]:
    """Return the lines of the report."""
    observations = sum(len(each.runs[IN_PROCESS].observations) for each in compared)
    turns = [abs(wrap_pan_deg(each.runs[IN_PROCESS].final.pan_deg - each.chase.start.pan_deg)) for each in compared if each.runs]
    lines = [
        f"{len(compared)} objects, {observations} observations; the camera turns by up to {max(turns, default=0.0):.0f} degrees",
        "",
        "| path | same | largest pan difference at an observation (deg) | tilt (deg) | zoom (%) |",
        "|---|---|---|---|---|",
    ]
    for path in DRIVERS:
        same = sum(not any(text.startswith(path) for text in each.deviations()) for each in compared)
        pairs = [
            (a.pose, b.pose)
            for each in compared
            for a, b in zip(each.runs[IN_PROCESS].observations, each.runs[path].observations, strict=False)
        ]
        pan = max(abs(wrap_pan_deg(a.pan_deg - b.pan_deg)) for a, b in pairs)
        tilt, zoom = max(abs(a.tilt_deg - b.tilt_deg) for a, b in pairs), max(abs(b.zoom / a.zoom - 1) for a, b in pairs)
        lines.append(f"| {path} | {same}/{len(compared)} | {pan:.4f} | {tilt:.4f} | {100 * zoom:.3f} |")
    named = [f"- {each.chase.scene} {each.chase.instruction}, {text}" for each in compared for text in each.deviations()]
    return [*lines, "", *(["Deviations:", *named] if named else ["No deviations."])]


if __name__ == "__main__":
    raise SystemExit(main())
