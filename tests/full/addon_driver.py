"""Run the add-on inside Blender: build a scene, enable the add-on, and evaluate expressions from standard input.

The argument after ``--`` is the folder with the add-on's package. Without it, the installed add-on ``scope_addon`` is enabled. Each
line of the input is an expression, whose value is printed as JSON. The names ``bpy``, ``math``, ``session``, ``wake``, ``scene``,
``cameras``, ``addon`` and ``run`` are defined. Blender ends when its input is closed. With a window, Blender's own timers work;
without one, this script calls the timer's function.
"""

import importlib
import json
import math
import queue
import sys
import threading
import time
from typing import Any

import bpy

LINES: "queue.SimpleQueue[str]" = queue.SimpleQueue()


def build() -> None:
    """Build a scene: a floor, a red box to the north, cones around, and two cameras."""
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_plane_add(size=80)
    paint(bpy.context.object, "floor", (0.35, 0.4, 0.32, 1))
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 8, 1))
    paint(bpy.context.object, "box", (0.8, 0.03, 0.02, 1))
    for k in range(12):
        bpy.ops.mesh.primitive_cone_add(radius1=1, depth=3, location=(14 * math.sin(k / 2 + 0.3), 14 * math.cos(k / 2 + 0.3), 1.5))
        paint(bpy.context.object, f"cone {k}", (0.9, 0.25 + k / 24, 0.05, 1) if k % 2 else (0.1, 0.3, 0.9 - k / 24, 1))
    light = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    light.data.energy = 3
    light.rotation_euler = (0.8, 0.3, 0)
    scene.collection.objects.link(light)
    for name, place, turn, lens in (("Main Gate", (0, 0, 2), (90, 0, 0), 24), ("roof", (0, -8, 12), (60, 0, 0), 35)):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        camera.data.lens = lens
        camera.location, camera.rotation_euler = place, [math.radians(a) for a in turn]
        scene.collection.objects.link(camera)
    scene.camera = bpy.data.objects["Main Gate"]
    scene.display.shading.color_type = "OBJECT"
    bpy.context.view_layer.update()


def paint(item: Any, name: str, colour: tuple[float, ...]) -> None:
    """Give an object a colour, in solid shading and in renders."""
    item.name, item.color = name, colour
    material = bpy.data.materials.new(name)
    material.diffuse_color = colour
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = colour
    item.data.materials.append(material)


def read_lines() -> None:
    """Read the input in a thread, because Blender's main thread must not wait for it."""
    for line in sys.stdin:
        LINES.put(line)
    LINES.put("")


def evaluate_lines(names: dict[str, Any]) -> bool:
    """Evaluate the lines that have arrived. Return whether the input is still open."""
    while not LINES.empty():
        line = LINES.get()
        if not line:
            return False
        names["scene"] = bpy.context.scene  # another file may have been opened
        try:
            reply = {"value": eval(line, names)}  # noqa: S307 - the test's own expressions
        except Exception as error:
            reply = {"error": f"{type(error).__name__}: {error}"}
        emit("reply", reply)
    return True


def finish(addon: Any) -> None:
    """Remove the add-on, and print the cameras that remain in the scene."""
    addon.unregister()
    scene = bpy.context.scene
    found = sorted(item.name for item in scene.objects if item.type == "CAMERA")
    emit("end", {"cameras": found, "active": scene.camera.name})


def emit(kind: str, content: object) -> None:
    """Print a line that the test reads."""
    sys.stdout.write(f"@{kind} {json.dumps(content, default=str)}\n")
    sys.stdout.flush()


def view() -> Any:
    """Return the context of the first 3D viewport, for ``with``."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window, area=area, region=region)


def run(operator: str, **values: Any) -> list[str]:
    """Call an operator of the add-on in the 3D viewport, as a button does."""
    with view():
        return list(getattr(bpy.ops.scope, operator)("EXEC_DEFAULT", **values))


def main() -> None:
    sys.path[:0] = sys.argv[sys.argv.index("--") + 1 :]
    build()
    bpy.context.preferences.view.show_splash = False
    bpy.ops.preferences.addon_enable(module="scope_addon")
    addon, module = (importlib.import_module(f"scope_addon{name}") for name in ("", ".ui.session"))
    names = {"bpy": bpy, "session": module.session, "wake": module.wake, "addon": addon, "run": run}
    names |= {"cameras": importlib.import_module("scope_addon.scene.cameras"), "math": math}
    threading.Thread(target=read_lines, daemon=True).start()
    emit("reply", {"value": bpy.app.version_string})
    if not bpy.app.background:

        def work() -> float | None:
            if evaluate_lines(names):
                return 0.02
            finish(addon)
            bpy.ops.wm.quit_blender()
            return None

        bpy.app.timers.register(work, first_interval=0.5)
        return
    while evaluate_lines(names):
        time.sleep(module.session.tick() or 0.02)
    finish(addon)


main()
