"""Where a camera looks: pan, tilt, zoom."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


def wrap_pan_deg(pan_deg: float) -> float:
    """The same direction in (-180, 180]."""
    wrapped = math.fmod(pan_deg, 360.0)
    if wrapped > 180.0:
        wrapped -= 360.0
    elif wrapped <= -180.0:
        wrapped += 360.0
    return wrapped


@dataclass(frozen=True, slots=True)
class Pose:
    """Pan in degrees (positive = right, clockwise from above), tilt in degrees (positive = up), zoom as optical magnification."""

    pan_deg: float = 0.0
    tilt_deg: float = 0.0
    zoom: float = 1.0

    def __post_init__(self) -> None:
        if not all(math.isfinite(v) for v in (self.pan_deg, self.tilt_deg, self.zoom)):
            raise ValueError(f"a pose needs finite numbers, got {self}")
        if self.zoom <= 0:
            raise ValueError(f"zoom must be positive, got {self.zoom}")

    def turned(self, pan_deg: float = 0.0, tilt_deg: float = 0.0) -> Pose:
        """The pose after a relative move, not wrapped and not clamped: limits are the camera's business."""
        return replace(self, pan_deg=self.pan_deg + pan_deg, tilt_deg=self.tilt_deg + tilt_deg)

    def zoomed(self, factor: float) -> Pose:
        """The pose with ``factor`` times the magnification."""
        return replace(self, zoom=self.zoom * factor)

    def as_dict(self) -> dict[str, float]:
        """Rounded for people and models: hundredths of a degree, thousandths of a magnification."""
        return {
            "pan_deg": round(self.pan_deg, 2) + 0.0,
            "tilt_deg": round(self.tilt_deg, 2) + 0.0,
            "zoom": round(self.zoom, 3),
        }
