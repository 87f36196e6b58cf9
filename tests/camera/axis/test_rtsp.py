"""Live frames over RTSP, from the virtual camera."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import AsyncIterator
from contextlib import aclosing, asynccontextmanager

import anyio
import pytest

from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.network import rtsp
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.errors import CameraSignInError, CameraUnreachableError, ForeignAddressError
from scope_ptz.errors import ConfigError
from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, serve_virtual_cameras
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.axis.fake_vapix import PASSWORD, USER
from tests.camera.axis.opening import opened
from tests.support.loopback import nobody_listens

pytestmark = [pytest.mark.anyio, pytest.mark.full]


@asynccontextmanager
async def _camera(scene: Scene) -> AsyncIterator[AxisCamera]:
    account = Account(USER, PASSWORD, Role.ADMINISTRATOR)
    device = VirtualDevice(scene, accounts=[account], width=640, height=360, time_scale=30)
    options = VirtualCameraOptions(scenes=(scene.name,))
    async with (
        serve_virtual_cameras([device], options) as (served,),
        opened(served.port, stream="rtsp", width=640, height=360, latency_s=0.2) as camera,
    ):
        yield camera


async def test_frames_follow_the_camera(analytic_scene: Scene) -> None:
    target, seen = Pose(60.0, -10.0, 2.0), []
    async with _camera(analytic_scene) as camera:
        await camera.move(Pose(0.0, 0.0, 1.0))
        async with aclosing(camera.frames()) as stream:
            with anyio.fail_after(30):
                async for frame in stream:
                    seen.append(frame)
                    if len(seen) == 5:
                        await camera.move(target)
                    if len(seen) > 10 and abs(frame.pose.pan_deg - target.pan_deg) < 0.1:
                        break
        # A frame over RTSP shows what a snapshot of the same pose shows.
        snapshot = await camera.frame()
        difference = abs(seen[-1].image.astype(float) - snapshot.image).mean()
        assert difference < 12, difference
        assert (seen[-1].width, seen[-1].height) == (640, 360)
        assert [f.time_s for f in seen] == sorted(f.time_s for f in seen)


async def test_a_lost_stream_does_not_show_the_password() -> None:
    with nobody_listens() as url:
        place = url.split("/")[2]
        stream = rtsp.RtspStream(
            f"rtsp://{place}/axis-media/media.amp", Credentials(USER, PASSWORD), width=640, height=360, stalled_s=0.5, give_up_s=0.3
        )  # fmt: skip
        try:
            with anyio.fail_after(20), pytest.raises(CameraUnreachableError, match="stream=mjpeg") as caught:
                await stream.next()
        finally:
            await stream.close()
    assert PASSWORD not in f"{caught.value!r} {caught.value.__context__!r} {stream!r}"
    assert not stream._thread.is_alive()


async def test_without_pyav_the_message_names_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ConfigError, match=r"scope-ptz\[camera\]"):
        rtsp.RtspStream("rtsp://127.0.0.1/x", None, width=1, height=1)


async def test_a_wrong_password_is_reported_at_once(analytic_scene: Scene) -> None:
    device = VirtualDevice(analytic_scene, accounts=[Account(USER, PASSWORD, Role.VIEWER)], width=320, height=180)
    async with serve_virtual_cameras([device], VirtualCameraOptions(scenes=(analytic_scene.name,))) as (served,):
        url = f"rtsp://127.0.0.1:{served.vapix.rtsp_port}/axis-media/media.amp"
        stream = rtsp.RtspStream(url, Credentials(USER, "wrong"), width=320, height=180, give_up_s=600)
        with anyio.fail_after(30), pytest.raises(CameraSignInError, match="rejected the user name or the password"):
            await stream.next()
        await stream.close()


async def test_a_redirect_is_not_followed() -> None:
    """FFmpeg would follow it, and send the password in clear text to a host that asks for it."""
    visitors = []

    async def elsewhere(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        visitors.append(await reader.read(4096))
        writer.close()

    async def redirect(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        writer.write(f"RTSP/1.0 302 Moved\r\nCSeq: 1\r\nLocation: rtsp://127.0.0.1:{other_port}/x\r\n\r\n".encode())
        await writer.drain()
        writer.close()

    async with await asyncio.start_server(elsewhere, "127.0.0.1", 0) as other:
        other_port = other.sockets[0].getsockname()[1]
        async with await asyncio.start_server(redirect, "127.0.0.1", 0) as camera:
            url = f"rtsp://127.0.0.1:{camera.sockets[0].getsockname()[1]}/x"
            stream = rtsp.RtspStream(url, Credentials(USER, PASSWORD), width=320, height=180, give_up_s=600)
            with anyio.fail_after(30), pytest.raises(ForeignAddressError, match="no credentials were sent there"):
                await stream.next()
            await stream.close()
    assert visitors == []
