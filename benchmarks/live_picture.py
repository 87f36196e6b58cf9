"""Measure the rendering time of frames with moving actors, in multiples of a bare ``cv2.remap``.

    python benchmarks/live_picture.py [--scene SCENE] [--frames 30] [--zooms 1,1.5,2,3,5] [--still] [--cache-mb 96] [--memory]

For each viewpoint and zoom, the benchmark finds a pose and a moment at which four actors are in view, or as many as possible. The
camera then turns slowly at 25 frames per second while the actors move. With ``--still``, the camera does not turn. Frames
alternate with bare remaps of the same size.

With ``--memory``, the benchmark also measures the time and memory of prefetching a viewpoint, and the stalls after it.
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
MAX_ACTORS = 4
"""The search for a pose ends when this number of actors is in view."""
TURN_DEG = 0.05
"""Angle in degrees by which the camera turns between two frames."""
STALL_MS = 40.0
"""Rendering time in milliseconds above which a frame counts as a stall."""
TOUR_FRAMES = 600
"""Number of frames of a tour around a prefetched viewpoint."""


def main() -> int:
    """Measure the selected scenes and print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", action="append", help="scene to measure; repeatable (default: all scenes of the package)")
    parser.add_argument("--frames", type=int, default=30, help="frames per viewpoint and zoom (default: 30)")
    parser.add_argument("--zooms", default="1,1.5,2,3,5", help="zooms, separated by commas (default: 1,1.5,2,3,5)")
    parser.add_argument("--still", action="store_true", help="measure a camera that stands still instead of one that turns")
    parser.add_argument("--memory", action="store_true", help="also measure prefetching, with a separate process per viewpoint")
    parser.add_argument("--cache-mb", type=int, default=96, help="size of the bounded tile cache for --memory (default: 96)")
    parser.add_argument("--tour", nargs=3, metavar=("SCENE", "VIEWPOINT", "CACHE_MB"), help="measure only one prefetched viewpoint")
    parser.add_argument("--threads", type=int, default=cv2.getNumThreads(), help="number of OpenCV threads")
    parser.add_argument("--cpu", action="store_true", help="measure the CPU time of all threads instead, for busy machines")
    arguments = parser.parse_args()
    cv2.setNumThreads(arguments.threads)
    if arguments.tour:
        _tour(arguments.tour[0], arguments.tour[1], int(arguments.tour[2]))
        return 0
    clock = time.process_time if arguments.cpu else time.perf_counter
    zooms = [float(z) for z in arguments.zooms.split(",")]
    print(f"{WIDTH}x{HEIGHT}, {cv2.getNumThreads()} OpenCV threads; times as multiples of a bare cv2.remap, and in ms")
    all_times: list[tuple[float, float]] = []
    for name in arguments.scene or list_scenes():
        scene = load_scene(name)
        for viewpoint in scene.file.viewpoints:
            for zoom in zooms:
                all_times += _report(scene, viewpoint.name, zoom, arguments.frames, clock, 0.0 if arguments.still else TURN_DEG)
            scene.release()
    print("all views: " + _summary(all_times))
    if arguments.memory:
        for name in arguments.scene or list_scenes():
            for viewpoint in load_scene(name).file.viewpoints:
                for cache_mb in (0, arguments.cache_mb):
                    _report_prefetch(name, viewpoint.name, cache_mb)
    return 0


def _report(
    scene: Scene, viewpoint: str, zoom: float, frames: int, clock: Callable[[], float], turn_deg: float
) -> list[tuple[float, float]]:
    """Print a summary of the times of one view, and return (milliseconds of the frame, milliseconds of the remap) of each frame."""
    pack = scene.viewpoint(viewpoint)
    pose, start_s, actors = _busiest_view(scene, pack, zoom)
    sheet = pack.colour_atlas.sheet
    times = []
    for k, view in enumerate(_turning_views(pose, frames + 3, turn_deg)):
        picture(scene, viewpoint, view, start_s + k / FRAMES_PER_S)  # Load everything into memory, as prefetching does.
    for k, view in enumerate(_turning_views(pose, frames + 3, turn_deg)):
        maps = np.ascontiguousarray(view_map(pack, pack.colour_atlas, view))
        start = clock()
        cv2.remap(sheet, maps, None, cv2.INTER_LINEAR)
        middle = clock()
        picture(scene, viewpoint, view, start_s + k / FRAMES_PER_S)
        remap_ms, frame_ms = (middle - start) * 1e3, (clock() - middle) * 1e3
        if k >= 3:
            times.append((frame_ms, remap_ms))
    print(f"{scene.name:>15} {viewpoint:<10} {zoom:3g}x, {actors} actors: {_summary(times)}", flush=True)
    return times


