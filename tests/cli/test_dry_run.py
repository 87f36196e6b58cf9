"""``--dry-run``: plans are made and reported, and nothing moves."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz.camera.guard.dry_run import DryRunCamera
from scope_ptz.camera.guard.guarded_camera import GuardedCamera
from scope_ptz.camera.guard.rules import CameraRules, Region
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from tests.cli.conftest import SCENE, Scope
from tests.cli.served_camera import ServedCamera
from tests.support.misbehaving import Misbehaving, good

CAMERA = f"sim:{SCENE}?width=160&height=90"
MOONDREAM = {"detect": {"objects": [{"x_min": 0.7, "y_min": 0.4, "x_max": 0.8, "y_max": 0.6}]}}


@pytest.mark.parametrize("scheme", ["axis", "onvif"])
def test_a_real_camera_does_not_move(scope: Scope, served_camera: ServedCamera, tmp_path: Path, scheme: str) -> None:
    device = served_camera.device
    before, commands = device.pose(), device._motion.commands
    with Misbehaving(then=good(moondream=MOONDREAM)) as server:
        result = scope(
            "ask", "pan right 20 and count the cars, then zoom in on the car", "--camera", served_camera.spec(scheme),
            "--perception",
            "moondream2", "--perception-url", server.url, "--dry-run", "--json",
        )  # fmt: skip
    assert result.code == 0, result.err
    assert (device.pose(), device._motion.commands) == (before, commands)
    assert result.json["dry_run"] is True
    assert result.json["planned"][0] == f"would move to pan {before.pan_deg + 20:g}, tilt {before.tilt_deg:g}, zoom 1x"
    assert len(result.json["planned"]) >= 2  # the zoom is planned from the position of the car
    assert result.json["pose"]["zoom"] > 1
    assert "Dry run: nothing has moved" in result.json["note"]
    trace = (Path(result.json["run_dir"]) / "trace.jsonl").read_text()
    assert "Dry run: nothing has moved" in json.loads(trace.splitlines()[0])["labels"]["perception_note"]
    assert "held back by the dry run" in trace


def test_a_sweep_is_reported_and_sees_only_the_view_at_the_start(scope: Scope) -> None:
    dry_sweep = scope("ask", "sweep the scene and count all cars", "--camera", CAMERA, "--dry-run", "--json").json
    current_view = scope("ask", "count the cars", "--camera", CAMERA, "--json").json
    full_sweep = scope("ask", "sweep the scene and count all cars", "--camera", CAMERA, "--json").json
    counts = [each["tool_calls"][0]["result"]["count"] for each in (dry_sweep, current_view, full_sweep)]
    assert counts[0] == counts[1]
    assert counts[2] >= counts[1]
    assert len(dry_sweep["planned"]) > 10


def test_a_dry_run_can_be_replayed(scope: Scope) -> None:
    result = scope("ask", "pan right 20 and count the balls", "--camera", CAMERA, "--dry-run", "--json").json
    replayed = scope("replay", result["run_dir"], "--json")
    assert (replayed.code, replayed.json["equal"], replayed.json["repeated"]) == (0, True, True)


def test_the_output_lists_the_planned_commands(scope: Scope) -> None:
    result = scope("ask", "pan right 20, then go home", "--camera", CAMERA, "--dry-run")
    assert result.code == 0
    for text in (
        "Dry run: the camera has not moved. Planned commands:",
        "would move to pan 20",
        "would go home",
        "held back by the dry run",
    ):
        assert text in result.out
    plain = scope("ask", "pan right 20, then go home", "--camera", CAMERA).out
    assert "ry run" not in plain


def test_a_chat_can_be_a_dry_run(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = iter(["pan right 20", "pan right 10", "/quit"])
    monkeypatch.setattr("builtins.input", lambda _="": next(lines))
    monkeypatch.setattr("scope_ptz.cli.chat.has_input", lambda: True)
    result = scope("chat", "--camera", CAMERA, "--dry-run")
    assert result.code == 0, result.err
    assert result.out.count("would move to pan 20") == 1
    assert result.out.count("would move to pan 30") == 1


def test_a_dry_run_in_python(scenes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    with scope_ptz.open(CAMERA, dry_run=True) as session:
        before = session.frame().pose
        run = session.ask("pan right 20")
        assert run.pose.pan_deg == before.pan_deg + 20
        assert session.frame().pose == before
        assert "held back by the dry run" in session.move(pan_deg=5).message
        assert session.camera.info.dry_run


@pytest.mark.anyio
async def test_rules_of_the_site_are_part_of_the_plan(analytic_scene: Scene) -> None:
    rules = CameraRules(keep_out=(Region(name="window", pan_deg=(30.0, 60.0), tilt_deg=(-30.0, 30.0)),))
    reports: list[str] = []
    camera = DryRunCamera(GuardedCamera(SimulatedCamera(analytic_scene), rules), reports.append)
    arrival = await camera.move(Pose(45.0, 0.0, 1.0))
    assert not 30.0 < arrival.pose.pan_deg < 60.0 or not -30.0 < arrival.pose.tilt_deg < 30.0
    assert "the keep-out region 'window'" in reports[0]
    assert "the keep-out region 'window', and by the dry run" in arrival.limited_by
