"""Control the motors of an ONVIF device, with angles in degrees and zoom as magnification."""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable
from datetime import timedelta
from typing import TYPE_CHECKING, Any

from scope_ptz.camera.network.errors import CameraReplyError
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.geometry import Pose, wrap_pan_deg

if TYPE_CHECKING:
    from scope_ptz.camera.onvif.client import OnvifClient
    from scope_ptz.camera.onvif.device import OnvifDevice
    from scope_ptz.camera.onvif.spaces import Ends, ReportedSpace


class OnvifMotors:
    """PTZ control through one media profile.

    Args:
        client: The connection.
        device: The device's properties and capabilities.
    """

    def __init__(self, client: OnvifClient, device: OnvifDevice) -> None:
        self._client, self._device = client, device
        self._sends_timeout = True

    async def pose(self) -> Pose:
        """Read the position. The reported move status is not used, because it is unreliable on many devices.

        Raises:
            CameraReplyError: The device does not report its position, or the position is not a number.
        """
        status = await self._client.call("ptz", "GetStatus", ProfileToken=self._device.ptz_profile)
        position = getattr(status, "Position", None)
        pan_tilt = getattr(position, "PanTilt", None)
        if pan_tilt is None or pan_tilt.x is None or pan_tilt.y is None:
            raise CameraReplyError(
                f"The camera at {self._client.address} does not report its position, so moves cannot be checked. "
                "Try updating its firmware."
            )
        space = self._device.report_spaces.get(str(pan_tilt.space or "")) or self._device.report_spaces[""]
        pan_deg, tilt_deg = space.pan.to_value(float(pan_tilt.x)), space.tilt.to_value(float(pan_tilt.y))
        zoom = getattr(position, "Zoom", None)
        units = self._device.zoom.rows[0][0] if zoom is None or zoom.x is None else float(zoom.x)
        if not all(map(math.isfinite, (pan_deg, tilt_deg, units))):
            raise CameraReplyError(f"The camera at {self._client.address} reports a position that is not a number.")
        if self._device.limits.pan_endless:
            pan_deg = wrap_pan_deg(pan_deg)
        return Pose(pan_deg, tilt_deg, self._device.zoom.to_zoom(units))

    async def move(self, pose: Pose) -> None:
        """Start moving to a pose, which must be within the limits."""
        space, zoom = self._device.move_space, self._device.zoom
        position: dict[str, Any] = {
            "PanTilt": {"x": space.pan.to_units(pose.pan_deg), "y": space.tilt.to_units(pose.tilt_deg), "space": space.uri}
        }
        if zoom.moves:
            position["Zoom"] = {"x": zoom.to_units(pose.zoom), "space": zoom.uri}
        await self._client.call("ptz", "AbsoluteMove", ProfileToken=self._device.ptz_profile, Position=position)

    def centring_command(self, current: Pose, target: Pose, x: float, y: float) -> Callable[[], Awaitable[None]] | None:
        """Return a command that centres a point in the picture with a relative move in fractions of the field of view.

        Args:
            current: The current pose.
            target: The pose that the command should reach; only its zoom is used.
            x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
            y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).

        Returns:
            The command; None if the device does not support such moves, or cannot combine them with the requested zoom.
        """
        device, space = self._device, self._device.fov_translation
        if space is None or space.y is None:
            return None
        turn = {"x": _interpolate(x, space.x), "y": _interpolate(1.0 - y, space.y), "space": space.uri}
        translation: dict[str, Any] = {"PanTilt": turn}
        if not math.isclose(current.zoom, target.zoom, rel_tol=1e-6):
            if device.zoom_translation is None:
                return None
            units = device.zoom.to_units(target.zoom) - device.zoom.to_units(current.zoom)
            translation["Zoom"] = {"x": units, "space": device.zoom_translation.uri}

        async def send() -> None:
            await self._client.call("ptz", "RelativeMove", ProfileToken=device.ptz_profile, Translation=translation)

        return send

    async def drive(self, pan_dps: float, tilt_dps: float, zoom_rate: float, timeout_s: float) -> None:
        """Move continuously at the given velocities. The request includes a timeout unless the device rejects timeouts."""
        top, velocity = self._device.capabilities.top_speed, {}
        if self._device.velocity is not None:
            space = self._device.velocity
            velocity["PanTilt"] = {
                "x": _speed(pan_dps, top.pan_dps, space, self._device.move_space.pan.values),
                "y": _speed(tilt_dps, top.tilt_dps, space, self._device.move_space.tilt.values, axis="y"),
                "space": space.uri,
            }
        if top.zoom_rate and self._device.zoom_velocity is not None:
            space = self._device.zoom_velocity
            velocity["Zoom"] = {"x": _speed(zoom_rate, top.zoom_rate, space), "space": space.uri}
        arguments: dict[str, Any] = {"ProfileToken": self._device.ptz_profile, "Velocity": velocity}
        shortest_s, longest_s = self._device.timeout_s
        if self._sends_timeout:
            limit = {"Timeout": timedelta(seconds=min(max(timeout_s, shortest_s), longest_s))}
            try:
                await self._client.call("ptz", "ContinuousMove", **arguments, **limit)
            except OnvifFaultError as fault:
                if not fault.has_any_code("TimeoutNotSupported", "InvalidArgVal"):
                    raise
                self._sends_timeout = False
            else:
                return
        await self._client.call("ptz", "ContinuousMove", **arguments)

    async def stop(self) -> None:
        """Stop all axes."""
        await self._client.call("ptz", "Stop", ProfileToken=self._device.ptz_profile, PanTilt=True, Zoom=True)

    async def go_home(self) -> None:
        """Start moving to the home position. No speed is sent, because some devices reject it."""
        await self._client.call("ptz", "GotoHomePosition", ProfileToken=self._device.ptz_profile)


def _interpolate(fraction: float, ends: Ends) -> float:
    """Return the value at a fraction of a range."""
    return ends[0] + fraction * (ends[1] - ends[0])


def _speed(
    value: float, top: float, space: ReportedSpace, axis_units: tuple[float, float] = (0.0, 1.0), *, axis: str = "x"
) -> float:  # fmt: skip
    """Convert a velocity to a coordinate in a generic space, whose ends are the top speeds.

    The sign is inverted if the axis's units run in the opposite direction.
    """
    if not value or not top:
        return 0.0
    low, high = space.y if axis == "y" and space.y is not None else space.x
    fraction = min(max(value / top, -1.0), 1.0) * (1.0 if axis_units[0] < axis_units[1] else -1.0)
    return fraction * (high if fraction > 0 else -low)
