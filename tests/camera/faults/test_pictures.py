"""Pictures that are truncated, black, frozen, or of another size never become an observation."""

from __future__ import annotations

from contextlib import aclosing
from functools import partial
from pathlib import Path

import pytest

from scope_ptz.camera.network.errors import PictureError
from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import Driver, is_stationary, served, set_faults
from tests.camera.faults.runs import Run, ask, expect_answer, expect_camera_error

pytestmark = pytest.mark.anyio

COUNT = "how many cones are there?"


def _fault_of(run: Run) -> str:
    (error,) = run.errors
    assert isinstance(error, PictureError)
    return error.fault


@pytest.mark.parametrize(("fault", "words"), [("truncated", "incomplete"), ("black", "is black"), ("size", "160x90")])
async def test_broken_picture(driver: Driver, device: VirtualDevice, fault: str, words: str, tmp_path: Path) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        run = await ask(camera, COUNT, tmp_path, when_started=partial(set_faults, device, picture=fault))
        failed = await expect_camera_error(run, PictureError, words)
        assert _fault_of(run) == fault
        assert failed.replies == ()  # perception never saw the picture
        assert is_stationary(device)
        set_faults(device)
        await expect_answer(await ask(camera, COUNT, tmp_path))


async def test_frozen_picture(driver: Driver, device: VirtualDevice, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.camera.network.device_pictures.MAX_PICTURE_LAG_S", 0.2)
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        set_faults(device, picture="frozen")
        await expect_answer(await ask(camera, COUNT, tmp_path))  # the same picture at one pose is fine
        run = await ask(camera, f"pan right 40 degrees. {COUNT}", tmp_path)
        await expect_camera_error(run, PictureError, "frozen")
        assert _fault_of(run) == "frozen"
        assert is_stationary(device)
        set_faults(device)


async def test_black_picture_does_not_make_a_move_fail(driver: Driver, device: VirtualDevice) -> None:
    set_faults(device, picture="black")
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        assert (await camera.move(Pose(40.0, -12.0, 2.0))).pose.pan_deg == pytest.approx(40.0, abs=0.1)


@pytest.mark.parametrize("fault", ["truncated", "black", "size"])
async def test_broken_picture_in_a_stream(driver: Driver, device: VirtualDevice, fault: str) -> None:
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        set_faults(device, picture=fault)
        with pytest.raises(PictureError) as caught:
            async with aclosing(camera.frames()) as stream:
                await anext(stream)
        assert caught.value.fault == fault
        set_faults(device)
        async with aclosing(camera.frames()) as stream:
            await anext(stream)
