"""Build VAPIX requests (a path and a query) from validated values. This module does not send them.

Sources: the pan/tilt/zoom, video streaming and parameter management chapters of the VAPIX library.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from scope_ptz.camera.capabilities import check_preset_name
from scope_ptz.errors import InputError

PTZ_PATH = "/axis-cgi/com/ptz.cgi"
CONFIGURATION_PATH = "/axis-cgi/com/ptzconfig.cgi"
QUEUE_PATH = "/axis-cgi/com/ptzqueue.cgi"
PARAMETER_PATH = "/axis-cgi/param.cgi"
SNAPSHOT_PATH = "/axis-cgi/jpg/image.cgi"
MJPEG_PATH = "/axis-cgi/mjpg/video.cgi"
RTSP_PATH = "/axis-media/media.amp"

_INVALID_PRESET_CHARS = '"<>~:'


@dataclass(frozen=True, slots=True)
class VapixRequest:
    """A VAPIX request.

    Attributes:
        path: The path on the device.
        query: Query parameters, not yet URL-encoded.
        retryable: Whether the request may be sent again after a lost connection. This is safe only if it is idempotent.
    """

    path: str
    query: dict[str, str]
    retryable: bool = True


def absolute(channel: int, pan_deg: float, tilt_deg: float, zoom_units: int) -> VapixRequest:
    """Move to an absolute position. Angles are in degrees; zoom is in the device's units (1 to 19999)."""
    _check_finite(pan_deg=pan_deg, tilt_deg=tilt_deg)
    query = {"pan": _format_number(_clamp(pan_deg, 180.0)), "tilt": _format_number(_clamp(tilt_deg, 180.0))}
    return _ptz(channel, **query, zoom=str(min(max(zoom_units, 1), 19999)))


def centre(channel: int, x: float, y: float, percent: int, size: tuple[int, int]) -> VapixRequest:
    """Centre a point in the picture, and optionally zoom.

    Args:
        channel: The video channel.
        x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
        y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).
        percent: The resulting focal length as a percentage of the current one.
        size: Width and height in pixels of the picture to which the coordinates in the request refer.
    """
    width, height = size
    point, size_fields = f"{round(x * width)},{round(y * height)}", {"imagewidth": str(width), "imageheight": str(height)}
    command = {"center": point} if percent == 100 else {"areazoom": f"{point},{max(percent, 1)}"}
    return replace(_ptz(channel, **command, **size_fields), retryable=False)


def continuous_pan_tilt(channel: int, pan: int, tilt: int, *, proportional: bool = False) -> VapixRequest:
    """Pan and tilt continuously at velocities from -100 to 100.

    Args:
        channel: The video channel.
        pan: Pan velocity, positive to the right.
        tilt: Tilt velocity, positive upwards.
        proportional: Whether the device scales velocities with zoom by default; the request turns this off.
    """
    extra = {"proportionalspeed": "disabled"} if proportional else {}
    return _ptz(channel, continuouspantiltmove=f"{_clamp_speed(pan)},{_clamp_speed(tilt)}", **extra)


def continuous_zoom(channel: int, zoom: int) -> VapixRequest:
    """Zoom continuously at a velocity from -100 to 100, positive to zoom in."""
    return _ptz(channel, continuouszoommove=str(_clamp_speed(zoom)))


def stop(channel: int) -> tuple[VapixRequest, ...]:
    """Stop all axes, whether they are moving continuously or to a position."""
    return continuous_pan_tilt(channel, 0, 0), continuous_zoom(channel, 0), _ptz(channel, move="stop")


def home(channel: int) -> VapixRequest:
    """Go to the home position."""
    return _ptz(channel, move="home")


def go_to_preset(channel: int, name: str) -> VapixRequest:
    """Go to a preset by name."""
    return _ptz(channel, gotoserverpresetname=name)


def save_preset(channel: int, name: str) -> VapixRequest:
    """Save the current position as a preset.

    Raises:
        InputError: The name is invalid, or contains characters that AXIS cameras do not allow.
    """
    check_preset_name(name)
    if invalid := sorted(set(name) & set(_INVALID_PRESET_CHARS)):
        raise InputError(f"An AXIS preset name may not contain {' '.join(invalid)}. Choose another name.")
    return VapixRequest(CONFIGURATION_PATH, {"camera": _channel(channel), "setserverpresetname": name})


