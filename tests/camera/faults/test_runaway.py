"""A continuous move never runs away: whatever happens to the program or to the network, the camera stops."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import anyio
import pytest

from scope_ptz.agent.trace import read_trace
from scope_ptz.camera.network.errors import CameraTimeoutError, CameraUnreachableError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import (
    HEIGHT,
    PASSWORD,
    USER,
    WIDTH,
    Driver,
    NetworkCamera,
    is_stationary,
    make_device,
    served,
    until,
)
from tests.support.misbehaving import Misbehaving, good
from tests.support.partition import BadNetwork, Fate

pytestmark = pytest.mark.anyio

ROOT = Path(__file__).parents[3]
DPS = 10.0
LONG_S = 10.0
TIMED_OUT_DEG = 0.9 * DPS * LONG_S  # a camera that comes this far was stopped by nobody


@pytest.fixture
def device(analytic_scene: Scene) -> VirtualDevice:
    """A camera with motors as fast as real ones."""
    return make_device(analytic_scene, time_scale=1.0)


@asynccontextmanager
async def connected(driver: Driver, device: VirtualDevice) -> AsyncIterator[tuple[NetworkCamera, BadNetwork]]:
    """A camera behind a network that can be partitioned."""
    async with served(device) as camera_server:
        with BadNetwork(camera_server.port) as network:
            async with driver.opened(network.port, reply_s=1.0) as camera:
                yield camera, network


@pytest.mark.parametrize("fate", ["refuse", pytest.param("drop", marks=pytest.mark.full)])
async def test_link_lost_during_a_drive(driver: Driver, device: VirtualDevice, fate: Fate) -> None:
    async with connected(driver, device) as (camera, network):
        await camera.drive(DPS, timeout_s=0.3)
        await until(lambda: device.commanded_velocity.pan_dps)
        network.fate = fate
        network.cut()
        with pytest.raises((CameraUnreachableError, CameraTimeoutError)):
            await camera.drive(DPS, timeout_s=0.3)
        if driver.name == "onvif":  # the device knows the timeout
            await until(lambda: is_stationary(device))
        else:  # VAPIX has none: the stop is sent until it arrives
            assert not is_stationary(device)
        network.fate = "forward"
        await until(lambda: is_stationary(device))


async def test_watchdog_keeps_sending_stop_after_the_camera_is_closed(driver: Driver, device: VirtualDevice) -> None:
    """Closing the camera gives up after a few seconds; the watchdog process keeps trying until the link is back."""
    async with served(device) as camera_server:
        with BadNetwork(camera_server.port) as network:
            async with driver.opened(network.port, reply_s=1.0) as camera:
                await camera.drive(DPS, timeout_s=2.0)
                network.fate = "refuse"
                network.cut()
                camera._dead_mans_switch._give_up_s = 0.0
            network.fate = "forward"
            await until(lambda: is_stationary(device))


async def test_drive_ends_at_its_timeout(driver: Driver, device: VirtualDevice) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        await camera.drive(DPS, timeout_s=0.2)
        assert not is_stationary(device)
        await until(lambda: is_stationary(device))


async def test_drive_ends_although_the_event_loop_is_blocked(driver: Driver, device: VirtualDevice) -> None:
    """The virtual camera runs in a thread of its own here; the driver's event loop hangs."""
    blocked = threading.Event()

    async def serve_elsewhere(ready: asyncio.Future[int], loop: asyncio.AbstractEventLoop) -> None:
        async with served(device) as camera_server:
            loop.call_soon_threadsafe(ready.set_result, camera_server.port)
            await until(blocked.is_set)

    loop = asyncio.get_running_loop()
    ready = loop.create_future()
    thread = threading.Thread(target=lambda: asyncio.run(serve_elsewhere(ready, loop)))
    thread.start()
    try:
        async with driver.opened(await ready) as camera:
            await camera.drive(DPS, timeout_s=0.2)
            for _ in range(400):
                threading.Event().wait(0.05)  # no task runs meanwhile, on purpose
                if is_stationary(device):
                    break
            assert is_stationary(device)
    finally:
        blocked.set()
        await anyio.to_thread.run_sync(thread.join)


