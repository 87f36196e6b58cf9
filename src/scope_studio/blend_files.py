"""Open a user's .blend file without running its scripts, and read its cameras."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import bpy
from mathutils import Vector

from scope_ptz.geometry.sphere import pan_tilt_deg
from scope_studio.kit.core.stage import Viewpoint

VERTICAL_TILT_DEG = 89.9
"""Tilt in degrees beyond which a camera's bearing is taken from its up vector, because its axis is almost vertical."""

NON_PERSPECTIVE_HFOV_DEG = 60.0
"""Horizontal field of view in degrees for orthographic and panoramic cameras, which are rendered in perspective."""


def open_file(path: str) -> tuple[dict[str, Any], tuple[Viewpoint, ...]]:
    """Open a .blend file with its scripts and script drivers disabled.

    Returns:
        A description of the file and its cameras as plain data, and the cameras as viewpoints. A camera's title is its name in the
        file, and its name is the title in kebab case.

    Raises:
        ValueError: The scene of the file has no camera.
    """
    preferences = bpy.context.preferences.filepaths
    preferences.use_scripts_auto_execute = False
    bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    bpy.context.preferences.filepaths.use_scripts_auto_execute = False
    scene = bpy.context.scene
    scene.render.use_multiview = False  # stereo rendering would change the names of image files
    scene.cycles.shading_system = False  # no OSL shader scripts
    bpy.context.view_layer.update()
    objects = sorted((o for o in scene.objects if o.type == "CAMERA"), key=lambda o: o.name)
    if not objects:
        raise ValueError(f"{path} has no camera. Add a camera to its scene in Blender and save the file")
    active = scene.camera if scene.camera in objects else objects[0]
    cameras = [_describe_camera(o, name, scene) for o, name in zip(objects, _kebab_names([o.name for o in objects]), strict=True)]
    description = {
        "name": _kebab(Path(path).stem),
        "title": Path(path).name,
        "blender_version": bpy.app.version_string,
        "active": cameras[objects.index(active)]["name"],
        "cameras": cameras,
    }
    return description, tuple(Viewpoint(c["name"], tuple(c["position_m"]), c["bearing_deg"], "") for c in cameras)


def set_time(time_s: float) -> None:
    """Set the animation to a time in seconds after the first frame."""
    scene = bpy.context.scene
    frame = scene.frame_start + time_s * scene.render.fps / scene.render.fps_base
    scene.frame_set(math.floor(frame), subframe=frame - math.floor(frame))


def _describe_camera(camera: bpy.types.Object, name: str, scene: bpy.types.Scene) -> dict[str, Any]:
    """Return the description of a camera as plain data."""
    matrix = camera.matrix_world
    axes = matrix.to_3x3().normalized()
    bearing, tilt = _pan_tilt(axes @ Vector((0.0, 0.0, -1.0)))
    if abs(tilt) > VERTICAL_TILT_DEG:
        bearing, _ = _pan_tilt((axes @ Vector((0.0, 1.0, 0.0))) * -math.copysign(1.0, tilt))
    return {
        "name": name,
        "title": camera.name,
        "position_m": list(matrix.translation),
        "bearing_deg": bearing,
        "tilt_deg": tilt,
        "hfov_deg": _hfov_deg(camera.data, scene.render),
    }


def _kebab(text: str) -> str:
    """Convert text to kebab case."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "camera"


def _kebab_names(titles: list[str]) -> list[str]:
    """Return a kebab-case name for each title. Duplicate names get a number."""
    names: list[str] = []
    for title in titles:
        name, number = _kebab(title), 2
        while name in names:
            name, number = f"{_kebab(title)}-{number}", number + 1
        names.append(name)
    return names


def _pan_tilt(direction: Vector) -> tuple[float, float]:
    """Return the bearing and tilt of a direction in degrees."""
    pan, tilt = pan_tilt_deg(tuple(direction))
    return float(pan), float(tilt)


def _hfov_deg(data: bpy.types.Camera, render: bpy.types.RenderSettings) -> float:
    """Return the horizontal field of view of a camera at the aspect ratio of the file's render settings."""
    if data.type != "PERSP":
        return NON_PERSPECTIVE_HFOV_DEG
    width, height = render.resolution_x * render.pixel_aspect_x, render.resolution_y * render.pixel_aspect_y
    if data.sensor_fit == "VERTICAL" or (data.sensor_fit == "AUTO" and height > width):
        angle = data.angle_y if data.sensor_fit == "VERTICAL" else data.angle
        return math.degrees(2 * math.atan(math.tan(angle / 2) * width / height))
    return math.degrees(data.angle_x)
