"""VAPIX scales: zoom positions from 1 to 9999, and speeds from 1 to 100."""

from __future__ import annotations

from bisect import bisect_right

from scope_ptz.camera.motion import Motor
from scope_ptz.geometry import Limits

MAX_ZOOM_STEP = 9999
"""The zoom position at the end of the optical range."""

SPEEDS = ((1, 0.0005), (20, 0.015), (40, 0.06), (60, 0.2), (80, 0.5), (100, 1.0))
"""Speed values with the corresponding fractions of the top speed. Slow speeds are finely graded, as on AXIS cameras."""


def zoom_step(zoom: float, limits: Limits) -> int:
    """Return the zoom position for a magnification. Positions are linear in magnification."""
    fraction = (zoom - limits.min_zoom) / (limits.max_zoom - limits.min_zoom)
    return round(1 + min(max(fraction, 0.0), 1.0) * (MAX_ZOOM_STEP - 1))


def magnification(step: float, limits: Limits) -> float:
    """Return the magnification at a zoom position, clamped to the optical range."""
    fraction = (min(max(step, 1), MAX_ZOOM_STEP) - 1) / (MAX_ZOOM_STEP - 1)
    return limits.min_zoom + fraction * (limits.max_zoom - limits.min_zoom)


def speed_fraction(speed: float) -> float:
    """Return the signed fraction of the top speed for a speed value; 0 for values between -1 and 1."""
    value = min(abs(speed), 100.0)
    if value < 1:
        return 0.0
    upper = min(bisect_right(SPEEDS, value, key=lambda row: row[0]), len(SPEEDS) - 1)
    (low, low_fraction), (high, high_fraction) = SPEEDS[upper - 1], SPEEDS[upper]
    fraction = low_fraction + (high_fraction - low_fraction) * (value - low) / (high - low)
    return fraction if speed > 0 else -fraction


def speed_table(motor: Motor) -> list[tuple[int, float]]:
    """Return the speed values with a motor's corresponding speeds."""
    return [(value, fraction * motor.speed) for value, fraction in SPEEDS]
