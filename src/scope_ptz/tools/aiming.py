"""Calculate the pose that shows a box in the centre of the frame at a requested size.

All calculations use directions on the sphere. Adding image angles to pan and tilt would be inexact away from the centre of the
frame, and wrong at steep tilts. The *limiting side* of a target is its width or height, whichever fills the larger fraction of the
frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz import geometry
from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.geometry import Axis, Pose
from scope_ptz.perception.base import Box

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.geometry import Perspective, Projection

    Floats = NDArray[np.float64]

TARGET_FILL = 0.75
"""Fraction of the frame that the limiting side of a framed target should fill. The paper requires 60 to 90%."""


@dataclass(frozen=True, slots=True)
class Aim:
    """A pose that frames a target.

    Attributes:
        pose: The pose, within the camera's limits.
        fill: Fraction of the frame that the limiting side should fill; None for a pose at a given zoom.
        limited_by: The axes whose limits prevent the target from being centred or from reaching the requested size.
    """

    pose: Pose
    fill: float | None
    limited_by: tuple[Axis, ...]


def outline(frame: Frame, box: Box, per_side: int = 9) -> Floats:
    """Return directions of shape ``(4 * per_side, 3)`` along the border of a box."""
    return projection_outline(frame.projection, box, per_side)


def projection_outline(projection: Projection, box: Box, per_side: int = 9) -> Floats:
    """Return directions of shape ``(4 * per_side, 3)`` along the border of a box in a view."""
    import numpy as np

    t = np.linspace(0.0, 1.0, per_side)
    xs, ys = box.x_min + t * box.width, box.y_min + t * box.height
    low_x, high_x, low_y, high_y = (np.full(per_side, v) for v in (box.x_min, box.x_max, box.y_min, box.y_max))
    border = np.concatenate([np.stack(pair, axis=-1) for pair in ((xs, low_y), (xs, high_y), (low_x, ys), (high_x, ys))])
    return projection.directions(border)


def view(info: CameraInfo, pose: Pose) -> Perspective:
    """Return the projection of the camera's frame at a pose."""
    return geometry.Perspective(pose.pan_deg, pose.tilt_deg, info.optics.hfov_deg(pose.zoom), info.frame_width, info.frame_height)


def bounds(points: Floats) -> tuple[float, float, float, float]:
    """Return the left, top, right and bottom of normalised points. All are infinite if any point is behind the camera."""
    import numpy as np

    if np.isnan(points).any():
        return -math.inf, -math.inf, math.inf, math.inf
    (left, top), (right, bottom) = points.min(axis=0), points.max(axis=0)
    return float(left), float(top), float(right), float(bottom)


def measure(info: CameraInfo, pose: Pose, target: Floats) -> tuple[float, tuple[float, float]]:
    """Measure the size and position of a target in the view at a pose.

    Args:
        info: The camera.
        pose: The pose.
        target: Directions of shape ``(n, 3)`` along the target's outline.

    Returns:
        The fraction of the frame that the limiting side fills, and the offset of the target's centre from the frame's centre, as
        fractions of the frame's width and height.
    """
    left, top, right, bottom = bounds(view(info, pose).points(target))
    if not math.isfinite(left):
        return math.inf, (math.inf, math.inf)
    return max(right - left, bottom - top), ((left + right) / 2 - 0.5, (top + bottom) / 2 - 0.5)


def aim(info: CameraInfo, start: Pose, target: Floats, fill: float = TARGET_FILL) -> Aim:
    """Return the pose within the limits that centres a target and makes its limiting side fill the fraction ``fill`` of the frame.

    The calculation is iterative, because the target's bounding box and its centre change with the view.
    """
    import numpy as np

    centre = target.mean(axis=0)
    limits = info.limits
    pose, clamped = start, set[Axis]()
    for _ in range(8):
        pan, tilt = (float(v) for v in geometry.pan_tilt_deg(centre))
        zoom = _zoom_for_fill(info, Pose(pan, tilt, start.zoom), target, fill)
        requested = pose_towards(info, pan, tilt, zoom)
        pose, clamped_axes = limits.clamp(requested)
        clamped = set(clamped_axes)
        left, top, right, bottom = bounds(view(info, requested).points(target))
        if not math.isfinite(left):
            break
        centre = view(info, requested).directions(np.array([(left + right) / 2, (top + bottom) / 2]))
    return Aim(pose, fill, sort_axes(clamped))


