"""Run the same benchmark tasks with the simulated camera in process, the AXIS driver and the ONVIF driver, and compare them.

    python benchmarks/driver_parity.py [--tasks 120] [--split core] [--json FILE]
    python benchmarks/driver_parity.py --true-speed

The drivers connect to a virtual camera in this process, over HTTP on the loopback interface. Each task starts at its preset, in its
scene or variation, and at its scene time, which does not advance. The built-in planner and ground-truth perception run the task on
each path; the drivers use the backend ``simulation-only-truth``. The program prints the numbers of tasks with the same calls, the
same answer and the same final pose as in process, and every deviation. All paths use the same pixels, so this tests the drivers,
but not how well SCOPE works with pictures of real cameras.

Motors are 50 times faster than real ones. With --true-speed, ten tasks run at real speed, and a table shows the time by stage.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import statistics
import sys
from collections.abc import AsyncIterator, Callable, Iterable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, nullcontext
from dataclasses import asdict, dataclass, field
from itertools import groupby
from pathlib import Path
from typing import Any

from anyio import to_thread

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.store import NoImages
from scope_ptz.agent.timing import Timings
from scope_ptz.bench.tasks.splits import SPLITS, load_split
from scope_ptz.bench.tasks.stratified import stratified_sample
from scope_ptz.bench.tasks.task import Task
from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.base import Camera, PresetInfo
from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.http import DeviceHttp, DeviceTimeouts
from scope_ptz.camera.network.settling import SettlingCriteria
from scope_ptz.camera.onvif.camera import OnvifCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.geometry import Limits, Pose, wrap_pan_deg
from scope_ptz.perception.base import Perception
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.served import ServedTruth, ServedTruthPerception
from scope_ptz.planner.base import Briefing, CallTools, State
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.library import Library
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, serve
from scope_ptz.virtual_camera.onvif.app import OnvifApp

IN_PROCESS, DRIVERS = "in process", ("axis", "onvif")
TOLERANCE_DEG, ZOOM_TOLERANCE = 0.3, 0.02
"""Tolerances for the difference between the final pose with a driver and the one in process."""

ARGUMENT_TOLERANCE = 0.01
"""Tolerance for numbers in the arguments of calls. The planner calculates some of them from the reported pose."""

DEFAULT_TIME_SCALE = 50.0
TRUE_SPEED_TASKS = 10
STAGES = {"planner": "planner_s", "perception": "perception_s", "camera": "camera_s", "rendering": "render_s", "total": "total_s"}
OPERATOR = Credentials("parity", "parity-on-loopback")
SEED = 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", type=int, help="number of tasks (default: 120, or 10 with --true-speed)")
    parser.add_argument("--split", choices=SPLITS, default="core", help="tasks of 'unseen' are in scene variations (default: core)")
    parser.add_argument("--task", action="append", default=[], metavar="ID", help="run only this task; repeatable")
    parser.add_argument(
        "--time-scale", type=float, default=DEFAULT_TIME_SCALE, help="speed of the motors (default: %(default)g times real)"
    )
    parser.add_argument("--true-speed", action="store_true", help="run motors at real speed, and print the latency by stage")
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    arguments = parser.parse_args()
    all_tasks = load_split(arguments.split)
    local_tasks = tasks_in_one_viewpoint(all_tasks)
    usable_tasks = asyncio.run(tasks_with_calls(local_tasks))
    count = arguments.tasks or (TRUE_SPEED_TASKS if arguments.true_speed else 120)
    tasks = (
        [task for task in usable_tasks if task.id in arguments.task]
        if arguments.task
        else stratified_sample(usable_tasks, count, SEED)
    )
    if not tasks:
        parser.error("none of these tasks uses the camera and stays in one viewpoint")
    time_scale = 1.0 if arguments.true_speed else arguments.time_scale
    measured = asyncio.run(measure(tasks, time_scale=time_scale, progress=lambda text: print(text, file=sys.stderr)))
    if arguments.json is not None:
        arguments.json.write_text(json.dumps([asdict(each) for each in measured], indent=1, default=str))
    print(
        f"{len(all_tasks)} tasks, of which {len(local_tasks)} stay in one viewpoint. "
        f"The planner makes calls in {len(usable_tasks)} of these"
    )
    print(f"and ends the others immediately with a question. Measured: {len(measured)}.\n")
    print("\n".join(report(measured)))
    if arguments.true_speed:
        print("\n".join(latency_table(measured)))
    return 1 if any(each.deviations() for each in measured) else 0


# Tasks ----------------------------------------------------------------------------------------------------------------------
def tasks_in_one_viewpoint(tasks: Iterable[Task]) -> list[Task]:
    """Return the tasks that stay at one viewpoint. A physical camera cannot go to another one."""
    scenes, selected = Library(), list[Task]()
    for task in tasks:
        file = scenes(task.world).file
        viewpoint_of = {preset.name: preset.viewpoint for preset in file.presets}
        start = viewpoint_of[task.preset]
        visited = {viewpoint_of.get(str(call.arguments.get("name"))) for call in task.reference if call.tool == "go_to_preset"}
        if any(call.tool == "go_home" for call in task.reference):
            visited.add(viewpoint_of[file.home_preset])
        if visited <= {start}:
            selected.append(task)
    return selected


async def tasks_with_calls(tasks: Sequence[Task]) -> list[Task]:
    """Return the tasks in which the planner makes a call. The other tasks do not involve a driver."""
    scenes = Library()

    async def uses_camera(task: Task) -> bool:
        listed = scenes(task.world).file.presets
        viewpoint = next(preset.viewpoint for preset in listed if preset.name == task.preset)
        presets = tuple(preset.name for preset in listed if preset.viewpoint == viewpoint)
        briefing = Briefing(presets=presets, pose=Pose(), limits=Limits())
        return isinstance(await GrammarPlanner().step(State(instruction=task.instruction, briefing=briefing)), CallTools)

    return [task for task in tasks if await uses_camera(task)]


# Runs -----------------------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class PathRun:
    """The result of a task on one path. ``answer`` is the reply without the note on its source."""

    calls: list[tuple[str, dict[str, Any]]]
    outcome: str
    answer: str
    pose: Pose
    timings: Timings
    perception: str


@dataclass(frozen=True)
class TaskRuns:
    """The results of a task on all paths."""

    task: str
    runs: dict[str, PathRun] = field(default_factory=dict)

    def deviations(self) -> list[tuple[str, str, str]]:
        """Return path, kind and description of every deviation from the run in process."""
        own, found = self.runs[IN_PROCESS], []
        for path in DRIVERS:
            run = self.runs[path]
            if not same_calls(own.calls, run.calls):
                found.append((path, "calls", f"{_first_difference(own.calls, run.calls)}"))
            if (run.outcome, run.answer) != (own.outcome, own.answer):
                found.append((path, "answer", f"{run.outcome}: {run.answer!r} instead of {own.outcome}: {own.answer!r}"))
            if not same_pose(own.pose, run.pose):
                found.append((path, "pose", f"{_format_pose(run.pose)} instead of {_format_pose(own.pose)}"))
        return found


async def measure(
    tasks: Iterable[Task], *, time_scale: float = DEFAULT_TIME_SCALE, progress: Callable[[str], None] = lambda _: None
) -> list[TaskRuns]:
    """Run tasks on all paths.

    Args:
        tasks: The tasks. Each must stay in one viewpoint.
        time_scale: How many times faster than real the motors are.
        progress: Receives a line of text after each task.
    """
    scenes = Library()
    measured: list[TaskRuns] = []

    def place(task: Task) -> tuple[str, str]:
        presets = scenes(task.world).file.presets
        return task.world, next(preset.viewpoint for preset in presets if preset.name == task.preset)

    for (world, viewpoint), group in groupby(sorted(tasks, key=place), key=place):
        device = VirtualDevice(
            scenes(world), viewpoint=viewpoint, accounts=[Account(OPERATOR.user, OPERATOR.password, Role.OPERATOR)],
            time_scale=time_scale,
        )  # fmt: skip
        async with drivers(device, scenes, make_settling(time_scale)) as paths:
            for task in group:
                measured.append(TaskRuns(task.id))
                if time_scale == 1.0:  # reads the files of the task's views, so that no path spends time on it
                    await _in_process(scenes, viewpoint, task, real=False)
                measured[-1].runs[IN_PROCESS] = await _in_process(scenes, viewpoint, task, real=time_scale == 1.0)
                for name, (camera, perception) in paths.items():
                    # This clock never advances. The motors have their own clock.
                    device.clock = SceneClock(task.time_s)
                    await camera.go_to_preset(task.preset)
                    measured[-1].runs[name] = await _run(camera, perception, task)
                progress(f"{len(measured)} {task.id}: {'; '.join(map(': '.join, measured[-1].deviations())) or 'same'}")
    return measured


@asynccontextmanager
async def drivers(
    device: VirtualDevice, scenes: Callable[[str], Scene], settling: SettlingCriteria
) -> AsyncIterator[dict[str, tuple[Camera, Perception]]]:
    """Serve a camera, and connect each driver to it, with perception that reads the served ground truth."""
    # The first frame of a viewpoint reads its files, which may take longer than a driver waits for a reply.
    await to_thread.run_sync(device.expose)
    async with AsyncExitStack() as stack:
        (served,) = await stack.enter_async_context(
            serve([device], truth=True, onvif=lambda each: OnvifApp(each, rtsp_port=554))  # no stream is opened
        )  # fmt: skip
        axis = await AxisCamera.open(_http(served), OPERATOR, settling=settling)
        stack.push_async_callback(axis.close)
        onvif = await OnvifCamera.open(_http(served), OPERATOR, stream="snapshot", settling=settling)
        stack.push_async_callback(onvif.close)
        paths = dict[str, tuple[Camera, Perception]]()
        for name, camera in (("axis", axis), ("onvif", onvif)):
            perception = ServedTruthPerception(ServedTruth(_http(served), camera.clock), scenes)
            stack.push_async_callback(perception.close)
            paths[name] = (camera, perception)
        yield paths


def make_settling(time_scale: float) -> SettlingCriteria:
    """Return the settling parameters of the drivers for motors that are faster than real ones."""
    if time_scale == 1.0:
        return SettlingCriteria()
    own = SettlingCriteria()
    return SettlingCriteria(
        poll_s=max(own.poll_s / time_scale, 0.004),
        start_s=max(own.start_s / time_scale, 0.15),
        picture_interval_s=own.picture_interval_s / time_scale,
    )


class FrozenSceneClock(SceneClock):
    """A clock with a fixed scene time. The motors run in real time."""

    def __init__(self, time_s: float) -> None:
        super().__init__(time_s, realtime=True)
        self._time_s = time_s

    def now_s(self) -> float:
        return self._time_s


class SingleViewpointCamera(SimulatedCamera):
    """A simulated camera that lists the presets of one viewpoint without descriptions, as a device does."""

    async def presets(self) -> list[PresetInfo]:
        local = {preset.name for preset in self._scene.file.presets if preset.viewpoint == self.viewpoint}
        return [PresetInfo(preset.name) for preset in await super().presets() if preset.name in local]


async def _in_process(scenes: Callable[[str], Scene], viewpoint: str, task: Task, *, real: bool) -> PathRun:
    clock = FrozenSceneClock(task.time_s) if real else SceneClock(task.time_s)
    camera = SingleViewpointCamera(scenes(task.world), viewpoint=viewpoint, clock=clock)
    with nullcontext() if real else clock.hold():
        await camera.go_to_preset(task.preset)
        return await _run(camera, GroundTruthPerception(scenes), task)


async def _run(camera: Camera, perception: Perception, task: Task) -> PathRun:
    agent = Agent(GrammarPlanner(), camera, perception, NoImages(), snapshots=False)
    result = await agent.run(task.instruction)
    calls = [
        (outcome.call.name, dict(outcome.call.arguments)) for exchange in result.exchanges for outcome in exchange.outcomes
    ]  # fmt: skip
    ended = result.ended
    return PathRun(calls, ended.outcome, without_source(ended.text), ended.pose.pose(), ended.timings, perception.name)


def _http(served: ServedCamera) -> DeviceHttp:
    # The default time-out is too short for a busy machine.
    return DeviceHttp(DeviceAddress(served.host, served.port), OPERATOR, timeouts=DeviceTimeouts(reply_s=60.0))


# Comparison -----------------------------------------------------------------------------------------------------------------
def without_source(answer: str) -> str:
    """Return an answer without the note at its end, which names the perception backend."""
    return answer.rpartition(" (Source: ")[0] or answer


def same_calls(own: Sequence[tuple[str, dict[str, Any]]], other: Sequence[tuple[str, dict[str, Any]]]) -> bool:
    """Return whether two runs made the same calls in the same order."""
    return len(own) == len(other) and all(a[0] == b[0] and _are_equal(a[1], b[1]) for a, b in zip(own, other, strict=True))


def _are_equal(one: Any, two: Any) -> bool:
    if isinstance(one, dict) and isinstance(two, dict):
        return one.keys() == two.keys() and all(_are_equal(one[key], two[key]) for key in one)
    if isinstance(one, float | int) and isinstance(two, float | int):
        return abs(one - two) <= ARGUMENT_TOLERANCE
    return bool(one == two)


def same_pose(own: Pose, other: Pose) -> bool:
    """Return whether a final pose is within the tolerances."""
    return (
        abs(wrap_pan_deg(own.pan_deg - other.pan_deg)) <= TOLERANCE_DEG
        and abs(own.tilt_deg - other.tilt_deg) <= TOLERANCE_DEG
        and abs(other.zoom / own.zoom - 1) <= ZOOM_TOLERANCE
    )


def _first_difference(own: list[tuple[str, dict[str, Any]]], other: list[tuple[str, dict[str, Any]]]) -> str:
    k = next((k for k, (a, b) in enumerate(zip(own, other, strict=False)) if a[0] != b[0] or not _are_equal(a[1], b[1])), None)
    if k is None:
        return f"{len(other)} calls instead of {len(own)}"
    return f"call {k + 1} is {other[k]} instead of {own[k]}"


def _format_pose(pose: Pose) -> str:
    return f"pan {pose.pan_deg:.3f}, tilt {pose.tilt_deg:.3f}, zoom {pose.zoom:.4f}"


# Report ---------------------------------------------------------------------------------------------------------------------
def report(measured: Sequence[TaskRuns]) -> list[str]:
    """Return the lines of the report."""
    total = len(measured)
    lines = ["| path | same calls | same answer | same final pose | all three |", "|---|---|---|---|---|"]
    for path in DRIVERS:
        wrong = [{kind for where, kind, _ in each.deviations() if where == path} for each in measured]
        cells = [sum(kind not in found for found in wrong) for kind in ("calls", "answer", "pose")]
        cells.append(sum(not found for found in wrong))
        lines.append(f"| {path} | " + " | ".join(f"{n}/{total} ({n / total:.1%})" for n in cells) + " |")
    lines += ["", "| path | largest pan difference (deg) | tilt (deg) | zoom (%) |", "|---|---|---|---|"]
    for path in DRIVERS:
        pairs = [(each.runs[IN_PROCESS].pose, each.runs[path].pose) for each in measured]
        pan = max(abs(wrap_pan_deg(a.pan_deg - b.pan_deg)) for a, b in pairs)
        tilt, zoom = max(abs(a.tilt_deg - b.tilt_deg) for a, b in pairs), max(abs(b.zoom / a.zoom - 1) for a, b in pairs)
        lines.append(f"| {path} | {pan:.4f} | {tilt:.4f} | {100 * zoom:.3f} |")
    deviations = [f"- {each.task}, {path}, {kind}: {text}" for each in measured for path, kind, text in each.deviations()]
    return [*lines, "", *(["Deviations:", *deviations] if deviations else ["No deviations."])]


def latency_table(measured: Sequence[TaskRuns]) -> list[str]:
    """Return a table of seconds by stage: medians over tasks, and median differences from the run of the same task in process."""
    lines = ["", "Seconds per task by stage, median (difference to in process in the same task, median)", ""]
    lines += [f"| path | {' | '.join(STAGES)} |", "|---|" + "---|" * len(STAGES)]
    for path in (IN_PROCESS, *DRIVERS):
        cells = []
        for name in STAGES.values():
            spent = [getattr(each.runs[path].timings, name) for each in measured]
            more = [t - getattr(each.runs[IN_PROCESS].timings, name) for t, each in zip(spent, measured, strict=True)]
            cells.append(f"{statistics.median(spent):.3f}" + (f" ({statistics.median(more):+.3f})" if path != IN_PROCESS else ""))
        lines.append(f"| {path} | {' | '.join(cells)} |")
    return lines


if __name__ == "__main__":
    raise SystemExit(main())
