"""Convert the units of AXIS devices: zoom positions to magnifications, and speeds from -100 to 100 to degrees per second."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scope_ptz.geometry import Optics

OPTICAL_END_UNITS = 9999.0
"""The highest optical zoom position. Higher positions are digital zoom."""


@dataclass(frozen=True, slots=True)
class ZoomScale:
    """A table of zoom positions and magnifications, both increasing, with linear interpolation between the rows.

    Attributes:
        table: Rows of (zoom position, magnification).
    """

    table: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if len(self.table) < 2 or any(b[0] <= a[0] or b[1] <= a[1] for a, b in zip(self.table, self.table[1:], strict=False)):
            raise ValueError("a zoom scale needs two or more increasing rows")

    @property
    def min_zoom(self) -> float:
        return self.table[0][1]

    @property
    def max_zoom(self) -> float:
        return self.table[-1][1]

    def to_zoom(self, units: float) -> float:
        """Return the magnification at a zoom position."""
        import numpy as np

        return float(np.interp(units, [u for u, _ in self.table], [z for _, z in self.table]))

    def to_units(self, zoom: float) -> int:
        """Return the zoom position nearest to a magnification."""
        import numpy as np

        return round(float(np.interp(zoom, [z for _, z in self.table], [u for u, _ in self.table])))


@dataclass(frozen=True, slots=True)
class SpeedScale:
    """A table of device speeds from 1 to 100 and degrees per second, both increasing.

    Attributes:
        table: Rows of (speed, degrees per second).
    """

    table: tuple[tuple[float, float], ...]

    @property
    def top_dps(self) -> float:
        """The highest speed in degrees per second."""
        return self.table[-1][1]

    def to_speed(self, dps: float) -> int:
        """Return the device speed, from -100 to 100, for a velocity. Only a velocity of 0 becomes a speed of 0."""
        import numpy as np

        if dps == 0:
            return 0
        speed = float(np.interp(abs(dps), [d for _, d in self.table], [s for s, _ in self.table]))
        return int(math.copysign(max(1, round(speed)), dps))


def zoom_scale(
    rows: tuple[tuple[float, float], ...], min_units: float, max_units: float, widest: float, closest: float
) -> ZoomScale:
    """Return the zoom scale of a device.

    Args:
        rows: The device's own table of (zoom position, magnification); empty if it has none.
        min_units: The lowest zoom position.
        max_units: The highest zoom position.
        widest: Horizontal field of view in degrees at the widest zoom. It is used only if the device has no table.
        closest: The same at the closest zoom.
    """
    max_units = min(max_units, OPTICAL_END_UNITS)
    kept = tuple(row for row in rows if min_units <= row[0] <= max_units)
    if len(kept) >= 2:
        return ZoomScale(kept)
    ratio = math.tan(math.radians(widest) / 2) / math.tan(math.radians(closest) / 2)
    return ZoomScale(((min_units, 1.0), (max_units, ratio)))


def optics_of(scale: ZoomScale, fields: tuple[tuple[float, float], ...]) -> Optics:
    """Return the optics with the given fields of view. Between them, the focal length grows linearly with magnification.

    Args:
        scale: The zoom scale.
        fields: Rows of (fraction of the range of magnification, horizontal field of view in degrees), from fraction 0 to 1.
    """
    span = scale.max_zoom - scale.min_zoom
    return Optics(tuple((scale.min_zoom + fraction * span, hfov_deg) for fraction, hfov_deg in fields))
