"""Read the properties and capabilities of an AXIS device."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.camera.axis import requests
from scope_ptz.camera.axis.client import VapixClient
from scope_ptz.camera.axis.lens import focus_actions, iris_actions
from scope_ptz.camera.axis.replies import DeviceLimits, VapixError, decode_text, parse_limits, parse_table, parse_values
from scope_ptz.camera.axis.scales import SpeedScale, ZoomScale, build_optics, build_zoom_scale
from scope_ptz.camera.capabilities import Capabilities, Velocity
from scope_ptz.camera.network.errors import CameraReplyError, NotACameraError
from scope_ptz.errors import CameraError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Optics

KNOWN_OPTICS = {"AXIS M5075-G": AXIS_M5075_G}
"""Optics by product name, for devices that do not report their field of view."""

RTSP_PORT = 554
"""The standard port of RTSP servers."""

DEFAULT_SPEEDS = ((1.0, 1.0), (100.0, 100.0))
"""Rows of (device speed, degrees per second), assumed for devices without a speed table."""

DEFAULT_ZOOM_RATE = 1.0
"""Assumed top zoom speed in octaves per second; VAPIX does not report one."""


@dataclass(frozen=True, slots=True)
class AxisDevice:
    """The properties and capabilities of an AXIS device, read from its replies.

    Attributes:
        model: Product name; empty if the device reports none.
        limits: Limits of motion, with angles in degrees and zoom as magnification.
        optics: The lens, which relates magnification to field of view.
        zoom: The relation between zoom positions and magnifications.
        speeds: The relation between the device's speeds and degrees per second.
        capabilities: Capabilities beyond moving to a pose.
        supported: Names of the functions whose ``PTZ.Support`` parameter is true, such as ``AutoFocus``.
        control_queue_on: Whether the control queue is enabled, so that commands require control.
        locked: Whether the position is locked, so that the camera cannot be moved.
        sizes: Picture sizes that the device reports, as (width, height); empty if it reports none.
        firmware: Firmware version; empty if the device reports none.
    """

    model: str
    limits: Limits
    optics: Optics
    zoom: ZoomScale
    speeds: SpeedScale
    capabilities: Capabilities
    supported: frozenset[str]
    control_queue_on: bool
    locked: bool
    sizes: tuple[tuple[int, int], ...]
    firmware: str = ""


async def read_device(
    client: VapixClient, *, fields_deg: tuple[float, float] | None = None, measured: tuple[tuple[float, float], ...] | None = None
) -> AxisDevice:
    """Read the properties and capabilities of a device.

    Args:
        client: The connection.
        fields_deg: Horizontal fields of view in degrees at the widest and the closest zoom; None to use the values that the device
            reports.
        measured: Measured rows of (fraction of the zoom range, horizontal field of view in degrees), widest first.
            They are used if they cover the whole zoom range and ``fields_deg`` is None.

    Raises:
        NotACameraError: The device is not an AXIS camera with pan, tilt and zoom.
        CameraError: The device cannot be reached, rejects the credentials, or reports no field of view.
    """
    channel = client.channel
    brand = await _read_parameters(client, "root.Brand")
    ptz = await _read_parameters(client, "root.PTZ")
    image = await _read_parameters(client, "root.Properties.Image")
    firmware = (await _read_parameters(client, "root.Properties.Firmware")).get("Properties.Firmware.Version", "")
    model = brand.get("Brand.ProdFullName") or brand.get("Brand.ProdShortName") or ""
    reported = await _read_limits(client)
    if fields_deg is None and measured is not None and measured[0][0] < 0.01 and measured[-1][0] > 0.99:
        fields = ((0.0, measured[0][1]), *measured[1:-1], (1.0, measured[-1][1]))
    else:
        end_fields = fields_deg or _end_fields(model[:60], reported)
        fields = ((0.0, end_fields[0]), (1.0, end_fields[1]))
    widest, closest = fields[0][1], fields[-1][1]
    zoom = build_zoom_scale(
        await _read_table(client, "zoom", "zoomSteps"), reported.min_zoom_units, reported.max_zoom_units, widest, closest
    )  # fmt: skip
    speeds = SpeedScale(await _read_table(client, "speed", "speeds") or DEFAULT_SPEEDS)
    supported = frozenset(
        name.rsplit(".", 1)[1] for name, value in ptz.items() if name.startswith(f"PTZ.Support.S{channel}.") and value == "true"
    )
    prefix = f"PTZ.Various.V{channel}."
    return AxisDevice(
        model=model[:60],
        limits=_limits_in_degrees(reported, zoom),
        optics=build_optics(zoom, fields),
        zoom=zoom,
        speeds=speeds,
        capabilities=_capabilities(supported, speeds),
        supported=supported,
        control_queue_on=ptz.get(f"{prefix}CtlQueueing") == "true",
        locked=ptz.get(f"{prefix}Locked") == "true",
        sizes=_parse_sizes(image.get("Properties.Image.Resolution", "")),
        firmware="".join(c for c in firmware if c.isprintable())[:40],
    )


async def read_rtsp_port(client: VapixClient) -> int:
    """Return the RTSP port that the device reports, or the standard port if it reports none."""
    text = (await _read_parameters(client, "root.Network.RTSP")).get("Network.RTSP.Port", "")
    return int(text) if text.isdecimal() and 0 < int(text) < 65536 else RTSP_PORT


def _capabilities(supported: frozenset[str], speeds: SpeedScale) -> Capabilities:
    """Return a device's capabilities. If it has no ``PTZ.Support`` parameters, assume that continuous moves and presets work."""
    unreported = not supported
    top = Velocity(
        speeds.top_dps if unreported or "ContinuousPan" in supported else 0.0,
        speeds.top_dps if unreported or "ContinuousTilt" in supported else 0.0,
        DEFAULT_ZOOM_RATE if unreported or "ContinuousZoom" in supported else 0.0,
    )
    return Capabilities(
        top,
        edits_presets=unreported or "ServerPreset" in supported,
        focus=focus_actions(supported),
        iris=iris_actions(supported),
    )


