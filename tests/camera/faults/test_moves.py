"""Faults during moves and sweeps: a typed error that planner and person see, a camera that stands, and a whole trace."""

from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path

import anyio
import pytest

from scope_ptz.camera.network.errors import (
    CameraSignInError,
    CameraTimeoutError,
    CameraUnreachableError,
    PositionNotReachedError,
)
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import Driver, is_stationary, make_device, served, set_faults, set_timeouts, until, when_moved
from tests.camera.faults.runs import ask, expect_answer, expect_camera_error

pytestmark = pytest.mark.anyio

THERE = Pose(40.0, -12.0, 2.0)


@pytest.mark.full
async def test_unreachable_during_a_move(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=2.0)  # a move of 90 degrees takes about half a second
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        when_moved(device, partial(set_faults, device, down=True))
        run = await ask(camera, "pan right 90 degrees, then take a picture", tmp_path)
        await expect_camera_error(run, CameraUnreachableError, "Check the network")
        assert [call.fault for call in run.trace.calls] == ["camera"]
        await until(lambda: is_stationary(device))
        set_faults(device)
        await expect_answer(await ask(camera, "pan left 10 degrees", tmp_path))


@pytest.mark.full
async def test_unreachable_during_a_sweep(driver: Driver, device: VirtualDevice, tmp_path: Path) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        # The second move of the sweep.
        when_moved(device, lambda: when_moved(device, partial(set_faults, device, down=True), after_s=0.0), after_s=0.0)
        run = await ask(camera, "sweep the scene and count all cones", tmp_path)
        failed = await expect_camera_error(run, CameraUnreachableError, "Check the network")
        # A count that is not known is not zero.
        assert failed.outcome.call.name == "count_objects"
        assert failed.outcome.result is None
        await until(lambda: is_stationary(device))
        set_faults(device)


@pytest.mark.full
async def test_slow(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=2.0)
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:

        def slow_down() -> None:
            set_timeouts(camera, 0.3)
            # Later, since requests that are on their way keep the patience with which they were sent.
            asyncio.get_running_loop().call_later(0.1, partial(set_faults, device, stall_s=60.0))

        when_moved(device, slow_down)
        run = await ask(camera, "pan right 90 degrees", tmp_path)
        await expect_camera_error(run, CameraTimeoutError, "did not respond in time")
        set_timeouts(camera)
        await until(lambda: is_stationary(device))
        # Merely slow is no fault.
        set_faults(device, stall_s=0.02)
        await expect_answer(await ask(camera, "pan left 10 degrees", tmp_path))
        set_faults(device)


async def test_password_changed_meanwhile(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=2.0)
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        when_moved(device, partial(set_faults, device, unauthorized=True))
        run = await ask(camera, "pan right 90 degrees", tmp_path)
        await expect_camera_error(run, CameraSignInError, "rejected the")
        await until(lambda: is_stationary(device))
        set_faults(device)


async def test_rebooted_during_a_move(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=2.0)

    def reboot() -> None:
        set_faults(device, down=True)
        device.reboot()
        # Shorter than the driver's patience: it sees a camera at another place, not a lost one.
        asyncio.get_running_loop().call_later(0.1, set_faults, device)

    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        when_moved(device, reboot)
        run = await ask(camera, "pan right 90 degrees", tmp_path)
        await expect_camera_error(run, PositionNotReachedError, "but stopped at")
        assert is_stationary(device)
        await expect_answer(await ask(camera, "pan right 10 degrees", tmp_path))


async def test_rebooted_between_commands(driver: Driver, device: VirtualDevice) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        await camera.move(THERE)
        set_faults(device, down=True)
        device.reboot()
        with pytest.raises(CameraUnreachableError, match="rebooting"):
            await camera.pose()
        set_faults(device)
        assert (await camera.pose()).pan_deg == pytest.approx(device.home.pan_deg, abs=0.1)
        assert (await camera.move(THERE)).pose.pan_deg == pytest.approx(THERE.pan_deg, abs=0.1)


async def test_position_never_arrives(driver: Driver, device: VirtualDevice, tmp_path: Path) -> None:
    set_faults(device, stuck=["pan"])
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        run = await ask(camera, "pan right 40 degrees", tmp_path)
        await expect_camera_error(run, PositionNotReachedError, "The pan motor may be blocked")
        assert is_stationary(device)


async def test_move_that_does_not_end(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=0.5)
    async with served(device) as camera_server, driver.opened(camera_server.port, settling={"timeout_s": 0.3}) as camera:
        run = await ask(camera, "pan right 90 degrees", tmp_path)
        await expect_camera_error(run, PositionNotReachedError, "is still moving after 0.3 s")
        assert is_stationary(device)


async def test_somebody_else_moves_the_camera(driver: Driver, analytic_scene: Scene, tmp_path: Path) -> None:
    device = make_device(analytic_scene, time_scale=2.0)
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        when_moved(device, lambda: device.move(Pose(-20.0, 0.0, 1.0)))
        run = await ask(camera, "pan right 90 degrees", tmp_path)
        await expect_camera_error(run, PositionNotReachedError, "someone else may have moved the camera")
        assert is_stationary(device)


async def test_cancelled_move_is_stopped(driver: Driver, analytic_scene: Scene) -> None:
    device = make_device(analytic_scene, time_scale=1.0)
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        with anyio.move_on_after(0.3) as scope:
            await camera.move(Pose(device.pose().pan_deg + 150.0, 0.0, 1.0))
        assert scope.cancelled_caught
        assert is_stationary(device)
