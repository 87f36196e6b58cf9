"""Render one view of a .blend file with each of Blender's engines, and print the render time of each as a line of JSON.

    python benchmarks/blender_engines.py FILE.blend '{"position_m": [0, 0, 5], "bearing_deg": 0, "tilt_deg": -5, ...}'

The script requires a Python with ``bpy``. EEVEE and Workbench also require OpenGL (on Debian without a GPU: libegl1,
libgl1-mesa-dri).
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
from pathlib import Path

import bpy

ENGINES = {"Workbench": "BLENDER_WORKBENCH", "Cycles": "CYCLES", "EEVEE": "BLENDER_EEVEE"}
WARM_UP_PERCENT = 5
"""Resolution of the warm-up render, as a percentage of the full resolution."""


def main() -> None:
    """Open the file, place the camera, and time each engine."""
    blend, view = sys.argv[-2], json.loads(sys.argv[-1])
    bpy.ops.wm.open_mainfile(filepath=blend, use_scripts=False)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("benchmark", bpy.data.cameras.new("benchmark"))
    scene.collection.objects.link(camera)
    camera.data.angle_x = math.radians(view["hfov_deg"])
    camera.data.clip_end = 1e5
    camera.location = view["position_m"]
    camera.rotation_euler = (math.radians(90.0 + view["tilt_deg"]), 0.0, -math.radians(view["bearing_deg"]))
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = view["width"], view["height"], 100
    scene.cycles.samples, scene.cycles.use_denoising = 16, True
    for name, engine in ENGINES.items():
        print("seconds " + json.dumps({name: _render_seconds(scene, engine)}), flush=True)


def _render_seconds(scene: bpy.types.Scene, engine: str) -> float | None:
    """Return the render time of an engine in seconds, or None if the engine does not run on this machine.

    A small warm-up render, which is not measured, compiles the shaders and loads the data.
    """
    scene.render.engine = engine
    scene.render.use_persistent_data = True
    start = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for percent in (WARM_UP_PERCENT, 100):
            out = Path(folder) / f"{percent}.png"
            scene.render.filepath = str(out)
            scene.render.resolution_percentage = percent
            start = time.perf_counter()
            try:
                bpy.ops.render.render(write_still=True)
            except RuntimeError:
                return None
            if not out.exists():
                return None
    return time.perf_counter() - start


main()
