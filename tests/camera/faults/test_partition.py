"""A network that drops, delays and breaks what it carries: typed errors while it lasts, and work as usual afterwards."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import anyio
import pytest

from scope_ptz.camera.axis.requests import mjpeg
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.errors import CameraTimeoutError, CameraUnreachableError, PictureError
from scope_ptz.camera.network.rtsp import RtspStream
from scope_ptz.camera.network.streams import LiveStream, MjpegStream
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import (
    AXIS,
    HEIGHT,
    PASSWORD,
    USER,
    WIDTH,
    Driver,
    NetworkCamera,
    is_stationary,
    make_device,
    served,
    set_timeouts,
    until,
    when_moved,
)
from tests.camera.faults.runs import ask, expect_answer, expect_camera_error
from tests.support.partition import BadNetwork, Fate

pytestmark = pytest.mark.anyio


@asynccontextmanager
async def connected(driver: Driver, device: VirtualDevice) -> AsyncIterator[tuple[NetworkCamera, BadNetwork]]:
    """A camera behind a network that can be partitioned."""
    async with served(device) as camera_server:
        with BadNetwork(camera_server.port) as network:
            async with driver.opened(network.port) as camera:
                yield camera, network


@pytest.mark.parametrize("fate", ["drop", pytest.param("one_way", marks=pytest.mark.full)])
async def test_partition_during_a_move(driver: Driver, analytic_scene: Scene, fate: Fate, tmp_path: Path) -> None:
    """Connections stay open and silent. With ``one_way``, commands arrive and replies are lost."""
    replies_only = fate == "one_way"
    device = make_device(analytic_scene, time_scale=0.2 if replies_only else 2.0)
    async with connected(driver, device) as (camera, network):

        def part() -> None:
            set_timeouts(camera, 1.0 if replies_only else 0.3)  # the stop needs time to arrive
            # Later, since requests that are on their way keep the patience with which they were sent.
            asyncio.get_running_loop().call_later(0.1, setattr, network, "fate", fate)

        when_moved(device, part)
        run = await ask(camera, "pan right 90 degrees, then take a picture", tmp_path)
        await expect_camera_error(run, CameraTimeoutError, "did not respond in time")
        network.fate = "forward"
        network.cut()
        set_timeouts(camera)
        await until(lambda: is_stationary(device))
        if replies_only:  # the stop went through, though nobody heard of it
            assert device.pose().pan_deg < 80.0
        await expect_answer(await ask(camera, "pan left 10 degrees", tmp_path))


@pytest.mark.full
async def test_connections_are_reset_and_refused(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=2.0)
    async with connected(driver, device) as (camera, network):

        def cut() -> None:
            network.fate = "refuse"
            network.cut()

        when_moved(device, cut)
        run = await ask(camera, "pan right 90 degrees", tmp_path)
        await expect_camera_error(run, CameraUnreachableError, "heck the")
        network.fate = "forward"
        await until(lambda: is_stationary(device))
        await expect_answer(await ask(camera, "pan left 10 degrees", tmp_path))


async def test_brief_disconnections_are_retried(driver: Driver, device: VirtualDevice) -> None:
    async with connected(driver, device) as (camera, network):
        for _ in range(5):
            network.cut()
            await camera.pose()
            await camera.frame()


async def test_cut_in_the_middle_of_a_reply(driver: Driver, device: VirtualDevice, tmp_path: Path) -> None:
    async with connected(driver, device) as (camera, network):
        network.cut_after = 4000  # positions pass, pictures do not
        with pytest.raises(CameraUnreachableError, match="was lost"):
            await camera.frame()
        network.cut_after = None
        await expect_answer(await ask(camera, "how many cones are there?", tmp_path))


async def test_delay_is_no_fault(driver: Driver, device: VirtualDevice, tmp_path: Path) -> None:
    async with connected(driver, device) as (camera, network):
        network.delay_s = 0.02
        await expect_answer(await ask(camera, "pan right 10 degrees", tmp_path))
        assert device.pose().pan_deg == pytest.approx(10.0, abs=0.1)


@asynccontextmanager
async def streamed(kind: str, device: VirtualDevice) -> AsyncIterator[tuple[LiveStream, BadNetwork]]:
    """A stream through a network that can be partitioned, with little patience."""
    async with served(device, rtsp=True) as camera_server:
        port = camera_server.port if kind == "mjpeg" else camera_server.vapix.rtsp_port
        assert port is not None
        with BadNetwork(port) as network:
            if kind == "rtsp":
                url, account = f"rtsp://127.0.0.1:{network.port}/axis-media/media.amp", Credentials(USER, PASSWORD)
                stream: LiveStream = RtspStream(url, account, width=WIDTH, height=HEIGHT, stalled_s=0.5, give_up_s=3.0)
                try:
                    yield stream, network
                finally:
                    await stream.close()
                return
            async with AXIS.opened(network.port) as camera:
                request = mjpeg(1, WIDTH, HEIGHT, 25.0)
                http = camera._client.http
                stream = MjpegStream(http, request.path, request.query, width=WIDTH, height=HEIGHT, stalled_s=0.5, give_up_s=3.0)
                try:
                    yield stream, network
                finally:
                    await stream.close()


@pytest.mark.parametrize("kind", ["mjpeg", pytest.param("rtsp", marks=pytest.mark.full)])
async def test_stream_survives_cuts(kind: str, device: VirtualDevice) -> None:
    async with streamed(kind, device) as (stream, network):
        for _ in range(3):
            await stream.next()
            before = network.connections
            network.cut()
            await until(lambda seen=before: network.connections > seen)  # type: ignore[misc]
        with anyio.fail_after(30):
            for _ in range(3):
                await stream.next()


@pytest.mark.full
@pytest.mark.parametrize("kind", ["mjpeg", "rtsp"])
async def test_stream_in_a_lasting_partition_is_lost(kind: str, device: VirtualDevice) -> None:
    async with streamed(kind, device) as (stream, network):
        await stream.next()
        network.fate = "drop"
        with anyio.fail_after(60), pytest.raises((PictureError, CameraUnreachableError, CameraTimeoutError)) as caught:
            while True:
                await stream.next()
        assert PASSWORD not in str(caught.value)
