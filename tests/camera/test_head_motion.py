"""A driven head: no jumps, a limited speed, no pose beyond a limit, and a timeout."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.camera.head_motion import HeadMotion
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, Head, Motor
from scope_ptz.geometry import Limits, Pose

velocities = st.builds(Velocity, st.floats(-300, 300), st.floats(-300, 300), st.floats(-9, 9))
poses = st.builds(Pose, st.floats(-179, 179), st.floats(-60, 30), st.floats(1, 5))
times = st.floats(0, 4)
SLACK = 1e-6


def _motion(pose: Pose, limits: Limits | None = None) -> HeadMotion:
    return HeadMotion(AXIS_M5075_G_HEAD, limits or Limits(), pose)


@given(poses, velocities, velocities, times, times, st.floats(0, 0.2))
def test_a_driven_head_never_jumps_and_never_leaves_its_limits(
    pose: Pose, first: Velocity, second: Velocity, changed_s: float, at_s: float, step_s: float
) -> None:
    motion = _motion(pose)
    motion.drive(first, 0.0, 3.0)
    before = motion.pose(changed_s)
    motion.drive(second, changed_s, 3.0)
    assert motion.pose(changed_s) == before
    now, soon = motion.pose(changed_s + at_s), motion.pose(changed_s + at_s + step_s)
    assert Limits().clamp(soon)[1] == ()
    head = AXIS_M5075_G_HEAD
    assert abs(soon.pan_deg - now.pan_deg) <= head.pan.speed * step_s + SLACK
    assert abs(soon.tilt_deg - now.tilt_deg) <= head.tilt.speed * step_s + SLACK
    assert abs(math.log2(soon.zoom / now.zoom)) <= head.zoom.speed * step_s + SLACK


@given(poses, velocities, st.floats(0.01, 10), times)
def test_a_driven_head_stands_still_after_its_timeout(pose: Pose, velocity: Velocity, timeout_s: float, later_s: float) -> None:
    motion = _motion(pose)
    motion.drive(velocity, 5.0, timeout_s)
    end_time_s = motion.end_time_s()
    assert 5.0 + timeout_s <= end_time_s <= 5.0 + timeout_s + 0.25 + SLACK
    end = motion.pose(end_time_s)
    later = motion.pose(end_time_s + later_s)
    assert (later.pan_deg, later.tilt_deg, later.zoom) == pytest.approx((end.pan_deg, end.tilt_deg, end.zoom))
    assert not motion.is_moving(end_time_s)


def test_a_constant_velocity_covers_its_distance_after_the_ramp() -> None:
    motion = _motion(Pose())
    motion.drive(Velocity(pan_dps=40.0, tilt_dps=-10.0, zoom_rate=0.5), 0.0, 10.0)
    early, late = motion.pose(1.0), motion.pose(2.0)
    assert late.pan_deg - early.pan_deg == pytest.approx(40.0)
    assert late.tilt_deg - early.tilt_deg == pytest.approx(-10.0)
    assert late.zoom / early.zoom == pytest.approx(math.sqrt(2))
    assert motion.velocity(1.5) == Velocity(40.0, -10.0, 0.5)


def test_the_distance_is_the_integral_of_the_speed() -> None:
    motor = Motor(100.0, 400.0)
    steps = [motor.after_command(-70.0, 90.0, 0.6, k / 10_000) for k in range(12_000)]
    summed = sum((a + b) / 2 / 10_000 for (_, a), (_, b) in pairwise(steps))
    assert steps[-1][0] == pytest.approx(summed, abs=1e-3)
    assert steps[-1][1] == 0.0


def test_a_head_at_its_stop_turns_back_immediately() -> None:
    motion = _motion(Pose(170.0, 0.0, 1.0))
    motion.drive(Velocity(pan_dps=100.0), 0.0, 10.0)
    assert motion.pose(2.0).pan_deg == 179.0
    assert motion.velocity(2.0) == Velocity()
    motion.drive(Velocity(pan_dps=-100.0), 2.0, 10.0)
    assert motion.pose(2.5).pan_deg < 179.0 - 20.0


def test_an_endless_pan_wraps() -> None:
    motion = _motion(Pose(170.0, 0.0, 1.0), Limits(pan_endless=True))
    motion.drive(Velocity(pan_dps=100.0), 0.0, 10.0)
    assert motion.pose(0.5).pan_deg == pytest.approx(170.0 + 12.5 + 25.0 - 360.0)


def test_braking_takes_the_braking_distance_of_the_motor() -> None:
    motion = _motion(Pose())
    motion.drive(Velocity(pan_dps=100.0), 0.0, 10.0)
    before = motion.pose(1.0).pan_deg
    motion.brake(1.0)
    assert motion.pose(3.0).pan_deg - before == pytest.approx(100.0**2 / (2 * 400.0))


def test_a_reduced_speed_takes_longer() -> None:
    quick, slow = _motion(Pose()), _motion(Pose())
    quick.move(Pose(90, 0, 1), 0.0)
    slow.move(Pose(90, 0, 1), 0.0, speed_fraction=0.1)
    assert slow.end_time_s() == pytest.approx(Head.at_speed(AXIS_M5075_G_HEAD, 0.1).duration_s(Pose(), Pose(90, 0, 1)))
    assert slow.end_time_s() > 7 * quick.end_time_s()


@pytest.mark.parametrize("zoom_rate", [-1.5, 1.5])
def test_a_zoom_that_is_driven_for_a_year_stands_at_its_limit(zoom_rate: float) -> None:
    motion = _motion(Pose(0.0, 0.0, 2.0))
    motion.drive(Velocity(zoom_rate=zoom_rate), 0.0, 3.2e7)
    assert motion.pose(3.1e7).zoom == (5.0 if zoom_rate > 0 else 1.0)


def test_the_end_of_a_move_and_the_commanded_velocity() -> None:
    motion = _motion(Pose())
    assert motion.end == Pose()
    motion.move(Pose(30.0, -10.0, 2.0), 0.0)
    assert (motion.end, motion.commanded_velocity(0.1)) == (Pose(30.0, -10.0, 2.0), Velocity())
    motion.drive(Velocity(10.0), 0.2, 1.0)
    assert (motion.commanded_velocity(0.3), motion.commanded_velocity(2.0)) == (Velocity(10.0), Velocity())
    assert motion.end is None


def test_zoom_can_have_a_speed_of_its_own() -> None:
    motion = _motion(Pose())
    motion.move(Pose(90.0, 0.0, 5.0), 0.0, speed_fraction=0.01, zoom_fraction=1.0)
    assert motion.pose(5.0).zoom == pytest.approx(5.0)
    assert motion.pose(5.0).pan_deg < 10.0
