"""ONVIF cameras from specs such as ``onvif://operator@10.0.0.7``: options, and what was measured before."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from scope_ptz.errors import InputError
from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from ssl import SSLContext

    from scope_ptz.camera.base import Camera
    from scope_ptz.camera.measuring.profile import CameraProfile
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.onvif.mapping import OnvifMapping
    from scope_ptz.camera.spec import CameraSpec

ANGLES = ("pan_min", "pan_max", "tilt_min", "tilt_max")
"""Options with the angles at the ends of the generic space, in degrees."""

_MAX_ANGLE_DEG = 360.0


def check_angles(spec: CameraSpec) -> None:
    """Check the options with angles.

    Raises:
        InputError: One is missing or wrong.
    """
    for axis in ("pan", "tilt"):
        _ends(spec, axis)


def profile_name(spec: CameraSpec, address: DeviceAddress) -> str:
    """Return the name of a camera's profile: driver, host, port and channel, without the user."""
    channel = f" {spec.options['profile']}" if "profile" in spec.options else ""
    return f"{spec.scheme} {address.host.lower()}:{address.port}{channel}"


def mapping_of(
    spec: CameraSpec, fields_deg: tuple[float, float] | None, profile: CameraProfile | None
) -> OnvifMapping:  # fmt: skip
    """Return what the options say about a camera, else what was measured on it.

    Args:
        spec: The camera.
        fields_deg: Horizontal fields of view at the widest and the closest zoom from the options.
        profile: Its profile.
    """
    from scope_ptz.camera.onvif.mapping import OnvifMapping

    configured = OnvifMapping(
        _ends(spec, "pan"), _ends(spec, "tilt"), None if fields_deg is None else ((0.0, fields_deg[0]), (1.0, fields_deg[1]))
    )
    found = profile.calibration if profile is not None else None
    if found is None:
        return configured
    rows = tuple((each.share, each.measured_deg) for each in found.fields)
    falling = len(rows) > 1 and all(b[0] > a[0] and b[1] < a[1] for a, b in pairwise(rows))
    measured = OnvifMapping(
        found.pan_deg, found.tilt_deg, rows if falling and "field of view" in found.replaces else None
    )  # fmt: skip
    return configured.over(measured)


async def open_onvif(
    spec: CameraSpec,
    address: DeviceAddress,
    credentials: Credentials,
    verify: SSLContext | bool,
    fields_deg: tuple[float, float] | None,
    *,
    measuring: bool,
) -> Camera:
    """Connect to an ONVIF camera.

    Args:
        spec: The camera.
        address: Where it is.
        credentials: The account.
        verify: How its certificate is checked.
        fields_deg: Horizontal fields of view from the options.
        measuring: Whether to assume what nobody has measured yet, and to leave out earlier measurements.

    Raises:
        CameraError: The camera cannot be reached, refuses the account, or has to be measured first.
    """
    from scope_ptz.camera.measuring.profile import load_profile
    from scope_ptz.camera.network.http import DeviceHttp
    from scope_ptz.camera.onvif.camera import OnvifCamera

    options = spec.options
    profile = None if measuring else load_profile(load_settings().camera_profiles_dir, profile_name(spec, address))
    mapping = mapping_of(spec, fields_deg, profile)
    return await OnvifCamera.open(
        DeviceHttp(address, credentials, verify=verify),
        credentials,
        mapping=mapping,
        assume=measuring,
        profile=options.get("profile", ""),
        width=int(options["width"]) if "width" in options else None,
        height=int(options["height"]) if "height" in options else None,
        stream="snapshot" if options.get("stream") == "snapshot" else "rtsp",
        rtsp_port=int(options["rtsp_port"]) if "rtsp_port" in options else None,
        latency_s=int(options.get("latency_ms", 100)) / 1000,
    )


def _ends(spec: CameraSpec, axis: str) -> tuple[float, float] | None:
    names = (f"{axis}_min", f"{axis}_max")
    given = [name for name in names if name in spec.options]
    if not given:
        return None
    low, high = (_angle(name, spec.options.get(name, "")) for name in names)
    if low == high:
        raise InputError(f"The camera options {names[0]} and {names[1]} are two different angles.")
    return low, high


def _angle(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= _MAX_ANGLE_DEG:
        raise InputError(f"The camera option {name} is an angle from -360 to 360 degrees, got '{text[:40]}'.")
    return value
