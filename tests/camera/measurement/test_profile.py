"""Profiles keep what was measured, and drivers use it where they know nothing better."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.camera.measurement.profile import (
    CalibrationRecord,
    CameraProfile,
    MeasuredField,
    load_profile,
    profile_path,
    save_profile,
)
from scope_ptz.errors import OutputError, PackError
from scope_ptz.factory.cameras import parse_camera
from scope_ptz.factory.cameras.onvif import onvif_mapping

RECORD = CalibrationRecord(
    measured_at="2026-01-01T00:00:00+00:00", pan_scale=-0.5, tilt_scale=1.0, tilt_offset_deg=5.0, pan_range_deg=(-180.0, 180.0),
    tilt_range_deg=(-90.0, 90.0), snapshot_s=0.1, move_s=1.0, settling_s=0.0, residual_px=0.3,
    fields=(
        MeasuredField(zoom=1, share=0, stated_deg=60, measured_deg=71),
        MeasuredField(zoom=11, share=1, stated_deg=6, measured_deg=14),
    ),
    replaces=("pan range", "tilt range", "field of view"),
)  # fmt: skip


def test_profile_comes_back(tmp_path: Path) -> None:
    profile = CameraProfile(camera="onvif 10.0.0.7:80", calibration=RECORD)
    path = save_profile(tmp_path / "new", profile)
    assert load_profile(tmp_path / "new", "onvif 10.0.0.7:80") == profile
    assert load_profile(tmp_path / "new", "onvif 10.0.0.8:80") is None
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def test_names_never_leave_the_folder(tmp_path: Path) -> None:
    for name in ("onvif ../../etc/passwd", "..", "/", "a" * 500, "onvif [fe80::1]:80"):
        assert profile_path(tmp_path, name).parent == tmp_path
    assert profile_path(tmp_path, "a/b") != profile_path(tmp_path, "a-b")


def test_damaged_profile_is_reported(tmp_path: Path) -> None:
    profile_path(tmp_path, "x").write_text('{"camera": 5}')
    with pytest.raises(PackError, match="measure the camera again"):
        load_profile(tmp_path, "x")


def test_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        save_profile(tmp_path / "file", CameraProfile(camera="x"))


def test_measured_replaces_assumed_and_options_replace_measured() -> None:
    profile = CameraProfile(camera="x", calibration=RECORD)
    measured = onvif_mapping(parse_camera("onvif://op@10.0.0.7"), None, profile.calibration)
    assert measured.pan_deg == (90.0, -90.0)
    assert measured.tilt_deg == (-85.0, 95.0)
    assert measured.fields == ((0.0, 71.0), (1.0, 14.0))
    configured = onvif_mapping(parse_camera("onvif://op@10.0.0.7?pan_min=-170&pan_max=170"), (70.0, 7.0), profile.calibration)
    assert configured.pan_deg == (-170.0, 170.0)
    assert configured.fields == ((0.0, 70.0), (1.0, 7.0))


def test_what_the_device_states_is_not_replaced() -> None:
    stated = RECORD.model_copy(update={"replaces": ()})
    mapping = onvif_mapping(parse_camera("onvif://op@10.0.0.7"), None, stated)
    assert (mapping.pan_deg, mapping.tilt_deg, mapping.fields) == (None, None, None)
