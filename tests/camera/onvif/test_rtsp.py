"""Frames by RTSP: live ones, and snapshots of a device that has no snapshot address."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, aclosing, asynccontextmanager
from typing import Any

import pytest

from scope_ptz.camera.onvif.camera import OnvifCamera
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import listen, serve
from scope_ptz.virtual_camera.rtsp.server import RtspServer
from tests.camera.onvif.opening import ACCOUNTS, opened
from tests.camera.onvif.vendor import Vendor

pytestmark = [pytest.mark.anyio, pytest.mark.full]

THERE = Pose(40.0, -12.0, 2.0)


@asynccontextmanager
async def driver(scene: Scene, vendor: Vendor, **options: Any) -> AsyncIterator[OnvifCamera]:
    device = VirtualDevice(scene, accounts=ACCOUNTS, width=320, height=180, time_scale=30)
    async with AsyncExitStack() as stack:
        (listener,) = listen("127.0.0.1", [0])
        port = listener.getsockname()[1]
        (served,) = await stack.enter_async_context(serve([device], onvif=vendor))
        await stack.enter_async_context(RtspServer(served.source, realm=served.vapix.realm).listen(listener))
        camera = await stack.enter_async_context(opened(served.port, stream="rtsp", rtsp_port=port, **options))
        yield camera


async def test_live_frames_come_by_rtsp(analytic_scene: Scene) -> None:
    async with driver(analytic_scene, Vendor(), latency_s=0.1) as camera:
        await camera.move(THERE)
        async with aclosing(camera.frames()) as stream:
            frame = await anext(stream)
            again = await anext(stream)
        assert (frame.width, frame.height) == (320, 180)
        assert frame.pose.pan_deg == pytest.approx(40.0, abs=0.1)
        assert again.time_s > frame.time_s


async def test_device_without_snapshots(analytic_scene: Scene) -> None:
    vendor = Vendor(refuse=lambda name, _: "ActionNotSupported" if name == "GetSnapshotUri" else "")
    async with driver(analytic_scene, vendor, latency_s=0.1) as camera:
        assert camera.pictures.snapshot_path == ""
        before = await camera.frame()
        await camera.move(THERE)
        after = await camera.frame()
        assert (after.width, after.height) == (320, 180)
        assert after.pose.pan_deg == pytest.approx(40.0, abs=0.1)
        assert abs(before.image.astype(float) - after.image).mean() > 3.0
