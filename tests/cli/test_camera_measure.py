"""``scope camera discover|probe|calibrate``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.camera.measurement import calibration
from scope_ptz.camera.measurement.calibration import AxisResponse, Calibration, FieldOfView
from scope_ptz.camera.measurement.profile import ProbeRecord
from scope_ptz.camera.measurement.report import report_name, report_text
from scope_ptz.virtual_camera.identity import FIRMWARE
from tests.cli.conftest import SCENE, Scope
from tests.cli.served_camera import ServedCamera

CAMERA = f"sim:{SCENE}?width=160&height=90"


@pytest.fixture(autouse=True)
def _profiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PROFILES_DIR", str(tmp_path / "profiles"))


def test_probe_reports_and_stores_capabilities(scope: Scope, tmp_path: Path) -> None:
    result = scope("camera", "probe", CAMERA)
    assert result.code == 0, result.err
    assert "Zoom: 1.00x to 5.00x" in result.out
    assert "160x90" in result.out
    (file,) = (tmp_path / "profiles").iterdir()
    assert str(file) in result.out
    assert scope("camera", "probe", CAMERA, "--json").json["frame_width"] == 160


def test_a_report_contains_capabilities_but_no_identifying_data(
    scope: Scope, served_camera: ServedCamera, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for scheme in ("axis", "onvif"):
        spec = served_camera.spec(scheme)
        result = scope("camera", "probe", spec, "--report")
        assert result.code == 0, result.err
        (report,) = tmp_path.glob("camera-report-*.md")
        text = report.read_text()
        report.unlink()
        assert "M5075-G" in text
        assert f"| {FIRMWARE} | {scheme} |" in text
        assert "once" in text
        details = json.loads(text.partition("```json\n")[2].partition("```")[0])
        assert details["presets"] == len(served_camera.device.presets()) > 0
        names = [preset.name for preset in served_camera.device.presets()]
        for secret in (*served_camera.secrets, *names, "127.0.0.1", str(served_camera.port), str(tmp_path)):
            assert secret not in text, secret
    assert scope("camera", "probe", spec, "--report", "--out", str(tmp_path / "none" / "x.md")).code != 0


def test_identifiers_in_the_name_of_a_model_are_removed() -> None:
    record = ProbeRecord(
        probed_at="", model="CAM ACCC8E00A1B2 10.0.0.7:80 ac:cc:8e:00:a1:b2 op@yard", driver="onvif", pan_range_deg=(-1, 1),
        tilt_range_deg=(-1, 1), zoom_range=(1, 2), pan_endless=False, zoom_table=((1, 60), (2, 30)), frame_width=1, frame_height=1,
        presets=("Vault",), drives=True, edits_presets=True, focus=False, iris=False, assumed=(), snapshot_s=0.1,
    )  # fmt: skip
    for text in (report_text(record).lower(), report_name(record)):
        assert "cam" in text
        assert not any(part in text for part in ("accc8e", "10.0.0.7", "ac:cc", "op@yard", "vault"))


@pytest.mark.parametrize("pan", [1.0, -1.0])
def test_calibrate_exits_with_1_if_pictures_contradict_the_camera(
    scope: Scope, monkeypatch: pytest.MonkeyPatch, pan: float
) -> None:
    contradictions = ("The pan is inverted.",) if pan < 0 else ()

    async def fake_calibrate(*_: object, **__: object) -> Calibration:
        fields = (FieldOfView(1.0, 0.0, 71.0, 71.1), FieldOfView(5.0, 1.0, 14.0, 14.0))
        return Calibration(AxisResponse(pan), AxisResponse(1.0), 0.0, fields, 0.1, 1.0, 0.0, 0.3, contradictions)

    monkeypatch.setattr(calibration, "calibrate", fake_calibrate)
    result = scope("camera", "calibrate", CAMERA)
    assert result.code == (1 if pan < 0 else 0)
    assert ("The pan is inverted." in result.err) == (pan < 0)
    assert ("INVERTED" in result.out) == (pan < 0)


def test_calibrate_needs_detail(scope: Scope) -> None:
    result = scope("camera", "calibrate", f"sim:{SCENE}?width=64&height=36")
    assert result.code == 1
    assert "detail" in result.err


def test_discover_uses_the_given_interface(scope: Scope) -> None:
    result = scope("camera", "discover", "--interface", "127.0.0.1", "--wait", "0.1", "--json")
    assert result.code == 0
    assert isinstance(result.json, list)
    wrong = scope("camera", "discover", "--interface", "eth0", "--wait", "0.1")
    assert wrong.code == 2
    assert "IPv4" in wrong.err


def test_a_dry_run_prints_the_moves_and_stores_nothing(scope: Scope, served_camera: ServedCamera, tmp_path: Path) -> None:
    before = served_camera.device.pose()
    result = scope("camera", "calibrate", served_camera.spec("axis"), "--zooms", "3", "--dry-run")
    assert result.code == 0, result.err
    assert "would move it to pan" in result.out
    assert "zoom to 1.00x, 2.24x, 5.00x" in result.out
    plan = scope("camera", "calibrate", served_camera.spec("onvif"), "--dry-run", "--json").json
    assert plan["zooms"] == sorted(plan["zooms"])
    assert len(plan["zooms"]) == 6
    assert served_camera.device.pose() == before
    assert not (tmp_path / "profiles").exists()
