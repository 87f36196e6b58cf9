"""ONVIF coordinate spaces, with scales and tables that convert between device units and degrees or magnification."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from scope_ptz.geometry import Optics

_PAN_TILT = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/"
_ZOOM = "http://www.onvif.org/ver10/tptz/ZoomSpaces/"

GENERIC = _PAN_TILT + "PositionGenericSpace"
DEGREES = _PAN_TILT + "SphericalPositionSpaceDegrees"
VELOCITY = _PAN_TILT + "VelocityGenericSpace"
ZOOM_GENERIC = _ZOOM + "PositionGenericSpace"
ZOOM_VELOCITY = _ZOOM + "VelocityGenericSpace"

TRANSLATION_FOV = _PAN_TILT + "TranslationSpaceFov"
ZOOM_TRANSLATION = _ZOOM + "TranslationGenericSpace"

Ends = tuple[float, float]
"""The two ends of a range."""


@dataclass(frozen=True, slots=True)
class ReportedSpace:
    """A coordinate space that a device reports. ``y`` is None for a one-dimensional space."""

    uri: str
    x: Ends
    y: Ends | None = None


@dataclass(frozen=True, slots=True)
class LinearScale:
    """A linear conversion between device units and values such as degrees.

    Attributes:
        units: The ends of the device's range, in increasing order.
        values: The values at these ends, in decreasing order if the device's units run in the opposite direction.
    """

    units: Ends
    values: Ends

    def __post_init__(self) -> None:
        if not (all(map(math.isfinite, (*self.units, *self.values))) and self.units[0] < self.units[1]):
            raise ValueError("a linear scale requires finite ends, with units in increasing order")
        if self.values[0] == self.values[1]:
            raise ValueError("a linear scale requires different values at its two ends")

    def to_value(self, units: float) -> float:
        """Convert device units to a value."""
        return self.values[0] + (units - self.units[0]) * self._slope

    def to_units(self, value: float) -> float:
        """Convert a value to device units, clamped to the device's range."""
        units = self.units[0] + (value - self.values[0]) / self._slope
        return min(max(units, self.units[0]), self.units[1])

    @property
    def _slope(self) -> float:
        return (self.values[1] - self.values[0]) / (self.units[1] - self.units[0])


@dataclass(frozen=True, slots=True)
class PanTiltSpace:
    """A space for pan and tilt positions, with scales that convert them to degrees (right and up are positive)."""

    uri: str
    pan: LinearScale
    tilt: LinearScale


@dataclass(frozen=True, slots=True)
class ZoomSpace:
    """A space for zoom positions, with a table that converts them to magnification.

    Attributes:
        uri: The URI of the space.
        rows: Rows of (device units, magnification, horizontal field of view in degrees), with increasing units and magnification.
        moves: Whether the device can set the zoom.
    """

    uri: str
    rows: tuple[tuple[float, float, float], ...]
    moves: bool = True

    def __post_init__(self) -> None:
        pairs = list(zip(self.rows, self.rows[1:], strict=False))
        if not pairs or any(b[0] <= a[0] or b[1] <= a[1] or b[2] >= a[2] for a, b in pairs):
            raise ValueError(
                "a zoom space requires at least two rows, with increasing units and magnification and decreasing field of view"
            )

    @property
    def optics(self) -> Optics:
        return Optics(tuple((zoom, hfov_deg) for _, zoom, hfov_deg in self.rows))

    def to_zoom(self, units: float) -> float:
        """Convert device units to a magnification."""
        return _interpolate(units, [row[0] for row in self.rows], [row[1] for row in self.rows])

    def to_units(self, zoom: float) -> float:
        """Convert a magnification to device units."""
        return _interpolate(zoom, [row[1] for row in self.rows], [row[0] for row in self.rows])


def reported_spaces(reported: Any) -> tuple[ReportedSpace, ...]:
    """Parse a list of spaces in a reply. Spaces with empty ranges, which some devices report, are omitted."""
    spaces = []
    for space in reported or ():
        x, y = parse_range(space.XRange), parse_range(getattr(space, "YRange", None))
        if space.URI and x is not None and (getattr(space, "YRange", None) is None or y is not None):
            spaces.append(ReportedSpace(str(space.URI), x, y))
    return tuple(spaces)


def parse_range(reported: Any) -> Ends | None:
    """Parse a range in a reply. Return None if it is missing, invalid or empty."""
    if reported is None or reported.Min is None or reported.Max is None:
        return None
    low, high = float(reported.Min), float(reported.Max)
    return (low, high) if math.isfinite(low) and math.isfinite(high) and low < high else None


def _interpolate(value: float, xs: list[float], ys: list[float]) -> float:
    import numpy as np

    return float(np.interp(value, xs, ys))
