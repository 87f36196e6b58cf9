"""The media profiles and their configurations, which the media and media2 services share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif.device_service import require_token
from scope_ptz.virtual_camera.onvif.operations import Request
from scope_ptz.virtual_camera.onvif.soap import invalid_argument

SOURCE = "video-source"
SOURCE_CONFIGURATION = "video-source-configuration"

FRAME_RATE = 25
"""Frame rate of the stream in frames per second."""

GOP_FRAMES = 25  # frames from one keyframe to the next
QUALITY = 70.0  # the reported quality, which clients cannot change

STREAM_PATH = "/axis-media/media.amp"
SNAPSHOT_PATH = "/axis-cgi/jpg/image.cgi"

MULTICAST = {"Address": {"Type": "IPv4", "IPv4Address": "0.0.0.0"}, "Port": 0, "TTL": 1, "AutoStart": False}  # noqa: S104
"""A placeholder multicast address, which the message types require although there is no multicast stream."""


@dataclass(frozen=True, slots=True)
class MediaProfile:
    """A media profile: a stream size with its encoder configuration.

    Attributes:
        token: Token of the profile.
        encoder_token: Token of the encoder configuration.
        name: The name that clients show.
        width: Width in pixels.
        height: Height in pixels.
        bitrate_kbps: The reported maximum bit rate in kbit/s.
        query: The query in the stream's URL; empty for full size.
    """

    token: str
    encoder_token: str
    name: str
    width: int
    height: int
    bitrate_kbps: int
    query: str

    @property
    def resolution(self) -> dict[str, int]:
        """The size in the form used in replies."""
        return {"Width": self.width, "Height": self.height}


def media_profiles(device: VirtualDevice) -> tuple[MediaProfile, ...]:
    """Return the profiles: one at full size, and one at half the width and height for video analysis."""
    width, height = device.width, device.height
    main = MediaProfile("profile-1", "h264-configuration-1", "Main", width, height, 4096, "")
    if width % 4 or height % 4:  # half of it would be odd, but H.264 requires even sizes
        return (main,)
    width, height = width // 2, height // 2
    return main, MediaProfile("profile-2", "h264-configuration-2", "Small", width, height, 1024, f"?resolution={width}x{height}")


def find_profile(device: VirtualDevice, token: str | None) -> MediaProfile:
    """Return a profile by token.

    Raises:
        SoapFault: There is no such profile.
    """
    for profile in media_profiles(device):
        if profile.token == token:
            return profile
    raise invalid_argument(f"There is no profile '{str(token)[:64]}'.", "NoProfile")


def find_encoder(device: VirtualDevice, token: str | None) -> MediaProfile:
    """Return the profile with an encoder configuration, given the configuration's token.

    Raises:
        SoapFault: There is no such configuration.
    """
    for profile in media_profiles(device):
        if profile.encoder_token == token:
            return profile
    raise invalid_argument(f"There is no configuration '{str(token)[:64]}'.", "NoConfig")


def selected_encoders(device: VirtualDevice, request: Request) -> tuple[MediaProfile, ...]:
    """Return the profiles whose encoders a request selects by configuration or profile; all of them if it names neither.

    Raises:
        SoapFault: The request names an unknown configuration or profile.
    """
    selected = media_profiles(device)
    if request.ConfigurationToken:
        selected = (find_encoder(device, request.ConfigurationToken),)
    if request.ProfileToken:
        profile = find_profile(device, request.ProfileToken)
        selected = (profile,) if profile in selected else ()
    return selected


def require_configuration(token: str | None, known: str) -> None:
    """Check that a configuration token is ``known``, the only valid one."""
    require_token("configuration", token, known, "NoConfig")


def source_configuration(device: VirtualDevice) -> dict[str, Any]:
    """Return the video source configuration."""
    return {
        "token": SOURCE_CONFIGURATION,
        "Name": "Video source",
        "UseCount": len(media_profiles(device)),
        "SourceToken": SOURCE,
        "Bounds": {"x": 0, "y": 0, "width": device.width, "height": device.height},
    }


def source_options(device: VirtualDevice) -> dict[str, Any]:
    """Return the options for the video source configuration, which allow only the full image."""
    zero = {"Min": 0, "Max": 0}
    return {
        "BoundsRange": {
            "XRange": zero,
            "YRange": zero,
            "WidthRange": {"Min": device.width, "Max": device.width},
            "HeightRange": {"Min": device.height, "Max": device.height},
        },
        "VideoSourceTokensAvailable": [SOURCE],
    }


def stream_uri(request: Request, profile: MediaProfile, rtsp_port: int, *, over_http: bool = False) -> str:
    """Return a stream URL with the host at which the client reached the device.

    Args:
        request: The client's request.
        profile: The profile.
        rtsp_port: Port of the RTSP server, which also serves RTSP over HTTP.
        over_http: Whether the client uses RTSP over HTTP.
    """
    scheme, standard = ("http", 80) if over_http else ("rtsp", 554)
    port = "" if rtsp_port == standard else f":{rtsp_port}"
    return f"{scheme}://{request.host}{port}{STREAM_PATH}{profile.query}"


def snapshot_uri(request: Request, profile: MediaProfile) -> str:
    """Return a snapshot URL with the host at which the client reached the device."""
    return f"{request.origin}{SNAPSHOT_PATH}?resolution={profile.width}x{profile.height}"
