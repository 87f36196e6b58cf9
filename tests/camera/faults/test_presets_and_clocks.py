"""A preset that is deleted meanwhile, and clocks that disagree."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.errors import UnknownNameError
from scope_ptz.virtual_camera.device import VirtualDevice
from tests.camera.faults.drivers import Driver, is_stationary, served, set_faults, when_moved
from tests.camera.faults.runs import ask, expect_answer

pytestmark = pytest.mark.anyio


async def test_preset_deleted_meanwhile(driver: Driver, device: VirtualDevice, tmp_path: Path) -> None:
    first, *others = device.presets()
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        when_moved(device, lambda: device.remove_preset(first.number), after_s=0.0)
        run = await ask(camera, f"pan right 10 degrees, then go to {first.name}", tmp_path)
        (error,) = run.errors
        assert type(error) is UnknownNameError
        # The planner gets the error and the presets that are left; nothing else moved the camera.
        refused = run.trace.calls[-1]
        assert (refused.fault, refused.outcome.error) == ("bad_call", str(error))
        assert all(other.name in str(error) for other in others)
        assert run.trace.ended is not None
        assert run.trace.ended.bad_calls == 1
        assert first.name in run.trace.ended.text
        assert is_stationary(device)
        assert device.pose().pan_deg == pytest.approx(device.home.pan_deg + 10.0, abs=0.1)


@pytest.mark.parametrize("skew_s", [-90_000.0, 4000.0])
async def test_clock_skew(driver: Driver, device: VirtualDevice, skew_s: float, tmp_path: Path) -> None:
    set_faults(device, clock_skew_s=skew_s)
    async with served(device) as camera_server, driver.opened(camera_server.port) as camera:
        await expect_answer(await ask(camera, "pan right 10 degrees", tmp_path))
        when_moved(device, lambda: set_faults(device, clock_skew_s=-skew_s), after_s=0.0)  # somebody sets the clock during a move
        await expect_answer(await ask(camera, "pan right 10 degrees, then pan left 5 degrees", tmp_path))
        assert device.pose().pan_deg == pytest.approx(15.0, abs=0.1)
