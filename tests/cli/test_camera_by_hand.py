"""``scope camera snapshot|move|presets|watch``: manual control of a camera."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import SCENE, Scope

CAMERA = f"sim:{SCENE}?width=160&height=90"


def test_a_snapshot_is_a_picture_with_its_pose(scope: Scope, tmp_path: Path) -> None:
    result = scope("camera", "snapshot", CAMERA, "-o", str(tmp_path / "new" / "a.png"), "--json")
    assert result.code == 0, result.err
    with Image.open(result.json["file"]) as picture:
        assert picture.size == (160, 90)
    assert (result.json["width"], result.json["height"], result.json["hfov_deg"]) == (160, 90, 71.0)
    wide = scope("camera", "snapshot", CAMERA, "--full", "-o", str(tmp_path / "b.jpg"), "--json").json
    assert wide["width"] > 600
    assert wide["hfov_deg"] == 360.0


@pytest.mark.parametrize(("options", "pose"), [
    (["--pan", "30", "--tilt", "-5", "--zoom", "2"], {"pan_deg": 30.0, "tilt_deg": -5.0, "zoom": 2.0}),
    (["--by-pan", "10"], {"pan_deg": 10.0, "tilt_deg": -8.0, "zoom": 1.0}),
    (["--home"], {"pan_deg": 0.0, "tilt_deg": -8.0, "zoom": 1.0}),
    ([], {"pan_deg": 0.0, "tilt_deg": -8.0, "zoom": 1.0}),
])  # fmt: skip
def test_move_reports_the_final_pose(scope: Scope, options: list[str], pose: dict[str, float]) -> None:
    assert scope("camera", "move", CAMERA, *options, "--json").json == {**pose, "clamped": [], "limited_by": ""}


def test_a_limit_is_reported(scope: Scope) -> None:
    assert "stopped by the tilt limit" in scope("camera", "move", CAMERA, "--tilt", "80").out


def test_a_dry_run_reports_the_commands_and_executes_none(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scope.yaml").write_text(f"cameras: {{yard: {{camera: '{CAMERA}', audit_log: audit.jsonl}}}}")
    for options in (["--by-pan", "10"], ["--home"], ["--stop"]):
        result = scope("camera", "move", "yard", *options, "--dry-run")
        assert result.code == 0
    assert "would go home" in scope("camera", "move", "yard", "--home", "--dry-run").err
    assert (tmp_path / "audit.jsonl").read_text() == ""
    scope("camera", "move", "yard", "--by-pan", "10")
    assert [json.loads(line)["event"] for line in (tmp_path / "audit.jsonl").read_text().splitlines()] == ["move", "arrived"]


def test_a_dry_snapshot_writes_no_file(scope: Scope, tmp_path: Path) -> None:
    file = tmp_path / "all.jpg"
    result = scope("camera", "snapshot", CAMERA, "--full", "--out", str(file), "--dry-run")
    assert result.code == 0, result.err
    assert result.err.count("would move to") > 2
    assert f"would write {file}" in result.err
    assert scope("camera", "snapshot", CAMERA, "--out", str(file), "--dry-run", "--json").json == {
        "file": str(file),
        "dry_run": True,
    }
    assert not file.exists()


def test_presets_are_listed_and_saved(scope: Scope) -> None:
    presets = scope("camera", "presets", CAMERA, "--json").json
    assert {preset["name"] for preset in scope("camera", "presets", CAMERA, "--save", "spot", "--json").json} == {
        *(preset["name"] for preset in presets), "spot",
    }  # fmt: skip
    assert scope("camera", "presets", CAMERA, "--remove", "nothing").code == 2


def test_watch_reports_and_saves_frames(scope: Scope, tmp_path: Path) -> None:
    result = scope("camera", "watch", CAMERA, "--count", "3", "--rate", "60", "--out", str(tmp_path / "frames"), "--json")
    frames = [json.loads(line) for line in result.out.splitlines()]
    assert [frame["number"] for frame in frames] == [1, 2, 3]
    assert frames[0]["time_s"] < frames[2]["time_s"]
    assert sorted(path.name for path in (tmp_path / "frames").iterdir()) == ["000001.jpg", "000002.jpg", "000003.jpg"]


@pytest.mark.parametrize("arguments", [
    ["move", CAMERA, "--pan", "nan"], ["move", CAMERA, "--zoom", "0"], ["move", CAMERA, "--home", "--stop"],
    ["move", CAMERA, "--preset", "nowhere"], ["snapshot", CAMERA, "-o", "a.txt"], ["snapshot", "axis://op:pw@10.0.0.7"],
    ["presets", CAMERA, "--save", " "], ["presets", CAMERA, "--save", "a", "--remove", "b"], ["watch", CAMERA, "--rate", "0"],
    ["move", "no-such-camera"], ["password", CAMERA],
])  # fmt: skip
def test_wrong_input_gives_one_line_and_exit_code_2(scope: Scope, arguments: list[str]) -> None:
    result = scope("camera", *arguments)
    assert (result.code, result.out) == (2, "")
    assert len(result.err.splitlines()) == 1
    assert "pw" not in result.err
