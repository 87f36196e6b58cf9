"""Camera optics (zoom to field of view) and limits of motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from scope_ptz.geometry.poses import Pose, wrap_pan_deg

Axis = Literal["pan", "tilt", "zoom"]


@dataclass(frozen=True, slots=True)
class Optics:
    """A zoom curve: a table of ``(magnification, horizontal field of view in degrees)``, widest first.

    Between rows, the focal length (1 / tan(hfov / 2)) is interpolated linearly in magnification, which is close to real zoom
    curves.
    No formula fits all lenses: the AXIS M5075-G is rated at 5x, but the ratio of its longest to its shortest focal length is 5.8.
    """

    table: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        zooms = [z for z, _ in self.table]
        fields = [h for _, h in self.table]
        if len(self.table) < 2 or sorted(set(zooms)) != zooms or sorted(set(fields), reverse=True) != fields:
            raise ValueError("a zoom table must have at least two rows, with increasing magnification and decreasing field of view")

    @property
    def min_zoom(self) -> float:
        return self.table[0][0]

    @property
    def max_zoom(self) -> float:
        return self.table[-1][0]

    def _focals(self) -> list[float]:
        return [1.0 / math.tan(math.radians(h) / 2) for _, h in self.table]

    def focal(self, zoom: float) -> float:
        """Return the focal length at a magnification, in units of half the image width: 1 / tan(hfov / 2)."""
        import numpy as np  # imported here, so that this module can be imported without NumPy

        return float(np.interp(zoom, [z for z, _ in self.table], self._focals()))

    def hfov_deg(self, zoom: float) -> float:
        """Return the horizontal field of view in degrees at a magnification, clamped to the table."""
        return math.degrees(2 * math.atan(1.0 / self.focal(zoom)))

    def zoom_for_focal(self, focal: float) -> float:
        """Return the magnification for a focal length (in units of half the image width), clamped to the table."""
        import numpy as np

        return float(np.interp(focal, self._focals(), [z for z, _ in self.table]))

    def zoom_for_hfov(self, hfov_deg: float) -> float:
        """Return the magnification for a horizontal field of view, clamped to the table."""
        return self.zoom_for_focal(1.0 / math.tan(math.radians(hfov_deg) / 2))


@dataclass(frozen=True, slots=True)
class Limits:
    """A camera's limits of motion. With ``pan_endless``, pan is unlimited and wraps at 180 degrees."""

    min_pan_deg: float = -179.0
    max_pan_deg: float = 179.0
    min_tilt_deg: float = -60.0
    max_tilt_deg: float = 30.0
    min_zoom: float = 1.0
    max_zoom: float = 5.0
    pan_endless: bool = False

    def clamp(self, pose: Pose) -> tuple[Pose, tuple[Axis, ...]]:
        """Return the nearest pose within the limits, and the axes that were clamped.

        Pan is clamped without being wrapped first: 170 + 20 = 190 becomes 179, so the camera does not turn the other way to -170.
        """
        pan = wrap_pan_deg(pose.pan_deg) if self.pan_endless else _clamp(pose.pan_deg, self.min_pan_deg, self.max_pan_deg)
        tilt = _clamp(pose.tilt_deg, self.min_tilt_deg, self.max_tilt_deg)
        zoom = _clamp(pose.zoom, self.min_zoom, self.max_zoom)
        clamped: list[Axis] = []
        if not self.pan_endless and abs(pan - pose.pan_deg) > 1e-9:
            clamped.append("pan")
        if abs(tilt - pose.tilt_deg) > 1e-9:
            clamped.append("tilt")
        if abs(zoom - pose.zoom) > 1e-9:
            clamped.append("zoom")
        return Pose(pan, tilt, zoom), tuple(clamped)

    def at_stop(self, pose: Pose, axis: Axis) -> bool:
        """Return whether a pose is at a limit of an axis; always False for endless pan."""
        value, low, high = {
            "pan": (pose.pan_deg, self.min_pan_deg, self.max_pan_deg),
            "tilt": (pose.tilt_deg, self.min_tilt_deg, self.max_tilt_deg),
            "zoom": (pose.zoom, self.min_zoom, self.max_zoom),
        }[axis]
        return not (axis == "pan" and self.pan_endless) and (value <= low + 1e-6 or value >= high - 1e-6)

    def aim_pan_deg(self, pan_deg: float) -> float:
        """Return an equivalent pan angle (differing by full turns) that is within the limits if possible."""
        wrapped = wrap_pan_deg(pan_deg)
        for candidate in (wrapped, wrapped + 360.0, wrapped - 360.0):
            if self.min_pan_deg <= candidate <= self.max_pan_deg:
                return candidate
        return wrapped


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


AXIS_M5075_G = Optics(
    ((1.0, 71.0), (1.5, 48.1), (2.0, 35.9), (2.5, 28.5), (3.0, 23.6), (3.5, 20.2), (4.0, 17.6), (4.5, 15.6), (5.0, 14.0))
)
"""The optics of the AXIS M5075-G.

The fields of view at the widest and the closest zoom are from the data sheet. The rows in between are interpolated along a smooth
curve, not measured.
"""
