"""The camera in the open scene of a Blender: the server's side, and the add-on's connection, with a fake scene."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import anyio
import pytest

from scope_ptz.camera.base import Camera
from scope_ptz.camera.blender_addon.scene import SceneDescription, window_scene
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.geometry import Pose
from scope_ptz.serve.security.access import MAX_BODY_BYTES, Access, max_body_bytes
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.security.tokens import TokenFile
from scope_ptz.serve.site.site import SiteOptions, site_cameras
from scope_ptz.settings import load_settings
from tests.addon.fake_blender import CAMERA, FakeBlender, place, window_camera
from tests.serve.serving import Served, serving

PATH = f"/cameras/{CAMERA}/add-on"


def description(*cameras: dict[str, object], **others: object) -> dict[str, object]:
    head = {"name": "a", "title": "a", "blender_version": "5.0", "active": "gate", "width": 160, "height": 90}
    return {**head, "cameras": list(cameras or (place("gate"),)), **others}


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    options = SiteOptions(tmp_path_factory.mktemp("window"))
    cameras = {CAMERA: f"{CAMERA}:", "works": "sim:highway-works"}
    with serving(options, Access("127.0.0.1", limits=RateLimits(None)), cameras) as server:
        yield server


@pytest.fixture
def blender(served: Served) -> Iterator[FakeBlender]:
    served.call(served.site.station(CAMERA).control.clear)
    fake = FakeBlender(served.root).start()
    wait_for(lambda: fake.link.connected)
    yield fake
    fake.stop()
    wait_for(lambda: served.site.station(CAMERA).add_on.current is None)


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = threading.Event()
    for _ in range(6000):
        if condition():
            return
        deadline.wait(0.01)
    raise AssertionError("the condition did not become true within 60 s")


@pytest.mark.full
@pytest.mark.anyio
class TestWindowCamera(CameraConformance):
    """The conformance suite of cameras, over HTTP and the threads of the add-on."""

    @pytest.fixture(autouse=True)
    def _folder(self, tmp_path: Path) -> None:
        self.folder = tmp_path

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        blenders: list[FakeBlender] = []
        try:
            async with window_camera(lambda url: blenders.append(FakeBlender(url).start()), self.folder) as (camera, _):
                yield camera
        finally:
            for fake in blenders:
                fake.stop()


def test_a_question_is_answered_with_the_scenes_own_views(served: Served, blender: FakeBlender) -> None:
    with served.client() as client:
        run = client.post("/ask", json={"camera": CAMERA, "instruction": "go to the roof preset, then zoom in 2x"}).json()
        state = client.get(f"/cameras/{CAMERA}").json()
    assert run["outcome"] == "answered"
    assert state["pose"] == pytest.approx({"pan_deg": 0.0, "tilt_deg": -5.0, "zoom": state["pose"]["zoom"]})
    looks = [request.arguments for request in blender.requests if request.operation == "look"]
    assert [look["viewpoint"] for look in looks] == ["roof", "roof"]
    assert looks[0]["bearing_deg"] == pytest.approx(70.0)
    assert looks[0]["hfov_deg"] == pytest.approx(30.0, abs=0.01)
    assert looks[1]["hfov_deg"] < 16.0


def test_an_unchanged_scene_is_not_rendered_again(served: Served, blender: FakeBlender) -> None:
    with served.client() as client:
        first = client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content
        again = client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content
        assert first == again
        frames = [request.arguments["version"] for request in blender.requests if request.operation == "frame"]
        assert frames == ["", "1"], "the second request names the version that the server has"
        blender.version = 2
        client.get(f"/cameras/{CAMERA}/frame")
        client.get(f"/cameras/{CAMERA}/frame")
    assert [r.arguments["version"] for r in blender.requests if r.operation == "frame"] == ["", "1", "1", "2"]


def test_failures_give_messages(served: Served, blender: FakeBlender) -> None:
    blender.broken = "There is no 3D viewport.\x1b[31m" + 600 * "x"
    with served.client() as client:
        reply = client.get(f"/cameras/{CAMERA}/frame")
        assert reply.status_code == 503
        message = reply.json()["error"]["message"]
        assert message.startswith("There is no 3D viewport.")
        assert message.isprintable()
        assert len(message) <= 500
        blender.broken = ""
        assert client.get(f"/cameras/{CAMERA}/frame").status_code == 200
        count = client.post(f"/cameras/{CAMERA}/tools/count_objects", json={"description": "cones", "view": "current"}).json()
    assert count["fault"] == "perception"
    assert "vision model" in count["error"]


def test_a_camera_without_blender_says_what_to_do(served: Served) -> None:
    with served.client() as client:
        reply = client.get(f"/cameras/{CAMERA}")
        assert (reply.status_code, reply.json()["error"]["code"]) == (503, "camera_failed")
        assert "press Connect" in reply.json()["error"]["message"]
        card = client.get(f"/cameras/{CAMERA}/card").json()
        assert card["kind"] == "blender"
        assert "scene_time" not in card["abilities"]


def test_the_camera_works_again_after_blender_reconnects(served: Served) -> None:
    with served.client() as client:
        for width in (160, 320):
            fake = FakeBlender(served.root)
            fake.link._description["width"] = width
            fake.start()
            wait_for(lambda fake=fake: fake.link.connected)  # type: ignore[misc]
            assert client.get(f"/cameras/{CAMERA}").json()["frame_width"] == width
            fake.stop()
            wait_for(lambda: client.get(f"/cameras/{CAMERA}").status_code == 503)
            assert not fake.link.problem


def test_cameras_that_the_user_adds_become_presets(served: Served, blender: FakeBlender) -> None:
    with served.client() as client:
        client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 33.0})
        blender.cameras.append(place("tower", bearing_deg=-20.0))
        blender.link.update(blender.describe())
        wait_for(lambda: len(client.get(f"/cameras/{CAMERA}/presets").json()) == 3)
        assert client.get(f"/cameras/{CAMERA}").json()["pose"]["pan_deg"] == pytest.approx(33.0)
        assert client.post(f"/cameras/{CAMERA}/presets/tower/go").status_code == 200
        assert client.delete(f"/cameras/{CAMERA}/presets/tower").json()["error"]["code"] == "refused_by_camera"


def test_a_second_blender_is_refused(served: Served, blender: FakeBlender) -> None:
    other = FakeBlender(served.root, client="blender-other")
    other.start()
    wait_for(lambda: other.link.ended)
    assert "Another Blender instance is connected" in other.link.problem
    other.stop()
    assert blender.link.connected


def test_other_cameras_have_no_add_on(served: Served) -> None:
    with served.client() as client:
        reply = client.post("/cameras/works/add-on", json=description())
    assert (reply.status_code, reply.json()["error"]["code"]) == (409, "refused_by_camera")


def test_a_connection_belongs_to_its_client(served: Served, blender: FakeBlender) -> None:
    current = served.site.station(CAMERA).add_on.current
    assert current is not None
    with served.client(tab="somebody-else") as client:
        for method, path, body in (
            ("PUT", "/scene", description()),
            ("POST", "/replies/1", {"result": {}}),
            ("DELETE", "", None),
            ("GET", "/requests", None),
        ):
            assert client.request(method, f"{PATH}/{current.id}{path}", json=body).status_code == 404
        assert client.put(f"{PATH}/{current.id}/pictures/1", content=b"x").status_code == 404


@pytest.mark.parametrize(
    ("cameras", "status"),
    [
        ([], 422),
        ([place("gate"), place("gate")], 409),
        ([place("roof")], 409),
        ([place("gate"), place("view", saved=True, viewpoint="nowhere")], 409),
        ([{**place("gate"), "tilt_deg": 95.0}], 422),
        ([{**place("gate"), "hfov_deg": 0.0}], 422),
        ([{**place("gate"), "position_m": [0.0, 0.0]}], 422),
        ([{**place("gate"), "position_m": [0.0, 0.0, "1e999"]}], 422),
        ([{**place("gate"), "unknown": 1}], 422),
    ],
)
def test_wrong_descriptions_are_refused(served: Served, cameras: list[dict[str, object]], status: int) -> None:
    with served.client() as client:
        reply = client.post(PATH, json={**description(), "cameras": cameras})
    assert reply.status_code == status


def test_viewers_cannot_connect_and_pictures_may_be_large(tmp_path: Path) -> None:
    file = TokenFile(tmp_path / "tokens.json")
    viewer, operator = file.add("vera", "viewer"), file.add("anna", "operator")
    access = Access("127.0.0.1", file, limits=RateLimits(None))
    with serving(SiteOptions(tmp_path / "runs"), access, {CAMERA: f"{CAMERA}:"}) as server:
        for token, problem in ((viewer, "operator role"), ("", "needs a token")):
            refused = FakeBlender(server.root, token)
            refused.start()
            wait_for(lambda refused=refused: refused.link.ended)  # type: ignore[misc]
            assert problem in refused.link.problem
            refused.stop()
        fake = FakeBlender(server.root, operator).start()
        wait_for(lambda: fake.link.connected)
        current = server.site.station(CAMERA).add_on.current
        assert current is not None
        with server.client(operator, tab="blender-test") as client:
            big = b"x" * (MAX_BODY_BYTES + 1)
            assert client.put(f"{PATH}/{current.id}/pictures/999", content=big).status_code == 404, "too late, but not too large"
            assert client.post(f"{PATH}/{current.id}/replies/999", content=big).status_code == 413
        fake.stop()
    assert max_body_bytes(f"/api/v1{PATH}/abc/pictures/1/../../x") == MAX_BODY_BYTES


@pytest.mark.anyio
async def test_a_wrong_picture_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blenders: list[FakeBlender] = []
    async with window_camera(lambda url: blenders.append(FakeBlender(url).start()), tmp_path) as (camera, site):
        for wrong in (b"", b"not a picture", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x00\x00\xa0\x00\x00\x00\x5a broken"):
            connection = site.station(CAMERA).add_on.connection
            monkeypatch.setattr("scope_addon.protocol.link.ServerClient.request_bytes", _sending(wrong))
            with pytest.raises(CameraError, match="picture"):
                await camera.frame()
            monkeypatch.undo()
            assert not connection.lost
        assert (await camera.frame()).width == 160
    blenders[0].stop()
    with pytest.raises(CameraError, match="not connected"):
        await camera.pose()


def _sending(wrong: bytes) -> Callable[..., bytes]:
    from scope_addon.protocol.server_client import ServerClient

    send = ServerClient.request_bytes

    def request_bytes(client: ServerClient, method: str, path: str, body: bytes | None = None, media_type: str = "") -> bytes:
        return send(client, method, path, wrong if media_type == "image/png" else body, media_type)

    return request_bytes


@pytest.mark.anyio
async def test_a_blender_that_disconnects_fails_waiting_requests(tmp_path: Path) -> None:
    blenders: list[FakeBlender] = []
    async with window_camera(lambda url: blenders.append(_silent(url)), tmp_path) as (camera, _):
        async with anyio.create_task_group() as group:
            failures: list[str] = []

            async def take() -> None:
                try:
                    await camera.frame()
                except CameraError as error:
                    failures.append(str(error))

            group.start_soon(take)
            while blenders[0].link.requests.empty():  # noqa: ASYNC110 - a thread fills the queue
                await anyio.sleep(0.005)
            blenders[0].link.stop()
        assert failures == ["Blender disconnected before it answered."]


def _silent(url: str) -> FakeBlender:
    fake = FakeBlender(url)
    fake.link.start()  # connected, but nobody carries out the requests
    return fake


def test_poses_follow_the_conventions_of_blend_files() -> None:
    cameras = (place("gate", 10.0, 90.0), place("roof", -100.0, 40.0), place("My view", 55.0, 30.0, saved=True, viewpoint="gate"))
    scene = window_scene(SceneDescription.model_validate(description(*cameras)))
    assert [(p.info.name, p.viewpoint, p.saved) for p in scene.presets.values()] == [
        ("gate", "gate", False),
        ("roof", "roof", False),
        ("My view", "gate", True),
    ]
    assert scene.home.pose == Pose(0.0, -5.0, 1.0)
    assert scene.presets["My view"].pose.pan_deg == pytest.approx(45.0)
    assert scene.optics.hfov_deg(scene.presets["My view"].pose.zoom) == pytest.approx(30.0, abs=0.01)
    assert scene.limits.pan_endless


@pytest.mark.anyio
async def test_the_camera_exists_only_on_a_server() -> None:
    with pytest.raises(InputError, match="scope serve --camera blender-window"):
        await open_camera(CAMERA)
    with pytest.raises(InputError, match="does not accept an address"):
        await open_camera(f"{CAMERA}:somewhere")
    assert site_cameras([CAMERA], load_settings()) == {CAMERA: f"{CAMERA}:"}
    assert CAMERA not in site_cameras([], load_settings())
    with pytest.raises(UnknownNameError):
        site_cameras(["blender-windows"], load_settings())


@pytest.mark.anyio
async def test_the_rules_of_scope_yaml_apply(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from scope_ptz.camera.blender_addon.connection import AddOnSlot

    (tmp_path / "scope.yaml").write_text(
        "cameras:\n  stage:\n    camera: 'blender-window:'\n    rules:\n      soft_limits: {min_pan_deg: -30, max_pan_deg: 30}\n"
    )
    monkeypatch.chdir(tmp_path)
    slot = AddOnSlot()
    slot.connect(SceneDescription.model_validate(description()), "blender-test")
    async with await open_camera("stage", add_on=slot) as opened:
        assert opened.camera.info.limits.max_pan_deg == 30.0
