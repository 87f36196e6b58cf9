"""``scope ask`` with an AXIS camera: the grammar plans, a model perceives, and camera errors reach the user."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from scope_ptz.camera.control import ControlLock
from tests.camera.axis.fake_vapix import PASSWORD, USER, FakeVapix
from tests.cli.conftest import Scope
from tests.support.misbehaving import Misbehaving, good

MOONDREAM = {"detect": {"objects": [{"x_min": 0.4, "y_min": 0.4, "x_max": 0.6, "y_max": 0.6}]}}


@pytest.fixture
def fake_camera(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[FakeVapix]:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    device = FakeVapix()
    with device.loopback:
        yield device


def _spec(fake_camera: FakeVapix) -> str:
    return f"axis://{USER}@127.0.0.1:{fake_camera.loopback.port}?width=640&height=360"


def _ask(scope: Scope, fake_camera: FakeVapix, instruction: str, *options: str) -> tuple[int, dict[str, object], str]:
    with Misbehaving(then=good(moondream=MOONDREAM)) as server:
        model = ("--perception", "moondream2", "--perception-url", server.url)
        result = scope("ask", instruction, "--camera", _spec(fake_camera), *model, "--json", *options)
    return result.code, result.json if result.out else {}, result.err


def test_an_instruction_moves_the_camera_and_is_answered(scope: Scope, fake_camera: FakeVapix, tmp_path: Path) -> None:
    code, summary, err = _ask(scope, fake_camera, "go to gate, pan right 10 degrees and count the people")
    assert (code, err) == (0, "")
    assert "1" in str(summary["answer"])
    assert fake_camera.position()[0] == pytest.approx(50.0, abs=0.1)
    traces = b"".join(path.read_bytes() for path in (tmp_path / "runs").rglob("*.jsonl"))
    assert traces
    assert PASSWORD.encode() not in traces


def test_ground_truth_is_refused(scope: Scope, fake_camera: FakeVapix) -> None:
    result = scope("ask", "count the people", "--camera", _spec(fake_camera), "--perception", "ground-truth")
    assert result.code == 2
    assert "ground" in result.err


def test_a_stuck_motor_is_reported(scope: Scope, fake_camera: FakeVapix) -> None:
    fake_camera.stuck = frozenset({"pan"})
    code, summary, _ = _ask(scope, fake_camera, "pan right 40 degrees")
    assert code != 0
    assert "but stopped at" in str(summary)


def test_a_wrong_password_is_reported_in_one_line(scope: Scope, fake_camera: FakeVapix, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", "wrong-word")
    code, _, err = _ask(scope, fake_camera, "pan right 40 degrees")
    assert code == 1
    assert "rejected the user name or the password" in err
    assert "wrong-word" not in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("axis://127.0.0.1", "must contain a user name"),
        ("axis://op:pw@127.0.0.1", "Remove user:password@"),
        ("axis://op@127.0.0.1", "SCOPE_CAMERA_PASSWORD"),
    ],
)
def test_missing_credentials(scope: Scope, monkeypatch: pytest.MonkeyPatch, spec: str, message: str) -> None:
    monkeypatch.delenv("SCOPE_CAMERA_PASSWORD", raising=False)
    result = scope("ask", "pan right", "--camera", spec, "--perception", "moondream2", "--perception-url", "http://127.0.0.1:9/v1")
    assert result.code == 2
    assert message in result.err


def test_a_camera_under_control_of_another_program_is_not_moved(scope: Scope, fake_camera: FakeVapix, tmp_path: Path) -> None:
    lock = ControlLock("cam", f"127.0.0.1:{fake_camera.loopback.port}/1", tmp_path / "cache" / "control")
    lock.acquire("the night shift")
    try:
        code, _, err = _ask(scope, fake_camera, "pan right 40 degrees")
    finally:
        lock.release()
    assert code == 1
    assert "the night shift" in err
    assert not fake_camera.moves


def test_scene_options_are_refused(scope: Scope, fake_camera: FakeVapix) -> None:
    code, _, err = _ask(scope, fake_camera, "pan right", "--viewpoint", "mast")
    assert code == 2
    assert "--viewpoint" in err
