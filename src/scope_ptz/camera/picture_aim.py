"""Compute the pose that centres a point in the picture."""

from __future__ import annotations

import math

from scope_ptz import geometry
from scope_ptz.errors import InputError
from scope_ptz.geometry import Limits, Optics, Pose


def check_point(x: float, y: float, zoom_factor: float) -> None:
    """Check the arguments of ``Camera.centre_on``.

    Raises:
        InputError: The point is outside the picture, or the factor is not above 0.
    """
    if not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
        raise InputError(f"A point in the picture must be given as fractions of its width and height from 0 to 1; got {x}, {y}.")
    if not (zoom_factor > 0 and math.isfinite(zoom_factor)):
        raise InputError(f"The zoom factor must be above 0; got {zoom_factor}.")


def towards_point(
    optics: Optics, limits: Limits, size: tuple[int, int], pose: Pose, x: float, y: float, zoom_factor: float
) -> Pose:
    """Return the pose that centres a point in the picture taken at ``pose``. The result may be beyond the limits.

    Args:
        optics: The optics.
        limits: Limits of motion, used to choose between pan angles that differ by full turns.
        size: Width and height of the picture in pixels.
        pose: The current pose.
        x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
        y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).
        zoom_factor: Factor by which to change the focal length.

    Raises:
        InputError: The point is outside the picture, or the factor is not above 0.
    """
    check_point(x, y, zoom_factor)
    view = geometry.Perspective(pose.pan_deg, pose.tilt_deg, optics.hfov_deg(pose.zoom), *size)
    pan_deg, tilt_deg = (float(angle) for angle in geometry.pan_tilt_deg(view.directions((x, y))))
    return Pose(limits.aim_pan_deg(pan_deg), tilt_deg, _zoom_for_focal(optics, optics.focal(pose.zoom) * zoom_factor))


def _zoom_for_focal(optics: Optics, focal: float) -> float:
    """Return the magnification for a focal length.

    Beyond the ends of the table, it is extrapolated in proportion to the focal length, so that the caller can clamp it.
    """
    shortest, longest = optics.focal(optics.min_zoom), optics.focal(optics.max_zoom)
    if focal > longest:
        return optics.max_zoom * focal / longest
    return optics.min_zoom * focal / shortest if focal < shortest else optics.zoom_for_focal(focal)
