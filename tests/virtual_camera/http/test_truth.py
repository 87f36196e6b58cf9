"""Ground truth that the virtual camera offers beside its pictures."""

from __future__ import annotations

import json

import httpx2
import pytest

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.virtual_camera.http.serving import IMAGE, PTZ, VIDEO, Parts, camera_and_client, decoded, until

pytestmark = pytest.mark.anyio


async def test_the_truth_of_a_picture_stands_beside_it_and_can_be_asked_for(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device, truth=True) as (_, session):
        first = await session.get(IMAGE)
        await session.get(PTZ, params={"pan": "33", "tilt": "-7", "zoom": "5000"})
        await until(lambda: not served_device.is_moving())
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
                hfov_deg, taken_s = served_device.optics.hfov_deg(pose.zoom), float(reply.headers["x-scope-taken"])
                assert found.json() == {**expected, "hfov_deg": hfov_deg, "taken_s": pytest.approx(taken_s, abs=0.001)}
            length = int.from_bytes(reply.content[4:6], "big")
            assert reply.content[2:4] == b"\xff\xfe"
            comment = json.loads(reply.content[6 : 4 + length])
            assert comment == {**expected, "taken_s": float(reply.headers["x-scope-taken"])}
            assert decoded(reply.content).shape == (180, 320, 3)
        assert (await session.get("/virtual/truth")).json()["pose"]["pan_deg"] == 33
        late = {"taken": repr(float(second.headers["x-scope-taken"]) + 0.5)}
        assert (await session.get("/virtual/truth", params=late)).status_code == 404
        assert (await session.get("/virtual/truth", params={**late, "within": "2"})).json()["pose"]["pan_deg"] == 33
        assert (await session.get("/virtual/truth", params={**late, "within": "soon"})).status_code == 400
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
