"""Provide the results of `scope camera calibrate` to the driver of a network camera."""

from __future__ import annotations

import logging
from itertools import pairwise
from typing import TYPE_CHECKING

from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from scope_ptz.camera.measurement.profile import CalibrationRecord
    from scope_ptz.camera.network.address import DeviceAddress
    from scope_ptz.camera.network.settling import Settling
    from scope_ptz.camera.spec import CameraSpec

_LOG = logging.getLogger(__name__)


def profile_name(spec: CameraSpec, address: DeviceAddress) -> str:
    """Return the name of a camera's profile: driver, host, port and channel, without the user."""
    channel = f" {spec.options['profile']}" if "profile" in spec.options else ""
    channel += f" channel {spec.options['channel']}" if spec.options.get("channel", "1") != "1" else ""
    return f"{spec.scheme} {address.host.lower()}:{address.port}{channel}"


def load_calibration(spec: CameraSpec, address: DeviceAddress) -> CalibrationRecord | None:
    """Return the calibration of a camera; None if there is none.

    Differences between measured and reported values that the calibration found are logged as warnings.

    Raises:
        PackError: The camera's profile is damaged.
    """
    from scope_ptz.camera.measurement.profile import load_profile

    profile = load_profile(load_settings().camera_profiles_dir, profile_name(spec, address))
    found = None if profile is None else profile.calibration
    for sentence in found.contradictions if found is not None else ():
        _LOG.warning("note: the calibration of the camera at %s found: %s", address, sentence)
    return found


def measured_fields(calibration: CalibrationRecord | None) -> tuple[tuple[float, float], ...] | None:
    """Return rows of (position in the zoom range from 0 to 1, measured horizontal field of view in degrees), widest first.

    Return None if there are no rows, or if the fields of view do not decrease as the zoom increases, because the measurement is
    then invalid.
    """
    if calibration is None:
        return None
    rows = tuple((each.share, each.measured_deg) for each in calibration.fields)
    decreasing = len(rows) > 1 and all(b[0] > a[0] and b[1] < a[1] for a, b in pairwise(rows))
    return rows if decreasing else None


def measured_settling(calibration: CalibrationRecord | None) -> Settling:
    """Return the criteria for when a camera has settled. They allow more time if its picture settled slowly in the calibration."""
    from scope_ptz.camera.network.settling import Settling

    default = Settling()
    if calibration is None:
        return default
    return Settling(picture_timeout_s=max(default.picture_timeout_s, 3 * calibration.settling_s))
