"""Convert between AXIS units and physical units: zoom positions and magnifications, device speeds and degrees per second."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scope_ptz.geometry import Optics

OPTICAL_END_UNITS = 9999.0
"""The highest optical zoom position. Higher positions are digital zoom."""


@dataclass(frozen=True, slots=True)
class ZoomScale:
    """Converts between zoom positions and magnifications, with linear interpolation between the rows of a table.

    Attributes:
        table: Rows of (zoom position, magnification), increasing in both columns.
    """

    table: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if len(self.table) < 2 or any(b[0] <= a[0] or b[1] <= a[1] for a, b in zip(self.table, self.table[1:], strict=False)):
            raise ValueError("a zoom scale requires at least two rows, increasing in both columns")

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
    """Converts degrees per second to device speeds, with linear interpolation between the rows of a table.

    Attributes:
        table: Rows of (device speed from 1 to 100, degrees per second), increasing in both columns.
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


def build_zoom_scale(
    rows: tuple[tuple[float, float], ...], min_units: float, max_units: float, widest: float, closest: float
) -> ZoomScale:
    """Return the zoom scale of a device, from its own table or from its fields of view.

    Args:
        rows: The device's own table of (zoom position, magnification); empty if it has none.
        min_units: The lowest zoom position.
        max_units: The highest zoom position.
        widest: Horizontal field of view in degrees at the widest zoom; used only if the table has fewer than two usable rows.
        closest: Horizontal field of view in degrees at the closest zoom; used only if the table has fewer than two usable rows.
    """
    max_units = min(max_units, OPTICAL_END_UNITS)
    usable = tuple(row for row in rows if min_units <= row[0] <= max_units)
    if len(usable) >= 2:
        return ZoomScale(usable)
    ratio = math.tan(math.radians(widest) / 2) / math.tan(math.radians(closest) / 2)
    return ZoomScale(((min_units, 1.0), (max_units, ratio)))


def build_optics(scale: ZoomScale, fields: tuple[tuple[float, float], ...]) -> Optics:
    """Return the optics for a zoom scale and its fields of view. Between rows, the focal length grows linearly with magnification.

    Args:
        scale: The zoom scale.
        fields: Rows of (fraction of the magnification range, horizontal field of view in degrees), from fraction 0 to 1.
    """
    span = scale.max_zoom - scale.min_zoom
    return Optics(tuple((scale.min_zoom + fraction * span, hfov_deg) for fraction, hfov_deg in fields))
