"""Stream descriptions (SDP, RFC 4566)."""

from __future__ import annotations

from base64 import b64encode

from scope_ptz.virtual_camera.rtsp.encoder import ParameterSets
from scope_ptz.virtual_camera.rtsp.rtp import CLOCK_HZ, PAYLOAD_TYPE
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat, StreamUrl


def describe(url: StreamUrl, requested_format: StreamFormat, parameter_sets: ParameterSets, *, name: str, host: str) -> bytes:
    """Describe a video stream.

    Args:
        url: The URL that the client requested.
        requested_format: Size and frame rate of the stream.
        parameter_sets: The encoder's parameter sets.
        name: The camera's name.
        host: The camera's IP address.
    """
    sprop = ",".join(b64encode(parameter_set).decode() for parameter_set in (parameter_sets.sps, parameter_sets.pps))
    track = [
        f"a=rtpmap:{PAYLOAD_TYPE} H264/{CLOCK_HZ}",
        f"a=fmtp:{PAYLOAD_TYPE} packetization-mode=1;profile-level-id={parameter_sets.profile_level_id};"
        f"sprop-parameter-sets={sprop}",
        f"a=framerate:{requested_format.fps:.6f}",
        f"a=framesize:{PAYLOAD_TYPE} {requested_format.width}-{requested_format.height}",
    ]
    return _description(url, "video", track, name, host)


def describe_events(url: StreamUrl, *, name: str, host: str) -> bytes:
    """Describe an event stream. The arguments are those of ``describe``."""
    return _description(url, "application", [f"a=rtpmap:{PAYLOAD_TYPE} vnd.onvif.metadata/{CLOCK_HZ}"], name, host)


def _description(url: StreamUrl, medium: str, track: list[str], name: str, host: str) -> bytes:
    family = "IP6" if ":" in host else "IP4"
    title = "".join(c if c.isprintable() else " " for c in name) or "camera"
    lines = [
        "v=0",
        f"o=- 1 1 IN {family} {host}",
        f"s={title}",
        "t=0 0",
        f"a=control:{url.content_base}",
        "a=range:npt=now-",
        f"m={medium} 0 RTP/AVP {PAYLOAD_TYPE}",
        f"c=IN {family} {'::' if ':' in host else '0.0.0.0'}",  # noqa: S104 - no address is bound
        *track,
        f"a=control:{url.track}",
    ]
    return ("\r\n".join(lines) + "\r\n").encode()
