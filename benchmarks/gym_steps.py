"""Measure steps per second of the Gymnasium environments, compared with a bare re-projection of a frame.

    python benchmarks/gym_steps.py [--rounds 60] [--vector]

Each step is followed by a bare re-projection of the same view in the same size, so that other load on the machine affects both. The
ratio of the two is therefore steadier than steps per second. ``--vector`` also measures vectors; their times are per environment.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np

import scope_ptz.gym as scope_gym
from scope_ptz.geometry import AXIS_M5075_G, Perspective
from scope_ptz.gym.shared_scenes import shared_scene
from scope_ptz.simulator.reproject import colour_view

SCENE = "highway-works"
TASK = "scope1-highway-works-single-call-001"  # a task that pan, tilt and zoom alone can fulfil
UNLIMITED = 10**9
VECTOR_SIZE = 4


@dataclass(frozen=True)
class Case:
    """A configuration to measure: an environment, its frame size in pixels, and the actions."""

    label: str
    name: str
    size: tuple[int, int]
    options: dict[str, Any]
    action: Callable[[np.random.Generator], Any]


def main() -> int:
    """Measure the environments and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=60, help="measured steps of each environment (default: 60)")
    parser.add_argument("--vector", action="store_true", help="also measure vectors of environments")
    arguments = parser.parse_args()
    print(
        f"{SCENE}, {os.cpu_count()} cores, {arguments.rounds} steps each; medians, and the 10th to 90th percentile of the ratio\n"
    )
    print("| environment | frame | step | re-projection | steps per second | step / re-projection |")
    print("|---|---|---:|---:|---:|---:|")
    for case in _cases():
        print(_row(case, arguments.rounds), flush=True)
    if arguments.vector:
        for mode in ("sync", "async"):
            print(_vector_row(mode, arguments.rounds), flush=True)
    return 0


def _cases() -> list[Case]:
    search = {"scene": SCENE, "max_looks": UNLIMITED}
    task = {"task": TASK, "max_steps": UNLIMITED}
    small, middle, large = (320, 180), (640, 360), (1280, 720)
    return [
        *(Case("Search", "scope_ptz/Search-v0", size, search, _random_move) for size in (small, middle, large)),
        Case("Search, noisy detections", "scope_ptz/Search-v0", middle, {**search, "perception": "noisy"}, _random_move),
        Case(
            "Search, noisy detections, no frames", "scope_ptz/Search-v0", middle,
            {**search, "perception": "noisy", "frames": False}, _random_move,
        ),
        Case("TaskContinuous", "scope_ptz/TaskContinuous-v0", small, task, _random_move),
        Case("Task, adjust_ptz", "scope_ptz/Task-v0", small, task, _random_adjustment),
        Case("Task, count_objects", "scope_ptz/Task-v0", small, task, _count_cars),
    ]  # fmt: skip


def _random_move(rng: np.random.Generator) -> Any:
    return scope_gym.move_action(rng.uniform(-90, 90), rng.uniform(-10, 10), rng.uniform(0.7, 1.4))


def _random_adjustment(rng: np.random.Generator) -> Any:
    return scope_gym.tool_action(
        "adjust_ptz", pan_deg=rng.uniform(-90, 90), tilt_deg=rng.uniform(-10, 10), zoom_factor=rng.uniform(0.7, 1.4)
    )


def _count_cars(rng: np.random.Generator) -> Any:  # noqa: ARG001 - the signature of actions
    return scope_gym.tool_action("count_objects", description="cars")


def _row(case: Case, rounds: int) -> str:
    env = gymnasium.make(case.name, frame_size=case.size, disable_env_checker=True, **case.options)
    # The first pass decodes the layers of all views; the second takes the same steps.
    for _ in range(2):
        steps_s, bare_s = list[float](), list[float]()
        _, info = env.reset(seed=1)
        rng = np.random.default_rng(1)
        for _ in range(rounds):
            action = case.action(rng)
            start_s = time.perf_counter()
            observation, *_ = env.step(action)
            steps_s.append(time.perf_counter() - start_s)
            bare_s.append(_reprojection_s(info["viewpoint"], observation["pose"], case.size))
    env.close()
    return _table_row(case.label, case.size, steps_s, bare_s)


def _reprojection_s(viewpoint: str, pose: Any, size: tuple[int, int]) -> float:
    """Return the time in seconds of a bare re-projection at a pose."""
    pan, tilt, zoom = (float(v) for v in pose)
    view = Perspective(pan, tilt, AXIS_M5075_G.hfov_deg(zoom), *size)
    opened = shared_scene(SCENE).viewpoint(viewpoint)
    start_s = time.perf_counter()
    colour_view(opened, view)
    return time.perf_counter() - start_s


def _table_row(label: str, size: tuple[int, int], steps_s: list[float], bare_s: list[float]) -> str:
    """Return a row of the table from the times of steps, each of one environment, and of re-projections."""
    ratios = sorted(step / bare for step, bare in zip(steps_s, bare_s, strict=True))
    low, high = ratios[len(ratios) // 10], ratios[-1 - len(ratios) // 10]
    step_s, frame_s = statistics.median(steps_s), statistics.median(bare_s)
    return (
        f"| {label} | {size[0]}x{size[1]} | {step_s * 1e3:.1f} ms | {frame_s * 1e3:.1f} ms | {1 / step_s:.0f} | "
        f"{statistics.median(ratios):.1f} ({low:.1f} to {high:.1f}) |"
    )


def _vector_row(mode: str, rounds: int) -> str:
    """Measure a vector. Its processes are spawned, because a forked process inherits OpenCV's threads in an unknown state."""
    size = (320, 180)
    envs = gymnasium.make_vec(
        "scope_ptz.gym:scope_ptz/Search-v0", num_envs=VECTOR_SIZE, vectorization_mode=mode, scene=SCENE, max_looks=UNLIMITED,
        frame_size=size, vector_kwargs={"context": "spawn"} if mode == "async" else {},
    )  # fmt: skip
    scene = shared_scene(SCENE)  # keeps the scene open in this process, where re-projections are measured
    for _ in range(2):
        steps_s, bare_s = list[float](), list[float]()
        rng = np.random.default_rng(1)
        _, infos = envs.reset(seed=1)
        for _ in range(rounds):
            actions = np.stack([_random_move(rng) for _ in range(VECTOR_SIZE)])
            start_s = time.perf_counter()
            observations, *_ = envs.step(actions)
            steps_s.append((time.perf_counter() - start_s) / VECTOR_SIZE)
            bare_s.append(_reprojection_s(infos["viewpoint"][0], observations["pose"][0], size))
    envs.close()
    del scene
    return _table_row(f"Search, {VECTOR_SIZE} environments, {mode}", size, steps_s, bare_s)


if __name__ == "__main__":
    sys.exit(main())
