"""Plan the poses of a capture: overlapping rows of frames over a part of the sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from scope_ptz.camera.base import CameraInfo
from scope_ptz.errors import InputError
from scope_ptz.geometry import Limits, Perspective, Pose, direction

OVERLAP = 0.45
"""Fraction of a frame that its neighbour also shows. With this value, most directions are in at least three frames, so that moving
objects can be detected."""

MAX_OVERLAP = 0.8
WHOLE_CIRCLE_DEG = 340.0
"""Minimum pan range, in degrees, that is swept as a full circle, because the frames at its two ends overlap."""

EXTREME_REACH = 0.7
"""Fraction of the upper half of frames in the highest row, and of the lower half in the lowest row, in which neighbouring frames
must overlap as planned. To overlap nearer to the edge, too, these rows would need many more frames."""

MAX_FRAMES = 5000


@dataclass(frozen=True, slots=True)
class Ranges:
    """The part of a camera's range to capture, in degrees; None for the whole range of an axis."""

    pan_deg: tuple[float, float] | None = None
    tilt_deg: tuple[float, float] | None = None

    def within(self, limits: Limits) -> Limits:
        """Return the limits narrowed to these ranges. An endless pan with a range is no longer endless.

        Raises:
            InputError: A range is reversed, infinite, or outside the limits.
        """
        low_pan, high_pan = self._cut("pan", self.pan_deg, (limits.min_pan_deg, limits.max_pan_deg), endless=limits.pan_endless)
        low_tilt, high_tilt = self._cut("tilt", self.tilt_deg, (limits.min_tilt_deg, limits.max_tilt_deg))
        return replace(
            limits, min_pan_deg=low_pan, max_pan_deg=high_pan, min_tilt_deg=low_tilt, max_tilt_deg=high_tilt,
            pan_endless=limits.pan_endless and self.pan_deg is None,
        )  # fmt: skip

    @staticmethod
    def _cut(
        axis: str, chosen: tuple[float, float] | None, limits: tuple[float, float], *, endless: bool = False
    ) -> tuple[float, float]:  # fmt: skip
        """Return the chosen range of an axis, narrowed to its limits."""
        if chosen is None:
            return limits
        if not (all(math.isfinite(angle) for angle in chosen) and chosen[0] <= chosen[1]):
            raise InputError(
                f"The range of {axis} must be FROM:TO in degrees, with FROM below TO; got {chosen[0]:g}:{chosen[1]:g}."
            )
        cut = chosen if endless else (max(chosen[0], limits[0]), min(chosen[1], limits[1]))
        if cut[0] > cut[1] or cut[1] - cut[0] > 360.0:
            raise InputError(
                f"The camera's {axis} reaches from {limits[0]:g} to {limits[1]:g} degrees, so it cannot be captured from "
                f"{chosen[0]:g} to {chosen[1]:g}."
            )
        return cut


def is_full_circle(limits: Limits) -> bool:
    """Return whether frames within these limits form a full circle."""
    return limits.pan_endless or limits.max_pan_deg - limits.min_pan_deg >= WHOLE_CIRCLE_DEG


def plan_poses(info: CameraInfo, limits: Limits, zoom: float, overlap: float = OVERLAP) -> list[Pose]:
    """Return poses whose frames cover everything that the camera can show within limits at a magnification.

    Every other row is reversed, so that the camera travels less.

    Args:
        info: The camera.
        limits: The range of poses to cover.
        zoom: The magnification.
        overlap: Fraction of a frame that the next one also shows, from 0.05 to ``MAX_OVERLAP``.

    Raises:
        InputError: The overlap is out of range, or there would be more than ``MAX_FRAMES`` frames.
    """
    if not 0.05 <= overlap <= MAX_OVERLAP:
        raise InputError(f"The overlap must be from 0.05 to {MAX_OVERLAP:g}; got {overlap:g}.")
    view = Perspective(0.0, 0.0, info.optics.hfov_deg(zoom), info.frame_width, info.frame_height)
    tilts = _tilts(limits, view, overlap)
    spacing = view.vfov_deg * (1 - overlap) if len(tilts) == 1 else abs(tilts[0] - tilts[1])
    rows: list[list[Pose]] = []
    for row, tilt in enumerate(tilts):
        inner = spacing / 2
        outer = EXTREME_REACH * view.vfov_deg / 2
        edges = (tilt + (outer if row == 0 else inner), tilt, tilt - (outer if row == len(tilts) - 1 else inner))
        step = 2 * min(_half_width_deg(replace(view, tilt_deg=tilt), edge) for edge in edges) * (1 - overlap)
        rows.append([Pose(pan, tilt, zoom) for pan in _pans(limits, step, row)])
        if sum(len(each) for each in rows) > MAX_FRAMES:
            raise InputError(f"A sweep at {zoom:g}x needs more than {MAX_FRAMES} pictures. Choose a smaller range or zoom.")
    return [pose for row, poses in enumerate(rows) for pose in (poses if row % 2 == 0 else reversed(poses))]


def _tilts(limits: Limits, view: Perspective, overlap: float) -> list[float]:
    span = limits.max_tilt_deg - limits.min_tilt_deg
    count = math.ceil(span / (view.vfov_deg * (1 - overlap)) - 1e-9) + 1
    return np.linspace(limits.max_tilt_deg, limits.min_tilt_deg, count).tolist() if count > 1 else [limits.max_tilt_deg]


def _pans(limits: Limits, step_deg: float, row: int) -> list[float]:
    if is_full_circle(limits):
        count = max(3, math.ceil(360.0 / step_deg - 1e-9))
        low = limits.min_pan_deg if not limits.pan_endless else -180.0
        high = limits.max_pan_deg if not limits.pan_endless else 180.0
        # Alternate rows are shifted, so that the corners of frames lie on the centres of others.
        shift = 0.25 if row % 2 == 0 else 0.75
        return [min(max(-180.0 + (k + shift) * 360.0 / count, low), high) for k in range(count)]
    span = limits.max_pan_deg - limits.min_pan_deg
    count = math.ceil(span / step_deg - 1e-9) + 1
    return np.linspace(limits.min_pan_deg, limits.max_pan_deg, count).tolist() if count > 1 else [limits.min_pan_deg]


def _half_width_deg(view: Perspective, tilt_deg: float) -> float:
    """Return the largest pan offset at which a view still shows a tilt, in degrees; at least a tenth of its field of view."""
    turns = np.arange(0.0, 180.5, 0.5)
    points = view.points(direction(turns, min(max(tilt_deg, -90.0), 90.0)))
    inside = np.all((points >= 0) & (points <= 1), axis=-1)  # false for NaN
    first_outside = int(np.argmin(inside)) if not inside.all() else len(turns)
    return max(float(turns[max(first_outside - 1, 0)]), view.hfov_deg / 10)


def without_repeats(poses: list[Pose], known: list[Pose], hfov_deg: float) -> list[Pose]:
    """Return the poses that are not close to a known pose at the same zoom."""
    near_deg = hfov_deg / 50
    return [pose for pose in poses if not any(_same(pose, other, near_deg) for other in known)]


def _same(a: Pose, b: Pose, near_deg: float) -> bool:
    apart = (abs((a.pan_deg - b.pan_deg + 180.0) % 360.0 - 180.0), abs(a.tilt_deg - b.tilt_deg))
    return max(apart) < near_deg and math.isclose(a.zoom, b.zoom, rel_tol=0.02)
