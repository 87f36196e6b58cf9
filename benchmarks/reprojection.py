"""Measure the time for computing a view of a pack, relative to a ``cv2.remap`` of the same size with precomputed maps.

    python benchmarks/reprojection.py [--scene highway-works] [--search FOLDER] [--blender-python PYTHON]

With ``--blender-python``, one view of each viewpoint is also rendered with Blender's engines for comparison.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np

from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.environment import worker_command
from scope_ptz.geometry import AXIS_M5075_G, Perspective, Pose
from scope_ptz.simulator.pack import Scene, find_scenes
from scope_ptz.simulator.reproject import colour_view, view_map
from scope_ptz.simulator.truth import view_truth
from scope_ptz.simulator.viewpoint import Viewpoint

WIDTH, HEIGHT = 1280, 720
ROUNDS = 40


def main() -> int:
    """Measure the views of all viewpoints of a scene and print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="highway-works", help="scene to measure (default: highway-works)")
    parser.add_argument("--search", type=Path, action="append", default=[], help="additional folder of scenes; repeatable")
    parser.add_argument("--blender-python", type=Path, help="Python with bpy, for comparison with Blender's engines")
    parser.add_argument("--source", help="scene module or Python file from which to build the scene (default: the scene's module)")
    parser.add_argument("--threads", type=int, default=cv2.getNumThreads(), help="number of OpenCV threads")
    arguments = parser.parse_args()
    cv2.setNumThreads(arguments.threads)
    folders = find_scenes(arguments.search)
    if arguments.scene not in folders:
        print(f"No scene '{arguments.scene}'. Known scenes: {', '.join(folders) or 'none'}.", file=sys.stderr)
        return 2
    scene = Scene(folders[arguments.scene])
    print(
        f"{scene.name}, {WIDTH}x{HEIGHT}, {cv2.getNumThreads()} OpenCV threads, {ROUNDS} rounds; median (10th to 90th percentile)"
    )
    for place in scene.file.viewpoints:
        viewpoint = scene.viewpoint(place.name)
        for name, pose in _poses(viewpoint).items():
            _report(scene, viewpoint, name, pose)
    if arguments.blender_python:
        _report_engines(scene, arguments.source or scene.name, arguments.blender_python)
    return 0


def _poses(viewpoint: Viewpoint) -> dict[str, Pose]:
    """Return the poses to measure by name: some without tiles, and three zooms at a tile if the viewpoint has tiles."""
    poses = {"panorama only": Pose(0.0, -5.0, 1.0), "nadir": Pose(0.0, -60.0, 1.0), "seam": Pose(179.0, -20.0, 1.0)}
    closest = Perspective(0.0, 0.0, AXIS_M5075_G.hfov_deg(5.0), WIDTH, HEIGHT)
    if tiles := [tile for tile in viewpoint.manifest.tiles if tile.suits(closest)]:
        middle = tiles[len(tiles) // 2]
        poses |= {f"tiles {zoom:g}x": Pose(middle.pan_deg, middle.tilt_deg, zoom) for zoom in (2.0, 3.0, 5.0)}
    return poses


def _report(scene: Scene, viewpoint: Viewpoint, name: str, pose: Pose) -> None:
    view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), WIDTH, HEIGHT)
    sheet = viewpoint.colour_atlas.sheet
    floats = np.ascontiguousarray(view_map(viewpoint, viewpoint.colour_atlas, view))
    fixed = cv2.convertMaps(floats, None, cv2.CV_16SC2)
    view_truth(scene, viewpoint.name, view, 0.0)
    times = _interleaved(
        {
            "view": lambda: colour_view(viewpoint, view),
            "float": lambda: cv2.remap(sheet, floats, None, cv2.INTER_LINEAR),
            "fixed": lambda: cv2.remap(sheet, *fixed, cv2.INTER_LINEAR),
        }
    )
    # Measured separately, because it evicts data from the CPU caches and would slow down the next call.
    times |= _interleaved({"truth": lambda: view_truth(scene, viewpoint.name, view, 0.0)})
    print(
        f"{viewpoint.name:>14} {name:<14} view {_ms(times['view'])}  = {_ratio(times, 'float')} of a remap with float maps, "
        f"{_ratio(times, 'fixed')} with fixed-point maps; truth {_ms(times['truth'])}"
    )


def _report_engines(scene: Scene, source: str, python: Path) -> None:
    with TemporaryDirectory() as folder:
        blend = Path(folder) / "scene.blend"
        with BlenderWorker(worker_command(Path(folder), python), Path(folder) / "blender.log") as worker:
            worker.request("load_scene", {"source": source})
            worker.request("save", {"path": str(blend)})
        for place in scene.file.viewpoints:
            viewpoint = scene.viewpoint(place.name)
            view = Perspective(0.0, -5.0, AXIS_M5075_G.hfov_deg(1.0), WIDTH, HEIGHT)
            view_s = statistics.median(_interleaved({"view": partial(colour_view, viewpoint, view)})["view"])
            request = {
                "position_m": place.position_m,
                "bearing_deg": place.pan0_bearing_deg,
                "tilt_deg": view.tilt_deg,
                "hfov_deg": view.hfov_deg,
                "width": WIDTH,
                "height": HEIGHT,
            }
            command = [str(python), str(Path(__file__).with_name("blender_engines.py")), str(blend), json.dumps(request)]
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as engines:
                for line in engines.stdout or ():
                    if line.startswith("seconds "):
                        for engine, engine_s in json.loads(line.removeprefix("seconds ")).items():
                            result = (
                                "cannot run on this machine"
                                if engine_s is None
                                else f"{engine_s:7.2f} s = {engine_s / view_s:,.0f} views"
                            )
                            print(f"{place.name:>14} {engine:<14} {result}", flush=True)


def _interleaved(calls: dict[str, Callable[[], object]]) -> dict[str, list[float]]:
    """Return the seconds of each call in each round. Calls alternate, so that other load on the machine affects all equally.

    Each round begins with a different call, because later calls benefit from images that are already in the CPU caches.
    """
    times: dict[str, list[float]] = {name: [] for name in calls}
    names = list(calls)
    for round_number in range(ROUNDS + 3):
        first = round_number % len(names)
        for name in names[first:] + names[:first]:
            start = time.perf_counter()
            calls[name]()
            if round_number >= 3:
                times[name].append(time.perf_counter() - start)
    return times


def _ratio(times: dict[str, list[float]], reference: str) -> str:
    """Return the median ratio of view times to reference times, with the 10th and 90th percentile, as text."""
    ratios = sorted(a / b for a, b in zip(times["view"], times[reference], strict=True))
    return f"{statistics.median(ratios):.2f}x ({ratios[len(ratios) // 10]:.2f} to {ratios[-1 - len(ratios) // 10]:.2f})"


def _ms(seconds: list[float]) -> str:
    return f"{statistics.median(seconds) * 1e3:6.2f} ms"


if __name__ == "__main__":
    sys.exit(main())
