"""A short outage of the network interrupts live frames and says so; they resume when the camera is back."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import aclosing, asynccontextmanager

import anyio
import pytest

from scope_ptz.camera.base import Camera
from scope_ptz.camera.network import pose_track, streams
from scope_ptz.camera.network.errors import CameraTimeoutError, CameraUnreachableError, PictureError
from scope_ptz.camera.network.pose_track import PosePoller
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import AXIS, ONVIF, Driver, make_device, served, set_timeouts, until
from tests.support.partition import BadNetwork, Fate

pytestmark = pytest.mark.anyio

OUTAGE_S = 2.0
"""Longer than the driver retries one request, and shorter than a stream is given up."""

TRANSPORTS = [
    pytest.param(AXIS, "mjpeg", id="axis-mjpeg"),
    pytest.param(AXIS, "rtsp", id="axis-rtsp", marks=pytest.mark.full),
    pytest.param(ONVIF, "rtsp", id="onvif-rtsp", marks=pytest.mark.full),
    pytest.param(ONVIF, "snapshot", id="onvif-snapshot", marks=pytest.mark.full),
]


class Links:
    """The connections to a camera: one to its web interface and one to its RTSP server."""

    def __init__(self, *links: BadNetwork) -> None:
        self._links = links

    def fail(self, fate: Fate) -> None:
        for link in self._links:
            link.fate = fate
            if fate == "refuse":
                link.cut()

    def recover(self) -> None:
        for link in self._links:
            link.fate = "forward"
            link.cut()


@asynccontextmanager
async def connected(driver: Driver, transport: str, device: VirtualDevice) -> AsyncIterator[tuple[Camera, Links]]:
    """A camera whose web interface and RTSP server are behind networks that can fail."""
    async with served(device, rtsp=True) as camera_server:
        rtsp_port = camera_server.vapix.rtsp_port
        assert rtsp_port is not None
        with BadNetwork(camera_server.port) as web, BadNetwork(rtsp_port) as rtsp:
            async with driver.opened(web.port, stream=transport, rtsp_port=rtsp.port) as camera:
                yield camera, Links(web, rtsp)


@pytest.mark.parametrize(("driver", "transport"), TRANSPORTS)
@pytest.mark.parametrize("fate", ["refuse", pytest.param("drop", marks=pytest.mark.full)])
async def test_live_frames_resume_after_an_outage(driver: Driver, transport: str, fate: Fate, analytic_scene: Scene) -> None:
    device = make_device(analytic_scene)
    async with connected(driver, transport, device) as (camera, links), aclosing(camera.frames(rate_hz=25.0)) as frames:
        await anext(frames)
        assert camera.frames_problem == ""
        set_timeouts(camera, 0.5)  # type: ignore[arg-type]
        links.fail(fate)
        began_s = camera.clock.now_s()

        async def outage() -> None:
            await until(lambda: camera.frames_problem)
            assert "camera" in camera.frames_problem
            with pytest.raises((CameraUnreachableError, CameraTimeoutError)):
                await camera.move(Pose(40.0, -10.0, 2.0))
            await anyio.sleep(max(0.0, began_s + OUTAGE_S - camera.clock.now_s()))
            set_timeouts(camera)  # type: ignore[arg-type]
            links.recover()

        with anyio.fail_after(40):
            async with anyio.create_task_group() as group:
                group.start_soon(outage)
                async for newest in frames:
                    if newest.time_s >= began_s + OUTAGE_S:
                        break
        assert camera.frames_problem == ""
        assert newest.pose.pan_deg == pytest.approx(device.pose().pan_deg, abs=0.1)
        assert (await camera.move(Pose(-20.0, -10.0, 1.0))).pose.pan_deg == pytest.approx(-20.0, abs=0.1)


@pytest.mark.parametrize(("driver", "transport"), TRANSPORTS[:1])
async def test_an_outage_that_lasts_ends_the_frames(
    driver: Driver, transport: str, device: VirtualDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PosePoller.__init__, "__kwdefaults__", {"give_up_s": 0.5})
    monkeypatch.setattr(streams.MjpegStream.__init__, "__kwdefaults__", {"stalled_s": 0.5, "give_up_s": 0.5})
    async with connected(driver, transport, device) as (camera, links), aclosing(camera.frames()) as frames:
        await anext(frames)
        links.fail("refuse")
        with anyio.fail_after(30), pytest.raises((CameraUnreachableError, PictureError)):
            async for _ in frames:
                pass
        assert camera.frames_problem == ""


async def test_no_frame_gets_a_pose_from_both_sides_of_an_outage(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody knows how the camera moved in between."""
    monkeypatch.setattr(pose_track, "RETRY_S", 0.01)
    replies: list[Pose | Exception] = [Pose(0.0, 0.0, 1.0), CameraUnreachableError("the cable is loose"), Pose(90.0, 0.0, 1.0)]

    async def read() -> Pose:
        reply = replies.pop(0) if len(replies) > 1 else replies[0]
        if isinstance(reply, Exception):
            times.append(anyio.current_time())
            raise reply
        return reply

    times: list[float] = []
    poller = PosePoller(read)
    try:
        await until(lambda: poller.problem)
        assert poller.problem == "the cable is loose"
        assert await poller.at(times[0]) is None
        assert poller.problem == ""
        pose = await poller.at(anyio.current_time())
        assert pose is not None
        assert pose.pan_deg == 90.0
    finally:
        await poller.close()
