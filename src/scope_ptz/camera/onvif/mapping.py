"""Values that the driver requires but ONVIF does not report: the angles of generic spaces, fields of view, and speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, top_speed
from scope_ptz.geometry import AXIS_M5075_G, Optics

ASSUMED_PAN_DEG = (-180.0, 180.0)
ASSUMED_TILT_DEG = (-90.0, 90.0)
"""The angles at the ends of the generic space on most devices, used only while measuring the actual angles."""

ASSUMED_FIELDS_DEG = (60.0, 6.0)
"""Horizontal fields of view at the widest and the closest zoom, used only while measuring the actual ones."""
ASSUMED_SPEED = Velocity(60.0, 60.0, 0.5)
"""Assumed top speeds for devices whose speeds are unknown.

If they are wrong, continuous moves are slower or faster than requested. Stopping is not affected.
"""


@dataclass(frozen=True, slots=True)
class OnvifMapping:
    """Configured or measured values. None means unknown.

    Attributes:
        pan_deg: Pan in degrees at the low and the high end of the generic space.
        tilt_deg: Tilt in degrees at the low and the high end of the generic space.
        fields: Rows of (fraction of the zoom range, horizontal field of view in degrees), widest first.
        zoom_max: Magnification at the closest zoom; by default, the ratio of the focal lengths.
        top_speed: Velocities at the ends of the generic velocity spaces.
    """

    pan_deg: tuple[float, float] | None = None
    tilt_deg: tuple[float, float] | None = None
    fields: tuple[tuple[float, float], ...] | None = None
    zoom_max: float | None = None
    top_speed: Velocity | None = None

    def with_missing_from(self, other: OnvifMapping) -> OnvifMapping:
        """Return a copy with missing values taken from another mapping."""
        return OnvifMapping(
            self.pan_deg or other.pan_deg,
            self.tilt_deg or other.tilt_deg,
            self.fields or other.fields,
            (self.zoom_max or other.zoom_max) if not self.fields else self.zoom_max,
            self.top_speed or other.top_speed,
        )


def known_mapping(model: str) -> OnvifMapping:
    """Return the data sheet values for a model; an empty mapping if the model is unknown."""
    return _KNOWN.get(model.strip().upper().removeprefix("AXIS ").strip(), OnvifMapping())


def zoom_rows(fields: tuple[tuple[float, float], ...], zoom_max: float | None) -> tuple[tuple[float, float, float], ...]:
    """Return rows of (fraction of the zoom range, magnification, field of view in degrees).

    Without ``zoom_max``, the magnification is the ratio of the focal lengths. With ``zoom_max``, it increases linearly over the
    zoom range, as on devices with a rated zoom. In both cases it is 1 at the widest zoom.
    """
    first = math.tan(math.radians(fields[0][1]) / 2)
    return tuple(
        (
            fraction,
            1.0 + fraction * (zoom_max - 1.0) if zoom_max is not None else first / math.tan(math.radians(hfov_deg) / 2),
            hfov_deg,
        )
        for fraction, hfov_deg in fields
    )


def _mapping_of_optics(optics: Optics) -> OnvifMapping:
    low, high = optics.min_zoom, optics.max_zoom
    fields = tuple(((zoom - low) / (high - low), hfov_deg) for zoom, hfov_deg in optics.table)
    return OnvifMapping(fields=fields, zoom_max=high, top_speed=top_speed(AXIS_M5075_G_HEAD))


_KNOWN = {"M5075-G": _mapping_of_optics(AXIS_M5075_G)}
