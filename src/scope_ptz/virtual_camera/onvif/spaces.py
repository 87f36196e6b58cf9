"""Convert between poses and the ONVIF coordinate spaces for positions, translations and speeds.

In all spaces, positive x is right and positive y is up.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from scope_ptz.geometry import Limits, Optics, Perspective, Pose, wrap_pan_deg
from scope_ptz.geometry.sphere import pan_tilt_deg
from scope_ptz.virtual_camera.onvif.soap import invalid_argument

_PAN_TILT = "http://www.onvif.org/ver10/tptz/PanTiltSpaces/"
_ZOOM = "http://www.onvif.org/ver10/tptz/ZoomSpaces/"

POSITION = _PAN_TILT + "PositionGenericSpace"
POSITION_DEGREES = _PAN_TILT + "SphericalPositionSpaceDegrees"
TRANSLATION = _PAN_TILT + "TranslationGenericSpace"
TRANSLATION_DEGREES = _PAN_TILT + "SphericalTranslationSpaceDegrees"
TRANSLATION_FOV = _PAN_TILT + "TranslationSpaceFov"
VELOCITY = _PAN_TILT + "VelocityGenericSpace"
SPEED = _PAN_TILT + "GenericSpeedSpace"
ZOOM_POSITION = _ZOOM + "PositionGenericSpace"
ZOOM_TRANSLATION = _ZOOM + "TranslationGenericSpace"
ZOOM_VELOCITY = _ZOOM + "VelocityGenericSpace"
ZOOM_SPEED = _ZOOM + "ZoomGenericSpeedSpace"

_TOLERANCE = 1e-4  # clients that calculate in single precision may slightly exceed a range

Range = tuple[float, float]
SIGNED_UNIT: Range = (-1.0, 1.0)
FRACTION: Range = (0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Space:
    """A coordinate space: its URI and the range of each coordinate. ``y`` is None for a one-dimensional space."""

    uri: str
    x: Range
    y: Range | None = None

    def check(self, vector: Any, subcode: str) -> None:
        """Raise a ``SoapFault`` if a coordinate of a vector is missing or out of range."""
        for axis, limits in (("x", self.x), ("y", self.y)):
            if limits is None:
                continue
            value = getattr(vector, axis)
            if value is None or not limits[0] - _TOLERANCE <= value <= limits[1] + _TOLERANCE:
                raise invalid_argument(f"{axis} must be from {limits[0]:g} to {limits[1]:g}; got {value}.", subcode)


def requested_space(spaces: tuple[Space, ...], vector: Any, default: str) -> Space:
    """Return the space that a vector names, or the space with the URI ``default`` if it names none.

    Raises:
        SoapFault: The device does not support the space.
    """
    requested = getattr(vector, "space", None) or default
    for space in spaces:
        if space.uri == requested:
            return space
    raise invalid_argument("The device does not support this space.", "SpaceNotSupported")


@dataclass(frozen=True, slots=True)
class Spaces:
    """The coordinate spaces of a camera.

    Attributes:
        limits: The limits of the camera's poses.
        optics: The optics, which relate zoom to field of view.
        aspect: Aspect ratio of the image (width divided by height).
    """

    limits: Limits
    optics: Optics
    aspect: float

    @property
    def _pan(self) -> Range:
        return (-180.0, 180.0) if self.limits.pan_endless else (self.limits.min_pan_deg, self.limits.max_pan_deg)

    @property
    def _tilt(self) -> Range:
        return self.limits.min_tilt_deg, self.limits.max_tilt_deg

    @property
    def _zoom(self) -> Range:
        return self.limits.min_zoom, self.limits.max_zoom

    @property
    def positions(self) -> tuple[Space, ...]:
        return Space(POSITION, SIGNED_UNIT, SIGNED_UNIT), Space(POSITION_DEGREES, self._pan, self._tilt)

    @property
    def translations(self) -> tuple[Space, ...]:
        degrees = Space(TRANSLATION_DEGREES, _symmetric(self._pan), _symmetric(self._tilt))
        return Space(TRANSLATION, SIGNED_UNIT, SIGNED_UNIT), Space(TRANSLATION_FOV, SIGNED_UNIT, SIGNED_UNIT), degrees

    velocities = (Space(VELOCITY, SIGNED_UNIT, SIGNED_UNIT),)
    speeds = (Space(SPEED, FRACTION),)
    zoom_positions = (Space(ZOOM_POSITION, FRACTION),)
    zoom_translations = (Space(ZOOM_TRANSLATION, SIGNED_UNIT),)
    zoom_velocities = (Space(ZOOM_VELOCITY, SIGNED_UNIT),)
    zoom_speeds = (Space(ZOOM_SPEED, FRACTION),)

    def at_position(self, pose: Pose, space: Space, x: float, y: float) -> Pose:
        """Return ``pose`` with its pan and tilt changed to the position ``x``, ``y`` in a space."""
        if space.uri == POSITION:
            x, y = _from_unit(x, self._pan), _from_unit(y, self._tilt)
        return replace(pose, pan_deg=x, tilt_deg=y)

    def at_zoom_position(self, pose: Pose, x: float) -> Pose:
        """Return ``pose`` with its zoom changed to the position ``x``, as a fraction of the zoom range."""
        low, high = self._zoom
        return replace(pose, zoom=low + x * (high - low))

    def turn(self, pose: Pose, space: Space, x: float, y: float) -> Pose:
        """Return the pose after a pan and tilt translation in a space. The result may be beyond the limits."""
        if space.uri == TRANSLATION_FOV:
            return self._centre(pose, x, y)
        if space.uri == TRANSLATION:
            x, y = x * _span(self._pan) / 2, y * _span(self._tilt) / 2
        return pose.turned(x, y)

    def change_zoom(self, pose: Pose, x: float) -> Pose:
        """Return the pose after a zoom translation by ``x``, a signed fraction of the zoom range, clamped to the range."""
        low, high = self._zoom
        return replace(pose, zoom=min(max(pose.zoom + x * (high - low), low), high))

    def position(self, pose: Pose, uri: str) -> tuple[float, float]:
        """Return the pan and tilt of a pose as a position in the space with the given URI."""
        if uri == POSITION:
            return _to_unit(pose.pan_deg, self._pan), _to_unit(pose.tilt_deg, self._tilt)
        return pose.pan_deg, pose.tilt_deg

    def zoom_position(self, pose: Pose) -> float:
        """Return the zoom of a pose as a fraction of the zoom range."""
        low, high = self._zoom
        return min(max((pose.zoom - low) / (high - low), 0.0), 1.0)

    def _centre(self, pose: Pose, x: float, y: float) -> Pose:
        """Return the pose that centres the point ``x``, ``y`` of the image, where the image edges are at -1 and 1."""
        size = 1000
        view = Perspective(pose.pan_deg, pose.tilt_deg, self.optics.hfov_deg(pose.zoom), size, round(size / self.aspect))
        pan_deg, tilt_deg = pan_tilt_deg(view.directions([0.5 + x / 2, 0.5 - y / 2]))
        return replace(pose, pan_deg=pose.pan_deg + wrap_pan_deg(float(pan_deg) - pose.pan_deg), tilt_deg=float(tilt_deg))


def _span(limits: Range) -> float:
    return limits[1] - limits[0]


def _symmetric(limits: Range) -> Range:
    return -_span(limits), _span(limits)


def _from_unit(value: float, limits: Range) -> float:
    return limits[0] + (value + 1.0) / 2.0 * _span(limits)


def _to_unit(value: float, limits: Range) -> float:
    return min(max(2.0 * (value - limits[0]) / _span(limits) - 1.0, -1.0), 1.0)
