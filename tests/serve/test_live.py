"""Live video: skipped frames, acknowledgements, state, and failures of clients and cameras."""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import AsyncGenerator, Iterator
from contextlib import contextmanager
from typing import Any

import anyio
import cv2
import httpx2
import numpy as np
import pytest
from anyio import to_thread
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from scope_ptz.camera.base import Camera, Frame
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.serve.site.live_picture import LivePicture
from scope_ptz.simulator.pack import Scene
from tests.serve.serving import CAMERA, Served


def watch(served: Served) -> ClientConnection:
    return connect(f"ws://127.0.0.1:{served.port}/api/v1/cameras/{CAMERA}/live?width=320", proxy=None, max_size=2**24)


def make_frame(socket: ClientConnection) -> tuple[dict[str, Any], bytes]:
    """Return the metadata and the JPEG of the next frame, without acknowledging it."""
    while True:
        message = socket.recv(timeout=30)
        if isinstance(message, bytes):
            length = int.from_bytes(message[:4], "big")
            return json.loads(message[4 : 4 + length]), message[4 + length :]


def state_of(socket: ClientConnection) -> dict[str, Any]:
    while True:
        message = socket.recv(timeout=30)
        if isinstance(message, str):
            state: dict[str, Any] = json.loads(message)["state"]
            return state
        socket.send("drawn")


def test_frames_come_one_after_the_other_with_their_pose(client: httpx2.Client, served: Served) -> None:
    with watch(served) as socket:
        numbers = []
        for _ in range(10):
            facts, jpeg = make_frame(socket)
            numbers.append(facts["number"])
            picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
            assert picture is not None and picture.shape[1::-1] == (320, 180)
            assert set(facts["pose"]) == {"pan_deg", "tilt_deg", "zoom"}
            socket.send("drawn")
    assert numbers == sorted(set(numbers))


def test_a_slow_client_gets_the_newest_frame_and_no_queue(client: httpx2.Client, served: Served) -> None:
    with watch(served) as socket:
        first, _ = make_frame(socket)
        time.sleep(1.0)
        with pytest.raises(TimeoutError):
            while isinstance(socket.recv(timeout=0.2), str):
                pass
        socket.send("drawn")
        following, _ = make_frame(socket)
        socket.send("drawn")
        assert following["number"] >= first["number"] + 5


@contextmanager
def watch_new_stream(served: Served, began: threading.Event) -> Iterator[ClientConnection]:
    """Watch once the camera's stream is one that sets ``began``. The stream of an earlier watcher continues if a client
    connects before its next frame, so a client that meets it leaves again."""
    deadline = time.monotonic() + 60
    while True:
        with watch(served) as socket:
            if began.wait(1.0):
                yield socket
                return
        assert time.monotonic() < deadline, "the earlier stream did not end"
        while served.site.stations[CAMERA].live.watchers:
            time.sleep(0.01)
        time.sleep(0.5)


def test_a_frame_that_came_before_the_acknowledgement_is_sent_if_it_is_still_the_newest(
    client: httpx2.Client, served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    began, second, published, ended = (threading.Event() for _ in range(4))

    async def two_frames(camera: SimulatedCamera, *, rate_hz: float) -> AsyncGenerator[Frame]:
        began.set()
        yield await camera.frame()
        await to_thread.run_sync(second.wait)
        yield await camera.frame()
        published.set()
        await to_thread.run_sync(ended.wait)

    monkeypatch.setattr(SimulatedCamera, "frames", two_frames)
    try:
        with watch_new_stream(served, began) as socket:
            facts, _ = make_frame(socket)
            second.set()
            assert published.wait(20)
            time.sleep(0.2)  # for the server to offer the frame to this client
            socket.send("drawn")
            following, _ = make_frame(socket)
            assert following["number"] > facts["number"]
    finally:
        second.set()
        ended.set()


def test_the_state_comes_with_the_picture(client: httpx2.Client, served: Served) -> None:
    with watch(served) as socket:
        assert state_of(socket)["run"] is None
        run = client.post("/runs", json={"camera": CAMERA, "instruction": "track the ball for 300 seconds"}).json()["id"]
        while (state := state_of(socket))["run"] is None:
            pass
        assert state["run"] == run
        client.post(f"/cameras/{CAMERA}/stop")
        while (state := state_of(socket))["run"] is not None:
            pass
        assert state["can_undo"] is True


def test_frames_are_taken_only_while_somebody_watches(
    client: httpx2.Client, served: Served, caplog: pytest.LogCaptureFixture
) -> None:
    live = served.site.stations[CAMERA].live
    with watch(served) as socket:
        make_frame(socket)
        assert live.watchers == 1
    deadline = time.monotonic() + 20
    while live.watchers:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert not [record for record in caplog.records if record.exc_info], "a client that leaves is no error"


def test_an_unknown_camera_is_refused(served: Served) -> None:
    with pytest.raises((ConnectionClosed, Exception), match="403"):
        connect(f"ws://127.0.0.1:{served.port}/api/v1/cameras/nothing/live", proxy=None)


def test_motion_jpeg_is_not_compressed_and_ends(client: httpx2.Client) -> None:
    with client.stream("GET", f"/cameras/{CAMERA}/live.mjpeg", params={"frames": 3, "width": 160}) as response:
        assert response.headers["content-encoding"] == "identity"
        boundary = re.search(r"boundary=(\w+)", response.headers["content-type"])
        content = b"".join(response.iter_raw())
    assert boundary is not None
    parts = content.split(b"--" + boundary.group(1).encode())[1:-1]
    assert len(parts) == 3
    for part in parts:
        jpeg = part.partition(b"\r\n\r\n")[2]
        picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None and picture.shape[1] == 160


@pytest.mark.anyio
async def test_a_camera_failure_is_reported_and_retried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.serve.site.live_picture.RETRY_S", 0.01)
    attempts, often = 0, anyio.Event()

    async def broken() -> Any:
        nonlocal attempts
        attempts += 1
        if attempts == 3:
            often.set()
        raise RuntimeError("the cable is cut")

    live = LivePicture("yard", broken)
    async with anyio.create_task_group() as group:
        group.start_soon(live.run)
        async with live.watch() as frames:
            assert await anext(frames) is None
            assert live.problem == "the cable is cut"
            with anyio.fail_after(20):
                await often.wait()
        group.cancel_scope.cancel()


@pytest.mark.anyio
async def test_an_interruption_is_reported_until_frames_arrive_again(
    monkeypatch: pytest.MonkeyPatch, analytic_scene: Scene
) -> None:
    monkeypatch.setattr("scope_ptz.serve.site.live_picture.CHECK_INTERVAL_S", 0.01)

    class Interrupted(SimulatedCamera):
        frames_problem = ""

        async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
            yield await self.frame()
            await seen.wait()
            self.frames_problem = "the network is down"
            await back.wait()
            self.frames_problem = ""
            yield await self.frame()
            await anyio.sleep_forever()

    camera, seen, back = Interrupted(analytic_scene, width=320, height=180), anyio.Event(), anyio.Event()

    async def opened() -> Camera:
        return camera

    live = LivePicture("yard", opened)
    async with anyio.create_task_group() as group:
        group.start_soon(live.run)
        with anyio.fail_after(30):
            async with live.watch() as frames:
                first = await anext(frames)
                assert first is not None
                seen.set()
                assert await anext(frames) is None
                assert live.problem == "the network is down"
                back.set()
                second = await anext(frames)
                assert second is not None
                assert second.number == first.number + 1
                assert live.problem == ""
        group.cancel_scope.cancel()
