"""Measure cameras and keep what was found in their profiles."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import monotonic
from typing import TYPE_CHECKING

from scope_ptz.factory.cameras import OpenCamera, open_camera, parse_camera
from scope_ptz.settings import load_settings

if TYPE_CHECKING:
    from scope_ptz.camera.measuring.profile import CalibrationRecord, CameraProfile, ProbeRecord
    from scope_ptz.camera.spec import CameraSpec

_SHOTS = 5


async def probe_camera(text: str) -> tuple[ProbeRecord, Path]:
    """Read what a camera can do, take some pictures, and store it. The camera does not move.

    Returns:
        What was found, and the file that keeps it.

    Raises:
        ScopeError: The camera cannot be opened or fails, or the profile cannot be written.
    """
    spec = parse_camera(text)
    async with await open_camera(spec, measuring=True) as opened:
        record = await _probe(opened)
    return record, _store(spec, probe=record)


async def calibrate_camera(
    text: str, *, zooms: int = 6, progress: Callable[[str], None] = lambda _: None
) -> tuple[CalibrationRecord, Path]:  # fmt: skip
    """Calibrate a camera from its own pictures, and store the result. The camera moves.

    Returns:
        What was found, and the file that keeps it.

    Raises:
        ScopeError: The camera cannot be opened or fails, no place has enough detail, or the profile cannot be written.
    """
    from scope_ptz.camera.measuring.calibration import calibrate
    from scope_ptz.camera.measuring.profile import record_of

    spec = parse_camera(text)
    async with await open_camera(spec, measuring=True) as opened:
        info = opened.camera.info
        found = await calibrate(opened.camera, zooms=zooms, assumed=info.assumed, progress=progress)
        limits = info.limits
        record = record_of(
            found, (limits.min_pan_deg, limits.max_pan_deg), (limits.min_tilt_deg, limits.max_tilt_deg), info.assumed
        )  # fmt: skip
    return record, _store(spec, calibration=record)


async def _probe(opened: OpenCamera) -> ProbeRecord:
    from scope_ptz.camera.measuring.profile import ProbeRecord, now

    camera, info = opened.camera, opened.camera.info
    limits, can = info.limits, info.capabilities
    times = []
    for _ in range(_SHOTS):
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
        drives=can.drives,
        edits_presets=can.edits_presets,
        focus=can.focus,
        iris=can.iris,
        assumed=info.assumed,
        snapshot_s=median(times),
    )


def _store(spec: CameraSpec, **found: object) -> Path:
    from scope_ptz.camera.measuring.profile import CameraProfile, load_profile, save_profile
    from scope_ptz.errors import PackError

    folder, name = load_settings().camera_profiles_dir, _name(spec)
    try:
        old = load_profile(folder, name)
    except PackError:
        old = None  # a damaged profile is replaced
    profile: CameraProfile = (old or CameraProfile(camera=name)).model_copy(update=found)
    return save_profile(folder, profile)


def _name(spec: CameraSpec) -> str:
    from scope_ptz.camera.network.address import parse_address
    from scope_ptz.factory.network_cameras import NETWORK_SCHEMES
    from scope_ptz.factory.onvif_cameras import profile_name

    if spec.scheme not in NETWORK_SCHEMES:
        return f"{spec.scheme} {spec.address}"
    return profile_name(spec, parse_address(spec.address, tls=spec.options.get("tls") == "on")[1])