def aim_at_zoom(info: CameraInfo, target: Floats, zoom: float) -> Aim:
    """Return the pose within the limits that aims at the centre of a target at a given magnification."""
    pan, tilt = (float(v) for v in geometry.pan_tilt_deg(target.mean(axis=0)))
    pose, clamped = info.limits.clamp(pose_towards(info, pan, tilt, zoom))
    return Aim(pose, None, clamped)


def sort_axes(axes: set[Axis]) -> tuple[Axis, ...]:
    """Return the axes in the order pan, tilt, zoom."""
    order: tuple[Axis, ...] = ("pan", "tilt", "zoom")
    return tuple(name for name in order if name in axes)


def _zoom_for_fill(info: CameraInfo, pose: Pose, target: Floats, fill: float) -> float:
    """Return the magnification at which the target fills the requested fraction.

    In a centred view, sizes are proportional to the focal length. A focal length outside the lens's range gives a zoom outside the
    camera's limits, so that clamping reports the limit.
    """
    optics = info.optics
    current_fill, _ = measure(info, pose, target)
    if not math.isfinite(current_fill):
        return optics.min_zoom
    focal = optics.focal(pose.zoom) * fill / max(current_fill, 1e-6)
    if focal > optics.focal(optics.max_zoom):
        return optics.max_zoom * focal / optics.focal(optics.max_zoom)
    if focal < optics.focal(optics.min_zoom):
        return optics.min_zoom * focal / optics.focal(optics.min_zoom)
    return optics.zoom_for_focal(focal)


def touches_border(box: Box, margin: float = 0.004) -> bool:
    """Return whether a box touches the border of its frame, which means that the target may extend beyond it."""
    return min(box.x_min, box.y_min, 1 - box.x_max, 1 - box.y_max) <= margin


def nearest_box(info: CameraInfo, frame: Frame, boxes: tuple[Box, ...], target: Floats) -> Box | None:
    """Return the box nearest to the target's expected position; None if no box is close enough to be the target."""
    left, top, right, bottom = bounds(frame.projection.points(target))
    if not boxes or not math.isfinite(left):
        return None
    x, y = (left + right) / 2, (top + bottom) / 2
    best = min(boxes, key=lambda b: math.hypot(b.centre[0] - x, (b.centre[1] - y) * info.frame_height / info.frame_width))
    # Either box may show only part of the target, so the larger one sets the tolerance.
    near_x, near_y = max(right - left, best.width, 0.05), max(bottom - top, best.height, 0.05)
    if abs(best.centre[0] - x) > near_x or abs(best.centre[1] - y) > near_y:
        return None
    return best


def pose_towards(info: CameraInfo, pan_deg: float, tilt_deg: float, zoom: float) -> Pose:
    """Return the pose that aims in a direction, with a pan within the limits if possible."""
    limits = info.limits
    return Pose(pan_deg if limits.pan_endless else limits.aim_pan_deg(pan_deg), tilt_deg, zoom)


def extrapolate(previous: Floats, current: Floats, ratio: float) -> Floats:
    """Extrapolate a motion from ``previous`` to ``current`` by ``ratio`` times its length.

    All directions are unit vectors of shape ``(3,)``.
    """
    pan0, tilt0 = geometry.pan_tilt_deg(previous)
    pan1, tilt1 = geometry.pan_tilt_deg(current)
    turn = (float(pan1 - pan0) + 180.0) % 360.0 - 180.0
    return geometry.direction(float(pan1) + turn * ratio, float(tilt1) + float(tilt1 - tilt0) * ratio)
