"""Plans of captures: their poses cover everything that the camera shows within the limits."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.camera.base import CameraInfo
from scope_ptz.camera.capture.plan import Ranges, exclude_known_poses, plan_poses
from scope_ptz.errors import InputError
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose

INFO = CameraInfo("any", Limits(), AXIS_M5075_G, 1280, 720, simulated=True)
GRID = np.stack(np.meshgrid(np.linspace(0.03, 0.97, 9), np.linspace(0.03, 0.97, 7)), axis=-1)


def covered(view: Perspective, others: list[Perspective]) -> float:
    """Return the share of a view that other views show."""
    rays = view.directions(GRID)
    shown = np.any([np.all((p := other.points(rays)) >= 0, axis=-1) & np.all(p <= 1, axis=-1) for other in others], axis=0)
    return float(shown.mean())


@settings(max_examples=30, deadline=None)
@given(
    st.floats(-179, 100), st.floats(0, 250), st.floats(-60, 0), st.floats(0, 60), st.sampled_from([1.0, 2.0]), st.floats(0.3, 0.6),
    st.floats(0, 1), st.floats(0, 1),
)  # fmt: skip
def test_every_view_within_the_limits_is_covered(
    left: float, width: float, bottom: float, height: float, zoom: float, overlap: float, x: float, y: float
) -> None:
    limits = Ranges((left, min(left + width, 179.0)), (bottom, min(bottom + height, 30.0))).within(Limits())
    poses = plan_poses(INFO, limits, zoom, overlap)
    assert all(not limits.clamp(pose)[1] for pose in poses)
    hfov_deg = AXIS_M5075_G.hfov_deg(zoom)
    views = [Perspective(pose.pan_deg, pose.tilt_deg, hfov_deg, 1280, 720) for pose in poses]
    pan = limits.min_pan_deg + x * (limits.max_pan_deg - limits.min_pan_deg)
    tilt = limits.min_tilt_deg + y * (limits.max_tilt_deg - limits.min_tilt_deg)
    assert covered(Perspective(pan, tilt, hfov_deg, 1280, 720), views) > 0.9


@pytest.mark.parametrize("limits", [Limits(), Limits(pan_endless=True)])
def test_a_full_circle_is_closed(limits: Limits) -> None:
    poses = plan_poses(INFO, limits, 1.0)
    views = [Perspective(pose.pan_deg, pose.tilt_deg, 71.0, 1280, 720) for pose in poses]
    for pan in (-180.0, -170.0, 175.0, 0.0):
        assert covered(Perspective(pan, -10.0, 71.0, 1280, 720), views) == 1.0
    assert all(not limits.clamp(pose)[1] for pose in poses)


def test_rows_alternate_so_that_the_camera_does_not_travel_back() -> None:
    poses = plan_poses(INFO, Limits(-60, 60, -40, 20), 1.0)
    turns = [max(abs(a.pan_deg - b.pan_deg), abs(a.tilt_deg - b.tilt_deg)) for a, b in pairwise(poses)]
    assert max(turns) < 60


@pytest.mark.parametrize("ranges", [
    Ranges((10.0, -10.0)), Ranges((float("nan"), 1.0)), Ranges((200.0, 300.0)), Ranges(None, (40.0, 50.0)),
])  # fmt: skip
def test_a_range_outside_the_limits_is_refused(ranges: Ranges) -> None:
    with pytest.raises(InputError, match="degrees"):
        ranges.within(Limits())


def test_overlaps_and_numbers_of_frames_are_limited() -> None:
    with pytest.raises(InputError, match="overlap"):
        plan_poses(INFO, Limits(), 1.0, 0.95)
    with pytest.raises(InputError, match="more than 5000"):
        plan_poses(INFO, Limits(), 5.0, 0.8)


def test_poses_that_are_known_are_not_taken_again() -> None:
    known = [Pose(10.0, 0.0, 4.0), Pose(179.9, 0.0, 4.0)]
    poses = [Pose(10.1, 0.1, 4.0), Pose(-180.0, 0.0, 4.0), Pose(10.0, 0.0, 1.0), Pose(30.0, 0.0, 4.0)]
    assert exclude_known_poses(poses, known, 17.6) == poses[2:]
