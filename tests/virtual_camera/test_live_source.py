"""One live video source for all streams."""

from __future__ import annotations

from itertools import pairwise

import anyio
import pytest

from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice
from scope_ptz.virtual_camera.live_source import LiveSource

pytestmark = pytest.mark.anyio


async def _take(source: LiveSource, count: int, pause_s: float = 0.0) -> list[Exposure]:
    taken: list[Exposure] = []
    async with source.subscribe() as exposures:
        async for exposure in exposures:
            taken.append(exposure)
            if len(taken) == count:
                break
            await anyio.sleep(pause_s)
    return taken


@pytest.fixture
def device(analytic_scene: Scene) -> VirtualDevice:
    return VirtualDevice(analytic_scene, width=64, height=36)


@pytest.mark.parametrize("latency_s", [0.0, 0.05])
async def test_all_clients_get_the_same_frames_in_order(device: VirtualDevice, latency_s: float) -> None:
    source = LiveSource(device, rate_hz=200, latency_s=latency_s)
    got: list[list[Exposure]] = []

    async def watch() -> None:
        got.append(await _take(source, 5))

    async with anyio.create_task_group() as group:
        group.start_soon(source.run)
        async with anyio.create_task_group() as watching:
            for _ in range(3):
                watching.start_soon(watch)
        group.cancel_scope.cancel()
    assert len(got) == 3
    for frames in got:
        times = [frame.taken_s for frame in frames]
        assert times == sorted(set(times))
    shared = set.intersection(*({id(frame) for frame in frames} for frames in got))
    assert shared


async def test_a_slow_client_skips_frames_and_gets_the_newest(device: VirtualDevice) -> None:
    source = LiveSource(device, rate_hz=200)
    async with anyio.create_task_group() as group:
        group.start_soon(source.run)
        slow = await _take(source, 3, pause_s=0.2)
        group.cancel_scope.cancel()
    assert all(later.taken_s - sooner.taken_s > 0.1 for sooner, later in pairwise(slow))


async def test_no_frames_are_produced_without_clients(device: VirtualDevice) -> None:
    source = LiveSource(device, rate_hz=200)
    exposed = 0
    expose = device.expose

    def counting() -> Exposure:
        nonlocal exposed
        exposed += 1
        return expose()

    device.expose = counting  # type: ignore[method-assign, assignment]
    async with anyio.create_task_group() as group:
        group.start_soon(source.run)
        for _ in range(2):
            await _take(source, 2)
            await anyio.sleep(0.05)
            after = exposed
            await anyio.sleep(0.1)
            assert exposed == after
            assert source.subscribers == 0
        group.cancel_scope.cancel()


async def test_a_new_client_never_gets_an_older_picture(device: VirtualDevice) -> None:
    source = LiveSource(device, rate_hz=200)
    async with anyio.create_task_group() as group:
        group.start_soon(source.run)
        await _take(source, 2)
        device.time_scale = 1e6
        device.move(Pose(90.0, 0.0, 1.0))
        await anyio.sleep(0.1)
        assert (await _take(source, 1))[0].pose == Pose(90.0, 0.0, 1.0)
        group.cancel_scope.cancel()
