"""Combine the cameras in a .blend file into one pan-tilt-zoom camera, in which each camera is a viewpoint with a preset."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from scope_ptz.geometry import Limits, Optics
from scope_ptz.simulator.models import SceneFile, ScenePreset, SceneViewpoint

MIN_ZOOM_RANGE = 5.0
"""Minimum ratio between the combined camera's highest and lowest zoom."""


@dataclass(frozen=True, slots=True)
class FileCameras:
    """The cameras in a .blend file, combined into one pan-tilt-zoom camera.

    Attributes:
        scene: The cameras as viewpoints, each with one preset; the active camera has the home preset. There are no instances.
        optics: The optics. Zoom 1 is the widest field of view among the cameras.
        limits: The limits. Pan is endless, tilt is -90 to 90 degrees, and the zoom range covers every camera's field of view.
    """

    scene: SceneFile
    optics: Optics
    limits: Limits


def file_cameras(description: dict[str, Any]) -> FileCameras:
    """Return the cameras in a .blend file, given the result of the worker's operation ``open_file``."""
    cameras = description["cameras"]
    widest_deg = max(camera["hfov_deg"] for camera in cameras)
    zooms = [_half_width(widest_deg) / _half_width(camera["hfov_deg"]) for camera in cameras]
    max_zoom = max(MIN_ZOOM_RANGE, *zooms)
    closest_deg = 2 * math.degrees(math.atan(_half_width(widest_deg) / max_zoom))
    presets = [
        ScenePreset(
            name=camera["name"], viewpoint=camera["name"], pan_deg=0.0, tilt_deg=camera["tilt_deg"], zoom=zoom,
            description=camera["title"],
        )
        for camera, zoom in zip(cameras, zooms, strict=True)
    ]  # fmt: skip
    viewpoints = [
        SceneViewpoint(name=camera["name"], position_m=camera["position_m"], pan0_bearing_deg=camera["bearing_deg"])
        for camera in cameras
    ]
    scene = SceneFile(
        name=description["name"], title=description["title"], version="live", blender_version=description["blender_version"],
        viewpoints=viewpoints, presets=presets, home_preset=description["active"], instances=[], texts=[],
    )  # fmt: skip
    limits = Limits(-180.0, 180.0, -90.0, 90.0, 1.0, max_zoom, pan_endless=True)
    return FileCameras(scene, Optics(((1.0, widest_deg), (max_zoom, closest_deg))), limits)


def _half_width(hfov_deg: float) -> float:
    """Return half the width of the area in view at distance 1."""
    return math.tan(math.radians(hfov_deg) / 2)
