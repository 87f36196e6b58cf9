"""The site: names, lapsing control, unused cameras, failures of the store, and killed servers."""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import anyio
import httpx2
import pytest

from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.camera_control import CameraControl
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import NotInControlError
from scope_ptz.serve.site.pairs import Pairs
from scope_ptz.serve.site.site import SiteOptions, site_cameras
from scope_ptz.serve.site.station import IdleReturn, Station
from scope_ptz.settings import ScopeSettings
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.prefetch import Prefetch, Prefetches
from scope_ptz.store.run_store import RunStore
from tests.serve.conftest import SPEC
from tests.serve.serving import CAMERA, serving

ANNA, BEN = Client("anna", "anna:1", "operator"), Client("ben", "ben:1", "operator")


@pytest.mark.anyio
async def test_control_lapses_but_not_during_a_run(analytic_scene: Scene) -> None:
    camera, busy = SimulatedCamera(analytic_scene), False
    control = CameraControl("yard", lambda: busy, lease_s=0.05)
    await control.require(ANNA, camera)
    with pytest.raises(NotInControlError, match="controlled by anna"):
        await control.require(BEN, camera)
    busy = True
    await anyio.sleep(0.1)
    with pytest.raises(NotInControlError):
        await control.require(BEN, camera)
    busy = False
    await control.require(BEN, camera)
    assert control.holder == BEN
    with pytest.raises(NotInControlError):
        await control.answer(ANNA, BEN.key, camera, grant=True)


@pytest.mark.anyio
async def test_control_shows_in_the_lock_of_the_camera(analytic_scene: Scene) -> None:
    camera = SimulatedCamera(analytic_scene)
    control = CameraControl("yard", lambda: False)
    await control.ask(ANNA, camera)
    assert camera.control_lock is not None and camera.control_lock.holder is not None
    assert camera.control_lock.holder.name == "anna"
    assert not await control.ask(BEN, camera)
    await control.answer(ANNA, BEN.key, camera, grant=True)
    assert camera.control_lock.holder.name == "ben"
    await control.release(BEN)
    assert camera.control_lock.holder is None


@pytest.mark.anyio
async def test_control_ends_soon_after_its_holder_has_disconnected(analytic_scene: Scene) -> None:
    camera = SimulatedCamera(analytic_scene)
    control = CameraControl("yard", lambda: False, absent_s=0.05)
    await control.require(ANNA, camera)
    await anyio.sleep(0.1)
    assert control.holder == ANNA, "a program needs no live connection"
    with control.live_connection(ANNA):
        with control.live_connection(ANNA):
            pass
        with control.live_connection(BEN):
            pass
        await anyio.sleep(0.1)
        assert control.holder == ANNA
    with control.live_connection(ANNA):
        await anyio.sleep(0.1)
        assert control.holder == ANNA, "it has reconnected"
    await anyio.sleep(0.1)
    assert control.holder is None
    await control.require(BEN, camera)
    assert control.holder == BEN


@pytest.mark.anyio
async def test_control_ends_with_the_run_of_a_client_that_left(analytic_scene: Scene) -> None:
    camera, busy = SimulatedCamera(analytic_scene), True
    control = CameraControl("yard", lambda: busy)
    await control.require(ANNA, camera)
    await control.release(ANNA)
    assert control.holder == ANNA  # for the run in progress
    busy = False
    await control.clear_if_released()
    assert control.holder is None
    assert camera.control_lock is not None and camera.control_lock.holder is None


@pytest.mark.anyio
async def test_a_client_that_comes_back_during_its_run_keeps_control(analytic_scene: Scene) -> None:
    camera, busy = SimulatedCamera(analytic_scene), True
    control = CameraControl("yard", lambda: busy)
    await control.require(ANNA, camera)
    await control.release(ANNA)
    assert await control.ask(ANNA, camera)
    busy = False
    await control.clear_if_released()
    assert control.holder == ANNA


