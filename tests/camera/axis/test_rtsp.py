"""Live frames over RTSP, from the virtual camera."""

from __future__ import annotations

import sys
from collections.abc import AsyncIterator
from contextlib import aclosing, asynccontextmanager

import anyio
import pytest

from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.network import rtsp
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.errors import CameraUnreachableError
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