async def _read_limits(client: VapixClient) -> DeviceLimits:
    try:
        return parse_limits((await client.send(requests.query(client.channel, "limits"))).body)
    except (VapixError, CameraReplyError) as error:
        message = f"The device at {client.address} is not an AXIS camera with pan, tilt and zoom. {error}"
        raise NotACameraError(message) from None


async def _read_parameters(client: VapixClient, group: str) -> dict[str, str]:
    """Return a group of parameters; empty if the device has no such group."""
    try:
        return parse_values(decode_text((await client.send(requests.parameters(group))).body))
    except (VapixError, CameraReplyError):
        return {}


async def _read_table(client: VapixClient, group: str, attribute: str) -> tuple[tuple[float, float], ...]:
    """Return a calibration table; empty if the device has none, for example because its firmware is old."""
    request = requests.attributes(client.channel, "zoom" if group == "zoom" else "speed")
    try:
        rows = parse_table((await client.send(request)).body, client.channel, attribute, group)
    except (VapixError, CameraReplyError):
        return ()
    return rows if len(rows) >= 2 else ()


def _end_fields(model: str, reported: DeviceLimits) -> tuple[float, float]:
    """Return the horizontal fields of view in degrees at the widest and the closest zoom, as reported or known for the model."""
    widest, closest = reported.max_field_angle, reported.min_field_angle
    if widest is not None and closest is not None and 0 < closest < widest <= 1800:
        return widest / 10, closest / 10
    if (optics := KNOWN_OPTICS.get(model)) is not None:
        return optics.table[0][1], optics.table[-1][1]
    raise CameraError(
        "The camera does not report its field of view. Add the values from its data sheet in degrees: ?hfov_wide=...&hfov_tele=..."
    )


def _limits_in_degrees(reported: DeviceLimits, zoom: ZoomScale) -> Limits:
    endless = reported.max_pan_deg - reported.min_pan_deg >= 360.0
    return Limits(
        reported.min_pan_deg, reported.max_pan_deg, reported.min_tilt_deg, reported.max_tilt_deg,
        zoom.min_zoom, zoom.max_zoom, pan_endless=endless,
    )  # fmt: skip


def _parse_sizes(text: str) -> tuple[tuple[int, int], ...]:
    """Parse sizes in the form ``1920x1080,1280x720,...``."""
    pairs = (part.strip().partition("x") for part in text.split(","))
    return tuple(
        (int(w), int(h)) for w, _, h in pairs if w.isdecimal() and h.isdecimal() and 0 < int(w) <= 20000 and 0 < int(h) <= 20000
    )
