"""Scene time: no waiting in evaluation, wall-clock time while watched, and no progress while held."""

from __future__ import annotations

import time

import pytest

from scope_ptz.simulator.clock import SceneClock

pytestmark = pytest.mark.anyio


async def test_in_evaluation_time_advances_by_the_slept_durations() -> None:
    clock = SceneClock(5.0)
    began = time.monotonic()
    await clock.sleep(1000.0)
    await clock.sleep(-3.0)
    assert clock.now_s() == 1005.0
    assert clock.elapsed_s() == 1000.0
    assert time.monotonic() - began < 1.0


async def test_while_watched_time_follows_the_wall_clock() -> None:
    clock = SceneClock(5.0, realtime=True)
    await clock.sleep(0.1)
    assert 5.1 <= clock.now_s() < 6.0


@pytest.mark.parametrize("realtime", [False, True])
async def test_held_time_stops_and_continues_from_there(realtime: bool) -> None:
    clock = SceneClock(2.0, realtime=realtime)
    await clock.sleep(0.05)
    with clock.hold():
        held = clock.now_s()
        with clock.hold():
            await clock.sleep(0.05)
        await clock.sleep(0.05)
        assert clock.now_s() == held
    assert clock.now_s() == pytest.approx(held, abs=0.02)
    await clock.sleep(0.05)
    assert clock.now_s() >= held + 0.05 - 1e-9
