"""Faults of the virtual camera, switched on over HTTP and seen by clients."""

from __future__ import annotations

import json

import httpx2
import pytest

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.faults import Faults
from scope_ptz.virtual_camera.http.server import serve
from tests.virtual_camera.http.serving import IMAGE, PTZ, VIDEO, Parts, camera_and_client, client, decoded, until

pytestmark = pytest.mark.anyio


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


async def test_a_fraction_of_requests_is_dropped(served_device: VirtualDevice) -> None:
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
        await until(lambda: camera.source.subscribers == 0)


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
    assert not served_device.is_moving()


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
        assert served_device.down
        with pytest.raises(httpx2.TransportError):
            await session.get(PTZ, params={"query": "position"})
        await until(lambda: not served_device.down)
        assert served_device.pose() == served_device.home
        assert (await session.get(PTZ, params={"query": "position"})).status_code == 200


async def test_a_client_restarts_the_camera(served_device: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.virtual_camera.http.vapix_routes.REBOOT_S", 0.3)
    async with camera_and_client(served_device) as (_, session):
        await session.get(PTZ, params={"pan": "77"})
        assert (await session.get("/axis-cgi/restart.cgi")).status_code == 200
        await until(lambda: served_device.down)
        with pytest.raises(httpx2.TransportError):
            await session.get(PTZ, params={"query": "position"})
        await until(lambda: not served_device.down)
        assert served_device.pose() == served_device.home
