"""Open network cameras from specs such as ``axis://operator@10.0.0.7``: find credentials, acquire control, connect the driver."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scope_ptz.camera.base import Camera
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.factory.cameras.calibrations import load_calibration, measured_fields, measured_settling
from scope_ptz.factory.cameras.onvif import ANGLES, check_angles, open_onvif
from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from ssl import SSLContext

    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.perception.ground_truth.served import ServedTruth

NETWORK_SCHEMES: tuple[str, ...] = ("axis", "onvif")
"""The schemes of network camera drivers."""

STREAMS = {"axis": ("mjpeg", "rtsp"), "onvif": ("rtsp", "snapshot")}
"""The values of the option ``stream`` for each scheme. The first value is the default."""

_NUMBERS = {"width": 10_000, "height": 10_000, "channel": 64, "rtsp_port": 65_535, "latency_ms": 10_000}  # maximum values
_DEGREES = ("hfov_wide", "hfov_tele")
_CHOICES = {"tls": ("on", "off")}

OPTIONS = {
    "axis": (*_NUMBERS, "stream", *_CHOICES, *_DEGREES),
    "onvif": (*(name for name in _NUMBERS if name != "channel"), "stream", "profile", *_CHOICES, *_DEGREES, *ANGLES),
}
"""The options of each scheme."""


@dataclass(frozen=True, slots=True)
class OpenNetworkCamera:
    """A connected network camera.

    Attributes:
        camera: The camera.
        release: A function that releases the control lock. Call it after closing the camera.
        served_truth: A function that connects to a virtual camera's ground truth, for simulation-only perception. It raises
            ``InputError`` if the camera is not on this machine.
    """

    camera: Camera
    release: Callable[[], Awaitable[None]]
    served_truth: Callable[[], ServedTruth]


def check_network_spec(spec: CameraSpec) -> None:
    """Check a spec's address and options without connecting.

    Raises:
        InputError: The address or an option is invalid.
    """
    from scope_ptz.camera.network.address import parse_address

    parse_address(spec.address, tls=spec.options.get("tls") == "on")
    known = OPTIONS[spec.scheme]
    choices = {**_CHOICES, "stream": STREAMS[spec.scheme]}
    for name, value in spec.options.items():
        if name not in known:
            raise UnknownNameError("camera option", name[:40], known)
        if name in _NUMBERS and not (value.isdecimal() and 0 < int(value) <= _NUMBERS[name]):
            raise InputError(f"The camera option {name} must be a whole number from 1 to {_NUMBERS[name]}; got '{value[:40]}'.")
        if name in choices and value not in choices[name]:
            raise InputError(f"The camera option {name} must be {' or '.join(choices[name])}; got '{value[:40]}'.")
        if name in _DEGREES:
            _degrees(name, value)
    check_angles(spec)
    fields = _fields(spec)
    if ("hfov_wide" in spec.options) != ("hfov_tele" in spec.options) or (fields is not None and fields[0] <= fields[1]):
        raise InputError("Specify both hfov_wide and hfov_tele in degrees. hfov_wide must be the larger angle.")


async def open_network_camera(spec: CameraSpec, *, actor: str = "scope", for_measurement: bool = False) -> OpenNetworkCamera:
    """Connect to a network camera and acquire its control lock, so that only one program at a time can move it.

    Args:
        spec: The camera.
        actor: Name of the holder of control, which is shown to other programs that request control.
        for_measurement: Whether the camera is opened to be probed or calibrated. If so, stored measurements are ignored, and the
            driver may assume values that are not known yet.

    Raises:
        InputError: The spec or an option is invalid.
        ConfigError: There is no password for the account.
        ControlHeldError: Another program has control. The message names the holder if known.
        CameraError: The camera cannot be reached, or rejects the credentials.
    """
    from scope_ptz.camera.control import ControlLock
    from scope_ptz.camera.network.address import parse_address
    from scope_ptz.factory.cameras.passwords import find_credentials

    check_network_spec(spec)
    _, address = parse_address(spec.address, tls=spec.options.get("tls") == "on")
    credentials = find_credentials(spec)
    key = f"{address.host.lower()}:{address.port}/{spec.options.get('channel', '1')}"
    lock = ControlLock(f"The camera at {address}", key, load_settings().cache_dir / "control")
    lock.acquire(actor)

    async def release() -> None:
        lock.release()

    try:
        verify = await _tls_verification(spec, address)
        if spec.scheme == "onvif":
            camera = await open_onvif(spec, address, credentials, verify, _fields(spec), for_measurement=for_measurement)
        else:
            camera = await _open_axis(spec, address, credentials, verify, for_measurement=for_measurement)
        return OpenNetworkCamera(camera, release, lambda: _served_truth(camera, address, credentials, verify))
    except BaseException:
        lock.release()
        raise


def _served_truth(
    camera: Camera, address: DeviceAddress, credentials: Credentials, verify: SSLContext | bool
) -> ServedTruth:  # fmt: skip
    from scope_ptz.camera.network.http import DeviceHttp
    from scope_ptz.perception.ground_truth.served import ServedTruth

    return ServedTruth(DeviceHttp(address, credentials, verify=verify), camera.clock)


async def _tls_verification(spec: CameraSpec, address: DeviceAddress) -> SSLContext | bool:
    """Return a TLS context for the fingerprint in ``scope.yaml``, or True to use the system's certificate authorities."""
    if not spec.name or not address.tls:
        return True
    from anyio import to_thread

    from scope_ptz.camera.network.trust import trust_fingerprint
    from scope_ptz.factory.cameras.named_cameras import named_cameras

    named = named_cameras().get(spec.name)
    if named is None or named.fingerprint is None:
        return True
    return await to_thread.run_sync(trust_fingerprint, address, named.fingerprint)


async def _open_axis(
    spec: CameraSpec, address: DeviceAddress, credentials: Credentials, verify: SSLContext | bool, *, for_measurement: bool
) -> Camera:
    from scope_ptz.camera.axis.camera import AxisCamera
    from scope_ptz.camera.network.http import DeviceHttp

    options = spec.options
    calibration = None if for_measurement else load_calibration(spec, address)
    return await AxisCamera.open(
        DeviceHttp(address, credentials, verify=verify),
        credentials,
        channel=int(options.get("channel", 1)),
        width=int(options.get("width", 1280)),
        height=int(options.get("height", 720)),
        stream="rtsp" if options.get("stream") == "rtsp" else "mjpeg",
        rtsp_port=int(options["rtsp_port"]) if "rtsp_port" in options else None,
        latency_s=int(options.get("latency_ms", 100)) / 1000,
        fields_deg=_fields(spec),
        measured_fields=measured_fields(calibration),
        settling=measured_settling(calibration),
    )


def _fields(spec: CameraSpec) -> tuple[float, float] | None:
    if "hfov_wide" not in spec.options or "hfov_tele" not in spec.options:
        return None
    return _degrees("hfov_wide", spec.options["hfov_wide"]), _degrees("hfov_tele", spec.options["hfov_tele"])


def _degrees(name: str, value: str) -> float:
    try:
        degrees = float(value)
    except ValueError:
        degrees = 0.0
    if not 0.1 <= degrees < 180.0:
        raise InputError(f"The camera option {name} must be an angle from 0.1 to 180 degrees; got '{value[:40]}'.")
    return degrees
