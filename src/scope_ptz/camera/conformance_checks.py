"""Helpers for the camera conformance suite: poses to move to, and assertions with messages."""

from __future__ import annotations

import math
from collections.abc import Awaitable

from scope_ptz.camera.base import CameraInfo
from scope_ptz.geometry import Pose, wrap_pan_deg


def poses(info: CameraInfo) -> list[Pose]:
    """Return four poses that are far from each other. Pan and tilt are well within the limits, and zoom spans its range."""
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


def middle(info: CameraInfo) -> Pose:
    """Return the pose in the middle of all ranges."""
    limits = info.limits
    pan, tilt = (limits.min_pan_deg + limits.max_pan_deg) / 2, (limits.min_tilt_deg + limits.max_tilt_deg) / 2
    return Pose(pan, tilt, math.sqrt(limits.min_zoom * limits.max_zoom))


def turn(pose: Pose, since: Pose) -> float:
    """Return the angle in degrees by which the camera has turned to the right since a pose."""
    return wrap_pan_deg(pose.pan_deg - since.pan_deg)


async def expect_error(kind: type[Exception], operation: Awaitable[object]) -> None:
    """Fail unless an operation raises an error of a given type."""
    try:
        await operation
    except kind:
        return
    raise AssertionError(f"expected {kind.__name__}, but nothing was raised")


def expect(condition: bool, otherwise: str) -> None:
    """Fail with a message unless a condition holds."""
    if not condition:
        raise AssertionError(otherwise)
