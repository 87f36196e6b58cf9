"""Scene time: no waiting in evaluation, wall-clock time while watched, and no progress while held."""

from __future__ import annotations

import anyio
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.errors import InputError
from scope_ptz.simulator.clock import MAX_SPEED, MAX_TIME_S, MIN_SPEED, SceneClock

pytestmark = pytest.mark.anyio


async def test_in_evaluation_time_advances_by_the_slept_durations() -> None:
    clock = SceneClock(5.0)
    with anyio.fail_after(100):  # it does not wait for real time
        await clock.sleep(1000.0)
        await clock.sleep(-3.0)
    assert clock.now_s() == 1005.0
    assert clock.elapsed_s() == 1000.0


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


async def test_a_pause_stops_scene_time_but_not_the_motors() -> None:
    clock = SceneClock(4.0)
    clock.pause()
    clock.pause()
    await clock.sleep(2.0)
    assert (clock.now_s(), clock.elapsed_s(), clock.playing, clock.held) == (4.0, 2.0, False, False)
    clock.play()
    clock.play()
    await clock.sleep(2.0)
    assert (clock.now_s(), clock.playing) == (6.0, True)


async def test_a_pause_outlasts_a_hold_and_a_hold_outlasts_a_pause() -> None:
    clock = SceneClock(1.0)
    clock.pause()
    with clock.hold():
        assert clock.held
        clock.play()
        await clock.sleep(1.0)
        assert clock.now_s() == 1.0
        clock.pause()
    await clock.sleep(1.0)
    assert clock.now_s() == 1.0


@given(
    steps=st.lists(
        st.one_of(
            st.tuples(st.just("sleep"), st.floats(0.0, 100.0)),
            st.tuples(st.just("speed"), st.floats(MIN_SPEED, MAX_SPEED)),
            st.tuples(st.just("seek"), st.floats(0.0, MAX_TIME_S)),
            st.tuples(st.sampled_from(["play", "pause"]), st.just(0.0)),
        ),
        max_size=20,
    )
)
async def test_time_is_the_sum_of_the_intervals_at_each_speed(steps: list[tuple[str, float]]) -> None:
    clock, expected_s, speed, playing = SceneClock(7.0), 7.0, 1.0, True
    for what, value in steps:
        if what == "sleep":
            await clock.sleep(value)
            expected_s += value * speed if playing else 0.0
        elif what == "speed":
            clock.set_speed(value)
            speed = value
        elif what == "seek":
            clock.seek(value)
            expected_s = value
        else:
            getattr(clock, what)()
            playing = what == "play"
        assert clock.now_s() == pytest.approx(expected_s, abs=1e-6)


@pytest.mark.parametrize("time_s", [-0.1, MAX_TIME_S + 1, float("nan"), float("inf")])
async def test_impossible_times_are_refused_and_change_nothing(time_s: float) -> None:
    clock = SceneClock(3.0)
    with pytest.raises(InputError, match="from 0 to 86400 seconds"):
        clock.seek(time_s)
    assert clock.now_s() == 3.0


@pytest.mark.parametrize("speed", [0.0, -1.0, 10.5, float("nan"), float("inf")])
async def test_impossible_speeds_are_refused_and_change_nothing(speed: float) -> None:
    clock = SceneClock(3.0)
    with pytest.raises(InputError, match=r"from 0\.1 to 10"):
        clock.set_speed(speed)
    assert (clock.speed, clock.now_s()) == (1.0, 3.0)
