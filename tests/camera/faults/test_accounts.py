"""Accounts of least privilege: the role operator suffices, and errors name a missing right."""

from __future__ import annotations

from contextlib import aclosing
from pathlib import Path

import pytest

from scope_ptz.camera.network.errors import CameraSignInError
from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import (
    ADMIN,
    ADMIN_PASSWORD,
    AXIS,
    ONVIF,
    VIEWER,
    VIEWER_PASSWORD,
    Driver,
    is_stationary,
    served,
    until,
)
from tests.camera.faults.runs import ask, expect_answer, expect_camera_error

pytestmark = pytest.mark.anyio


async def test_operator_can_do_all_that_the_tools_need(driver: Driver, device: VirtualDevice, tmp_path: Path) -> None:
    preset = device.presets()[0].name
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        run = await ask(camera, f"go to {preset}, pan right 10 degrees, zoom in 2x, go home and take a picture", tmp_path)
        await expect_answer(run)
        async with aclosing(camera.frames()) as stream:
            await anext(stream)
        await camera.drive(5.0, timeout_s=5.0)
        await camera.stop()
        assert is_stationary(device)


async def test_operator_cannot_change_presets(driver: Driver, device: VirtualDevice) -> None:
    before = device.presets()
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        with pytest.raises(CameraSignInError, match="administrator"):
            await camera.save_preset("north gate")
        with pytest.raises(CameraSignInError, match="administrator"):
            await camera.remove_preset(before[0].name)
    assert device.presets() == before


async def test_administrator_can_change_presets(driver: Driver, device: VirtualDevice) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port, user=ADMIN, password=ADMIN_PASSWORD) as camera:
        await camera.save_preset("north gate")
        assert "north gate" in [preset.name for preset in await camera.presets()]
        await camera.remove_preset("north gate")
        assert "north gate" not in [preset.name for preset in device.presets()]


async def test_viewer_cannot_open_an_axis_camera(device: VirtualDevice) -> None:
    """VAPIX tells position and limits only to accounts that may control PTZ."""
    async with served(device) as camera_server:
        with pytest.raises(CameraSignInError, match="operator account with PTZ control"):
            async with AXIS.opened(camera_server.port, user=VIEWER, password=VIEWER_PASSWORD):
                pass


async def test_viewer_sees_by_onvif_and_cannot_move(device: VirtualDevice, tmp_path: Path) -> None:
    async with served(device) as camera_server, ONVIF.opened(camera_server.port, user=VIEWER, password=VIEWER_PASSWORD) as camera:
        await expect_answer(await ask(camera, "how many cones are there?", tmp_path))
        run = await ask(camera, "pan right 10 degrees", tmp_path)
        await expect_camera_error(run, CameraSignInError, "requires the role operator")
        with pytest.raises(CameraSignInError, match="role operator"):
            await camera.drive(5.0, timeout_s=5.0)
    await until(lambda: is_stationary(device))
    assert device.pose() == Pose(device.home.pan_deg, device.home.tilt_deg, device.home.zoom)
