"""The virtual camera over HTTP: sign-in, error forms, pictures, streams, faults, ground truth, and a clean end."""

from __future__ import annotations

import asyncio
import gc
import json
import logging
import socket
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import anyio
import cv2
import httpx2
import numpy as np
import pytest
from numpy.typing import NDArray

from scope_ptz.errors import ConfigError, PackError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice
from scope_ptz.virtual_camera.faults import Faults
from scope_ptz.virtual_camera.http import server as server_module
from scope_ptz.virtual_camera.http.jpeg import PictureFormat
from scope_ptz.virtual_camera.http.server import ServedCamera, serve

pytestmark = pytest.mark.anyio

PTZ, IMAGE, VIDEO = "/axis-cgi/com/ptz.cgi", "/axis-cgi/jpg/image.cgi", "/axis-cgi/mjpg/video.cgi"


def client(camera: ServedCamera, user: str = "root", password: str = "pass word", **options: Any) -> httpx2.AsyncClient:  # noqa: S107
    auth = httpx2.DigestAuth(user, password) if user else None
    return httpx2.AsyncClient(base_url=camera.url, auth=auth, trust_env=False, timeout=20, **options)


@asynccontextmanager
async def camera_and_client(device: VirtualDevice, **options: Any) -> AsyncIterator[tuple[ServedCamera, httpx2.AsyncClient]]:
    async with serve([device], **options) as (camera,), client(camera) as session:
        yield camera, session


def decoded(jpeg: bytes) -> NDArray[np.uint8]:
    image = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return np.asarray(image, np.uint8)


class Parts:
    """Reads the parts of a multipart stream as a browser does: by boundary and Content-Length."""

    def __init__(self, response: httpx2.Response) -> None:
        self._boundary = response.headers["content-type"].partition("boundary=")[2].encode()
        self._chunks = response.aiter_bytes()
        self._buffer = b""

    async def take(self, count: int) -> list[tuple[dict[str, str], bytes]]:
        """Return the headers and the body of the next parts."""
        return [await self._next() for _ in range(count)]

    async def _next(self) -> tuple[dict[str, str], bytes]:
        head = await self._until(b"\r\n\r\n")
        first, *lines = head.split(b"\r\n")
        assert first == b"--" + self._boundary
        headers = {name.lower(): value.strip() for name, _, value in (line.decode().partition(":") for line in lines)}
        length = int(headers["content-length"])
        while len(self._buffer) < length + 2:
            self._buffer += await anext(self._chunks)
        body, end, self._buffer = self._buffer[:length], self._buffer[length : length + 2], self._buffer[length + 2 :]
        assert end == b"\r\n"
        return headers, body

    async def _until(self, mark: bytes) -> bytes:
        while mark not in self._buffer:
            self._buffer += await anext(self._chunks)
        found, _, self._buffer = self._buffer.partition(mark)
        return found


