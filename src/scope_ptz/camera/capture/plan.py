"""Plan the poses for a capture: rows of overlapping frames that cover part of the sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from scope_ptz.camera.base import CameraInfo
from scope_ptz.errors import InputError
from scope_ptz.geometry import Limits, Perspective, Pose, direction

OVERLAP = 0.45
"""Fraction of a frame that overlaps its neighbour.

With this value, at least three frames cover most directions, so that moving objects can be detected.
"""

MAX_OVERLAP = 0.8
WHOLE_CIRCLE_DEG = 340.0
"""Minimum pan range in degrees to sweep as a full circle. The frames at its two ends overlap."""

OUTER_ROW_OVERLAP_EXTENT = 0.7
"""How far towards the outer edge the highest and lowest rows fully overlap, as a fraction of half a frame's height.

Full overlap up to the edge would require many more frames in these rows.
"""

MAX_FRAMES = 5000


@dataclass(frozen=True, slots=True)
class Ranges:
    """The part of a camera's range to capture, in degrees; None for the whole range of an axis."""

    pan_deg: tuple[float, float] | None = None
    tilt_deg: tuple[float, float] | None = None

    def within(self, limits: Limits) -> Limits:
        """Return the limits narrowed to these ranges. Pan is not endless if it is limited to a range.

        Raises:
            InputError: A range is reversed, not finite, outside the limits, or wider than 360 degrees.
        """
        low_pan, high_pan = self._narrow("pan", self.pan_deg, (limits.min_pan_deg, limits.max_pan_deg), endless=limits.pan_endless)
        low_tilt, high_tilt = self._narrow("tilt", self.tilt_deg, (limits.min_tilt_deg, limits.max_tilt_deg))
        return replace(
            limits, min_pan_deg=low_pan, max_pan_deg=high_pan, min_tilt_deg=low_tilt, max_tilt_deg=high_tilt,
            pan_endless=limits.pan_endless and self.pan_deg is None,
        )  # fmt: skip

    @staticmethod
    def _narrow(
        axis: str, chosen: tuple[float, float] | None, limits: tuple[float, float], *, endless: bool = False
    ) -> tuple[float, float]:  # fmt: skip
        """Return the chosen range of an axis, narrowed to its limits."""
        if chosen is None:
            return limits
        if not (all(math.isfinite(angle) for angle in chosen) and chosen[0] <= chosen[1]):
            raise InputError(
                f"The {axis} range must be FROM:TO in degrees, with FROM not above TO; got {chosen[0]:g}:{chosen[1]:g}."
            )
        result = chosen if endless else (max(chosen[0], limits[0]), min(chosen[1], limits[1]))
        if result[0] > result[1] or result[1] - result[0] > 360.0:
            raise InputError(
                f"The camera's {axis} range is {limits[0]:g} to {limits[1]:g} degrees, so {chosen[0]:g} to {chosen[1]:g} degrees "
                f"cannot be captured."
            )
        return result


def is_full_circle(limits: Limits) -> bool:
    """Return whether the frames within these limits form a full circle."""
    return limits.pan_endless or limits.max_pan_deg - limits.min_pan_deg >= WHOLE_CIRCLE_DEG


def plan_poses(info: CameraInfo, limits: Limits, zoom: float, overlap: float = OVERLAP) -> list[Pose]:
    """Return poses whose frames cover everything that the camera can show within the limits at a given magnification.

    Every other row is reversed to reduce travel.

    Args:
        info: The camera.
        limits: The range of poses to cover.
        zoom: The magnification.
        overlap: Fraction of a frame that overlaps the next one, from 0.05 to ``MAX_OVERLAP``.

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
        outer = OUTER_ROW_OVERLAP_EXTENT * view.vfov_deg / 2
        edges = (tilt + (outer if row == 0 else inner), tilt, tilt - (outer if row == len(tilts) - 1 else inner))
        step = 2 * min(_half_width_deg(replace(view, tilt_deg=tilt), edge) for edge in edges) * (1 - overlap)
        rows.append([Pose(pan, tilt, zoom) for pan in _pans(limits, step, row)])
        if sum(len(poses) for poses in rows) > MAX_FRAMES:
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
        # Alternate rows are shifted by half a step, so that the corners of frames fall near the centres of others.
        shift = 0.25 if row % 2 == 0 else 0.75
        return [min(max(-180.0 + (k + shift) * 360.0 / count, low), high) for k in range(count)]
    span = limits.max_pan_deg - limits.min_pan_deg
    count = math.ceil(span / step_deg - 1e-9) + 1
    return np.linspace(limits.min_pan_deg, limits.max_pan_deg, count).tolist() if count > 1 else [limits.min_pan_deg]


def _half_width_deg(view: Perspective, tilt_deg: float) -> float:
    """Return half the width of a view at a given tilt, in degrees of pan; at least a tenth of the field of view."""
    turns = np.arange(0.0, 180.5, 0.5)
    points = view.points(direction(turns, min(max(tilt_deg, -90.0), 90.0)))
    inside = np.all((points >= 0) & (points <= 1), axis=-1)  # false for NaN
    first_outside = int(np.argmin(inside)) if not inside.all() else len(turns)
    return max(float(turns[max(first_outside - 1, 0)]), view.hfov_deg / 10)


def exclude_known_poses(poses: list[Pose], known: list[Pose], hfov_deg: float) -> list[Pose]:
    """Return the poses that are not close to any known pose at the same zoom."""
    near_deg = hfov_deg / 50
    return [pose for pose in poses if not any(_is_close(pose, other, near_deg) for other in known)]


def _is_close(a: Pose, b: Pose, near_deg: float) -> bool:
    differences_deg = (abs((a.pan_deg - b.pan_deg + 180.0) % 360.0 - 180.0), abs(a.tilt_deg - b.tilt_deg))
    return max(differences_deg) < near_deg and math.isclose(a.zoom, b.zoom, rel_tol=0.02)
