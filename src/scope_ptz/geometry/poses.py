"""Camera poses: pan, tilt and zoom."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


def wrap_pan_deg(pan_deg: float) -> float:
    """Wrap a pan angle in degrees to (-180, 180]."""
    wrapped = math.fmod(pan_deg, 360.0)
    if wrapped > 180.0:
        wrapped -= 360.0
    elif wrapped <= -180.0:
        wrapped += 360.0
    return wrapped


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose: pan in degrees (positive = right), tilt in degrees (positive = up), zoom as optical magnification (1 = widest)."""

    pan_deg: float = 0.0
    tilt_deg: float = 0.0
    zoom: float = 1.0

    def __post_init__(self) -> None:
        if not all(math.isfinite(v) for v in (self.pan_deg, self.tilt_deg, self.zoom)):
            raise ValueError(f"pan, tilt and zoom must be finite numbers; got {self}")
        if self.zoom <= 0:
            raise ValueError(f"zoom must be positive; got {self.zoom}")

    def turned(self, pan_deg: float = 0.0, tilt_deg: float = 0.0) -> Pose:
        """Return the pose after a relative turn. It is neither wrapped nor clamped; the camera applies its own limits."""
        return replace(self, pan_deg=self.pan_deg + pan_deg, tilt_deg=self.tilt_deg + tilt_deg)

    def zoomed(self, factor: float) -> Pose:
        """Return the pose with ``factor`` times the magnification."""
        return replace(self, zoom=self.zoom * factor)

    def as_dict(self) -> dict[str, float]:
        """Return the pose as a dictionary for display and for models, with degrees rounded to 0.01 and magnification to 0.001."""
        return {
            "pan_deg": round(self.pan_deg, 2) + 0.0,
            "tilt_deg": round(self.tilt_deg, 2) + 0.0,
            "zoom": round(self.zoom, 3),
        }