def _summary(times: list[tuple[float, float]]) -> str:
    """Format the median time of a remap, and the median and 99th percentile of the frame times."""
    remap_ms = statistics.median(remap for _, remap in times)
    frames_ms = np.array([frame for frame, _ in times])
    median, p99 = float(np.median(frames_ms)), float(np.quantile(frames_ms, 0.99))
    return (
        f"remap {remap_ms:5.1f} ms, median {median:5.1f} ms = {median / remap_ms:4.2f}x, p99 {p99:5.1f} ms = {p99 / remap_ms:4.2f}x"
    )


def _view(pose: Pose) -> Perspective:
    return Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), WIDTH, HEIGHT)


def _turning_views(pose: Pose, frames: int, turn_deg: float = TURN_DEG) -> Iterator[Perspective]:
    """Yield the views of a camera that turns right by ``turn_deg`` per frame."""
    for k in range(frames):
        yield _view(Limits().clamp(pose.turned(pan_deg=turn_deg * k))[0])


def _busiest_view(scene: Scene, viewpoint: Viewpoint, zoom: float) -> tuple[Pose, float, int]:
    """Return the pose and the scene time at which the most actors are in view, and the number of these actors."""
    best, most_inside = (Pose(0.0, -10.0, zoom), 0.0, 0), 0
    for time_s in np.arange(0.0, 60.0, 1.5):
        actors = composited_actors(scene, viewpoint, float(time_s))
        directions = [a.offset_m / np.linalg.norm(a.offset_m) for a in actors]
        for k in range(len(actors)):
            for other in range(k, len(actors)):
                pan, tilt = (float(v) for v in pan_tilt_deg(directions[k] + directions[other]))
                pose = Limits().clamp(Pose(pan, tilt, zoom))[0]
                points = _view(pose).points(np.array(directions))
                inside = int(np.all((points > 0.02) & (points < 0.98), axis=-1).sum())
                if inside > most_inside:
                    visible = sum(actor_patch(viewpoint, _view(pose), actor) is not None for actor in actors)
                    if visible > best[2]:
                        best, most_inside = (pose, float(time_s), visible), inside
                if best[2] >= MAX_ACTORS:
                    return best
    return best


def _tour(name: str, viewpoint: str, cache_mb: int) -> None:
    """Prefetch a viewpoint, render a tour around it, and print times and memory.

    Run this function in a separate process, because it measures the memory of the whole process.
    """
    scene = load_scene(name, tile_bytes=cache_mb * 1_000_000 or None)
    start, start_cpu = time.perf_counter(), time.process_time()
    Prefetch(scene.viewpoint(viewpoint), WIDTH).wait()
    prefetch_s, prefetch_cpu_s = time.perf_counter() - start, time.process_time() - start_cpu
    prefetched_mb = _resident_mb()
    times, cpu_times = [], []
    for k in range(TOUR_FRAMES):
        progress = k / TOUR_FRAMES
        pan, zoom = (progress * 5 * 360.0) % 358.0 - 179.0, 1.0 + 4.0 * abs(math.sin(7 * progress * math.pi))
        start, start_cpu = time.perf_counter(), time.process_time()
        picture(scene, viewpoint, _view(Pose(pan, -12.0 + 10.0 * math.sin(40 * progress), zoom)), k / FRAMES_PER_S)
        times.append((time.perf_counter() - start) * 1e3)
        cpu_times.append((time.process_time() - start_cpu) * 1e3)
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    stalls = sum(t > STALL_MS for t in times)
    print(
        f"{name:>15} {viewpoint:<10} {f'{cache_mb} MB of tiles' if cache_mb else 'all tiles':>14}: prefetched in "
        f"{prefetch_s:4.1f} s ({prefetch_cpu_s:4.1f} s of processor time) with {prefetched_mb:4.0f} MB; after {TOUR_FRAMES} frames "
        f"{_resident_mb():4.0f} MB, peak {peak_mb:4.0f} MB; longest frame {max(times):5.1f} ms "
        f"({max(cpu_times):5.1f} ms of processor time), {stalls} above {STALL_MS:g} ms"
    )


def _resident_mb() -> float:
    """Return the resident memory of this process in MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6


def _report_prefetch(scene: str, viewpoint: str, cache_mb: int) -> None:
    """Run ``_tour`` in a separate process and print its output."""
    command = [sys.executable, __file__, "--tour", scene, viewpoint, str(cache_mb)]
    print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.rstrip(), flush=True)


if __name__ == "__main__":
    sys.exit(main())
