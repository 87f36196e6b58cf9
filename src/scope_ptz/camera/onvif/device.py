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
"""Minimum pan range in degrees that counts as endless."""


@dataclass(frozen=True, slots=True)
class OnvifDevice:
    """The properties and capabilities of an ONVIF device.

    Attributes:
        manufacturer: Name of the manufacturer.
        model: Name of the model.
        firmware: Firmware version.
        ptz_profile: Token of the profile used for PTZ control.
        picture_profile: Token of the profile used for pictures.
        width: Width of the stream in pixels.
        height: Height of the stream in pixels.
        move_space: The coordinate space for absolute moves.
        report_spaces: The spaces in which the device may report positions, by URI; the key "" is for positions without a space.
        zoom: The coordinate space for zoom positions.
        velocity: The generic velocity space for pan and tilt; None if they cannot be driven.
        zoom_velocity: The generic velocity space for zoom; None if it cannot be driven.
        fov_translation: The space for relative turns in fractions of the field of view; None if there is none.
        zoom_translation: The generic space for relative zoom; None if there is none.
        video_source: Token of the video source, used for focus and iris.
        timeout_s: Shortest and longest timeout in seconds that the device accepts for continuous moves.
        limits: Limits of motion.
        capabilities: Optional capabilities, except focus and iris.
        assumed: Names of the values that are assumed because they are not reported, configured or measured.
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
        """The manufacturer and model, for messages."""
        return " ".join(word for word in (self.manufacturer, self.model) if word) or "ONVIF camera"


async def read_device(client: OnvifClient, mapping: OnvifMapping, *, width: int = 1280, profile: str = "") -> OnvifDevice:
    """Read the properties and capabilities of a device.

    Args:
        client: The connection.
        mapping: Configured or measured values, which take precedence over the known values for the model.
        width: The requested picture width in pixels.
        profile: Token or name of the profile to use; by default, a suitable one is chosen.

    Raises:
        CameraError: The device cannot be reached, rejects the credentials, or has no suitable profile or position space.
    """
    information = await client.call("devicemgmt", "GetDeviceInformation")
    manufacturer, model, firmware = (_clean_text(information[key]) for key in ("Manufacturer", "Model", "FirmwareVersion"))
    mapping = mapping.with_missing_from(known_mapping(model))
    ptz, picture = choose_profiles(await client.call("media", "GetProfiles"), str(client.address), width, profile)
    configuration = ptz.PTZConfiguration
    offered_spaces, timeout = await _options(client, configuration)
    assumed: list[str] = []
    reported = {
        space.uri: space for space in spaces.reported_spaces(offered_spaces.AbsolutePanTiltPositionSpace) if space.y is not None
    }
    report_spaces = _position_spaces(reported, mapping, assumed)
    if not report_spaces:
        raise CameraReplyError(
            f"The camera at {client.address} reports no space for absolute positions, so it cannot be moved to a pose."
        )
    move_space = report_spaces.get(spaces.DEGREES) or next(iter(report_spaces.values()))
    zoom = _zoom_space(spaces.reported_spaces(offered_spaces.AbsoluteZoomPositionSpace), mapping, assumed)
    velocity = _find_space(spaces.reported_spaces(offered_spaces.ContinuousPanTiltVelocitySpace), spaces.VELOCITY)
    zoom_velocity = _find_space(spaces.reported_spaces(offered_spaces.ContinuousZoomVelocitySpace), spaces.ZOOM_VELOCITY)
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
        _find_space(spaces.reported_spaces(offered_spaces.RelativePanTiltTranslationSpace), spaces.TRANSLATION_FOV),
        _find_space(spaces.reported_spaces(offered_spaces.RelativeZoomTranslationSpace), spaces.ZOOM_TRANSLATION),
        _video_source(picture),
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


def choose_profiles(profiles: Any, address: str, width: int, requested: str = "") -> tuple[Any, Any]:
    """Return the profile to use for PTZ control and the profile to use for pictures.

    Only a profile with a PTZ configuration can control the camera, and on some devices only the substream's profile has one. By
    default, pictures are taken from the smallest sufficiently wide profile with the same video source.

    Raises:
        CameraError: There is no suitable profile.
    """
    profiles = [profile for profile in profiles or () if profile.token]
    ptz_profiles = [profile for profile in profiles if getattr(profile, "PTZConfiguration", None) is not None]
    if not ptz_profiles:
        raise CameraError(f"The camera at {address} has no ONVIF profile with PTZ. PTZ may be off or unsupported.")
    if requested:
        named = [profile for profile in profiles if requested in (profile.token, profile.Name)]
        if not named:
            raise CameraError(
                f"The camera at {address} has no profile '{requested[:40]}'. Available profiles: {', '.join(map(_name, profiles))}."
            )
        return (named[0] if named[0] in ptz_profiles else ptz_profiles[0]), named[0]
    ptz = ptz_profiles[0]
    video_profiles = [
        profile
        for profile in profiles
        if getattr(profile, "VideoEncoderConfiguration", None) is not None and _video_source(profile) == _video_source(ptz)
    ]  # fmt: skip
    if not video_profiles:
        raise CameraError(f"The camera at {address} has no ONVIF profile with video. Create one in the camera's settings.")
    wide = [profile for profile in video_profiles if profile.VideoEncoderConfiguration.Resolution.Width >= width]
    sizes = {id(profile): profile.VideoEncoderConfiguration.Resolution.Width for profile in video_profiles}
    return ptz, min(wide, key=lambda profile: sizes[id(profile)]) if wide else max(
        video_profiles, key=lambda profile: sizes[id(profile)]
    )


async def _options(client: OnvifClient, configuration: Any) -> tuple[Any, Ends]:
    """Return the spaces that a PTZ configuration supports, and its timeout range in seconds."""
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


def _position_spaces(reported: dict[str, ReportedSpace], mapping: OnvifMapping, assumed: list[str]) -> dict[str, PanTiltSpace]:
    """Return the position spaces with their scales, and add the names of assumed ranges to ``assumed``."""
    position_spaces: dict[str, PanTiltSpace] = {}
    degrees = reported.get(spaces.DEGREES)
    if degrees is not None and degrees.y is not None:
        position_spaces[spaces.DEGREES] = PanTiltSpace(
            spaces.DEGREES, LinearScale(degrees.x, degrees.x), LinearScale(degrees.y, degrees.y)
        )
    generic = reported.get(spaces.GENERIC)
    if generic is not None and generic.y is not None:
        pan, tilt = mapping.pan_deg, mapping.tilt_deg
        if degrees is not None and degrees.y is not None:
            pan, tilt = pan or degrees.x, tilt or degrees.y
        if pan is None:
            assumed.append("pan range")
        if tilt is None:
            assumed.append("tilt range")
        position_spaces[spaces.GENERIC] = PanTiltSpace(
            spaces.GENERIC, LinearScale(generic.x, pan or ASSUMED_PAN_DEG), LinearScale(generic.y, tilt or ASSUMED_TILT_DEG)
        )
    return position_spaces


def _zoom_space(reported: tuple[ReportedSpace, ...], mapping: OnvifMapping, assumed: list[str]) -> ZoomSpace:
    space = _find_space(reported, spaces.ZOOM_GENERIC)
    if mapping.fields is None:
        assumed.append("field of view")
    fields = mapping.fields or ((0.0, ASSUMED_FIELDS_DEG[0]), (1.0, ASSUMED_FIELDS_DEG[1]))
    if space is None:  # optics require two rows even for a fixed lens
        return ZoomSpace(spaces.ZOOM_GENERIC, ((0.0, 1.0, fields[0][1]), (1.0, 1.0001, fields[0][1] * 0.9999)), moves=False)
    low, high = space.x
    rows = tuple((low + fraction * (high - low), zoom, hfov) for fraction, zoom, hfov in zoom_rows(fields, mapping.zoom_max))
    return ZoomSpace(space.uri, rows)


def _limits(move_space: PanTiltSpace, zoom: ZoomSpace, configuration: Any, known: dict[str, PanTiltSpace]) -> Limits:
    """Return the limits of the position space, narrowed to the limits in the configuration."""
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


def _find_space(reported: tuple[ReportedSpace, ...], uri: str) -> ReportedSpace | None:
    return next((space for space in reported if space.uri == uri), None)


def _video_source(profile: Any) -> str:
    return str(getattr(getattr(profile, "VideoSourceConfiguration", None), "SourceToken", ""))


def _name(profile: Any) -> str:
    return _clean_text(profile.Name) or _clean_text(profile.token)


def _clean_text(text: object) -> str:
    """Return text from the device, truncated and without unprintable characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in str(text or "")).split())[:60]
