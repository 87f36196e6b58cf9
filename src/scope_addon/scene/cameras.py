"""Describe the cameras of the open scene, and store presets as cameras."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bpy
from mathutils import Matrix, Vector

from ..protocol.errors import AddOnError
from ..protocol.view import View, bearing_tilt_deg, parse_view

PRESET, DESCRIPTION, VIEWPOINT, VIEW_CAMERA = "scope_preset", "scope_description", "scope_viewpoint", "scope_view_camera"
"""Names of the custom properties of presets saved through SCOPE, and of the camera that SCOPE moves."""

COLLECTION = "SCOPE presets"
NON_PERSPECTIVE_HFOV_DEG = 60.0  # used for orthographic and panoramic cameras, which SCOPE shows in perspective
VIEWPOINT_TOLERANCE_M = 0.001  # a saved preset that is farther than this from its camera gets its own viewpoint


def describe(scene: Any) -> dict[str, Any]:
    """Describe a scene for the server: its cameras, the active camera, and the picture size.

    Raises:
        AddOnError: The scene has no camera.
    """
    objects = sorted((o for o in scene.objects if o.type == "CAMERA" and VIEW_CAMERA not in o), key=lambda o: o.name)
    own_cameras = [o for o in objects if PRESET not in o]
    if not own_cameras:
        raise AddOnError("The scene has no camera. Add one with Add > Camera, and press Connect again.")
    presets = {str(o[PRESET]): o for o in objects if PRESET in o}
    names = _kebab_names([o.name for o in own_cameras], set(presets))
    positions = {name: o.matrix_world.translation for name, o in zip(names, own_cameras, strict=True)}
    positions.update((name, o.matrix_world.translation) for name, o in presets.items() if VIEWPOINT not in o)
    active = previous_camera(scene)
    cameras = [_describe_camera(scene, o, name, o.name, None) for name, o in zip(names, own_cameras, strict=True)]
    for name, o in presets.items():
        viewpoint = o.get(VIEWPOINT)
        if viewpoint not in positions or (positions[viewpoint] - o.matrix_world.translation).length > VIEWPOINT_TOLERANCE_M:
            viewpoint = None
        cameras.append({**_describe_camera(scene, o, name, str(o.get(DESCRIPTION, "")), viewpoint), "saved": True})
    settings = scene.scope
    return {
        "name": _kebab(Path(bpy.data.filepath).stem) if bpy.data.filepath else "unsaved",
        "title": Path(bpy.data.filepath).name[:200] if bpy.data.filepath else "an unsaved file",
        "blender_version": bpy.app.version_string,
        "active": names[own_cameras.index(active)] if active in own_cameras else names[0],
        "cameras": cameras,
        "width": settings.width,
        "height": settings.height,
    }


def save_preset(scene: Any, arguments: Mapping[str, Any]) -> None:
    """Save a view as a preset: a camera in the scene. A preset of the same name is replaced."""
    name, description, view = str(arguments.get("name", "")), str(arguments.get("description", "")), parse_view(arguments)
    add_preset(scene, name, view, description, view.viewpoint)


def add_preset(scene: Any, name: str, view: View, description: str = "", viewpoint: str = "") -> None:
    """Add a preset, or replace it.

    Args:
        scene: The scene.
        name: The name of the preset.
        view: The view of the preset.
        description: A description; may be empty.
        viewpoint: The name of the camera with the same optical centre; empty if there is none.
    """
    camera = find_preset(scene, name)
    if camera is None:
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        _collection(scene).objects.link(camera)
    camera[PRESET], camera[DESCRIPTION] = name, description
    if viewpoint:
        camera[VIEWPOINT] = viewpoint
    elif VIEWPOINT in camera:
        del camera[VIEWPOINT]
    aim(camera, view)
    bpy.context.view_layer.update()


def remove_preset(scene: Any, name: str) -> None:
    """Remove a preset that was saved through SCOPE.

    Raises:
        AddOnError: There is no such preset.
    """
    camera = find_preset(scene, name)
    if camera is None:
        raise AddOnError(f"The scene has no preset '{name}' that was saved through SCOPE.")
    data = camera.data
    bpy.data.objects.remove(camera)
    if data.users == 0:
        bpy.data.cameras.remove(data)


def find_preset(scene: Any, name: str) -> Any:
    """Return the camera of a preset that was saved through SCOPE; None if there is none."""
    return next((o for o in scene.objects if o.type == "CAMERA" and o.get(PRESET) == name), None)


def aim(camera: Any, view: View) -> None:
    """Set a camera object to a view, with a perspective projection."""
    right, up, ahead = view.axes()
    axes = Matrix((right, up, tuple(-value for value in ahead))).transposed()
    camera.matrix_world = Matrix.Translation(view.position_m) @ axes.to_4x4()
    data = camera.data
    data.type, data.sensor_fit, data.shift_x, data.shift_y = "PERSP", "HORIZONTAL", 0.0, 0.0
    data.angle_x = math.radians(view.hfov_deg)


def view_through(scene: Any, camera: Any, viewpoint: str) -> View:
    """Return the view of a camera object."""
    bearing, tilt = _direction(camera.matrix_world)
    return View(viewpoint, tuple(camera.matrix_world.translation), bearing, tilt, _hfov_deg(camera.data, scene.render))


def viewport_view(region_3d: Any) -> View:
    """Return the view of a 3D viewport.

    Raises:
        AddOnError: The viewport is not in perspective.
    """
    if region_3d.view_perspective == "ORTHO":
        raise AddOnError("Switch the viewport to perspective (View > Perspective/Orthographic) to save its view as a preset.")
    matrix = region_3d.view_matrix.inverted()
    bearing, tilt = _direction(matrix)
    hfov_deg = math.degrees(2 * math.atan(1.0 / region_3d.window_matrix[0][0]))
    return View("", tuple(matrix.translation), bearing, tilt, hfov_deg)


def previous_camera(scene: Any) -> Any:
    """Return the scene's active camera, or the one that was active before SCOPE connected; None if there is none."""
    active = scene.camera
    if active is not None and VIEW_CAMERA in active:
        return scene.objects.get(str(active[VIEW_CAMERA]))
    return active


