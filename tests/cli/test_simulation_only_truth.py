"""``scope ask --perception simulation-only-truth``: a camera driver with the ground truth that a virtual camera serves."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from anyio.from_thread import start_blocking_portal

from scope_ptz.builtin_names import SERVED_TRUTH
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, serve
from tests.cli.conftest import SCENE, Scope

PASSWORD = "parity-on-loopback"


@pytest.fixture(params=[True, False], ids=["truth", "no truth"])
def camera_server(
    request: pytest.FixtureRequest, scenes: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Iterator[ServedCamera]:
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", PASSWORD)
    monkeypatch.setenv("SCOPE_CACHE_DIR", str(tmp_path / "cache"))
    device = VirtualDevice(
        Scene(scenes / SCENE), accounts=[Account("op", PASSWORD, Role.OPERATOR)], width=320, height=180, time_scale=500
    )  # fmt: skip
    with start_blocking_portal() as portal, portal.wrap_async_context_manager(serve([device], truth=request.param)) as (camera,):
        yield camera


@pytest.mark.parametrize("camera_server", [True], indirect=True)
def test_answers_and_traces_name_the_source(scope: Scope, camera_server: ServedCamera, tmp_path: Path) -> None:
    spec = f"axis://op@127.0.0.1:{camera_server.port}?width=320&height=180"
    result = scope("ask", "how many blocks are there?", "--camera", spec, "--perception", SERVED_TRUTH, "--json")
    assert result.code == 0, result.err
    assert result.json["answer"] == f"I can see 1 block in this view. (Source: {SERVED_TRUTH}.)"
    (trace,) = (tmp_path / "runs").rglob("trace.jsonl")
    start = json.loads(trace.read_text().splitlines()[0])
    assert start["perception"] == SERVED_TRUTH
    assert start["labels"]["perception_note"].startswith("Simulation only")
    assert (start["simulated"], start["scene"]) == (False, None)
    assert PASSWORD not in trace.read_text()


@pytest.mark.parametrize("camera_server", [False], indirect=True)
def test_a_camera_without_served_truth_gives_advice(scope: Scope, camera_server: ServedCamera) -> None:
    spec = f"axis://op@127.0.0.1:{camera_server.port}?width=320&height=180"
    result = scope("ask", "how many blocks are there?", "--camera", spec, "--perception", SERVED_TRUTH, "--json")
    assert "scope camera serve --truth" in result.out


def test_other_cameras_are_refused(scope: Scope) -> None:
    result = scope("ask", "how many blocks are there?", "--camera", SCENE, "--perception", SERVED_TRUTH)
    assert result.code == 2
    assert "virtual camera on this machine" in result.err


def test_evaluations_reject_served_truth(scope: Scope) -> None:
    result = scope("bench", "run", "--perception", SERVED_TRUTH, "--limit", "1")
    assert result.code == 2
    assert "virtual camera on this machine" in result.err
