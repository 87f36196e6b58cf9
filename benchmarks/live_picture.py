"""Time frames with moving actors as multiples of a bare ``cv2.remap``, and the stalls and memory of a prefetched viewpoint.

    python benchmarks/live_picture.py [--scene SCENE] [--frames 30] [--zooms 1,1.5,2,3,5] [--cache-mb 96] [--memory]

For each viewpoint and zoom, the pose and the moment with the most actors in view are found; four where that is possible. The
camera then turns slowly while the actors move at 25 frames a second. Views and bare look-ups of the same size take turns.
"""

from __future__ import annotations

import argparse
import math
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np

from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, pan_tilt_deg
from scope_ptz.simulator.actors import composited_actors
from scope_ptz.simulator.drawing import actor_patch
from scope_ptz.simulator.pack import Scene, list_scenes, load_scene
from scope_ptz.simulator.prefetch import Prefetch
from scope_ptz.simulator.reproject import view_map
from scope_ptz.simulator.viewpoint import Viewpoint
from scope_ptz.simulator.views import picture

WIDTH, HEIGHT = 1280, 720
FRAMES_PER_S = 25
MOST_ACTORS = 4
STALL_MS = 40.0
TOUR_FRAMES = 600


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", action="append", help="scenes (default: all in the package)")
    parser.add_argument("--frames", type=int, default=30, help="frames per viewpoint and zoom (default: 30)")
    parser.add_argument("--zooms", default="1,1.5,2,3,5", help="zooms (default: 1,1.5,2,3,5)")
    parser.add_argument("--memory", action="store_true", help="also measure prefetching, each viewpoint in a process of its own")
    parser.add_argument("--cache-mb", type=int, default=96, help="tile cache for the bounded measurement (default: 96)")
    parser.add_argument("--tour", nargs=3, metavar=("SCENE", "VIEWPOINT", "CACHE_MB"), help="only one prefetched tour")
    parser.add_argument("--threads", type=int, default=cv2.getNumThreads(), help="OpenCV threads")
    parser.add_argument("--cpu", action="store_true", help="measure processor time, for busy machines; use --threads 1")
    arguments = parser.parse_args()
    cv2.setNumThreads(arguments.threads)
    if arguments.tour:
        _tour(arguments.tour[0], arguments.tour[1], int(arguments.tour[2]))
        return 0
    clock = time.thread_time if arguments.cpu else time.perf_counter
    zooms = [float(z) for z in arguments.zooms.split(",")]
    print(f"{WIDTH}x{HEIGHT}, {cv2.getNumThreads()} OpenCV threads; times as multiples of a bare cv2.remap, and in ms")
    every: list[tuple[float, float]] = []
    for name in arguments.scene or list_scenes():
        scene = load_scene(name)
        for place in scene.file.viewpoints:
            for zoom in zooms:
                every += _report(scene, place.name, zoom, arguments.frames, clock)
            scene.release()
    print("all views: " + _summary(every))
    if arguments.memory:
        for name in arguments.scene or list_scenes():
            for place in load_scene(name).file.viewpoints:
                for cache_mb in (0, arguments.cache_mb):
                    _report_prefetch(name, place.name, cache_mb)
    return 0


def _report(scene: Scene, viewpoint: str, zoom: float, frames: int, clock: Callable[[], float]) -> list[tuple[float, float]]:
    """Print and return (milliseconds of a picture, milliseconds of a bare look-up) of each frame."""
    here = scene.viewpoint(viewpoint)
    pose, start_s, actors = _busiest(scene, here, zoom)
    sheet = here.colour_atlas.sheet
    times = []
    for k, view in enumerate(_turning(pose, frames + 3)):
        picture(scene, viewpoint, view, start_s + k / FRAMES_PER_S)  # so that everything is in memory, as after prefetching
    for k, view in enumerate(_turning(pose, frames + 3)):
        where = np.ascontiguousarray(view_map(here, here.colour_atlas, view))
        began = clock()
        cv2.remap(sheet, where, None, cv2.INTER_LINEAR)
        between = clock()
        picture(scene, viewpoint, view, start_s + k / FRAMES_PER_S)
        bare, ours = (between - began) * 1e3, (clock() - between) * 1e3
        if k >= 3:
            times.append((ours, bare))
    print(f"{scene.name:>15} {viewpoint:<10} {zoom:3g}x, {actors} actors: {_summary(times)}", flush=True)
    return times


