"""Many reconnects leave nothing: no socket, no thread, no task, no process, and no memory that grows with their number."""

from __future__ import annotations

import asyncio
import gc
import os
import threading
import tracemalloc
from collections.abc import Awaitable, Callable
from contextlib import aclosing
from pathlib import Path

import pytest

from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import Driver, is_stationary, served, set_faults, until
from tests.support.partition import BadNetwork

pytestmark = pytest.mark.anyio

WORKERS = 6  # idle threads that anyio keeps for later work
BYTES_EACH = 1500  # of memory that one reconnect may leave, as the logins that the camera remembers; a lost connection takes 7000

MEASURED_TIMES = 101  # fewer show no trend of memory


def resource_usage() -> dict[str, int]:
    """Return what this process holds."""
    gc.collect()
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    return {
        "files": len(list(Path("/proc/self/fd").iterdir())),
        "threads": threading.active_count(),
        "tasks": len(asyncio.all_tasks()),
        "processes": len(children),
    }


async def expect_nothing_left(times: int, once: Callable[[], Awaitable[None]]) -> None:
    """Do something many times and compare what is held before and afterwards."""
    for _ in range(3):
        await once()  # what is made at the first use and kept
    before, grown_bytes = resource_usage(), 0
    if times < MEASURED_TIMES:
        for _ in range(times):
            await once()
    else:
        grown_bytes = await _grown_bytes(times, once)
    await until(lambda: resource_usage()["files"] <= before["files"] + 2)
    after = resource_usage()
    assert after["threads"] <= before["threads"] + WORKERS, [thread.name for thread in threading.enumerate()]
    assert after["tasks"] <= before["tasks"] + 2
    assert after["processes"] == before["processes"]
    assert grown_bytes < 300_000 + BYTES_EACH * times


async def _grown_bytes(times: int, once: Callable[[], Awaitable[None]]) -> int:
    """Do something many times and return by how much the memory of Python objects grew after the first fifth."""
    tracemalloc.start()
    try:
        for k in range(times):
            if k == times // 5:
                gc.collect()
                start_bytes = tracemalloc.get_traced_memory()[0]
            await once()
        gc.collect()
        return tracemalloc.get_traced_memory()[0] - start_bytes
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("times", [100, pytest.param(1000, marks=pytest.mark.full)])
async def test_lost_connections_leave_nothing(driver: Driver, device: VirtualDevice, times: int) -> None:
    """The link breaks again and again while the camera stays open."""
    async with served(device) as camera_server:
        with BadNetwork(camera_server.port) as network:
            async with driver.opened(network.port) as camera:

                async def once() -> None:
                    network.cut()
                    await camera.pose()

                await expect_nothing_left(times, once)
            assert network.connections > times


@pytest.mark.parametrize("times", [5, pytest.param(150, marks=pytest.mark.full)])
async def test_reopened_cameras_leave_nothing(driver: Driver, device: VirtualDevice, times: int) -> None:
    """The camera is opened, driven, streamed from and closed. ``benchmarks/camera_reconnects.py`` does it a thousand times."""
    async with served(device) as camera_server:

        async def once() -> None:
            async with driver.opened(camera_server.port) as camera:
                await camera.drive(5.0, timeout_s=5.0)
                async with aclosing(camera.frames()) as stream:
                    await anext(stream)

        await expect_nothing_left(times, once)
        await until(lambda: is_stationary(device))


@pytest.mark.parametrize("times", [5, pytest.param(150, marks=pytest.mark.full)])
async def test_failed_openings_leave_nothing(driver: Driver, device: VirtualDevice, times: int) -> None:
    set_faults(device, unauthorized=True)
    async with served(device) as camera_server:

        async def once() -> None:
            with pytest.raises(Exception, match="rejected"):
                async with driver.opened(camera_server.port):
                    pass

        await expect_nothing_left(times, once)


@pytest.mark.parametrize("times", [5, pytest.param(150, marks=pytest.mark.full)])
async def test_broken_streams_leave_nothing(driver: Driver, device: VirtualDevice, times: int) -> None:
    """The connections of a stream break, and it is opened again by itself."""
    async with served(device) as camera_server:
        with BadNetwork(camera_server.port) as network:
            async with driver.opened(network.port) as camera, aclosing(camera.frames()) as stream:

                async def once() -> None:
                    network.cut()
                    before = network.connections
                    while network.connections == before:
                        await anext(stream)
                    # Two more frames, with pictures and poses that are read again: breaks at short intervals
                    # are one long failure.
                    await anext(stream)
                    await anext(stream)

                await expect_nothing_left(times, once)