async def test_commands_answer_204_and_errors_200(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        done = await session.get(PTZ, params={"pan": "10"})
        assert (done.status_code, done.content) == (204, b"")
        wrong = await session.get(PTZ, params={"pan": "ten"})
        assert wrong.status_code == 200
        assert wrong.headers["content-type"].startswith("text/plain")
        assert wrong.text.startswith("Error:")
        listed = await session.get("/axis-cgi/param.cgi", params={"action": "list", "group": "root.Nothing"})
        assert (listed.status_code, listed.text.startswith("# Error:")) == (200, True)
        assert (await session.get("/axis-cgi/nothing.cgi")).status_code == 404
        assert (await session.put(PTZ)).status_code == 405


@pytest.mark.parametrize("content_type", ["text/plain", "application/x-www-form-urlencoded", "application/json", ""])
async def test_bodies_count_whatever_their_type(served_device: VirtualDevice, content_type: str) -> None:
    async with camera_and_client(served_device) as (_, session):
        headers = {"Content-Type": content_type} if content_type else {}
        reply = await session.post(PTZ, content=b"pan=25&tilt=-5", headers=headers)
        assert reply.status_code == 204
        assert served_device.destination == Pose(25, -5, 1)


async def test_a_body_that_is_too_large_is_refused(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        assert (await session.post(PTZ, content=b"pan=1&" * 20_000)).status_code == 413
        assert (await session.post(PTZ, content="&".join(f"a{k}=1" for k in range(1000)))).status_code == 400
        assert (await session.get(PTZ, params={"query": "position"})).status_code == 200


async def test_basic_is_refused_and_never_asked_for(served_device: VirtualDevice) -> None:
    async with serve([served_device]) as (camera,):
        async with httpx2.AsyncClient(base_url=camera.url, auth=("root", "pass word"), trust_env=False) as basic:
            reply = await basic.get(IMAGE)
        assert reply.status_code == 401
        challenges = reply.headers.get_list("www-authenticate")
        assert len(challenges) == 2
        assert all(challenge.startswith("Digest ") for challenge in challenges)


@pytest.mark.parametrize(
    ("user", "password", "allowed"),
    [
        ("visitor", "secret-3", {IMAGE}),
        ("guard", "secret-2", {IMAGE, PTZ}),
        ("root", "pass word", {IMAGE, PTZ, "/axis-cgi/com/ptzconfig.cgi", "/virtual/faults"}),
        ("root", "guess", set()),
        ("", "", set()),
    ],
)
async def test_roles(served_device: VirtualDevice, user: str, password: str, allowed: set[str]) -> None:
    async with serve([served_device]) as (camera,), client(camera, user, password) as session:
        for path in (IMAGE, PTZ, "/axis-cgi/com/ptzconfig.cgi", "/virtual/faults"):
            status = (await session.get(path)).status_code
            assert (status == 200) == (path in allowed), path
            assert status in ((200,) if path in allowed else (403,) if allowed else (401,))


async def test_snapshots(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        full = await session.get(IMAGE)
        assert full.headers["content-type"] == "image/jpeg"
        assert int(full.headers["content-length"]) == len(full.content)
        assert decoded(full.content).shape == (180, 320, 3)
        assert not any(name.startswith("x-scope") for name in full.headers)
        expected = served_device.expose().image[..., ::-1].astype(float)
        best = decoded((await session.get(IMAGE, params={"compression": "0"})).content)
        assert np.abs(best - expected).mean() < 2
        small = await session.get(IMAGE, params={"resolution": "160x90", "compression": "90"})
        assert decoded(small.content).shape == (90, 160, 3)
        assert len(small.content) < len(full.content)
        square = decoded((await session.get(IMAGE, params={"resolution": "90x90", "compression": "0"})).content)
        middle = cv2.resize(expected[:, 70:250].astype(np.uint8), (90, 90), interpolation=cv2.INTER_AREA)
        assert np.abs(square - middle.astype(float)).mean() < 3
        for wrong in ("4000x3000", "8x8", "big", "1x", "-1x5"):
            assert (await session.get(IMAGE, params={"resolution": wrong})).status_code == 400
        assert (await session.get(IMAGE, params={"compression": "101"})).status_code == 400


async def test_several_browsers_watch_and_one_vanishes(served_device: VirtualDevice) -> None:
    got: dict[str, int] = {}

    async def watch(camera: ServedCamera, name: str, resolution: str) -> None:
        async with client(camera) as session, session.stream("GET", VIDEO, params={"resolution": resolution}) as response:
            frames = await Parts(response).take(6)
            width, height = map(int, resolution.split("x"))
            assert all(decoded(jpeg).shape == (height, width, 3) for _, jpeg in frames)
            got[name] = len(frames)

    async with serve([served_device], rate_hz=50) as (camera,):
        vanishing = client(camera)
        stream = vanishing.stream("GET", VIDEO)
        response = await stream.__aenter__()
        assert len(await Parts(response).take(2)) == 2
        async with anyio.create_task_group() as group:
            for name, resolution in (("a", "320x180"), ("b", "320x180"), ("c", "160x90")):
                group.start_soon(watch, camera, name, resolution)
            await response.aclose()
            await vanishing.aclose()
        assert got == {"a": 6, "b": 6, "c": 6}
        await _until(lambda: camera.source.subscribers == 0)


async def test_clients_of_one_size_share_an_encoding(served_device: VirtualDevice) -> None:
    async with serve([served_device]) as (camera,):
        jpegs = camera.application.jpegs
        exposure = served_device.expose()
        encoded = await asyncio.gather(*(jpegs.jpeg(exposure, PictureFormat(160, 90)) for _ in range(5)))
        assert len({id(content) for content in encoded}) == 1
        assert jpegs.encodings == 1
        await jpegs.jpeg(exposure, PictureFormat(320, 180))
        await jpegs.jpeg(served_device.expose(), PictureFormat(160, 90))
        assert jpegs.encodings == 3


async def test_a_stream_ends_after_the_frames_that_were_asked_for(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device, rate_hz=100) as (_, session):
        reply = await session.get(VIDEO, params={"nbrofframes": "3", "fps": "30"})
        assert reply.content.count(b"--myboundary\r\n") == 3
        assert reply.content.endswith(b"--myboundary--\r\n")


async def test_a_lower_frame_rate_skips_frames(served_device: VirtualDevice) -> None:
    async with (
        camera_and_client(served_device, rate_hz=100, truth=True) as (_, session),
        session.stream("GET", VIDEO, params={"fps": "10"}) as response,
    ):
        frames = await Parts(response).take(4)
    times = [float(headers["x-scope-taken"]) for headers, _ in frames]
    assert times[-1] - times[0] > 0.29


async def test_a_live_picture_that_fails_is_started_again(
    served_device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(server_module, "RETRY_S", 0.01)
    monkeypatch.setattr(logging.getLogger("scope_ptz"), "propagate", True)  # commands that ran before turn it off
    expose, failures = served_device.expose, iter([PackError("The pack is damaged."), OSError("disk")])

    def failing(*size: int) -> Exposure:
        if error := next(failures, None):
            raise error
        return expose(*size)

    monkeypatch.setattr(served_device, "expose", failing)
    async with camera_and_client(served_device) as (_, session):
        reply = await session.get(VIDEO, params={"nbrofframes": "2"})
    assert reply.content.count(b"Content-Type: image/jpeg") == 2
    assert "The pack is damaged." in caplog.text
    assert "disk" in caplog.text


async def test_several_cameras_in_one_process(analytic_scene: Scene, served_device: VirtualDevice) -> None:
    roof = VirtualDevice(analytic_scene, viewpoint="roof", width=320, height=180)
    async with serve([served_device, roof]) as (first, second):
        assert first.port != second.port
        assert first.unit.serial != second.unit.serial
        async with client(first) as one, client(second, "") as other:
            assert not np.array_equal(decoded((await one.get(IMAGE)).content), decoded((await other.get(IMAGE)).content))
            await other.get(PTZ, params={"pan": "50"})
    assert served_device.destination == served_device.home
    assert roof.destination.pan_deg == 50


async def test_nothing_is_left_after_the_end(served_device: VirtualDevice) -> None:
    tasks, threads = len(asyncio.all_tasks()), threading.active_count()
    async with serve([served_device], truth=True) as (camera,):
        port = camera.port
        watching = client(camera)
        stream = watching.stream("GET", VIDEO)
        frames = Parts(await stream.__aenter__())
        await frames.take(1)
    with pytest.raises(httpx2.TransportError):
        await frames.take(100)
    await watching.aclose()
    assert len(asyncio.all_tasks()) == tasks
    assert threading.active_count() <= threads + 8  # anyio keeps idle worker threads
    assert not served_device.observers
    with pytest.raises(OSError, match=r"refused|111"):
        socket.create_connection(("127.0.0.1", port), timeout=1)
    async with serve([served_device], ports=[port]):
        pass
    gc.collect()


async def test_a_server_that_is_cancelled_closes_its_port(served_device: VirtualDevice) -> None:
    with anyio.move_on_after(0.2):
        async with serve([served_device]) as (camera,):
            port = camera.port
            await anyio.sleep_forever()
    with pytest.raises(OSError, match=r"refused|111"):
        socket.create_connection(("127.0.0.1", port), timeout=1)


async def test_a_stuck_client_does_not_hold_up_the_end(served_device: VirtualDevice) -> None:
    served_device.width, served_device.height = 1280, 720
    open_device = VirtualDevice(served_device.scene, width=1280, height=720)
    async with serve([open_device], rate_hz=100) as (camera,):
        with socket.create_connection((camera.host, camera.port)) as stuck:
            stuck.sendall(b"GET /axis-cgi/mjpg/video.cgi HTTP/1.1\r\nHost: camera\r\n\r\n")
            await _until(lambda: camera.source.subscribers == 1)
            await anyio.sleep(0.5)
            with anyio.fail_after(10):
                camera.application.close()
                await _until(lambda: camera.source.subscribers == 0)


async def test_ports_that_cannot_be_used(served_device: VirtualDevice) -> None:
    async with serve([served_device]) as (camera,):
        with pytest.raises(ConfigError, match=r"cannot be used.*Choose another port"):
            async with serve([served_device], ports=[camera.port]):
                pass
    with pytest.raises(ConfigError, match="one port for each camera"):
        async with serve([served_device], ports=[1, 2]):
            pass


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1", "camera.example"])  # noqa: S104 - refused
async def test_a_camera_without_accounts_stays_on_this_machine(analytic_scene: Scene, host: str) -> None:
    with pytest.raises(ConfigError, match="open to the network"):
        async with serve([VirtualDevice(analytic_scene)], host=host):
            pass


# Faults ----------------------------------------------------------------------------------------------------------------
async def test_faults_are_switched_on_demand(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        assert (await session.get("/virtual/faults")).json() == Faults().model_dump(mode="json")
        changed = await session.post("/virtual/faults", json={"stuck": ["tilt"], "move_status": "lying"})
        assert changed.json()["stuck"] == ["tilt"]
        assert served_device.faults == Faults(stuck=frozenset({"tilt"}), move_status="lying")
        wrong: object
        for wrong in ({"weather": 1}, {"drop": 2}, {"picture": "pink"}, [], "x"):
            reply = await session.post("/virtual/faults", json=wrong)
            assert reply.status_code == 400
            assert reply.json()["error"]
        assert (await session.post("/virtual/faults", content=b"{")).status_code == 400
        assert served_device.faults.stuck == {"tilt"}
        await session.post("/virtual/faults", json={"unauthorized": True, "down": True})
        assert (await session.delete("/virtual/faults")).json() == Faults().model_dump(mode="json")


async def test_faults_cannot_be_switched_by_web_pages(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (camera, session):
        reply = await session.post("/virtual/faults", json={"down": True}, headers={"Origin": "http://evil.example"})
        assert reply.status_code == 403
        own = await session.post("/virtual/faults", json={}, headers={"Origin": camera.url})
        assert own.status_code == 200


@pytest.mark.parametrize("fault", [Faults(drop=1.0), Faults(down=True)])
async def test_connections_break_without_a_reply(served_device: VirtualDevice, fault: Faults) -> None:
    async with camera_and_client(served_device) as (_, session):
        served_device.faults = fault
        for path in (PTZ, IMAGE, VIDEO):
            with pytest.raises(httpx2.TransportError):
                await session.get(path)
        served_device.faults = Faults()
        assert (await session.get(PTZ, params={"query": "speed"})).text == "speed=100\n"


async def test_a_share_of_requests_is_dropped(served_device: VirtualDevice) -> None:
    served_device.faults = Faults(drop=0.5)
    outcomes = []
    async with serve([served_device]) as (camera,):
        for _ in range(20):
            async with client(camera, "") as session:
                try:
                    outcomes.append((await session.get(PTZ)).status_code)
                except httpx2.TransportError:
                    outcomes.append(0)
    assert {0, 401} == set(outcomes)


async def test_a_stream_breaks_when_the_camera_goes_down(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (camera, session):
        async with session.stream("GET", VIDEO) as response:
            frames = Parts(response)
            await frames.take(1)
            served_device.faults = Faults(down=True)
            with pytest.raises(httpx2.TransportError):
                await frames.take(1000)
        await _until(lambda: camera.source.subscribers == 0)


async def test_replies_are_late(served_device: VirtualDevice) -> None:
    served_device.faults = Faults(stall_s=30)
    async with serve([served_device]) as (camera,), client(camera, "") as session:
        with pytest.raises(httpx2.ReadTimeout):
            await session.get(PTZ, timeout=0.2)
        served_device.faults = Faults(stall_s=0.2)
        assert (await session.get(PTZ)).status_code == 401


async def test_every_account_is_refused(served_device: VirtualDevice) -> None:
    served_device.faults = Faults(unauthorized=True)
    async with camera_and_client(served_device) as (_, session):
        reply = await session.get(PTZ, params={"pan": "1"})
        assert reply.status_code == 401
        assert reply.headers["www-authenticate"].startswith("Digest")
    assert not served_device.moving()


async def test_replies_are_garbage(served_device: VirtualDevice) -> None:
    served_device.faults = Faults(garbage=True)
    async with camera_and_client(served_device) as (_, session):
        for path in (PTZ, IMAGE, "/axis-cgi/param.cgi?action=list"):
            assert b"garbage" in (await session.get(path)).content
        with pytest.raises(ValueError, match=r"Expecting|codec|Invalid"):
            json.loads((await session.post("/axis-cgi/apidiscovery.cgi", content=b"{}")).content)


async def test_pictures_are_truncated_or_of_another_size(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        whole = (await session.get(IMAGE)).content
        served_device.faults = Faults(picture="truncated")
        cut = (await session.get(IMAGE)).content
        assert len(cut) < 0.6 * len(whole)
        assert cut.startswith(b"\xff\xd8")
        assert not cut.endswith(b"\xff\xd9")
        served_device.faults = Faults(picture="size")
        assert decoded((await session.get(IMAGE)).content).shape == (90, 160, 3)


async def test_a_reboot(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        await session.get(PTZ, params={"pan": "77"})
        assert (await session.post("/virtual/reboot", content="down_s=0.3")).json() == {"down_s": 0.3}
        await _until(lambda: served_device.faults.down)
        with pytest.raises(httpx2.TransportError):
            await session.get(PTZ, params={"query": "position"})
        await _until(lambda: not served_device.faults.down)
        assert served_device.pose() == served_device.home
        assert (await session.get(PTZ, params={"query": "position"})).status_code == 200


# Ground truth ----------------------------------------------------------------------------------------------------------
async def test_the_truth_of_a_picture_stands_beside_it_and_can_be_asked_for(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device, truth=True) as (_, session):
        first = await session.get(IMAGE)
        await session.get(PTZ, params={"pan": "33", "tilt": "-7", "zoom": "5000"})
        await _until(lambda: not served_device.moving())
        second = await session.get(IMAGE)
        assert second.headers["x-scope-pose"] == "pan=33.0;tilt=-7.0;zoom=3.0"
        for reply, pose in ((first, served_device.home), (second, Pose(33, -7, 3))):
            expected = {
                "scene": served_device.scene.name,
                "viewpoint": served_device.viewpoint,
                "pose": {"pan_deg": pose.pan_deg, "tilt_deg": pose.tilt_deg, "zoom": pose.zoom},
                "time_s": float(reply.headers["x-scope-time"]),
            }
            for name, header in (("time", "x-scope-time"), ("taken", "x-scope-taken")):
                found = await session.get("/virtual/truth", params={name: reply.headers[header]})
                assert found.json() == expected
            length = int.from_bytes(reply.content[4:6], "big")
            assert reply.content[2:4] == b"\xff\xfe"
            comment = json.loads(reply.content[6 : 4 + length])
            assert comment == {**expected, "taken_s": float(reply.headers["x-scope-taken"])}
            assert decoded(reply.content).shape == (180, 320, 3)
        assert (await session.get("/virtual/truth")).json()["pose"]["pan_deg"] == 33
        assert (await session.get("/virtual/truth", params={"time": "-5"})).status_code == 404
        assert (await session.get("/virtual/truth", params={"time": "soon"})).status_code == 400


async def test_every_part_of_a_stream_carries_its_truth(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device, truth=True) as (_, session), session.stream("GET", VIDEO) as response:
        for headers, jpeg in await Parts(response).take(3):
            found = (await session.get("/virtual/truth", params={"taken": headers["x-scope-taken"]})).json()
            assert found["time_s"] == float(headers["x-scope-time"])
            assert b'"scene"' in jpeg[:400]


async def test_there_is_no_truth_unless_it_is_offered(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        assert (await session.get("/virtual/truth")).status_code == 404
        assert b"viewpoint" not in (await session.get(IMAGE)).content


async def test_the_truth_is_for_this_machine_only(served_device: VirtualDevice) -> None:
    """A client with another address, which loopback cannot have, asks the application itself."""
    async with serve([served_device], truth=True) as (camera,):
        app = camera.application.app
        transport = httpx2.ASGITransport(app=app, client=("192.0.2.7", 40_000))
        auth = httpx2.DigestAuth("root", "pass word")
        async with httpx2.AsyncClient(base_url=camera.url, transport=transport, auth=auth) as far:
            picture = await far.get(IMAGE)
            assert picture.status_code == 200
            assert not any(name.startswith("x-scope") for name in picture.headers)
            assert b"viewpoint" not in picture.content
            for path in ("/virtual/truth", "/virtual/faults"):
                assert (await far.get(path)).status_code == 403


async def _until(condition: Callable[[], bool]) -> None:
    with anyio.fail_after(20):
        while not condition():  # noqa: ASYNC110 - what is waited for has no event
            await anyio.sleep(0.01)
