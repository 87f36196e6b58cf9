"""Starting and ending the server of virtual cameras: ports, several cameras, and a clean end."""

from __future__ import annotations

import asyncio
import gc
import socket
import threading

import anyio
import httpx2
import numpy as np
import pytest

from scope_ptz.errors import ConfigError
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import serve
from tests.virtual_camera.http.serving import IMAGE, PTZ, VIDEO, Parts, client, decoded, until

pytestmark = pytest.mark.anyio


async def test_several_cameras_in_one_process(analytic_scene: Scene, served_device: VirtualDevice) -> None:
    roof = VirtualDevice(analytic_scene, viewpoint="roof", width=320, height=180)
    async with serve([served_device, roof]) as (first, second):
        assert first.port != second.port
        assert first.vapix.serial != second.vapix.serial
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
            await until(lambda: camera.source.subscribers == 1)
            await anyio.sleep(0.5)
            with anyio.fail_after(10):
                camera.application.close()
                await until(lambda: camera.source.subscribers == 0)


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
