"""Aiming on the sphere: the pose that puts a box in the middle of the frame at a wanted size.

Everything goes through directions: adding image-space angles to pan and tilt is wrong off the axis and badly so at steep tilts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import CameraInfo, Frame
from scope_ptz.geometry import Axis, Perspective, Pose, direction, pan_tilt_deg
from scope_ptz.perception.base import Box

Floats = NDArray[np.float64]

TARGET_FILL = 0.75
"""Share of its limiting side that a framed target fills (60 to 90% is asked for)."""


@dataclass(frozen=True, slots=True)
class Aim:
    """A pose for framing a target: the fill of the limiting side that it aims at, and the limits that keep it from that."""

    pose: Pose
    fill_wanted: float | None
    limited_by: tuple[Axis, ...]


def outline(frame: Frame, box: Box, per_side: int = 9) -> Floats:
    """Directions (4 * per_side, 3) along the border of a box in a frame."""
    t = np.linspace(0.0, 1.0, per_side)
    xs, ys = box.x_min + t * box.width, box.y_min + t * box.height
    low_x, high_x, low_y, high_y = (np.full(per_side, v) for v in (box.x_min, box.x_max, box.y_min, box.y_max))
    border = np.concatenate([np.stack(pair, axis=-1) for pair in ((xs, low_y), (xs, high_y), (low_x, ys), (high_x, ys))])
    return frame.projection.directions(border)


def view(info: CameraInfo, pose: Pose) -> Perspective:
    """The camera's picture at a pose."""
    return Perspective(pose.pan_deg, pose.tilt_deg, info.optics.hfov_deg(pose.zoom), info.frame_width, info.frame_height)


def spans(points: Floats) -> tuple[float, float, float, float]:
    """Left, top, right, bottom of normalised points; infinite when some lie behind the camera."""
    if np.isnan(points).any():
        return -math.inf, -math.inf, math.inf, math.inf
    (left, top), (right, bottom) = points.min(axis=0), points.max(axis=0)
    return float(left), float(top), float(right), float(bottom)


def measure(info: CameraInfo, pose: Pose, target: Floats) -> tuple[float, tuple[float, float]]:
    """Fill of the limiting side and offset of the middle of a target (directions (n, 3)) seen from a pose."""
    left, top, right, bottom = spans(view(info, pose).points(target))
    if not math.isfinite(left):
        return math.inf, (math.inf, math.inf)
    return max(right - left, bottom - top), ((left + right) / 2 - 0.5, (top + bottom) / 2 - 0.5)


def aim(info: CameraInfo, start: Pose, target: Floats, fill: float = TARGET_FILL) -> Aim:
    """The pose within the limits that centres a target and makes it fill ``fill`` of its limiting side.

    Pan and tilt are iterated because a box turned to another view is no longer the same box: its middle moves.
    """
    middle = target.mean(axis=0)
    limits = info.limits
    pose, clamped = start, set[Axis]()
    for _ in range(8):
        pan, tilt = (float(v) for v in pan_tilt_deg(middle))
        zoom = _zoom_for(info, Pose(pan, tilt, start.zoom), target, fill)
        wanted = pose_towards(info, pan, tilt, zoom)
        pose, cut = limits.clamp(wanted)
        clamped = set(cut)
        left, top, right, bottom = spans(view(info, wanted).points(target))
        if not math.isfinite(left):
            break
        middle = view(info, wanted).directions(np.array([(left + right) / 2, (top + bottom) / 2]))
    return Aim(pose, fill, in_order(clamped))


def aim_at_zoom(info: CameraInfo, target: Floats, zoom: float) -> Aim:
    """The pose within the limits that looks at the middle of a target with a given magnification."""
    pan, tilt = (float(v) for v in pan_tilt_deg(target.mean(axis=0)))
    pose, clamped = info.limits.clamp(pose_towards(info, pan, tilt, zoom))
    return Aim(pose, None, clamped)


def in_order(axes: set[Axis]) -> tuple[Axis, ...]:
    """Axes in the order in which people name them."""
    order: tuple[Axis, ...] = ("pan", "tilt", "zoom")
    return tuple(name for name in order if name in axes)


def _zoom_for(info: CameraInfo, pose: Pose, target: Floats, fill: float) -> float:
    """Magnification at which the target fills its share: sizes in a centred view grow in proportion to the focal length.

    What lies beyond the lens's range comes out beyond the camera's limits, so that clamping tells.
    """
    optics = info.optics
    reached, _ = measure(info, pose, target)
    if not math.isfinite(reached):
        return optics.min_zoom
    focal = optics.focal(pose.zoom) * fill / max(reached, 1e-6)
    if focal > optics.focal(optics.max_zoom):
        return optics.max_zoom * focal / optics.focal(optics.max_zoom)
    if focal < optics.focal(optics.min_zoom):
        return optics.min_zoom * focal / optics.focal(optics.min_zoom)
    return optics.zoom_for_focal(focal)


def is_cut(box: Box, margin: float = 0.004) -> bool:
    """Whether a box touches the border of its frame: the target may go on outside."""
    return min(box.x_min, box.y_min, 1 - box.x_max, 1 - box.y_max) <= margin


def nearest(info: CameraInfo, frame: Frame, boxes: tuple[Box, ...], target: Floats) -> Box | None:
    """The box that continues a known target: the one whose middle is closest to where the target must be now."""
    left, top, right, bottom = spans(frame.projection.points(target))
    if not boxes or not math.isfinite(left):
        return None
    x, y = (left + right) / 2, (top + bottom) / 2
    best = min(boxes, key=lambda b: math.hypot(b.centre[0] - x, (b.centre[1] - y) * info.frame_height / info.frame_width))
    # What was seen before may have been a sliver of it, or it of what is seen now.
    near_x, near_y = max(right - left, best.width, 0.05), max(bottom - top, best.height, 0.05)
    if abs(best.centre[0] - x) > near_x or abs(best.centre[1] - y) > near_y:
        return None
    return best


def pose_towards(info: CameraInfo, pan_deg: float, tilt_deg: float, zoom: float) -> Pose:
    """The pose that looks at a direction, on the side of the pan stops where it can."""
    limits = info.limits
    return Pose(pan_deg if limits.pan_endless else limits.aim_pan_deg(pan_deg), tilt_deg, zoom)


def lookahead(previous: Floats, now: Floats, ratio: float) -> Floats:
    """Where a middle moving from ``previous`` to ``now`` will be after ``ratio`` times that interval (unit vectors (3,))."""
    pan0, tilt0 = pan_tilt_deg(previous)
    pan1, tilt1 = pan_tilt_deg(now)
    turn = (float(pan1 - pan0) + 180.0) % 360.0 - 180.0
    return direction(float(pan1) + turn * ratio, float(tilt1) + float(tilt1 - tilt0) * ratio)