def remove_preset(channel: int, name: str) -> VapixRequest:
    """Remove a preset by name."""
    return VapixRequest(CONFIGURATION_PATH, {"camera": _channel(channel), "removeserverpresetname": name})


def autofocus(channel: int, *, on: bool) -> VapixRequest:
    """Turn autofocus on or off."""
    return _ptz(channel, autofocus=_on_or_off(on))


def autoiris(channel: int, *, on: bool) -> VapixRequest:
    """Turn the automatic iris on or off."""
    return _ptz(channel, autoiris=_on_or_off(on))


def relative_focus(channel: int, steps: int) -> VapixRequest:
    """Move the focus by a number of steps, positive to focus farther away."""
    return replace(_ptz(channel, rfocus=str(_clamp_steps(steps))), retryable=False)


def relative_iris(channel: int, steps: int) -> VapixRequest:
    """Move the iris by a number of steps, positive to open it."""
    return replace(_ptz(channel, riris=str(_clamp_steps(steps))), retryable=False)


def query(channel: int, topic: Literal["position", "limits", "presetposcam", "speed"]) -> VapixRequest:
    """Read the position, the limits, the presets or the speed."""
    return _ptz(channel, query=topic)


def attributes(channel: int, group: Literal["zoom", "speed"]) -> VapixRequest:
    """Read the calibration table for zoom or speed."""
    return _ptz(channel, query="attributes", group=group, format="json")


def control_queue(channel: int, action: Literal["request", "drop", "query"]) -> VapixRequest:
    """Request PTZ control, release it, or read this client's position in the queue."""
    return VapixRequest(QUEUE_PATH, {"camera": _channel(channel), "control": action})


def parameters(group: str) -> VapixRequest:
    """List a group of parameters, such as ``root.PTZ``."""
    return VapixRequest(PARAMETER_PATH, {"action": "list", "group": group})


def snapshot(channel: int, width: int, height: int, *, compression: int = 15) -> VapixRequest:
    """Take one JPEG picture. ``compression`` goes from 0 (best quality) to 100."""
    query = {"camera": _channel(channel), "resolution": f"{width}x{height}", "compression": str(compression)}
    return VapixRequest(SNAPSHOT_PATH, query)


def mjpeg(channel: int, width: int, height: int, rate_hz: float, *, compression: int = 25) -> VapixRequest:
    """Open a Motion JPEG stream of at most ``rate_hz`` pictures per second."""
    picture = snapshot(channel, width, height, compression=compression)
    return VapixRequest(MJPEG_PATH, {**picture.query, "fps": str(min(max(math.ceil(rate_hz), 1), 60))})


def rtsp_path(channel: int, width: int, height: int, rate_hz: float) -> str:
    """Return the path and query for an H.264 stream."""
    rate = min(max(math.ceil(rate_hz), 1), 60)
    return f"{RTSP_PATH}?camera={_channel(channel)}&videocodec=h264&resolution={width}x{height}&fps={rate}"


def _ptz(channel: int, **arguments: str) -> VapixRequest:
    return VapixRequest(PTZ_PATH, {"camera": _channel(channel), **arguments})


def _channel(channel: int) -> str:
    if channel < 1:
        raise InputError(f"The channel of an AXIS camera must be 1 or more; got {channel}.")
    return str(channel)


def _check_finite(**values: float) -> None:
    for name, value in values.items():
        if not math.isfinite(value):
            raise InputError(f"{name} must be a finite number; got {value}.")


def _clamp(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)


def _format_number(value: float) -> str:
    """Format a number without an exponent, which devices cannot parse, and without a minus sign on zero."""
    return f"{value:.4f}".rstrip("0").rstrip(".").replace("-0", "0", 1) if abs(value) < 5e-5 else f"{value:.4f}"


def _clamp_speed(value: int) -> int:
    return min(max(value, -100), 100)


def _clamp_steps(value: int) -> int:
    return min(max(value, -9999), 9999)


def _on_or_off(on: bool) -> str:
    return "on" if on else "off"
