"""The move and status operations of the ONVIF PTZ service."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.camera.motion import top_speed
from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif import spaces
from scope_ptz.virtual_camera.onvif.clock import device_datetime, device_time_s
from scope_ptz.virtual_camera.onvif.media_profiles import find_profile
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration, duration_s
from scope_ptz.virtual_camera.onvif.soap import SoapFault, invalid_argument


class PtzService:
    """The operations for moves and status.

    Args:
        device: The camera.
        configuration: Its PTZ configuration.
    """

    def __init__(self, device: VirtualDevice, configuration: PtzConfiguration) -> None:
        self._device, self._configuration, self._spaces = device, configuration, configuration.spaces

    def operations(self) -> Operations:
        """Return the operations by name."""
        return {
            "GetServiceCapabilities": Operation(self._capabilities, None),
            "GetStatus": Operation(self._status),
            "AbsoluteMove": Operation(self._absolute, Role.OPERATOR),
            "RelativeMove": Operation(self._relative, Role.OPERATOR),
            "ContinuousMove": Operation(self._continuous, Role.OPERATOR),
            "Stop": Operation(self._stop, Role.OPERATOR),
        }

    def position(self, pose: Pose) -> dict[str, Any]:
        """Convert a pose to an ONVIF position in the default spaces."""
        x, y = self._spaces.position(pose, self._configuration.position)
        return {
            "PanTilt": {"x": x, "y": y, "space": self._configuration.position},
            "Zoom": {"x": self._spaces.zoom_position(pose), "space": spaces.ZOOM_POSITION},
        }

    def _capabilities(self, _: Request) -> Reply:
        # These attributes are newer than the WSDL files in onvif-zeep-async, so they are passed as additional attributes.
        reports = self._device.reported_moving() is not None
        extra_attributes = {"MoveStatus": "true" if reports else "false", "StatusPosition": "true"}
        return {
            "Capabilities": {"EFlip": False, "Reverse": False, "GetCompatibleConfigurations": True, "_attr_1": extra_attributes}
        }

    def _status(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        status = {"Position": self.position(self._device.pose()), "UtcTime": device_datetime(self._device)}
        if (moving := self._device.reported_moving()) is not None:
            status_text = "MOVING" if moving else "IDLE"
            status["MoveStatus"] = {"PanTilt": status_text, "Zoom": status_text}
        return {"PTZStatus": status}

    def _absolute(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        pan_tilt, zoom = _axes(request.Position)
        pose = self._device.destination
        if pan_tilt is not None:
            space = spaces.requested_space(self._spaces.positions, pan_tilt, self._configuration.position)
            space.check(pan_tilt, "InvalidPosition")
            pose = self._spaces.at_position(pose, space, pan_tilt.x, pan_tilt.y)
        if zoom is not None:
            spaces.requested_space(self._spaces.zoom_positions, zoom, spaces.ZOOM_POSITION).check(zoom, "InvalidPosition")
            pose = self._spaces.at_zoom_position(pose, zoom.x)
        self._move(pose, request.Speed)
        return {}

    def _relative(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        pan_tilt, zoom = _axes(request.Translation)
        current, pose = self._device.pose(), self._device.destination
        if pan_tilt is not None:
            space = spaces.requested_space(self._spaces.translations, pan_tilt, self._configuration.translation)
            space.check(pan_tilt, "InvalidTranslation")
            turned = self._spaces.turn(current, space, pan_tilt.x, pan_tilt.y)
            pose = replace(turned, zoom=pose.zoom)
        if zoom is not None:
            spaces.requested_space(self._spaces.zoom_translations, zoom, spaces.ZOOM_TRANSLATION).check(zoom, "InvalidTranslation")
            pose = replace(pose, zoom=self._spaces.change_zoom(current, zoom.x).zoom)
        self._move(pose, request.Speed)
        return {}

    def _continuous(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        pan_tilt, zoom = _axes(request.Velocity)
        velocity, top = self._device.commanded_velocity, top_speed(self._device.head)
        if pan_tilt is not None:
            spaces.requested_space(self._spaces.velocities, pan_tilt, spaces.VELOCITY).check(pan_tilt, "InvalidVelocity")
            velocity = replace(velocity, pan_dps=pan_tilt.x * top.pan_dps, tilt_dps=pan_tilt.y * top.tilt_dps)
        if zoom is not None:
            spaces.requested_space(self._spaces.zoom_velocities, zoom, spaces.ZOOM_VELOCITY).check(zoom, "InvalidVelocity")
            velocity = replace(velocity, zoom_rate=zoom.x * top.zoom_rate)
        timeout_s: float | None = self._configuration.timeout_s
        if request.Timeout is not None and (timeout_s := duration_s(request.Timeout)) is None:
            raise invalid_argument("The timeout is outside the supported range.", "TimeoutNotSupported")
        if velocity == Velocity():
            self._device.stop(sent_s=self._sent_s(request, latest=False))
            return {}
        # The device drops a move that was sent before a stop but arrives after it. The reply is the same as for a successful move.
        self._device.drive(velocity, timeout_s=timeout_s, sent_s=self._sent_s(request, latest=True))
        return {}

    def _stop(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        pan_tilt, zoom = request.PanTilt, request.Zoom
        if pan_tilt is None and zoom is None:
            pan_tilt = zoom = True
        sent_s = self._sent_s(request, latest=False)
        self._device.stop(pan_tilt=bool(pan_tilt), zoom=bool(zoom), sent_s=sent_s)
        return {}

    def _sent_s(self, request: Request, *, latest: bool) -> float | None:
        """Return the time at which a request was created, in Unix seconds; None if the request does not include it.

        A time in the future is replaced with the current time. Otherwise, a stop from a client whose clock is fast would block
        other clients' moves.

        Args:
            request: The request.
            latest: Whether to return the latest possible time (for a move) or the earliest (for a stop). If it is unclear which of
                the two was sent first, the move is therefore carried out.
        """
        if request.created_at is None:
            return None
        created_s = request.created_at.latest_s if latest else request.created_at.earliest_s
        return min(created_s, device_time_s(self._device)) - self._device.faults.clock_skew_s

    def _move(self, pose: Pose, speed: Any) -> None:
        fraction, zoom_fraction = self._configuration.speed_fractions(speed)
        self._device.move(pose, speed_fraction=fraction, zoom_fraction=zoom_fraction)


def _axes(vector: Any) -> tuple[Any, Any]:
    """Return the pan/tilt part and the zoom part of a vector; one of them may be None.

    Raises:
        SoapFault: Both parts are missing.
    """
    pan_tilt, zoom = getattr(vector, "PanTilt", None), getattr(vector, "Zoom", None)
    if pan_tilt is None and zoom is None:
        raise SoapFault("The move must specify pan and tilt, zoom, or both.", "InvalidArgs")
    return pan_tilt, zoom
