"""Requests over HTTP: forms of replies and errors, sign-in and roles."""

from __future__ import annotations

from urllib.request import HTTPDigestAuthHandler, HTTPPasswordMgrWithDefaultRealm, ProxyHandler, build_opener

import httpx2
import pytest
from anyio import to_thread

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.virtual_camera.http.serving import IMAGE, PTZ, camera_and_client, client

pytestmark = pytest.mark.anyio


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
        assert len(challenges) == 3
        assert all(challenge.startswith("Digest ") for challenge in challenges)


async def test_the_standard_library_signs_in(served_device: VirtualDevice) -> None:
    """It reads only the first challenge and does not know SHA-256."""

    def read(url: str) -> int:
        passwords = HTTPPasswordMgrWithDefaultRealm()
        passwords.add_password(None, url, "root", "pass word")
        opener = build_opener(ProxyHandler({}), HTTPDigestAuthHandler(passwords))
        with opener.open(url + IMAGE, timeout=20) as reply:
            return len(reply.read())

    async with serve([served_device]) as (camera,):
        assert await to_thread.run_sync(read, camera.url) > 1000


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
