"""Read the properties and capabilities of an ONVIF device: profiles, spaces, limits and optics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scope_ptz.camera.capabilities import Capabilities, Velocity
from scope_ptz.camera.network.errors import CameraReplyError, CameraSignInError
from scope_ptz.camera.onvif import spaces
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.camera.onvif.mapping import (
    ASSUMED_FIELDS_DEG,
    ASSUMED_PAN_DEG,
    ASSUMED_SPEED,
    ASSUMED_TILT_DEG,
    OnvifMapping,
    known_mapping,
    zoom_rows,
)
from scope_ptz.camera.onvif.spaces import Ends, LinearScale, PanTiltSpace, ReportedSpace, ZoomSpace
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Limits

if TYPE_CHECKING:
    from scope_ptz.camera.onvif.client import OnvifClient

ENDLESS_DEG = 359.5
"""A pan range of at least this many degrees counts as endless."""


@dataclass(frozen=True, slots=True)
class OnvifDevice:
    """The properties and capabilities of an ONVIF device.

    Attributes:
        manufacturer: Its manufacturer.
        model: Its model.
        firmware: Version of its firmware.
        ptz_profile: Token of the profile through which it is moved.
        picture_profile: Token of the profile whose pictures are taken.
        width: Width of the stream in pixels.
        height: Height of the stream in pixels.
        move_space: The coordinate space of absolute moves.
        report_spaces: The spaces in which it may report positions, by URI; the key "" is for positions that name no space.
        zoom: The space of zoom positions.
        velocity: The generic velocity space of pan and tilt; None if they cannot be driven.
        zoom_velocity: The generic velocity space of the zoom; None if it cannot be driven.
        fov_translation: The space of relative turns in fractions of the field of view; None if it has none.
        zoom_translation: The generic space of relative zoom; None if it has none.
        video_source: Token of the video source, for focus and iris.
        timeout_s: Shortest and longest timeout, in seconds, that it accepts for a continuous move.
        limits: Limits of motion.
        capabilities: Its optional capabilities, without focus and iris.
        assumed: Names of the values that are only assumed, because they are not reported, configured or measured.
    """

    manufacturer: str
    model: str
    firmware: str
    ptz_profile: str
    picture_profile: str
    width: int
    height: int
    move_space: PanTiltSpace
    report_spaces: dict[str, PanTiltSpace]
    zoom: ZoomSpace
    velocity: ReportedSpace | None
    zoom_velocity: ReportedSpace | None
    fov_translation: ReportedSpace | None
    zoom_translation: ReportedSpace | None
    video_source: str
    timeout_s: Ends
    limits: Limits
    capabilities: Capabilities
    assumed: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Manufacturer and model."""
        return " ".join(word for word in (self.manufacturer, self.model) if word) or "ONVIF camera"


