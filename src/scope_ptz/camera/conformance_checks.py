"""Helpers for the camera conformance suite: target poses and assertions."""

from __future__ import annotations

import math
from collections.abc import Awaitable

from scope_ptz.camera.base import CameraInfo
from scope_ptz.geometry import Pose, wrap_pan_deg


def target_poses(info: CameraInfo) -> list[Pose]:
    """Return four poses that are far apart. Pan and tilt are well within the limits, and zoom spans its range."""
    limits = info.limits
    fractions = ((0.5, 0.6, 0.0), (0.8, 0.4, 0.7), (0.2, 0.8, 0.3), (0.55, 0.2, 1.0))
    return [
        Pose(
            limits.min_pan_deg + pan * (limits.max_pan_deg - limits.min_pan_deg),
            limits.min_tilt_deg + tilt * (limits.max_tilt_deg - limits.min_tilt_deg),
            limits.min_zoom + zoom * (limits.max_zoom - limits.min_zoom),
        )
        for pan, tilt, zoom in fractions
    ]


def middle_pose(info: CameraInfo) -> Pose:
    """Return the pose in the middle of the camera's ranges."""
    limits = info.limits
    pan, tilt = (limits.min_pan_deg + limits.max_pan_deg) / 2, (limits.min_tilt_deg + limits.max_tilt_deg) / 2
    return Pose(pan, tilt, math.sqrt(limits.min_zoom * limits.max_zoom))


def pan_turn_deg(pose: Pose, since: Pose) -> float:
    """Return how far the camera has turned right since a pose, in degrees."""
    return wrap_pan_deg(pose.pan_deg - since.pan_deg)


async def expect_error(error_type: type[Exception], operation: Awaitable[object]) -> None:
    """Fail unless an operation raises an error of the given type."""
    try:
        await operation
    except error_type:
        return
    raise AssertionError(f"expected {error_type.__name__}, but nothing was raised")


def expect(condition: bool, message: str) -> None:
    """Fail with the message ``message`` unless a condition holds."""
    if not condition:
        raise AssertionError(message)
