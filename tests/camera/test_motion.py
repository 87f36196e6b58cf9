"""Camera motors: no jumps, no overshoot, and a limited speed."""

from __future__ import annotations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, Motor
from scope_ptz.geometry import Pose

motors = st.builds(Motor, st.floats(1, 200), st.floats(1, 1000))
poses = st.builds(Pose, st.floats(-179, 179), st.floats(-60, 30), st.floats(1, 5))


@given(motors, st.floats(-360, 360), st.floats(0, 1), st.floats(0, 1))
def test_a_motor_moves_monotonically_from_rest_to_rest(motor: Motor, distance: float, a: float, b: float) -> None:
    total = motor.duration_s(distance)
    early, late = sorted((a * total, b * total))
    gone = abs(motor.distance_after(distance, late)) - abs(motor.distance_after(distance, early))
    assert -1e-9 <= gone <= motor.speed * (late - early) + 1e-6
    assert motor.distance_after(distance, 0.0) == pytest.approx(0.0)
    assert motor.distance_after(distance, total) == distance
    assert abs(motor.distance_after(distance, total / 2)) == pytest.approx(abs(distance) / 2, abs=1e-6)


@given(st.floats(1, 300))
def test_a_long_move_takes_its_length_at_top_speed_and_one_ramp(distance: float) -> None:
    motor = Motor(100.0, 400.0)
    assume(distance > 25)
    assert motor.duration_s(distance) == pytest.approx(distance / 100 + 0.25)


@given(poses, poses, st.floats(0, 1))
def test_a_head_stays_between_start_and_end(start: Pose, end: Pose, share: float) -> None:
    duration = AXIS_M5075_G_HEAD.duration_s(start, end)
    at = AXIS_M5075_G_HEAD.at(start, end, share * duration)
    for name in ("pan_deg", "tilt_deg", "zoom"):
        low, high = sorted((getattr(start, name), getattr(end, name)))
        assert low - 1e-9 <= getattr(at, name) <= high + 1e-9
    assert AXIS_M5075_G_HEAD.at(start, end, duration) == end


def test_nothing_to_do_takes_no_time() -> None:
    assert AXIS_M5075_G_HEAD.duration_s(Pose(3, 4, 2), Pose(3, 4, 2)) == 0.0


def test_the_duration_of_a_turn_matches_the_data_sheet() -> None:
    assert AXIS_M5075_G_HEAD.duration_s(Pose(-179, 0, 1), Pose(179, 0, 1)) == pytest.approx(3.93, abs=0.1)