async def test_drive_ends_when_the_camera_is_closed(driver: Driver, device: VirtualDevice) -> None:
    async with served(device) as camera_server:
        async with driver.opened(camera_server.port) as camera:
            await camera.drive(DPS, 2.0, 0.1, timeout_s=LONG_S)
            assert not is_stationary(device)
        await until(lambda: is_stationary(device))
        assert device.pose().pan_deg - device.home.pan_deg < TIMED_OUT_DEG


async def test_drive_ends_on_cancel(driver: Driver, device: VirtualDevice) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        with anyio.move_on_after(0.3) as scope:
            while True:
                await camera.drive(DPS, timeout_s=LONG_S)
        assert scope.cancelled_caught
        await until(lambda: is_stationary(device))
        assert device.pose().pan_deg - device.home.pan_deg < TIMED_OUT_DEG


async def test_renewed_drive_goes_on_and_a_move_after_it_is_not_cut_short(driver: Driver, device: VirtualDevice) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        for _ in range(4):
            await camera.drive(DPS, timeout_s=1.0)
            await anyio.sleep(0.1)
            assert not is_stationary(device)
        there = Pose(device.pose().pan_deg + 20.0, device.home.tilt_deg, 1.0)
        assert (await camera.move(there)).pose.pan_deg == pytest.approx(there.pan_deg, abs=0.15)


def _heed_hang_up() -> None:
    """Undo what ``nohup`` sets: a program that is started by a test would otherwise ignore the signal too."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


PROGRAM = """
import anyio, sys
from scope_ptz.factory.cameras import open_camera

async def main():
    async with await open_camera(sys.argv[1]) as opened:
        await opened.camera.drive(10.0, timeout_s=10.0)
        print("driving", flush=True)
        await anyio.sleep_forever()

anyio.run(main)
"""


@pytest.mark.full
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT], ids=lambda number: number.name)
async def test_program_that_drives_is_ended(driver: Driver, device: VirtualDevice, number: signal.Signals, tmp_path: Path) -> None:
    """The drive's own timeout is far away, so it is the end of the program that stops the camera."""
    async with served(device) as camera_server:
        stream = "" if driver.name == "axis" else "?stream=snapshot"
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-c", PROGRAM, f"{driver.name}://{USER}@127.0.0.1:{camera_server.port}{stream}",
            stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE, env=_environment(tmp_path), preexec_fn=_heed_hang_up,
        )  # fmt: skip
        assert process.stdout is not None
        with anyio.fail_after(60):
            assert await process.stdout.readline() == b"driving\n", (await process.communicate())[1]
        assert not is_stationary(device)
        process.send_signal(number)
        await process.communicate()
        await until(lambda: is_stationary(device))
        assert device.pose().pan_deg - device.home.pan_deg < TIMED_OUT_DEG


@pytest.mark.full
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT], ids=lambda number: number.name)
async def test_command_that_moves_is_ended(driver: Driver, device: VirtualDevice, number: signal.Signals, tmp_path: Path) -> None:
    """``scope ask`` stops the camera and records how it ended."""
    device.time_scale = 0.25  # a move that takes seconds
    stream = "" if driver.name == "axis" else "&stream=snapshot"
    async with served(device) as camera_server:
        with Misbehaving(then=good(moondream={})) as server:
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-m", "scope_ptz.cli", "ask", "pan right 170 degrees",
                "--camera", f"{driver.name}://{USER}@127.0.0.1:{camera_server.port}?width={WIDTH}&height={HEIGHT}{stream}",
                "--perception", "moondream2", "--perception-url", server.url,
                stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE, env=_environment(tmp_path),
                preexec_fn=_heed_hang_up,
            )  # fmt: skip
            await until(lambda: device.is_moving() or process.returncode is not None, 60.0)
            process.send_signal(number)
            _, errors = await process.communicate()
        assert process.returncode == 130, errors
        await until(lambda: is_stationary(device))
        assert device.pose().pan_deg < 160.0
    trace = read_trace(next((tmp_path / "runs").iterdir()))
    assert trace.ended is not None
    assert trace.ended.outcome == "cancelled"


def _environment(cache: Path) -> dict[str, str]:
    return {
        **os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT / "src"), str(ROOT))),
        "SCOPE_CAMERA_PASSWORD": PASSWORD, "SCOPE_CACHE_DIR": str(cache / "cache"), "SCOPE_RUNS_DIR": str(cache / "runs"),
    }  # fmt: skip
