"""Open ONVIF cameras from specs such as ``onvif://operator@10.0.0.7``, with their options and stored measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.errors import InputError
from scope_ptz.factory.cameras.calibrations import load_calibration, measured_fields, measured_settling

if TYPE_CHECKING:
    from ssl import SSLContext

    from scope_ptz.camera.base import Camera
    from scope_ptz.camera.measurement.profile import CalibrationRecord
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.onvif.mapping import OnvifMapping
    from scope_ptz.camera.spec import CameraSpec

ANGLES = ("pan_min", "pan_max", "tilt_min", "tilt_max")
"""Options for the angles in degrees at the ends of the generic pan and tilt ranges."""

_MAX_ANGLE_DEG = 360.0


def check_angles(spec: CameraSpec) -> None:
    """Check the angle options.

    Raises:
        InputError: An angle is missing or invalid.
    """
    for axis in ("pan", "tilt"):
        _end_angles_deg(spec, axis)


def onvif_mapping(
    spec: CameraSpec, fields_deg: tuple[float, float] | None, calibration: CalibrationRecord | None
) -> OnvifMapping:  # fmt: skip
    """Return a camera's coordinate mapping, from its options and, where options are missing, from stored measurements.

    Args:
        spec: The camera.
        fields_deg: Horizontal fields of view in degrees at the widest and the closest zoom, from the options; None if not set.
        calibration: The stored measurements; None if there are none.
    """
    from scope_ptz.camera.onvif.mapping import OnvifMapping

    configured = OnvifMapping(
        _end_angles_deg(spec, "pan"),
        _end_angles_deg(spec, "tilt"),
        None if fields_deg is None else ((0.0, fields_deg[0]), (1.0, fields_deg[1])),
    )
    if calibration is None:
        return configured
    fields = measured_fields(calibration) if "field of view" in calibration.replaces else None
    measured = OnvifMapping(calibration.pan_deg, calibration.tilt_deg, fields)
    return configured.with_missing_from(measured)


async def open_onvif(
    spec: CameraSpec,
    address: DeviceAddress,
    credentials: Credentials,
    verify: SSLContext | bool,
    fields_deg: tuple[float, float] | None,
    *,
    for_measurement: bool,
) -> Camera:
    """Connect to an ONVIF camera.

    Args:
        spec: The camera.
        address: The camera's address.
        credentials: The credentials for signing in.
        verify: Whether to verify the camera's certificate, or a TLS context that verifies it.
        fields_deg: Horizontal fields of view in degrees at the widest and the closest zoom, from the options; None if not set.
        for_measurement: Whether to ignore stored measurements and assume values that have not been measured yet.

    Raises:
        CameraError: The camera cannot be reached, rejects the credentials, or must be calibrated first.
    """
    from scope_ptz.camera.network.http import DeviceHttp
    from scope_ptz.camera.onvif.camera import OnvifCamera

    options = spec.options
    calibration = None if for_measurement else load_calibration(spec, address)
    mapping = onvif_mapping(spec, fields_deg, calibration)
    return await OnvifCamera.open(
        DeviceHttp(address, credentials, verify=verify),
        credentials,
        mapping=mapping,
        assume=for_measurement,
        profile=options.get("profile", ""),
        width=int(options["width"]) if "width" in options else None,
        height=int(options["height"]) if "height" in options else None,
        stream="snapshot" if options.get("stream") == "snapshot" else "rtsp",
        rtsp_port=int(options["rtsp_port"]) if "rtsp_port" in options else None,
        latency_s=int(options.get("latency_ms", 100)) / 1000,
        settling=measured_settling(calibration),
    )


def _end_angles_deg(spec: CameraSpec, axis: str) -> tuple[float, float] | None:
    names = (f"{axis}_min", f"{axis}_max")
    present = [name for name in names if name in spec.options]
    if not present:
        return None
    low, high = (_angle(name, spec.options.get(name, "")) for name in names)
    if low == high:
        raise InputError(f"The camera options {names[0]} and {names[1]} must be two different angles.")
    return low, high


def _angle(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= _MAX_ANGLE_DEG:
        raise InputError(f"The camera option {name} must be an angle from -360 to 360 degrees; got '{text[:40]}'.")
    return value
