"""Poses between readings."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.network.pose_track import MAX_SAMPLES, PoseTrack
from scope_ptz.geometry import Pose, angle_between_deg, direction


def test_between_two_readings() -> None:
    track = PoseTrack()
    track.add(1.0, Pose(10, 0, 1))
    track.add(2.0, Pose(20, -4, 4))
    pose = track.at(1.5)
    assert (pose.pan_deg, pose.tilt_deg, pose.zoom) == pytest.approx((15, -2, 2))
    assert track.at(0.0) == Pose(10, 0, 1)
    assert track.at(9.0) == Pose(20, -4, 4)


@given(start=st.floats(-180, 180), turn=st.floats(-90, 90), share=st.floats(0, 1))
def test_the_shorter_way_round(start: float, turn: float, share: float) -> None:
    end = (start + turn + 180) % 360 - 180
    track = PoseTrack()
    track.add(0.0, Pose(start, 0, 1))
    track.add(1.0, Pose(end, 0, 1))
    found = track.at(share)
    assert -180 <= found.pan_deg <= 180
    assert angle_between_deg(direction(found.pan_deg, 0), direction(start + share * turn, 0)) == pytest.approx(0, abs=1e-3)


def test_memory_is_bounded_and_time_does_not_go_back() -> None:
    track = PoseTrack()
    for k in range(10 * MAX_SAMPLES):
        track.add(float(k), Pose(0, 0, 1))
    track.add(1.0, Pose(99, 0, 1))
    assert len(track._samples) == MAX_SAMPLES
    assert track.at(1e9) == Pose(0, 0, 1)
    with pytest.raises(ValueError, match="must have a reading"):
        PoseTrack().at(0.0)
