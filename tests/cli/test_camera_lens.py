"""``scope camera focus|iris`` and ``scope camera move --centre``: manual control through both drivers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.camera.control import ControlLock
from scope_ptz.virtual_camera.lens import SHARP_FOCUS
from tests.cli.conftest import SCENE, Scope
from tests.cli.served_camera import ServedCamera

SIMULATED = f"sim:{SCENE}?width=160&height=90"


@pytest.mark.full
@pytest.mark.parametrize("scheme", ["axis", "onvif"])
def test_focus_and_iris_are_set_and_read_back(scope: Scope, served_camera: ServedCamera, scheme: str) -> None:
    camera, lens = served_camera.spec(scheme), served_camera.device.lens
    assert "automatic, at 62%" in scope("camera", "focus", camera).out
    result = scope("camera", "focus", camera, "near", "--step", "0.2", "--json")
    assert result.code == 0, result.err
    assert result.json["autofocus"] is False
    assert result.json["focus"] == pytest.approx(SHARP_FOCUS - 0.2, abs=0.01)
    assert lens.focus == pytest.approx(SHARP_FOCUS - 0.2, abs=0.01)
    assert scope("camera", "focus", camera, "once", "--json").json["focus"] == pytest.approx(SHARP_FOCUS, abs=0.001)
    assert not lens.autofocus
    iris = scope("camera", "iris", camera, "close", "--step", "0.1", "--json").json
    assert (iris["autoiris"], iris["iris"]) == (False, pytest.approx(0.4, abs=0.01))
    assert "iris: automatic" in scope("camera", "iris", camera, "auto").out
    assert lens.autoiris


def test_a_dry_run_leaves_the_lens_alone(scope: Scope, served_camera: ServedCamera) -> None:
    result = scope("camera", "focus", served_camera.spec("axis"), "far", "--dry-run")
    assert result.code == 0
    assert "would set the focus: far by 5% of the range" in result.err
    assert served_camera.device.lens.autofocus


def test_lens_commands_are_in_the_audit_log(
    scope: Scope, served_camera: ServedCamera, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scope.yaml").write_text(f"cameras: {{yard: {{camera: '{served_camera.spec('axis')}', audit_log: audit.jsonl}}}}")
    assert scope("camera", "iris", "yard", "open").code == 0
    assert scope("camera", "move", "yard", "--centre", "0.6,0.4").code == 0
    events = [json.loads(line) for line in (tmp_path / "audit.jsonl").read_text().splitlines()]
    assert [event["event"] for event in events] == ["iris", "lens", "centre", "arrived"]
    assert events[0]["action"] == "open"
    assert events[1]["autoiris"] is False


def test_others_cannot_touch_the_lens_of_a_camera_under_control(scope: Scope, served_camera: ServedCamera, tmp_path: Path) -> None:
    lock = ControlLock("The camera", f"127.0.0.1:{served_camera.port}/1", tmp_path / "cache" / "control")
    lock.acquire("night shift")
    try:
        result = scope("camera", "focus", served_camera.spec("onvif"), "near")
    finally:
        lock.release()
    assert result.code == 1
    assert "night shift" in result.err
    assert served_camera.device.lens.autofocus


@pytest.mark.parametrize("scheme", ["axis", "onvif"])
def test_a_point_in_the_picture_is_centred(scope: Scope, served_camera: ServedCamera, scheme: str) -> None:
    device = served_camera.device
    before = device.pose()
    result = scope("camera", "move", served_camera.spec(scheme), "--centre", "0.75,0.5", "--zoom-by", "2")
    assert result.code == 0, result.err
    after = device.pose()
    assert after.pan_deg - before.pan_deg == pytest.approx(19.6, abs=1.0)  # a quarter of a picture that is 71 degrees wide
    assert device.optics.focal(after.zoom) / device.optics.focal(before.zoom) == pytest.approx(2.0, rel=0.03)


def test_a_camera_without_lens_control_is_reported(scope: Scope) -> None:
    for command in (["focus", SIMULATED, "near"], ["iris", SIMULATED, "open"], ["focus", SIMULATED]):
        result = scope("camera", *command)
        assert result.code == 1
        assert "cannot be set" in result.err


@pytest.mark.parametrize(
    "arguments",
    [
        ["focus", SIMULATED, "sideways"],
        ["iris", SIMULATED, "open", "--step", "7"],
        ["move", SIMULATED, "--centre", "middle"],
        ["move", SIMULATED, "--centre", "2,0.5"],
        ["move", SIMULATED, "--zoom-by", "2"],
        ["move", SIMULATED, "--centre", "0.5,0.5", "--zoom-by", "0"],
        ["move", SIMULATED, "--centre", "0.5,0.5", "--home"],
    ],
)
def test_wrong_input_gives_one_line_and_exit_code_2(scope: Scope, arguments: list[str]) -> None:
    result = scope("camera", *arguments)
    assert (result.code, result.out) == (2, "")
    assert len(result.err.splitlines()) == 1
