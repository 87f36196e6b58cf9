"""Calculations with velocities, poses and axes for a guarded camera."""

from __future__ import annotations

import math
from typing import Any

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.geometry import Axis, Pose


def velocity_fields(velocity: Velocity) -> dict[str, float]:
    """Return a velocity as a dictionary."""
    return {"pan_dps": velocity.pan_dps, "tilt_dps": velocity.tilt_dps, "zoom_rate": velocity.zoom_rate}


def cap_velocity(velocity: Velocity, top: Velocity) -> Velocity:
    """Return the velocity capped at the top speed of each axis."""

    def cap(speed: float, limit: float) -> float:
        return math.copysign(min(abs(speed), limit), speed)

    return Velocity(
        cap(velocity.pan_dps, top.pan_dps), cap(velocity.tilt_dps, top.tilt_dps), cap(velocity.zoom_rate, top.zoom_rate)
    )


def scale_velocity(velocity: Velocity, factor: float) -> Velocity:
    """Return the velocity scaled by a factor."""
    return Velocity(velocity.pan_dps * factor, velocity.tilt_dps * factor, velocity.zoom_rate * factor)


def pose_after(pose: Pose, velocity: Velocity, seconds: float) -> Pose:
    """Return the pose after moving at a velocity for some time."""
    zoom = pose.zoom * 2.0 ** max(-10.0, min(10.0, velocity.zoom_rate * seconds))
    return Pose(pose.pan_deg + velocity.pan_dps * seconds, pose.tilt_deg + velocity.tilt_dps * seconds, zoom)


def axis_changes(start: Pose, end: Pose) -> tuple[tuple[Axis, bool], ...]:
    """Return pan and tilt, each with a flag for whether the two poses differ on that axis."""
    return ("pan", start.pan_deg != end.pan_deg), ("tilt", start.tilt_deg != end.tilt_deg)


def merge_axes(*axes: Any) -> tuple[Axis, ...]:
    """Return the union of several groups of axes, in the order pan, tilt, zoom."""
    merged = {axis for group in axes for axis in group}
    order: tuple[Axis, ...] = ("pan", "tilt", "zoom")
    return tuple(axis for axis in order if axis in merged)
