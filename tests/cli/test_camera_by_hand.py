"""``scope camera snapshot|move|presets|watch``: a camera by hand."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.conftest import SCENE, Scope

CAMERA = f"sim:{SCENE}?width=160&height=90"


def test_a_snapshot_is_a_picture_with_its_pose(scope: Scope, tmp_path: Path) -> None:
    done = scope("camera", "snapshot", CAMERA, "-o", str(tmp_path / "new" / "a.png"), "--json")
    assert done.code == 0, done.err
    with Image.open(done.json["file"]) as picture:
        assert picture.size == (160, 90)
    assert (done.json["width"], done.json["height"], done.json["hfov_deg"]) == (160, 90, 71.0)
    wide = scope("camera", "snapshot", CAMERA, "--full", "-o", str(tmp_path / "b.jpg"), "--json").json
    assert wide["width"] > 600
    assert wide["hfov_deg"] == 360.0


@pytest.mark.parametrize(("options", "pose"), [
    (["--pan", "30", "--tilt", "-5", "--zoom", "2"], {"pan_deg": 30.0, "tilt_deg": -5.0, "zoom": 2.0}),
    (["--by-pan", "10"], {"pan_deg": 10.0, "tilt_deg": -8.0, "zoom": 1.0}),
    (["--home"], {"pan_deg": 0.0, "tilt_deg": -8.0, "zoom": 1.0}),
    ([], {"pan_deg": 0.0, "tilt_deg": -8.0, "zoom": 1.0}),
])  # fmt: skip
def test_move_goes_there_and_says_where_it_is(scope: Scope, options: list[str], pose: dict[str, float]) -> None:
    assert scope("camera", "move", CAMERA, *options, "--json").json == {**pose, "clamped": [], "limited_by": ""}


def test_a_limit_is_reported(scope: Scope) -> None:
    assert "stopped by the tilt limit" in scope("camera", "move", CAMERA, "--tilt", "80").out


def test_a_dry_run_says_what_it_would_do_and_does_nothing(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scope.yaml").write_text(f"cameras: {{yard: {{camera: '{CAMERA}', audit_log: audit.jsonl}}}}")
    for options in (["--by-pan", "10"], ["--home"], ["--stop"]):
        done = scope("camera", "move", "yard", *options, "--dry-run")
        assert done.code == 0
    assert "would go home" in scope("camera", "move", "yard", "--home", "--dry-run").err
    assert (tmp_path / "audit.jsonl").read_text() == ""
    scope("camera", "move", "yard", "--by-pan", "10")
    assert [json.loads(line)["event"] for line in (tmp_path / "audit.jsonl").read_text().splitlines()] == ["move", "arrived"]


def test_a_dry_snapshot_writes_no_file(scope: Scope, tmp_path: Path) -> None:
    file = tmp_path / "all.jpg"
    done = scope("camera", "snapshot", CAMERA, "--full", "--out", str(file), "--dry-run")
    assert done.code == 0, done.err
    assert done.err.count("would move to") > 2
    assert f"would write {file}" in done.err
    assert scope("camera", "snapshot", CAMERA, "--out", str(file), "--dry-run", "--json").json == {
        "file": str(file),
        "dry_run": True,
    }
    assert not file.exists()


def test_presets_are_listed_and_saved(scope: Scope) -> None:
    listed = scope("camera", "presets", CAMERA, "--json").json
    assert {preset["name"] for preset in scope("camera", "presets", CAMERA, "--save", "spot", "--json").json} == {
        *(preset["name"] for preset in listed), "spot",
    }  # fmt: skip
    assert scope("camera", "presets", CAMERA, "--remove", "nothing").code == 2


def test_watch_follows_the_picture_and_keeps_it(scope: Scope, tmp_path: Path) -> None:
    done = scope("camera", "watch", CAMERA, "--count", "3", "--rate", "60", "--out", str(tmp_path / "frames"), "--json")
    seen = [json.loads(line) for line in done.out.splitlines()]
    assert [frame["number"] for frame in seen] == [1, 2, 3]
    assert seen[0]["time_s"] < seen[2]["time_s"]
    assert sorted(path.name for path in (tmp_path / "frames").iterdir()) == ["000001.jpg", "000002.jpg", "000003.jpg"]


@pytest.mark.parametrize("arguments", [
    ["move", CAMERA, "--pan", "nan"], ["move", CAMERA, "--zoom", "0"], ["move", CAMERA, "--home", "--stop"],
    ["move", CAMERA, "--preset", "nowhere"], ["snapshot", CAMERA, "-o", "a.txt"], ["snapshot", "axis://op:pw@10.0.0.7"],
    ["presets", CAMERA, "--save", " "], ["presets", CAMERA, "--save", "a", "--remove", "b"], ["watch", CAMERA, "--rate", "0"],
    ["move", "no-such-camera"], ["password", CAMERA],
])  # fmt: skip
def test_wrong_input_ends_with_one_line_and_code_2(scope: Scope, arguments: list[str]) -> None:
    done = scope("camera", *arguments)
    assert (done.code, done.out) == (2, "")
    assert len(done.err.splitlines()) == 1
    assert "pw" not in done.err
