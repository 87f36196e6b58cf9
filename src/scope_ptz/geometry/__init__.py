"""Poses, optics and projections. Pure functions; callers use degrees, radians stay inside this package."""

from scope_ptz.geometry.optics import AXIS_M5075_G, Axis, Limits, Optics
from scope_ptz.geometry.poses import Pose, wrap_pan_deg
from scope_ptz.geometry.projection import Equirectangular, Perspective, Projection
from scope_ptz.geometry.sphere import angle_between_deg, direction, pan_tilt_deg

__all__ = [
    "AXIS_M5075_G",
    "Axis",
    "Equirectangular",
    "Limits",
    "Optics",
    "Perspective",
    "Pose",
    "Projection",
    "angle_between_deg",
    "direction",
    "pan_tilt_deg",
    "wrap_pan_deg",
]
