"""Sessions with a camera on a server: the camera contract, runs, tools and errors."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import httpx2
import pytest

import scope_ptz
from scope_ptz.api.remote.camera import RemoteCamera
from scope_ptz.api.remote.connection import Connection
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.camera.guard.guarded_camera import KeepOutError
from scope_ptz.errors import CameraError, ConfigError, InputError, PerceptionError, PlannerError, ToolCallError, UnknownNameError
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.site import SiteOptions
from tests.serve.conftest import SPEC
from tests.serve.serving import CAMERA, Served, serving
from tests.support.loopback import nobody_listens

LONG = "track the ball for 300 seconds"


@pytest.fixture
def address(client: httpx2.Client, served: Served) -> str:
    """The address of a free camera."""
    client.delete(f"/cameras/{CAMERA}/control")
    return f"{served.root}/{CAMERA}"


@pytest.mark.full
def test_a_session_behaves_like_a_local_one(address: str) -> None:
    with scope_ptz.open(address) as remote, scope_ptz.open("sim:analytic-yard?width=320&height=180") as local:
        instruction = "pan right 20 degrees and count the balls"
        ours, theirs = local.ask(instruction), remote.ask(instruction)
        assert (theirs.outcome, theirs.answer, str(theirs)) == (ours.outcome, ours.answer, str(ours))
        assert [(call.name, dict(call.arguments), call.result) for call in theirs.calls] == [
            (call.name, dict(call.arguments), call.result) for call in ours.calls
        ]
        assert theirs.pose == ours.pose == remote.pose()
        assert theirs.pictures == ours.pictures
        assert [theirs.picture(name).size for name in theirs.pictures] == [ours.picture(name).size for name in ours.pictures]
        assert theirs.filmstrip.size == ours.filmstrip.size
        assert theirs.folder is None
        there, here = remote.frame(), local.frame()
        assert (there.pose, there.hfov_deg, there.projection) == (here.pose, here.hfov_deg, here.projection)
        # The roller moves on the server, where time passes, but not in the local scene.
        assert (there.image == here.image).all(axis=2).mean() > 0.9
        assert [event.kind for event in remote.stream("zoom in 2x")] == [event.kind for event in local.stream("zoom in 2x")]
        assert len(remote.runs) == 2
        assert remote.scene is None
        assert (remote.planner.name, remote.perception.name) == ("grammar", "ground-truth")


def test_the_nine_tools_are_methods(address: str) -> None:
    with scope_ptz.open(address) as scope:
        assert scope.adjust_ptz(pan_deg=-20.0, zoom_percent=50).pose.zoom == pytest.approx(scope.pose().zoom)
        assert scope.move_to(pan_deg=0.0, zoom=1.0).zoom == 1.0
        presets = scope.get_presets().presets
        assert scope.go_to_preset(presets[0]).preset == presets[0]
        assert scope.go_home().pose.zoom > 0
        assert scope.count_objects("balls").count > 0
        assert scope.query_answer("is there a ball?").known
        assert scope.zoom_to_object("ball").found
        taken = [scope.take_image().file for _ in range(2)]
        assert len(set(taken)) == 2
        assert [scope.picture(file).size for file in taken] == [(320, 180)] * 2
        with pytest.raises(ToolCallError):
            scope.adjust_ptz(zoom_factor=2.0, zoom_limit="in")
        with pytest.raises(UnknownNameError):
            scope.go_to_preset("nowhere")
        with pytest.raises(InputError):
            scope.ask("  ")


def test_models_call_the_tools_of_a_camera_on_a_server(address: str) -> None:
    with scope_ptz.open(address) as remote, scope_ptz.open("sim:analytic-yard?width=320&height=180") as local:
        for arguments in ('{"description": "balls"}', '{"description": ""}', "{", '{"self": 1}'):
            theirs, ours = remote.dispatch("count_objects", arguments), local.dispatch("count_objects", arguments)
            assert (theirs.ok, theirs.error) == (ours.ok, ours.error)
            assert json.loads(theirs.text).keys() == json.loads(ours.text).keys()
            assert type(theirs.result) is type(ours.result)
        (picture,) = remote.dispatch("take_image").pictures
        assert picture.data_url.startswith("data:image/jpeg;base64,")
        missing = remote.dispatch("go_to_preset", {"name": "nowhere"})
        assert "There is no preset 'nowhere'" in json.loads(missing.text)["error"]
        assert remote.tool_schemas("responses") == local.tool_schemas("responses")


@pytest.mark.full
def test_a_conversation_continues_until_forget_is_called(address: str) -> None:
    with scope_ptz.open(address) as scope:
        scope.ask("zoom in 2x")
        assert len(scope.ask("go home")._trace.started.conversation) == 1
        scope.forget()
        assert scope.ask("go home")._trace.started.conversation == ()


def test_cancelling_locally_ends_the_run_on_the_server(address: str, client: httpx2.Client) -> None:
    with scope_ptz.open(address) as scope:
        timer = threading.Timer(0.3, scope.cancel)
        timer.start()
        run = scope.ask(LONG)
        assert run.outcome == "cancelled"
        for event in scope.stream(LONG):
            if event.kind == "decided":
                break
        assert scope.runs[-1].outcome == "cancelled"
    deadline = time.monotonic() + 20
    while client.get(f"/cameras/{CAMERA}").json()["run"] is not None:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert client.get(f"/cameras/{CAMERA}/control").json()["holder"] is None, "a closed session gives control up"


def test_only_one_of_two_sessions_controls_the_camera(address: str) -> None:
    with scope_ptz.open(address) as first, scope_ptz.open(address) as second:
        first.move(pan_deg=5.0)
        with pytest.raises(CameraError, match="controlled by another window or program"):
            second.move(pan_deg=-5.0)
        assert second.frame().width == 320
        with pytest.raises(CameraError, match="controlled by another window or program"):
            second.ask("go home")


def test_options_of_the_server_are_refused(address: str) -> None:
    for options in ({"planner": "grammar"}, {"seed": 3}, {"runs_dir": "runs"}, {"perception_url": "http://x/v1"}, {"max_steps": 3}):
        with pytest.raises(InputError, match="The camera's server determines"):
            scope_ptz.open(address, **options)
    with pytest.raises(UnknownNameError, match="has no pair"):
        scope_ptz.open(address, pair="qwen3-4b+moondream3")


def test_errors_have_clear_messages(
    address: str, served: Served, guarded: Served, tokens: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(UnknownNameError, match="There is no camera 'nothing'"):
        scope_ptz.open(f"{served.root}/nothing")
    with nobody_listens() as url, pytest.raises(CameraError, match="is not responding"):
        scope_ptz.open(url.replace("/v1", "/yard"))
    for wrong in (served.root, f"{served.root}/a/b", "http:///yard", f"{served.root}/yard?x=1"):
        with pytest.raises(ConfigError, match="http://HOST:PORT/CAMERA"):
            scope_ptz.open(wrong)
    with pytest.raises(ConfigError, match="SCOPE_TOKEN") as caught:
        scope_ptz.open(address.replace("http://", "http://anna:secret@"))
    assert "secret" not in str(caught.value)
    there = f"{guarded.root}/{CAMERA}"
    with pytest.raises(ConfigError, match="requires a token"):
        scope_ptz.open(there)
    monkeypatch.setenv("SCOPE_TOKEN", tokens["vera"])
    with scope_ptz.open(there) as scope:
        assert scope.frame().height == 180
        with pytest.raises(ConfigError, match="operator role"):
            scope.ask("go home")
    monkeypatch.setenv("SCOPE_TOKEN", tokens["anna"])
    with scope_ptz.open(there) as scope:
        assert scope.ask("go home").ok


@pytest.mark.anyio
async def test_planner_and_perception_stay_on_the_server(address: str) -> None:
    async with scope_ptz.open_async(address) as scope:
        with pytest.raises(PlannerError, match="runs on the server"):
            await scope.planner.step(None)  # type: ignore[arg-type]
        with pytest.raises(PerceptionError):
            await scope.perception.caption(await scope.frame())
        run = await scope.ask("go home")
        assert run.ok


@pytest.mark.full
@pytest.mark.anyio
class TestRemoteCamera(CameraConformance):
    """The conformance suite of cameras, through the API."""

    @pytest.fixture(autouse=True)
    def _address(self, address: str) -> None:
        self.address = address

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[scope_ptz.Camera]:
        async with Connection(self.address) as connection:
            camera = await RemoteCamera.open(connection)
            try:
                yield camera
            finally:
                await connection.request("DELETE", "~/control")


def test_a_keep_out_region_refuses_a_call_by_name(scenes: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scope.yaml").write_text(
        f"""
