"""``scope camera discover|probe|calibrate``."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.camera.measuring import calibration
from scope_ptz.camera.measuring.calibration import AxisResponse, Calibration, FieldOfView
from tests.cli.conftest import SCENE, Scope

CAMERA = f"sim:{SCENE}?width=160&height=90"


@pytest.fixture(autouse=True)
def _profiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PROFILES_DIR", str(tmp_path / "profiles"))


def test_probe_says_what_a_camera_can_do_and_stores_it(scope: Scope, tmp_path: Path) -> None:
    done = scope("camera", "probe", CAMERA)
    assert done.code == 0, done.err
    assert "Zoom: 1.00x to 5.00x" in done.out
    assert "160x90" in done.out
    (file,) = (tmp_path / "profiles").iterdir()
    assert str(file) in done.out
    assert scope("camera", "probe", CAMERA, "--json").json["frame_width"] == 160


def test_report_names_no_place(scope: Scope) -> None:
    plain = scope("camera", "probe", CAMERA)
    report = scope("camera", "probe", CAMERA, "--report")
    listed, counted = (text.out.partition("Presets: ")[2].splitlines()[0] for text in (plain, report))
    assert listed.partition(": ")[2]
    assert counted.isdecimal()
    assert "profiles" not in report.out


@pytest.mark.parametrize("pan", [1.0, -1.0])
def test_calibrate_exits_with_1_if_the_picture_contradicts(scope: Scope, monkeypatch: pytest.MonkeyPatch, pan: float) -> None:
    contradictions = ("The pan is inverted.",) if pan < 0 else ()

    async def measured(*_: object, **__: object) -> Calibration:
        fields = (FieldOfView(1.0, 0.0, 71.0, 71.1), FieldOfView(5.0, 1.0, 14.0, 14.0))
        return Calibration(AxisResponse(pan), AxisResponse(1.0), 0.0, fields, 0.1, 1.0, 0.0, 0.3, contradictions)

    monkeypatch.setattr(calibration, "calibrate", measured)
    done = scope("camera", "calibrate", CAMERA)
    assert done.code == (1 if pan < 0 else 0)
    assert ("The pan is inverted." in done.err) == (pan < 0)
    assert ("INVERTED" in done.out) == (pan < 0)


def test_calibrate_needs_detail(scope: Scope) -> None:
    done = scope("camera", "calibrate", f"sim:{SCENE}?width=64&height=36")
    assert done.code == 1
    assert "detail" in done.err


def test_discover_asks_at_an_interface(scope: Scope) -> None:
    done = scope("camera", "discover", "--interface", "127.0.0.1", "--wait", "0.1", "--json")
    assert done.code == 0
    assert isinstance(done.json, list)
    wrong = scope("camera", "discover", "--interface", "eth0", "--wait", "0.1")
    assert wrong.code == 2
    assert "IPv4" in wrong.err
