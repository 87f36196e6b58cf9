"""What was measured on an AXIS camera changes what its driver reports."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from scope_ptz.camera.measurement.profile import CalibrationRecord, CameraProfile, MeasuredField, save_profile
from scope_ptz.errors import CameraError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.cameras.calibrations import measured_settling
from scope_ptz.geometry import Pose
from tests.camera.axis.fake_vapix import PASSWORD, USER, FakeVapix

pytestmark = pytest.mark.anyio

RECORD = CalibrationRecord(
    measured_at="2026-11-23T00:00:00+00:00", pan_scale=1.0, tilt_scale=1.0, tilt_offset_deg=0.0, pan_range_deg=(-170, 170),
    tilt_range_deg=(-90, 20), snapshot_s=0.1, move_s=1.0, settling_s=2.0, residual_px=0.3,
    fields=tuple(
        MeasuredField(zoom=1 + 4 * share, share=share, stated_deg=stated, measured_deg=measured)
        for share, stated, measured in ((0.0, 71.0, 66.0), (0.5, 24.0, 20.0), (1.0, 14.0, 12.5))
    ),
)  # fmt: skip


@pytest.fixture(autouse=True)
def _settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("SCOPE_CAMERA_PROFILES_DIR", str(tmp_path / "profiles"))


async def _optics(fake: FakeVapix, options: str = "", *, for_measurement: bool = False) -> tuple[float, float, float]:
    spec = f"axis://{USER}@127.0.0.1:{fake.loopback.port}?width=640&height=360&latency_ms=1{options}"
    async with await open_camera(spec, for_measurement=for_measurement) as opened:
        info = opened.camera.info
        low, high = info.limits.min_zoom, info.limits.max_zoom
        frame = await opened.camera.frame()
        assert frame.hfov_deg == pytest.approx(info.optics.hfov_deg(frame.pose.zoom))
        return info.optics.hfov_deg(low), info.optics.hfov_deg((low + high) / 2), info.optics.hfov_deg(high)


def _store(fake: FakeVapix, tmp_path: Path, record: CalibrationRecord = RECORD) -> None:
    profile = CameraProfile(camera=f"axis 127.0.0.1:{fake.loopback.port}", calibration=record)
    save_profile(tmp_path / "profiles", profile)


async def test_measured_fields_replace_those_of_the_device(fake: FakeVapix, tmp_path: Path) -> None:
    stated = await _optics(fake)
    assert stated[::2] == pytest.approx((71.0, 14.0))
    _store(fake, tmp_path)
    assert await _optics(fake) == pytest.approx((66.0, 20.0, 12.5))
    assert (await _optics(fake, "&hfov_wide=70&hfov_tele=13"))[::2] == pytest.approx((70.0, 13.0))
    assert await _optics(fake, for_measurement=True) == stated, "an earlier measurement may not bias the next one"


async def test_a_device_without_field_angles_is_used_once_it_is_measured(fake: FakeVapix, tmp_path: Path) -> None:
    fake.cloak = frozenset({"fields"})
    with pytest.raises(CameraError, match="field of view"):
        await _optics(fake)
    _store(fake, tmp_path)
    assert (await _optics(fake))[0] == pytest.approx(66.0)


@pytest.mark.parametrize("shares", [(0.0, 0.5), (0.5, 1.0)])
async def test_fields_of_a_part_of_the_zoom_are_not_used(fake: FakeVapix, tmp_path: Path, shares: tuple[float, float]) -> None:
    fields = tuple(each for each in RECORD.fields if each.share in shares)
    _store(fake, tmp_path, RECORD.model_copy(update={"fields": fields}))
    assert (await _optics(fake))[0] == pytest.approx(71.0)


async def test_what_the_pictures_contradicted_is_a_warning(
    fake: FakeVapix, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    _store(fake, tmp_path, RECORD.model_copy(update={"contradictions": ("Pan is inverted.",)}))
    with caplog.at_level(logging.WARNING):
        await _optics(fake)
    assert "Pan is inverted." in caplog.text


def test_a_picture_that_settles_late_is_given_time() -> None:
    assert measured_settling(RECORD).picture_timeout_s == 6.0
    assert measured_settling(None).picture_timeout_s == 4.0
    assert measured_settling(RECORD.model_copy(update={"settling_s": 0.1})).picture_timeout_s == 4.0


async def test_centring_asks_the_device_and_corrects_it(fake: FakeVapix) -> None:
    """This device takes centring for a drive: what the driver checks is where it stands, not what it was told."""
    fake.more_support = ("AreaZoom",)
    spec = f"axis://{USER}@127.0.0.1:{fake.loopback.port}?width=640&height=360&latency_ms=1"
    async with await open_camera(spec) as opened:
        await opened.camera.move(Pose(0.0, -10.0, 1.0))
        fake.moves.clear()
        arrival = await opened.camera.centre_on(0.75, 0.5)
        commands = [text.split("=")[0] for _, text in fake.moves]
        assert commands == ["center", "pan"]
        assert "480,180" in fake.moves[0][1]
        assert arrival.pose.pan_deg == pytest.approx(19.9, abs=0.5)