cameras:
  quiet-yard:
    camera: "{SPEC}"
    rules: {{keep_out: [{{name: windows, pan_deg: [-180, 180], tilt_deg: [-90, 90]}}]}}
"""
    )
    monkeypatch.setenv("SCOPE_CONFIG", str(tmp_path / "scope.yaml"))
    access = Access("127.0.0.1", limits=RateLimits(None))
    with serving(SiteOptions(tmp_path / "runs"), access, {"quiet-yard": "quiet-yard"}) as server:
        with scope_ptz.open(f"{server.root}/quiet-yard") as scope:
            output = scope.dispatch("adjust_ptz", {"pan_deg": 5.0})
            assert not output.ok
            assert "keep-out region 'windows'" in json.loads(output.text)["error"]
            with pytest.raises(KeepOutError, match="windows"):
                scope.adjust_ptz(pan_deg=5.0)
            with pytest.raises(KeepOutError, match="windows"):
                scope.move_to(pan_deg=5.0)
        with server.client() as client:
            reply = client.post("/cameras/quiet-yard/tools/adjust_ptz", json={"pan_deg": 5.0}).json()
            assert (reply["fault"], reply["code"], reply["result"]) == ("camera", "kept_out", None)
            done = client.post("/cameras/quiet-yard/tools/get_presets", json={}).json()
            assert (done["error"], done["code"]) == (None, None)
