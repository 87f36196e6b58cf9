"""The poses to which a calibration moves the camera."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.camera.base import CameraInfo
from scope_ptz.geometry import Limits, Pose, wrap_pan_deg

PAN_OFFSETS_DEG = (0.0, 60.0, -60.0, 120.0)
"""Pan offsets from the start pose in degrees, tried in order until one shows enough detail."""

SMALL_TURN, LARGE_TURN = 0.12, 0.35
"""Turns as fractions of the field of view: the small one gives the sign, the large one the focal length."""

TIMED_TURN_DEG = 20.0
"""Size in degrees of the timed pan turn."""


@dataclass(frozen=True, slots=True)
class CalibrationPlan:
    """The moves for a calibration.

    Attributes:
        camera: The camera's name.
        base: The pose from which the camera turns.
        pan_deg: The largest pan turn to either side in degrees, if the camera turns exactly as commanded.
        tilt_deg: The largest tilt turn in degrees; negative means down.
        zooms: The magnifications at which the field of view is measured.
    """

    camera: str
    base: Pose
    pan_deg: float
    tilt_deg: float
    zooms: tuple[float, ...]


def plan_calibration(info: CameraInfo, start: Pose, zooms: int) -> CalibrationPlan:
    """Plan the moves for a calibration.

    Args:
        info: The camera.
        start: Its current pose.
        zooms: Number of zoom levels at which the field of view is measured.
    """
    base = base_pose(info.limits, start, PAN_OFFSETS_DEG[0])
    turn_deg = LARGE_TURN * info.optics.hfov_deg(base.zoom)
    return CalibrationPlan(
        info.name,
        base,
        max(turn_deg, TIMED_TURN_DEG),
        vertical_turn_deg(info.limits, base, turn_deg / 2),
        zoom_levels(info.limits, zooms),
    )


def base_pose(limits: Limits, start: Pose, turn_deg: float) -> Pose:
    """Return a pose with room to turn in all directions, at the widest zoom and near the horizon."""
    margin_deg = min(40.0, (limits.max_pan_deg - limits.min_pan_deg) / 4)
    pan = wrap_pan_deg(start.pan_deg + turn_deg)
    if not limits.pan_endless:
        pan = min(max(pan, limits.min_pan_deg + margin_deg), limits.max_pan_deg - margin_deg)
    lowest, highest = max(-35.0, limits.min_tilt_deg), min(15.0, limits.max_tilt_deg)
    tilt = min(max(start.tilt_deg, lowest), highest) if lowest < highest else start.tilt_deg
    return Pose(pan, tilt, limits.min_zoom)


def vertical_turn_deg(limits: Limits, base: Pose, size_deg: float) -> float:
    """Return the tilt change in the direction with more room, at most ``size_deg``."""
    up, down = limits.max_tilt_deg - base.tilt_deg, base.tilt_deg - limits.min_tilt_deg
    return min(size_deg, up) if up > down else -min(size_deg, down)


def zoom_levels(limits: Limits, zooms: int) -> tuple[float, ...]:
    """Return geometrically spaced magnifications, from the widest to the closest zoom; only one if the lens cannot zoom."""
    ratio = limits.max_zoom / limits.min_zoom
    if ratio < 1.01:
        return (limits.min_zoom,)
    between = (limits.min_zoom * ratio ** (step / (zooms - 1)) for step in range(zooms - 1))
    return (*between, limits.max_zoom)