async def read_device(client: OnvifClient, mapping: OnvifMapping, *, width: int = 1280, profile: str = "") -> OnvifDevice:
    """Read the properties and capabilities of a device.

    Args:
        client: The connection.
        mapping: Configured or measured values. They take precedence over those known for the model.
        width: The requested width of pictures in pixels.
        profile: Token or name of the profile to use; by default, a suitable one.

    Raises:
        CameraError: The device cannot be reached, refuses the account, or has no position space.
    """
    information = await client.call("devicemgmt", "GetDeviceInformation")
    manufacturer, model, firmware = (_word(information[key]) for key in ("Manufacturer", "Model", "FirmwareVersion"))
    mapping = mapping.with_missing_from(known_mapping(model))
    ptz, picture = choose_profiles(await client.call("media", "GetProfiles"), str(client.address), width, profile)
    configuration = ptz.PTZConfiguration
    offered, timeout = await _options(client, configuration)
    assumed: list[str] = []
    stated = {space.uri: space for space in spaces.reported_spaces(offered.AbsolutePanTiltPositionSpace) if space.y is not None}
    report_spaces = _position_spaces(stated, mapping, assumed)
    if not report_spaces:
        raise CameraReplyError(
            f"The camera at {client.address} reports no space of absolute positions, so SCOPE cannot move it to a pose."
        )
    move_space = report_spaces.get(spaces.DEGREES) or next(iter(report_spaces.values()))
    zoom = _zoom_space(spaces.reported_spaces(offered.AbsoluteZoomPositionSpace), mapping, assumed)
    velocity = _first(spaces.reported_spaces(offered.ContinuousPanTiltVelocitySpace), spaces.VELOCITY)
    zoom_velocity = _first(spaces.reported_spaces(offered.ContinuousZoomVelocitySpace), spaces.ZOOM_VELOCITY)
    top = mapping.top_speed or ASSUMED_SPEED
    resolution = picture.VideoEncoderConfiguration.Resolution
    return OnvifDevice(
        manufacturer,
        model,
        firmware,
        str(ptz.token),
        str(picture.token),
        int(resolution.Width),
        int(resolution.Height),
        move_space,
        {**report_spaces, "": report_spaces.get(_default_space(configuration)) or next(iter(report_spaces.values()))},
        zoom,
        velocity,
        zoom_velocity,
        _first(spaces.reported_spaces(offered.RelativePanTiltTranslationSpace), spaces.TRANSLATION_FOV),
        _first(spaces.reported_spaces(offered.RelativeZoomTranslationSpace), spaces.ZOOM_TRANSLATION),
        _source(picture),
        timeout,
        _limits(move_space, zoom, configuration, report_spaces),
        Capabilities(
            Velocity(
                top.pan_dps if velocity else 0.0,
                top.tilt_dps if velocity else 0.0,
                top.zoom_rate if zoom_velocity and zoom.moves else 0.0,
            ),
            edits_presets=True,
        ),
        tuple(assumed),
    )


def choose_profiles(profiles: Any, where: str, width: int, requested: str = "") -> tuple[Any, Any]:
    """Return the profile through which to move the camera, and the one from which to take pictures.

    Only profiles with a PTZ configuration can move the camera, and on some devices only the profile of the substream has one.
    Pictures come from
    the smallest profile of the same video source that is wide enough.

    Raises:
        CameraError: There is no suitable profile.
    """
    profiles = [each for each in profiles or () if each.token]
    moving = [each for each in profiles if getattr(each, "PTZConfiguration", None) is not None]
    if not moving:
        raise CameraError(f"The camera at {where} has no ONVIF profile with PTZ. It may have no motors, or PTZ is off.")
    if requested:
        named = [each for each in profiles if requested in (each.token, each.Name)]
        if not named:
            raise CameraError(
                f"The camera at {where} has no profile '{requested[:40]}'. It has: {', '.join(map(_name, profiles))}."
            )
        return (named[0] if named[0] in moving else moving[0]), named[0]
    ptz = moving[0]
    pictured = [
        each
        for each in profiles
        if getattr(each, "VideoEncoderConfiguration", None) is not None and _source(each) == _source(ptz)
    ]  # fmt: skip
    if not pictured:
        raise CameraError(f"The camera at {where} has no ONVIF profile with video. Create one in the camera's settings.")
    wide = [each for each in pictured if each.VideoEncoderConfiguration.Resolution.Width >= width]
    sizes = {id(each): each.VideoEncoderConfiguration.Resolution.Width for each in pictured}
    return ptz, min(wide, key=lambda each: sizes[id(each)]) if wide else max(pictured, key=lambda each: sizes[id(each)])


async def _options(client: OnvifClient, configuration: Any) -> tuple[Any, Ends]:
    """Return the spaces of a PTZ configuration, and the range of timeouts in seconds."""
    try:
        options = await client.call("ptz", "GetConfigurationOptions", ConfigurationToken=configuration.token)
        if options.Spaces is not None and options.Spaces.AbsolutePanTiltPositionSpace:
            timeout = options.PTZTimeout
            return options.Spaces, (timeout.Min.total_seconds(), timeout.Max.total_seconds()) if timeout else (0.1, 60.0)
    except CameraSignInError:
        raise
    except (OnvifFaultError, CameraReplyError, AttributeError):
        pass  # the PTZ node reports spaces too
    node = await client.call("ptz", "GetNode", NodeToken=configuration.NodeToken)
    return node.SupportedPTZSpaces, (0.1, 60.0)


