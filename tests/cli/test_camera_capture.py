"""``scope camera capture``: invalid options, and the use of a twin as a scene in other commands."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, make_devices
from tests.cli.conftest import SCENE, Scope

CAMERA = f"sim:{SCENE}?width=320&height=180"
SMALL = ("--pan", "-10:10", "--tilt", "-10:-8", "--close-ups", "0")


@pytest.mark.parametrize(("options", "message"), [
    (["--name", "My Yard"], "lower-case letters"),
    (["--name", "yard-v3"], "name of a scene variation"),
    ([], "must have a name"),
    (["--name", SCENE], "already exists"),
    (["--name", "yard", "--pan", "left"], "--pan must be FROM:TO"),
    (["--name", "yard", "--tilt", "50:60"], "cannot be captured"),
    (["--name", "yard", "--zoom", "99"], "Each zoom must be above"),
    (["--name", "yard", "--overlap", "0"], "overlap"),
])  # fmt: skip
def test_wrong_options_give_one_line(scope: Scope, scenes: Path, options: list[str], message: str) -> None:
    result = scope("camera", "capture", CAMERA, "--to", str(scenes), *options)
    assert (result.code, result.out) == (2, "")
    assert message in result.err
    assert len(result.err.splitlines()) == 1
    assert not any(path.name.startswith(".yard") for path in scenes.iterdir())


def test_capture_needs_a_scenes_folder(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SCOPE_SCENES_DIR")
    result = scope("camera", "capture", "sim:highway-works", "--name", "yard")
    assert (result.code, result.out) == (2, "")
    assert "--to" in result.err


def test_a_dry_run_prints_the_plan_and_writes_nothing(scope: Scope, tmp_path: Path) -> None:
    arguments = (
        "camera",
        "capture",
        CAMERA,
        "--to",
        str(tmp_path / "scenes"),
        "--name",
        "my-yard",
        *SMALL,
        "--zoom",
        "3",
        "--dry-run",
    )
    result = scope(*arguments)
    assert result.code == 0, result.err
    assert "pan -10 to 10 and tilt -10 to -8 degrees" in result.out
    assert "pictures at 3x" in result.out
    assert "the camera did not move" in result.out
    plan = scope(*arguments, "--json").json
    assert [sweep["zoom"] for sweep in plan["sweeps"]] == [1.0, 3.0]
    assert plan["sweeps"][1]["pictures"] > plan["sweeps"][0]["pictures"] >= 1
    assert not (tmp_path / "scenes").exists()


@pytest.mark.full
def test_a_twin_works_as_a_scene(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "scenes"
    result = scope("camera", "capture", CAMERA, "--to", str(folder), "--name", "my-yard", *SMALL)
    assert result.code == 0, result.err
    assert "my-yard" in result.out
    assert "no ground truth" in result.out
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(folder))
    assert "my-yard" in scope("scene", "list").out
    scene_card = scope("scene", "show", "my-yard", "--contact-sheet", str(tmp_path / "sheet.png"))
    assert (scene_card.code, "no ground truth" in scene_card.out) == (0, True)
    assert "no ground truth" in scope("scene", "show", "my-yard", "--all", "--contact-sheet", str(tmp_path / "sheet.png")).out
    view = tmp_path / "view.png"
    assert scope("scene", "view", "my-yard", "--pan", "3", "-o", str(view)).code == 0
    assert view.stat().st_size > 1000
    assert scope("ask", "pan right 5 degrees", "--scene", "my-yard", "--fast").code == 0
    answer = scope("ask", "how many balls are there?", "--scene", "my-yard", "--fast", "--json")
    assert "captured from a camera and has no ground truth" in answer.out + answer.err
    final = json.loads(answer.out.splitlines()[-1])
    assert "I can see 0" not in json.dumps(final)
    (device,) = make_devices(VirtualCameraOptions(scenes=("my-yard",)), [])
    assert device.limits.max_pan_deg == 10.0
    assert device.expose(320, 180).image.std() > 10
    built = scope("bench", "build", "--scene", "my-yard", "--out", str(tmp_path / "tasks.jsonl"))
    assert (built.code, "has no ground truth" in built.err) == (2, True)
    assert not (tmp_path / "tasks.jsonl").exists()
    second = scope("camera", "capture", CAMERA, "--to", str(folder), "--name", "my-yard", *SMALL)
    assert (second.code, "already exists" in second.err) == (2, True)


def test_the_camera_name_in_the_site_file_is_the_default(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rules = "{keep_out: [{name: window, pan_deg: [0, 5], tilt_deg: [-12, -6]}]}"
    (tmp_path / "scope.yaml").write_text(f"cameras: {{yard-gate: {{camera: '{CAMERA}', rules: {rules}}}}}")
    result = scope("camera", "capture", "yard-gate", "--to", str(tmp_path / "scenes"), *SMALL, "--json")
    assert result.code == 0, result.err
    assert result.json["name"] == "yard-gate"
    assert result.json["unseen_share"] > 0.005
    assert Path(result.json["folder"]) == tmp_path / "scenes" / "yard-gate"
