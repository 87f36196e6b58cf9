"""The PTZ node and its configuration: coordinate spaces, defaults and limits."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import MAX_PRESETS, VirtualDevice
from scope_ptz.virtual_camera.onvif import spaces
from scope_ptz.virtual_camera.onvif.device_service import require_token
from scope_ptz.virtual_camera.onvif.media_profiles import media_profiles
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.soap import invalid_argument

NODE = "ptz-node"
CONFIGURATION = "ptz-configuration"
MIN_TIMEOUT_S, MAX_TIMEOUT_S = 0.1, 60.0
"""Minimum and maximum duration of a continuous move in seconds."""


def duration_s(value: Any) -> float | None:
    """Return a duration from a request in seconds; None if it is invalid or outside the limits."""
    seconds = value.total_seconds() if isinstance(value, timedelta) else None  # isodate uses another type for months and years
    return seconds if seconds is not None and MIN_TIMEOUT_S <= seconds <= MAX_TIMEOUT_S else None


class PtzConfiguration:
    """The PTZ configuration. Clients can change its name and its defaults.

    Attributes:
        spaces: The camera's coordinate spaces.
        name: Name of the configuration.
        position: URI of the space in which positions are reported, which is also the default space for absolute moves.
        translation: URI of the default space for relative moves.
        timeout_s: Default duration of a continuous move in seconds.
        speed: Default pan and tilt speed as a fraction of the top speed.
        zoom_speed: Default zoom speed as a fraction of the top speed.
    """

    def __init__(self, device: VirtualDevice) -> None:
        self.spaces = spaces.Spaces(device.limits, device.optics, device.width / device.height)
        self._use_count = len(media_profiles(device))
        self.name = "PTZ"
        self.position, self.translation = spaces.POSITION, spaces.TRANSLATION
        self.timeout_s, self.speed, self.zoom_speed = 5.0, 1.0, 1.0

    def operations(self) -> Operations:
        """Return the operations by name."""
        return {
            "GetNodes": Operation(lambda _: {"PTZNode": [self._node()]}),
            "GetNode": Operation(self._get_node),
            "GetConfigurations": Operation(lambda _: {"PTZConfiguration": [self.values()]}),
            "GetConfiguration": Operation(self._get_configuration),
            "GetCompatibleConfigurations": Operation(lambda _: {"PTZConfiguration": [self.values()]}),
            "GetConfigurationOptions": Operation(self._options),
            "SetConfiguration": Operation(self._set, Role.ADMINISTRATOR),
        }

    def values(self) -> dict[str, Any]:
        """Return the configuration in the form used in replies."""
        pan_tilt = self.spaces.positions[0]
        return {
            "token": CONFIGURATION,
            "Name": self.name,
            "UseCount": self._use_count,
            "NodeToken": NODE,
            "DefaultAbsolutePantTiltPositionSpace": self.position,
            "DefaultAbsoluteZoomPositionSpace": spaces.ZOOM_POSITION,
            "DefaultRelativePanTiltTranslationSpace": self.translation,
            "DefaultRelativeZoomTranslationSpace": spaces.ZOOM_TRANSLATION,
            "DefaultContinuousPanTiltVelocitySpace": spaces.VELOCITY,
            "DefaultContinuousZoomVelocitySpace": spaces.ZOOM_VELOCITY,
            "DefaultPTZSpeed": {
                "PanTilt": {"x": self.speed, "y": self.speed, "space": spaces.SPEED},
                "Zoom": {"x": self.zoom_speed, "space": spaces.ZOOM_SPEED},
            },
            "DefaultPTZTimeout": timedelta(seconds=self.timeout_s),
            "PanTiltLimits": {"Range": _space_fields(pan_tilt)},
            "ZoomLimits": {"Range": _space_fields(self.spaces.zoom_positions[0])},
        }

    def _node(self) -> dict[str, Any]:
        return {
            "token": NODE,
            "FixedHomePosition": False,
            "Name": "PTZ",
            "SupportedPTZSpaces": self._all_spaces(),
            "MaximumNumberOfPresets": MAX_PRESETS,
            "HomeSupported": True,
        }

    def _all_spaces(self) -> dict[str, Any]:
        groups = {
            "AbsolutePanTiltPositionSpace": self.spaces.positions,
            "AbsoluteZoomPositionSpace": self.spaces.zoom_positions,
            "RelativePanTiltTranslationSpace": self.spaces.translations,
            "RelativeZoomTranslationSpace": self.spaces.zoom_translations,
            "ContinuousPanTiltVelocitySpace": self.spaces.velocities,
            "ContinuousZoomVelocitySpace": self.spaces.zoom_velocities,
            "PanTiltSpeedSpace": self.spaces.speeds,
            "ZoomSpeedSpace": self.spaces.zoom_speeds,
        }
        return {name: [_space_fields(space) for space in group] for name, group in groups.items()}

    def _get_node(self, request: Request) -> Reply:
        require_token("PTZ node", request.NodeToken, NODE, "NoEntity")
        return {"PTZNode": self._node()}

    def _get_configuration(self, request: Request) -> Reply:
        self._require(request.PTZConfigurationToken)
        return {"PTZConfiguration": self.values()}

    def _options(self, request: Request) -> Reply:
        self._require(request.ConfigurationToken)
        timeout = {"Min": timedelta(seconds=MIN_TIMEOUT_S), "Max": timedelta(seconds=MAX_TIMEOUT_S)}
        return {"PTZConfigurationOptions": {"Spaces": self._all_spaces(), "PTZTimeout": timeout}}

    def _set(self, request: Request) -> Reply:
        requested = request.PTZConfiguration
        self._require(requested.token)
        position = _require_space(self.spaces.positions, requested.DefaultAbsolutePantTiltPositionSpace, self.position)
        translation = _require_space(self.spaces.translations, requested.DefaultRelativePanTiltTranslationSpace, self.translation)
        _require_space(self.spaces.zoom_positions, requested.DefaultAbsoluteZoomPositionSpace, spaces.ZOOM_POSITION)
        _require_space(self.spaces.zoom_translations, requested.DefaultRelativeZoomTranslationSpace, spaces.ZOOM_TRANSLATION)
        _require_space(self.spaces.velocities, requested.DefaultContinuousPanTiltVelocitySpace, spaces.VELOCITY)
        _require_space(self.spaces.zoom_velocities, requested.DefaultContinuousZoomVelocitySpace, spaces.ZOOM_VELOCITY)
        speed, zoom_speed = self.speed_fractions(requested.DefaultPTZSpeed, "ConfigModify")
        timeout_s: float | None = self.timeout_s
        if requested.DefaultPTZTimeout is not None:
            timeout_s = duration_s(requested.DefaultPTZTimeout)
        if requested.NodeToken != NODE or timeout_s is None:
            raise invalid_argument("The node is unknown, or the default timeout is not one of the options.", "ConfigModify")
        self.name = (requested.Name or self.name)[:64]
        self.position, self.translation, self.timeout_s = position, translation, timeout_s
        self.speed, self.zoom_speed = speed, zoom_speed
        return {}

    def speed_fractions(self, speed: Any, subcode: str = "InvalidSpeed") -> tuple[float, float]:
        """Return the requested pan/tilt speed and zoom speed as fractions of the top speeds.

        Missing values and 0 mean the default.

        Raises:
            SoapFault: A number is not from 0 to 1, or a space is not supported.
        """
        pan_tilt, zoom = getattr(speed, "PanTilt", None), getattr(speed, "Zoom", None)
        fraction, zoom_fraction = self.speed, self.zoom_speed
        if pan_tilt is not None:
            space = spaces.requested_space(self.spaces.speeds, pan_tilt, spaces.SPEED)
            spaces.Space(space.uri, space.x, space.x).check(pan_tilt, subcode)
            fraction = min(max(pan_tilt.x, pan_tilt.y) or self.speed, 1.0)
        if zoom is not None:
            spaces.requested_space(self.spaces.zoom_speeds, zoom, spaces.ZOOM_SPEED).check(zoom, subcode)
            zoom_fraction = min(zoom.x or self.zoom_speed, 1.0)
        return fraction, zoom_fraction

    def _require(self, token: str | None) -> None:
        require_token("PTZ configuration", token, CONFIGURATION, "NoConfig")


def _space_fields(space: spaces.Space) -> dict[str, Any]:
    fields: dict[str, Any] = {"URI": space.uri, "XRange": {"Min": space.x[0], "Max": space.x[1]}}
    if space.y is not None:
        fields["YRange"] = {"Min": space.y[0], "Max": space.y[1]}
    return fields


def _require_space(group: tuple[spaces.Space, ...], uri: str | None, default: str) -> str:
    if uri is not None and uri not in {space.uri for space in group}:
        raise invalid_argument("A default space is not one of the options.", "ConfigModify")
    return uri or default
