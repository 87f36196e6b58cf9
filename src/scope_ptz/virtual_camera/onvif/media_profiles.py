"""The media profile and its configurations, which Media and Media2 describe in their own types."""

from __future__ import annotations

from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif.device_service import require_token
from scope_ptz.virtual_camera.onvif.operations import Request

PROFILE = "profile-1"
SOURCE = "video-source"
SOURCE_CONFIGURATION = "video-source-configuration"
ENCODER_CONFIGURATION = "h264-configuration"

FRAME_RATE = 25
"""Frames per second of the stream."""

GOP_FRAMES = 25
BITRATE_KBPS = 4096

STREAM_PATH = "/axis-media/media.amp"
SNAPSHOT_PATH = "/axis-cgi/jpg/image.cgi"

MULTICAST = {"Address": {"Type": "IPv4", "IPv4Address": "0.0.0.0"}, "Port": 0, "TTL": 1, "AutoStart": False}  # noqa: S104
"""There is no multicast stream, but the types demand an address."""


def require_profile(token: str | None) -> None:
    """Raise a fault unless a token is that of the profile."""
    require_token("profile", token, PROFILE, "NoProfile")


def require_configuration(token: str | None, known: str) -> None:
    """Raise a fault unless a token of a configuration is the known one."""
    require_token("configuration", token, known, "NoConfig")


def source_configuration(device: VirtualDevice) -> dict[str, Any]:
    """Return the configuration of the video source."""
    return {
        "token": SOURCE_CONFIGURATION,
        "Name": "Video source",
        "UseCount": 1,
        "SourceToken": SOURCE,
        "Bounds": {"x": 0, "y": 0, "width": device.width, "height": device.height},
    }


def source_options(device: VirtualDevice) -> dict[str, Any]:
    """Return the options of the video source's configuration: the whole picture, nothing else."""
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


def stream_uri(request: Request, rtsp_port: int) -> str:
    """Return the address of the stream as the client can reach it."""
    port = "" if rtsp_port == 554 else f":{rtsp_port}"
    return f"rtsp://{request.host}{port}{STREAM_PATH}"


def snapshot_uri(request: Request, device: VirtualDevice) -> str:
    """Return the address of the current picture as the client can reach it."""
    return f"{request.origin}{SNAPSHOT_PATH}?resolution={device.width}x{device.height}"
