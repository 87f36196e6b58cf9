"""Queries in ``ptz.cgi``: position, limits, presets, speed and attributes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from scope_ptz.geometry import Limits
from scope_ptz.virtual_camera.device import DevicePreset, VirtualDevice
from scope_ptz.virtual_camera.vapix import lens, replies, scales
from scope_ptz.virtual_camera.vapix.arguments import Arguments
from scope_ptz.virtual_camera.vapix.replies import Reply
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

GROUPS = ("zoom", "speed")  # the attribute groups that ``query=attributes`` can select

Attributes = Mapping[str, str | Sequence[Mapping[str, str]]]


def query(camera: VapixCamera, arguments: Arguments) -> Reply:
    """Handle ``query=...``.

    Raises:
        InputError: There is no such query.
    """
    return QUERIES[arguments.choice("query", tuple(QUERIES))](camera, arguments)


def _position(camera: VapixCamera, _: Arguments) -> Reply:
    pose = camera.device.pose()
    content = {
        "pan": f"{pose.pan_deg:.4f}",
        "tilt": f"{pose.tilt_deg:.4f}",
        "zoom": scales.zoom_step(pose.zoom, camera.device.limits),
        **lens.state(camera.device.lens),
    }
    return replies.values(content)


def limit_values(device: VirtualDevice) -> dict[str, object]:
    """Return the camera's limits by VAPIX name. Field angles are in tenths of a degree."""
    limits, optics = device.limits, device.optics
    return {
        "MinPan": f"{limits.min_pan_deg:g}",
        "MaxPan": f"{limits.max_pan_deg:g}",
        "MinTilt": f"{limits.min_tilt_deg:g}",
        "MaxTilt": f"{limits.max_tilt_deg:g}",
        "MinZoom": 1,
        "MaxZoom": scales.MAX_ZOOM_STEP,
        **lens.LIMITS,
        "MinFieldAngle": round(10 * optics.hfov_deg(limits.max_zoom)),
        "MaxFieldAngle": round(10 * optics.hfov_deg(limits.min_zoom)),
    }


def _limits(camera: VapixCamera, _: Arguments) -> Reply:
    return replies.values(limit_values(camera.device))


def _speed(camera: VapixCamera, _: Arguments) -> Reply:
    return replies.values({"speed": camera.speed})


def _presets(camera: VapixCamera, arguments: Arguments) -> Reply:
    return _preset_list(arguments, [f"presetposno{preset.number}={preset.name}" for preset in camera.device.presets()])


def preset_data(preset: DevicePreset, limits: Limits) -> str:
    """Return a preset's pose in the format of AXIS cameras: ``tilt=...:pan=...:zoom=...``."""
    pose = preset.pose
    return f"tilt={pose.tilt_deg:.6f}:pan={pose.pan_deg:.6f}:zoom={scales.zoom_step(pose.zoom, limits)}"


def _preset_positions(camera: VapixCamera, arguments: Arguments) -> Reply:
    limits = camera.device.limits
    rows = [f"presetposno{preset.number}={preset.name}:{preset_data(preset, limits)}" for preset in camera.device.presets()]
    return _preset_list(arguments, rows)


def _preset_list(arguments: Arguments, rows: list[str]) -> Reply:
    if arguments.text("format") == "json":
        return replies.document({"Camera 1": {"presets": rows}})
    return replies.lines(["Preset Positions for camera 1", *rows])


def _attributes(camera: VapixCamera, arguments: Arguments) -> Reply:
    groups = (arguments.choice("group", GROUPS),) if "group" in arguments else GROUPS
    attributes: dict[str, str | Sequence[Mapping[str, str]]] = {}
    if "zoom" in groups:
        attributes.update(_zoom_attributes(camera.device))
    if "speed" in groups:
        rows = scales.speed_table(camera.device.head.pan)
        attributes["speeds"] = [{"value": str(value), "speed": f"{speed:g}"} for value, speed in rows]
    if arguments.text("format") == "json":
        return replies.document({"Camera 1": attributes})
    return replies.lines(["Attributes for camera 1", *(f"{name}={_format_attribute(value)}" for name, value in attributes.items())])


def _zoom_attributes(device: VirtualDevice) -> Attributes:
    """Return the magnifications at both ends of the zoom range and at the positions in the optics' field-of-view table."""
    limits = device.limits
    inside = [zoom for zoom, _ in device.optics.table if limits.min_zoom <= zoom <= limits.max_zoom]
    steps = sorted({1, scales.MAX_ZOOM_STEP, *(scales.zoom_step(zoom, limits) for zoom in inside)})
    return {
        "maxOpticalZoomMag": f"{limits.max_zoom:g}",
        "zoomSteps": [{"value": str(step), "zoom": f"{scales.magnification(step, limits):.6f}"} for step in steps],
    }


def _format_attribute(value: Any) -> str:
    if isinstance(value, str):
        return value
    return ",".join(" | ".join(f"{name}={content}" for name, content in row.items()) for row in value)


QUERIES: dict[str, Callable[[VapixCamera, Arguments], Reply]] = {
    "position": _position,
    "limits": _limits,
    "speed": _speed,
    "presetposall": _presets,
    "presetposcam": _presets,
    "presetposcamdata": _preset_positions,
    "attributes": _attributes,
}