def _position_spaces(stated: dict[str, ReportedSpace], mapping: OnvifMapping, assumed: list[str]) -> dict[str, PanTiltSpace]:
    """Return the position spaces with their scales to degrees."""
    found: dict[str, PanTiltSpace] = {}
    degrees = stated.get(spaces.DEGREES)
    if degrees is not None and degrees.y is not None:
        found[spaces.DEGREES] = PanTiltSpace(spaces.DEGREES, LinearScale(degrees.x, degrees.x), LinearScale(degrees.y, degrees.y))
    generic = stated.get(spaces.GENERIC)
    if generic is not None and generic.y is not None:
        pan, tilt = mapping.pan_deg, mapping.tilt_deg
        if degrees is not None and degrees.y is not None:
            pan, tilt = pan or degrees.x, tilt or degrees.y
        if pan is None:
            assumed.append("pan range")
        if tilt is None:
            assumed.append("tilt range")
        found[spaces.GENERIC] = PanTiltSpace(
            spaces.GENERIC, LinearScale(generic.x, pan or ASSUMED_PAN_DEG), LinearScale(generic.y, tilt or ASSUMED_TILT_DEG)
        )
    return found


def _zoom_space(stated: tuple[ReportedSpace, ...], mapping: OnvifMapping, assumed: list[str]) -> ZoomSpace:
    space = _first(stated, spaces.ZOOM_GENERIC)
    if mapping.fields is None:
        assumed.append("field of view")
    fields = mapping.fields or ((0.0, ASSUMED_FIELDS_DEG[0]), (1.0, ASSUMED_FIELDS_DEG[1]))
    if space is None:  # a fixed lens still needs a table of two rows
        return ZoomSpace(spaces.ZOOM_GENERIC, ((0.0, 1.0, fields[0][1]), (1.0, 1.0001, fields[0][1] * 0.9999)), moves=False)
    low, high = space.x
    rows = tuple((low + fraction * (high - low), zoom, hfov) for fraction, zoom, hfov in zoom_rows(fields, mapping.zoom_max))
    return ZoomSpace(space.uri, rows)


def _limits(move_space: PanTiltSpace, zoom: ZoomSpace, configuration: Any, known: dict[str, PanTiltSpace]) -> Limits:
    """Return the limits of the position space, narrowed to those of the configuration."""
    pan, tilt = sorted(move_space.pan.values), sorted(move_space.tilt.values)
    endless = pan[1] - pan[0] >= ENDLESS_DEG
    narrowed = getattr(configuration, "PanTiltLimits", None)
    for space in spaces.reported_spaces([narrowed.Range] if narrowed is not None and narrowed.Range is not None else ()):
        scale = known.get(space.uri)
        if scale is None or space.y is None:
            continue
        low_pan, high_pan = sorted(map(scale.pan.to_value, space.x))
        low_tilt, high_tilt = sorted(map(scale.tilt.to_value, space.y))
        pan, tilt = [max(pan[0], low_pan), min(pan[1], high_pan)], [max(tilt[0], low_tilt), min(tilt[1], high_tilt)]
        endless = endless and pan[1] - pan[0] >= ENDLESS_DEG
    last = zoom.rows[-1][1] if zoom.moves else zoom.rows[0][1]
    return Limits(pan[0], pan[1], tilt[0], tilt[1], zoom.rows[0][1], last, pan_endless=endless)


def _default_space(configuration: Any) -> str:
    return str(getattr(configuration, "DefaultAbsolutePantTiltPositionSpace", None) or spaces.GENERIC)


def _first(stated: tuple[ReportedSpace, ...], uri: str) -> ReportedSpace | None:
    return next((space for space in stated if space.uri == uri), None)


def _source(profile: Any) -> str:
    return str(getattr(getattr(profile, "VideoSourceConfiguration", None), "SourceToken", ""))


def _name(profile: Any) -> str:
    return _word(profile.Name) or _word(profile.token)


def _word(text: object) -> str:
    """Return text from the device, shortened and without non-printable characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in str(text or "")).split())[:60]
