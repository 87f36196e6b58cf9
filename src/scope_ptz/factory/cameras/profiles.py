"""Probe and calibrate cameras, and store the results in their profiles."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import monotonic
from typing import TYPE_CHECKING

from scope_ptz.factory.cameras.opening import OpenCamera, open_camera
from scope_ptz.factory.cameras.parsing import parse_camera
from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from scope_ptz.camera.measurement.calibration_plan import CalibrationPlan
    from scope_ptz.camera.measurement.profile import CalibrationRecord, CameraProfile, ProbeRecord
    from scope_ptz.camera.spec import CameraSpec

_TIMED_PICTURES = 5  # number of pictures to time; the median is stored


async def probe_camera(text: str) -> tuple[ProbeRecord, Path]:
    """Read a camera's capabilities, measure how long it takes to take a picture, and store the result. The camera does not move.

    Returns:
        The record, and the path of the profile.

    Raises:
        ScopeError: The camera cannot be opened or failed, or the profile cannot be written.
    """
    spec = parse_camera(text)
    async with await open_camera(spec, for_measurement=True) as opened:
        record = await _probe(opened)
    return record, _store(spec, probe=record)


async def calibrate_camera(
    text: str, *, zooms: int = 6, progress: Callable[[str], None] = lambda _: None
) -> tuple[CalibrationRecord, Path]:  # fmt: skip
    """Calibrate a camera from its own pictures, and store the result. The camera moves.

    Returns:
        The record, and the path of the profile.

    Raises:
        ScopeError: The camera cannot be opened or failed, no direction shows enough detail, or the profile cannot be written.
    """
    from scope_ptz.camera.measurement.calibration import calibrate
    from scope_ptz.camera.measurement.profile import calibration_record

    spec = parse_camera(text)
    async with await open_camera(spec, for_measurement=True) as opened:
        info = opened.camera.info
        calibration = await calibrate(opened.camera, zooms=zooms, assumed=info.assumed, progress=progress)
        limits = info.limits
        record = calibration_record(
            calibration, (limits.min_pan_deg, limits.max_pan_deg), (limits.min_tilt_deg, limits.max_tilt_deg), info.assumed
        )  # fmt: skip
    return record, _store(spec, calibration=record)


async def plan_camera_calibration(text: str, *, zooms: int = 6) -> CalibrationPlan:
    """Plan the moves for a calibration. The camera does not move, and nothing is stored.

    Raises:
        ScopeError: The camera cannot be opened or failed.
    """
    from scope_ptz.camera.measurement.calibration_plan import plan_calibration

    async with await open_camera(parse_camera(text), for_measurement=True) as opened:
        return plan_calibration(opened.camera.info, await opened.camera.pose(), zooms)


def stored_calibration(text: str) -> CalibrationRecord | None:
    """Return a camera's stored calibration; None if there is none.

    Raises:
        ScopeError: The spec is invalid, or the profile is damaged.
    """
    from scope_ptz.camera.measurement.profile import load_profile

    profile = load_profile(load_settings().camera_profiles_dir, _profile_name(parse_camera(text)))
    return None if profile is None else profile.calibration


async def _probe(opened: OpenCamera) -> ProbeRecord:
    from scope_ptz.camera.measurement.profile import ProbeRecord, now

    camera, info = opened.camera, opened.camera.info
    limits, capabilities = info.limits, info.capabilities
    times = []
    for _ in range(_TIMED_PICTURES):
        started_s = monotonic()
        frame = await camera.frame()
        times.append(monotonic() - started_s)
    return ProbeRecord(
        probed_at=now(),
        model=info.name.partition(" at ")[0],
        driver=opened.spec.scheme,
        pan_range_deg=(limits.min_pan_deg, limits.max_pan_deg),
        tilt_range_deg=(limits.min_tilt_deg, limits.max_tilt_deg),
        zoom_range=(limits.min_zoom, limits.max_zoom),
        pan_endless=limits.pan_endless,
        zoom_table=tuple((round(zoom, 4), round(hfov, 3)) for zoom, hfov in info.optics.table),
        frame_width=frame.width,
        frame_height=frame.height,
        presets=tuple(preset.name for preset in await camera.presets()),
        drives=capabilities.drives,
        edits_presets=capabilities.edits_presets,
        focus=bool(capabilities.focus),
        iris=bool(capabilities.iris),
        focus_actions=capabilities.focus,
        iris_actions=capabilities.iris,
        firmware=info.firmware,
        assumed=info.assumed,
        snapshot_s=median(times),
    )


def _store(spec: CameraSpec, **records: object) -> Path:
    from scope_ptz.camera.measurement.profile import CameraProfile, load_profile, save_profile
    from scope_ptz.errors import PackError

    folder, name = load_settings().camera_profiles_dir, _profile_name(spec)
    try:
        existing = load_profile(folder, name)
    except PackError:
        existing = None  # a damaged profile is replaced
    profile: CameraProfile = (existing or CameraProfile(camera=name)).model_copy(update=records)
    return save_profile(folder, profile)


def _profile_name(spec: CameraSpec) -> str:
    from scope_ptz.camera.network.address import parse_address
    from scope_ptz.factory.cameras.calibrations import profile_name
    from scope_ptz.factory.cameras.network import NETWORK_SCHEMES

    if spec.scheme not in NETWORK_SCHEMES:
        return f"{spec.scheme} {spec.address}"
    return profile_name(spec, parse_address(spec.address, tls=spec.options.get("tls") == "on")[1])
