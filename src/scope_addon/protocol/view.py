"""Views in scene coordinates, and validation of request arguments."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from .errors import AddOnError

Vector = tuple[float, float, float]


class View(NamedTuple):
    """A camera view in scene coordinates.

    Attributes:
        viewpoint: The name of the camera with the same optical centre.
        position_m: The position.
        bearing_deg: The direction as an angle from the scene's y axis, clockwise as seen from above.
        tilt_deg: The tilt; positive is up.
        hfov_deg: The horizontal field of view.
    """

    viewpoint: str
    position_m: Vector
    bearing_deg: float
    tilt_deg: float
    hfov_deg: float

    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Return the right, up and forward directions as unit vectors."""
        p, t = math.radians(self.bearing_deg), math.radians(self.tilt_deg)
        sp, cp, st, ct = math.sin(p), math.cos(p), math.sin(t), math.cos(t)
        return (cp, -sp, 0.0), (-sp * st, -cp * st, ct), (sp * ct, cp * ct, st)

    def interpolate(self, end: View, fraction: float) -> View:
        """Interpolate between this view and ``end``, turning the shorter way. A fraction of 1 returns exactly ``end``."""
        if fraction >= 1.0 or end.viewpoint != self.viewpoint:
            return end
        turn = (end.bearing_deg - self.bearing_deg + 180.0) % 360.0 - 180.0

        def between(a: float, b: float) -> float:
            return a + (b - a) * fraction

        return end._replace(
            bearing_deg=self.bearing_deg + turn * fraction,
            tilt_deg=between(self.tilt_deg, end.tilt_deg),
            hfov_deg=between(self.hfov_deg, end.hfov_deg),
        )


def bearing_tilt_deg(direction: Vector, up: Vector) -> tuple[float, float]:
    """Return the bearing and tilt of a direction. The up vector determines the bearing if the direction is almost vertical."""
    x, y, z = direction
    tilt = math.degrees(math.atan2(z, math.hypot(x, y)))
    if abs(tilt) > 89.9:
        sign = -math.copysign(1.0, tilt)
        x, y = up[0] * sign, up[1] * sign
    return math.degrees(math.atan2(x, y)), tilt


def parse_view(arguments: Mapping[str, Any]) -> View:
    """Return the view in the arguments of a request.

    Raises:
        AddOnError: An argument is missing or out of range.
    """
    try:
        x, y, z = (float(value) for value in arguments["position_m"])
        bearing, tilt, hfov = (float(arguments[name]) for name in ("bearing_deg", "tilt_deg", "hfov_deg"))
        viewpoint = str(arguments["viewpoint"])
    except (KeyError, TypeError, ValueError):
        raise AddOnError("The server's request has no valid view. Update the add-on.") from None
    if not all(math.isfinite(value) for value in (x, y, z, bearing)) or not -90.0 <= tilt <= 90.0 or not 0.0 < hfov < 180.0:
        raise AddOnError("The server's request has no valid view. Update the add-on.")
    return View(viewpoint, (x, y, z), bearing, tilt, hfov)


def parse_size(arguments: Mapping[str, Any]) -> tuple[int, int]:
    """Return the width and height in the arguments of a request.

    Raises:
        AddOnError: The width or height is missing or out of range.
    """
    width, height = arguments.get("width"), arguments.get("height")
    if not isinstance(width, int) or not isinstance(height, int) or not (16 <= width <= 3840 and 16 <= height <= 2160):
        raise AddOnError("The server's request has no valid picture size. Update the add-on.")
    return width, height
