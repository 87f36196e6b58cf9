"""``scope ask`` with an AXIS camera: the grammar plans, a model looks, and errors of the camera reach the person."""

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
def fake(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[FakeVapix]:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    device = FakeVapix()
    with device.loopback:
        yield device


def _spec(fake: FakeVapix) -> str:
    return f"axis://{USER}@127.0.0.1:{fake.loopback.port}?width=640&height=360"


def _ask(scope: Scope, fake: FakeVapix, instruction: str, *options: str) -> tuple[int, dict[str, object], str]:
    with Misbehaving(then=good(moondream=MOONDREAM)) as server:
        model = ("--perception", "moondream2", "--perception-url", server.url)
        done = scope("ask", instruction, "--camera", _spec(fake), *model, "--json", *options)
    return done.code, done.json if done.out else {}, done.err


def test_an_instruction_moves_the_camera_and_is_answered(scope: Scope, fake: FakeVapix, tmp_path: Path) -> None:
    code, summary, err = _ask(scope, fake, "go to gate, pan right 10 degrees and count the people")
    assert (code, err) == (0, "")
    assert "1" in str(summary["answer"])
    assert fake.position()[0] == pytest.approx(50.0, abs=0.1)
    written = b"".join(path.read_bytes() for path in (tmp_path / "runs").rglob("*.jsonl"))
    assert written
    assert PASSWORD.encode() not in written


def test_ground_truth_is_refused(scope: Scope, fake: FakeVapix) -> None:
    done = scope("ask", "count the people", "--camera", _spec(fake), "--perception", "ground-truth")
    assert done.code == 2
    assert "ground" in done.err


def test_a_stuck_motor_is_reported(scope: Scope, fake: FakeVapix) -> None:
    fake.stuck = frozenset({"pan"})
    code, summary, _ = _ask(scope, fake, "pan right 40 degrees")
    assert code != 0
    assert "position never arrived" in str(summary)


def test_a_wrong_password_is_reported_in_one_line(scope: Scope, fake: FakeVapix, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", "wrong-word")
    code, _, err = _ask(scope, fake, "pan right 40 degrees")
    assert code == 1
    assert "refuses the user name or the password" in err
    assert "wrong-word" not in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("axis://127.0.0.1", "must name the account"),
        ("axis://op:pw@127.0.0.1", "Remove user:password@"),
        ("axis://op@127.0.0.1", "SCOPE_CAMERA_PASSWORD"),
    ],
)
def test_missing_credentials(scope: Scope, monkeypatch: pytest.MonkeyPatch, spec: str, message: str) -> None:
    monkeypatch.delenv("SCOPE_CAMERA_PASSWORD", raising=False)
    done = scope("ask", "pan right", "--camera", spec, "--perception", "moondream2", "--perception-url", "http://127.0.0.1:9/v1")
    assert done.code == 2
    assert message in done.err


def test_another_program_has_control(scope: Scope, fake: FakeVapix, tmp_path: Path) -> None:
    lock = ControlLock("cam", f"127.0.0.1:{fake.loopback.port}/1", tmp_path / "cache" / "control")
    lock.acquire("the night shift")
    try:
        code, _, err = _ask(scope, fake, "pan right 40 degrees")
    finally:
        lock.release()
    assert code == 1
    assert "the night shift" in err
    assert not fake.moves


def test_scene_options_are_refused(scope: Scope, fake: FakeVapix) -> None:
    code, _, err = _ask(scope, fake, "pan right", "--viewpoint", "mast")
    assert code == 2
    assert "--viewpoint" in err
