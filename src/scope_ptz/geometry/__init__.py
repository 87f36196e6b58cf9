"""Poses, optics and projections, as pure functions. Callers use degrees; radians are internal to this package.

Names are imported on first use, so that commands that need only poses and limits start without NumPy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
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

_MODULES = {
    "optics": ("AXIS_M5075_G", "Axis", "Limits", "Optics"),
    "poses": ("Pose", "wrap_pan_deg"),
    "projection": ("Equirectangular", "Perspective", "Projection"),
    "sphere": ("angle_between_deg", "direction", "pan_tilt_deg"),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    module = _MODULE_OF.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{module}"), name)
    globals()[name] = value
    return value
