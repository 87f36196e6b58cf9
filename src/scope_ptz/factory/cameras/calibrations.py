"""Apply the results of ``scope camera calibrate`` when a network camera is opened."""

from __future__ import annotations

import logging
from itertools import pairwise
from typing import TYPE_CHECKING

from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from scope_ptz.camera.measurement.profile import CalibrationRecord
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.settling import SettlingCriteria
    from scope_ptz.camera.spec import CameraSpec

_LOG = logging.getLogger(__name__)


def profile_name(spec: CameraSpec, address: DeviceAddress) -> str:
    """Return the name of a camera's profile, which consists of driver, host, port and channel, without the user name."""
    channel = f" {spec.options['profile']}" if "profile" in spec.options else ""
    channel += f" channel {spec.options['channel']}" if spec.options.get("channel", "1") != "1" else ""
    return f"{spec.scheme} {address.host.lower()}:{address.port}{channel}"


def load_calibration(spec: CameraSpec, address: DeviceAddress) -> CalibrationRecord | None:
    """Load a camera's calibration; None if there is none.

    Contradictions between measured and reported values are logged as warnings.

    Raises:
        PackError: The camera's profile is damaged.
    """
    from scope_ptz.camera.measurement.profile import load_profile

    profile = load_profile(load_settings().camera_profiles_dir, profile_name(spec, address))
    calibration = None if profile is None else profile.calibration
    for sentence in calibration.contradictions if calibration is not None else ():
        _LOG.warning("note: the calibration of the camera at %s found a contradiction. %s", address, sentence)
    return calibration


def measured_fields(calibration: CalibrationRecord | None) -> tuple[tuple[float, float], ...] | None:
    """Return rows of (position in the zoom range from 0 to 1, measured horizontal field of view in degrees), widest first.

    Return None if there are too few rows, or if the fields of view do not decrease with increasing zoom, which means that the
    measurement is invalid.
    """
    if calibration is None:
        return None
    rows = tuple((field.share, field.measured_deg) for field in calibration.fields)
    decreasing = len(rows) > 1 and all(b[0] > a[0] and b[1] < a[1] for a, b in pairwise(rows))
    return rows if decreasing else None


def measured_settling(calibration: CalibrationRecord | None) -> SettlingCriteria:
    """Return the settling criteria for a camera. The picture timeout is longer if its picture settled slowly."""
    from scope_ptz.camera.network.settling import SettlingCriteria

    default = SettlingCriteria()
    if calibration is None:
        return default
    return SettlingCriteria(picture_timeout_s=max(default.picture_timeout_s, 3 * calibration.settling_s))