def wait_for(client: httpx2.Client, path: str, field: str, value: object) -> None:
    deadline = time.monotonic() + 60
    while client.get(path).json()[field] != value:
        assert time.monotonic() < deadline, f"{field} did not become {value}"
        time.sleep(0.05)


def test_an_unused_camera_returns_to_its_preset(scenes: None, tmp_path: Path) -> None:
    options = SiteOptions(tmp_path / "runs", idle=IdleReturn(0.5))
    with serving(options, Access("127.0.0.1", limits=RateLimits(None)), {CAMERA: SPEC}) as served, served.client() as client:
        home = client.post(f"/cameras/{CAMERA}/home").json()["pose"]["pan_deg"]
        client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": home + 8.0})
        wait_for(client, f"/cameras/{CAMERA}/pose", "pan_deg", home)


def test_a_locked_store_loses_no_run(scenes: None, tmp_path: Path) -> None:
    root = tmp_path / "runs"
    with (
        serving(SiteOptions(root), Access("127.0.0.1", limits=RateLimits(None)), {CAMERA: SPEC}) as served,
        served.client() as client,
    ):
        client.get("/runs")
        other = sqlite3.connect(root / "store.sqlite", isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        run = client.post("/ask", json={"camera": CAMERA, "instruction": "go home"}).json()
        assert run["outcome"] == "answered", "a run needs no index"
        assert client.get(f"/runs/{run['id']}").json()["outcome"] == "answered"
        other.execute("ROLLBACK")
        other.close()
        served.call(served.site.library.wait_for_indexing, 30.0)
        assert client.get(f"/runs/{run['id']}/details").json()["run"]["outcome"] == "answered"


def test_a_damaged_scene_or_a_full_disk_gives_an_error_reply(scenes: None, tmp_path: Path) -> None:
    root = tmp_path / "runs"
    with (
        serving(SiteOptions(root), Access("127.0.0.1", limits=RateLimits(None)), {CAMERA: SPEC}) as served,
        served.client() as client,
    ):
        served.site.runner._library.root = tmp_path / "runs" / "store.sqlite"  # a folder cannot be created inside a file
        reply = client.post("/runs", json={"camera": CAMERA, "instruction": "go home"})
        assert (reply.status_code, reply.json()["error"]["code"]) == (507, "cannot_be_written")
        served.site.runner._library.root = root
        assert client.post("/ask", json={"camera": CAMERA, "instruction": "go home"}).json()["outcome"] == "answered"


def test_only_configured_cameras_and_scenes_are_served(scenes: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scope.yaml").write_text("version: 1\ncameras:\n  yard-gate:\n    camera: axis://operator@10.0.0.7\n")
    monkeypatch.setenv("SCOPE_CONFIG", str(tmp_path / "scope.yaml"))
    settings = ScopeSettings(scenes_dir=Path(os.environ["SCOPE_SCENES_DIR"]), config=tmp_path / "scope.yaml")
    found = site_cameras((), settings)
    assert next(iter(found)) == "yard-gate"
    assert found["analytic-yard"] == "sim:analytic-yard"
    assert site_cameras(("yard-gate",), settings) == {"yard-gate": "yard-gate"}
    for name in ("axis://operator@10.0.0.7", "sim:analytic-yard", "blender:yard.blend"):
        with pytest.raises(UnknownNameError):
            site_cameras((name,), settings)


def start_server(*arguments: str, runs: Path) -> tuple[subprocess.Popen[str], str]:
    """Start ``scope serve`` and return it with its address."""
    command = [sys.executable, "-m", "scope_ptz.cli", "serve", "--port", "0", "--json", "--runs-dir", str(runs), *arguments]
    program = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    assert program.stdout is not None
    return program, str(json.loads(program.stdout.readline())["url"])


@pytest.mark.full
def test_killing_the_server_loses_no_finished_step(scenes: None, tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    program, url = start_server("--camera", "analytic-yard", runs=runs)
    try:
        with httpx2.Client(base_url=f"{url}/api/v1", trust_env=False, timeout=60.0) as client:
            body = {"camera": "analytic-yard", "instruction": "count the balls, then track the ball for 300 seconds"}
            run = client.post("/runs", json=body).json()["id"]
            with client.stream("GET", f"/runs/{run}/events") as response:
                seen = next(line for line in response.iter_lines() if line.startswith("data: ") and '"event":"call"' in line)
    finally:
        os.kill(program.pid, signal.SIGKILL)
        program.communicate()
    with RunStore(runs) as store:
        store.index()
        stored = store.run(run)
    assert stored.run.outcome == "unfinished"
    assert [step.tool for step in stored.steps] == ["count_objects"]
    assert seen.removeprefix("data: ") in (runs / run / "trace.jsonl").read_text().splitlines()
    again, url = start_server("--camera", "analytic-yard", runs=runs)
    try:
        with httpx2.Client(base_url=f"{url}/api/v1", trust_env=False, timeout=60.0) as client:
            assert client.get(f"/runs/{run}").json()["outcome"] == "unfinished"
            assert f"data: {seen.removeprefix('data: ')}" in client.get(f"/runs/{run}/events").text
    finally:
        again.send_signal(signal.SIGINT)
        _, errors = again.communicate(timeout=60)
    assert again.returncode == 130
    assert re.fullmatch(r"(scope: cancelled\.\n)?", errors), errors


@pytest.mark.full
def test_an_interrupt_records_the_end_of_a_run(scenes: None, tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    program, url = start_server("--camera", "analytic-yard", runs=runs)
    try:
        with httpx2.Client(base_url=f"{url}/api/v1", trust_env=False, timeout=60.0) as client:
            body = {"camera": "analytic-yard", "instruction": "track the ball for 300 seconds"}
            run = client.post("/runs", json=body).json()["id"]
    finally:
        program.send_signal(signal.SIGINT)
        _, errors = program.communicate(timeout=60)
    assert (program.returncode, errors) == (130, "scope: cancelled.\n")
    with RunStore(runs) as store:
        assert store.run(run).run.outcome == "cancelled", "it is in the index already"


@pytest.mark.full
def test_a_server_on_the_network_does_not_start_without_tokens(scenes: None, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "scope_ptz.cli", "serve", "--host", "0.0.0.0", "--port", "0"]  # noqa: S104 - the server must refuse to start
    command += ["--tokens", str(tmp_path / "tokens.json"), "--runs-dir", str(tmp_path / "runs")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 2
    assert "open to the network at 0.0.0.0 without tokens" in done.stderr
    assert not (tmp_path / "runs").exists()
    with pytest.raises(ConfigError):
        Access("192.0.2.1")


@pytest.mark.anyio
async def test_cancelling_the_opening_of_a_camera_stops_its_prefetch(scenes: None, monkeypatch: pytest.MonkeyPatch) -> None:
    started, proceed, ended, prefetches = threading.Event(), threading.Event(), threading.Event(), []
    prefetch = SimulatedCamera.prefetch

    def slow(camera: SimulatedCamera) -> Prefetch:
        started.set()
        assert proceed.wait(30)
        prefetches.append(prefetch(camera))
        return prefetches[-1]

    def start(self: Prefetches, make: Callable[[], Prefetch]) -> None:
        begin(self, make)
        ended.set()

    begin = Prefetches.start
    monkeypatch.setattr(Prefetches, "start", start)
    monkeypatch.setattr(SimulatedCamera, "prefetch", slow)
    station = Station("yard", SPEC, Pairs(), actor="test")
    opening = asyncio.create_task(station.get_open_camera())
    assert await anyio.to_thread.run_sync(started.wait, 30)
    opening.cancel()
    with pytest.raises(asyncio.CancelledError):
        await opening
    await station.close()
    proceed.set()
    await anyio.to_thread.run_sync(ended.wait, 30)
    assert prefetches[0].wait(30)
    assert prefetches[0].cancelled
