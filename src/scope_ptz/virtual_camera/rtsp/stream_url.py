"""Stream URLs and their options, such as ``rtsp://HOST/axis-media/media.amp?resolution=640x360&fps=10``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from urllib.parse import parse_qsl, urlsplit

from scope_ptz.errors import InputError
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.picture_size import parse_resolution
from scope_ptz.virtual_camera.rtsp.messages import RefusedError

PATHS = ("/axis-media/media.amp", "/onvif-media/media.amp")
TRACK = "stream=0"
"""The name of a stream's only track."""

MAX_FIELDS = 50
MIN_FPS, MAX_FPS = 0.1, 1000.0

_AUTHORITY = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]+)(:\d{1,5})?")


@dataclass(frozen=True, slots=True)
class StreamFormat:
    """The stream format that a client requests. Clients that request the same format share an encoder.

    Attributes:
        width: Width in pixels.
        height: Height in pixels.
        fps: Frames per second.
    """

    width: int
    height: int
    fps: float


@dataclass(frozen=True, slots=True)
class StreamUrl:
    """A stream URL from a client, without credentials, trailing slash or track name."""

    base: str
    query: str

    @property
    def events_only(self) -> bool:
        """Whether the stream contains only events and no video."""
        options = _options(self)
        return options.get("video") == "0" and options.get("event", "").lower() == "on"

    @property
    def content_base(self) -> str:
        """The URL of the whole stream, for use in replies."""
        return f"{self.base}/{self._suffix}"

    @property
    def track(self) -> str:
        """The URL of the track."""
        return f"{self.base}/{TRACK}{self._suffix}"

    @property
    def _suffix(self) -> str:
        return f"?{self.query}" if self.query else ""


def parse_url(uri: str) -> StreamUrl:
    """Parse a stream URL.

    Raises:
        RefusedError: The text is not an RTSP URL, or there is no such stream.
    """
    try:
        parts = urlsplit(uri)
    except ValueError as error:
        raise RefusedError(400) from error
    authority = parts.netloc.rpartition("@")[2]
    if parts.scheme.lower() != "rtsp" or not _AUTHORITY.fullmatch(authority):
        raise RefusedError(400)
    # Some clients append the track name after the query.
    path = parts.path.removesuffix("/").removesuffix(f"/{TRACK}")
    query = parts.query.removesuffix("/").removesuffix(f"/{TRACK}")
    if path not in PATHS:
        raise RefusedError(404)
    return StreamUrl(f"rtsp://{authority}{path}", query)


def stream_format(url: StreamUrl, device: VirtualDevice, rate_hz: float) -> StreamFormat:
    """Return the format that a stream URL requests. Unknown options are ignored, as on AXIS cameras.

    Args:
        url: The URL.
        device: The camera.
        rate_hz: Frame rate of its live video, which is the default and the maximum.

    Raises:
        RefusedError: An option has a value that the camera does not support.
    """
    try:
        options = _options(url)
        width, height = parse_resolution(device, options.get("resolution", ""))
        fps = float(options.get("fps", "0"))
    except (ValueError, InputError) as error:
        raise RefusedError(400) from error
    if (
        width % 2
        or height % 2
        or not (fps == 0 or MIN_FPS <= fps <= MAX_FPS)
        or options.get("videocodec", "h264").lower() != "h264"
    ):
        raise RefusedError(400)
    if options.get("camera", "1") != "1":
        raise RefusedError(404)
    return StreamFormat(width, height, min(fps, rate_hz) if fps else rate_hz)


def _options(url: StreamUrl) -> dict[str, str]:
    """Return the options in a URL's query. Names are in lower case.

    Raises:
        RefusedError: There are too many options.
    """
    try:
        return {name.lower(): value for name, value in parse_qsl(url.query, max_num_fields=MAX_FIELDS)}
    except ValueError as error:
        raise RefusedError(400) from error