def _summary(times: list[tuple[float, float]]) -> str:
    bare = statistics.median(b for _, b in times)
    ours = np.array([a for a, _ in times])
    median, p99 = float(np.median(ours)), float(np.quantile(ours, 0.99))
    return f"bare {bare:5.1f} ms, median {median:5.1f} ms = {median / bare:4.2f}x, p99 {p99:5.1f} ms = {p99 / bare:4.2f}x"


def _view(pose: Pose) -> Perspective:
    return Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), WIDTH, HEIGHT)


def _turning(pose: Pose, frames: int) -> Iterator[Perspective]:
    for k in range(frames):
        yield _view(Limits().clamp(pose.turned(pan_deg=0.05 * k))[0])


def _busiest(scene: Scene, here: Viewpoint, zoom: float) -> tuple[Pose, float, int]:
    """Return the pose and moment at which the most actors show, and how many do."""
    best, found = (Pose(0.0, -10.0, zoom), 0.0, 0), 0
    for time_s in np.arange(0.0, 60.0, 1.5):
        actors = composited_actors(scene, here, float(time_s))
        directions = [a.offset_m / np.linalg.norm(a.offset_m) for a in actors]
        for k in range(len(actors)):
            for other in range(k, len(actors)):
                pan, tilt = (float(v) for v in pan_tilt_deg(directions[k] + directions[other]))
                pose = Limits().clamp(Pose(pan, tilt, zoom))[0]
                points = _view(pose).points(np.array(directions))
                inside = int(np.all((points > 0.02) & (points < 0.98), axis=-1).sum())
                if inside > found:
                    shown = sum(actor_patch(here, _view(pose), actor) is not None for actor in actors)
                    if shown > best[2]:
                        best, found = (pose, float(time_s), shown), inside
                if best[2] >= MOST_ACTORS:
                    return best
    return best


def _tour(name: str, viewpoint: str, cache_mb: int) -> None:
    """Prefetch a viewpoint, tour it, and print time, memory and the longest frames. For a process of its own."""
    scene = load_scene(name, tile_bytes=cache_mb * 1_000_000 or None)
    here = scene.viewpoint(viewpoint)
    start, start_cpu = time.perf_counter(), time.process_time()
    Prefetch(here, WIDTH).wait()
    took_s, took_cpu_s = time.perf_counter() - start, time.process_time() - start_cpu
    times, cpu_times = [], []
    for k in range(TOUR_FRAMES):
        share = k / TOUR_FRAMES
        pan, zoom = (share * 5 * 360.0) % 358.0 - 179.0, 1.0 + 4.0 * abs(math.sin(7 * share * math.pi))
        began, began_cpu = time.perf_counter(), time.process_time()
        picture(scene, viewpoint, _view(Pose(pan, -12.0 + 10.0 * math.sin(40 * share), zoom)), k / FRAMES_PER_S)
        times.append((time.perf_counter() - began) * 1e3)
        cpu_times.append((time.process_time() - began_cpu) * 1e3)
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
    now_mb = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6
    stalls = sum(t > STALL_MS for t in times)
    print(
        f"{name:>15} {viewpoint:<10} {f'{cache_mb} MB of tiles' if cache_mb else 'all tiles':>14}: prefetched in {took_s:4.1f} s "
        f"({took_cpu_s:4.1f} s of processor time), then {now_mb:4.0f} MB, peak {peak_mb:4.0f} MB; longest of {TOUR_FRAMES} frames "
        f"{max(times):5.1f} ms ({max(cpu_times):5.1f} ms of processor time), {stalls} above {STALL_MS:g} ms"
    )


def _report_prefetch(scene: str, viewpoint: str, cache_mb: int) -> None:
    command = [sys.executable, __file__, "--tour", scene, viewpoint, str(cache_mb)]
    print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.rstrip(), flush=True)


if __name__ == "__main__":
    sys.exit(main())
