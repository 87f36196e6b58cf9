"""Runs inside Blender: renders one view of a .blend file with each engine and prints the seconds as one line of JSON.

    python benchmarks/blender_engines.py FILE.blend '{"position_m": [0, 0, 5], "bearing_deg": 0, "tilt_deg": -5, ...}'

Needs a Python with ``bpy``; EEVEE and Workbench also need OpenGL (on Debian without a GPU: libegl1, libgl1-mesa-dri).
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


def main() -> None:
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
        print("seconds " + json.dumps({name: _seconds(scene, engine)}), flush=True)


def _seconds(scene: bpy.types.Scene, engine: str) -> float | None:
    """Of a render after a tiny one, which compiles shaders and loads data; None where the engine does not run."""
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