def _describe_camera(scene: Any, camera: Any, name: str, title: str, viewpoint: str | None) -> dict[str, Any]:
    view = view_through(scene, camera, name)
    return {
        "name": name,
        "title": title[:200],
        "position_m": list(view.position_m),
        "bearing_deg": view.bearing_deg,
        "tilt_deg": view.tilt_deg,
        "hfov_deg": view.hfov_deg,
        "viewpoint": viewpoint,
    }


def _direction(matrix: Any) -> tuple[float, float]:
    axes = matrix.to_3x3().normalized()
    return bearing_tilt_deg(tuple(axes @ Vector((0.0, 0.0, -1.0))), tuple(axes @ Vector((0.0, 1.0, 0.0))))


def _hfov_deg(data: Any, render: Any) -> float:
    """Return the horizontal field of view at the aspect ratio of the render settings, as for `blender:FILE.blend` cameras."""
    if data.type != "PERSP":
        return NON_PERSPECTIVE_HFOV_DEG
    width, height = render.resolution_x * render.pixel_aspect_x, render.resolution_y * render.pixel_aspect_y
    if data.sensor_fit == "VERTICAL" or (data.sensor_fit == "AUTO" and height > width):
        angle = data.angle_y if data.sensor_fit == "VERTICAL" else data.angle
        return math.degrees(2 * math.atan(math.tan(angle / 2) * width / height))
    return math.degrees(data.angle_x)


def _collection(scene: Any) -> Any:
    existing = scene.collection.children.get(COLLECTION)
    if existing is None:
        existing = bpy.data.collections.new(COLLECTION)
        scene.collection.children.link(existing)
    return existing


def _kebab(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "camera"


def _kebab_names(titles: list[str], taken: set[str]) -> list[str]:
    """Return a kebab-case name for each title, as for `blender:FILE.blend` cameras. Duplicate names get a number."""
    names: list[str] = []
    for title in titles:
        name, number = _kebab(title), 2
        while name in names or name in taken:
            name, number = f"{_kebab(title)}-{number}", number + 1
        names.append(name)
    return names
