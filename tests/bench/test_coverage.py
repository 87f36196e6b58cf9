"""Coverage of evidence by observations: direction, size, viewpoint, time and question."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scope_ptz.bench.scoring.coverage import (
    are_inside,
    box_directions,
    density_px_per_deg,
    is_clearly_shown,
    reference_directions,
    uncovered_part,
)
from scope_ptz.bench.scoring.episode import CameraPosition, Observation
from scope_ptz.bench.tasks.task import EvidenceView, Item
from scope_ptz.geometry import Pose, direction, pan_tilt_deg
from tests.bench.sample_runs import FRAME, view

PANS, TILTS, ZOOMS = st.floats(-179, 179), st.floats(-55, 25), st.floats(1, 5)
POSES = st.builds(Pose, PANS, TILTS, ZOOMS)


def observation(pose: Pose, viewpoint: str = "mast", **extra: Any) -> Observation:
    return Observation(viewpoint, FRAME.view(pose), extra.pop("time_s", 0.0), extra.pop("how", "count"), **extra)


SWEEP = Observation("mast", FRAME.sweep(), 0.0, "count")


def evidence(pose: Pose, **extra: Any) -> EvidenceView:
    return view(CameraPosition("mast", pose), **extra)


@given(POSES)
def test_a_frame_covers_its_own_view(pose: Pose) -> None:
    assert uncovered_part(evidence(pose), [observation(pose)]) is None
    assert uncovered_part(evidence(pose), [observation(pose, "bridge")]) is not None
    assert uncovered_part(evidence(pose), []) is not None


@given(POSES, st.floats(0.06, 1.0), st.sampled_from([1, -1]))
def test_a_frame_turned_by_more_than_the_inset_does_not_cover_the_view(pose: Pose, fraction: float, side: int) -> None:
    fov = FRAME.optics.hfov_deg(pose.zoom)
    turned = Pose(pose.pan_deg + side * fraction * fov / math.cos(math.radians(pose.tilt_deg)), pose.tilt_deg, pose.zoom)
    assert uncovered_part(evidence(pose), [observation(turned)]) is not None


@given(POSES)
def test_within_half_a_degree_and_three_percent_of_zoom_a_view_at_the_wide_end_is_covered(pose: Pose) -> None:
    assume(pose.zoom <= 1.5)
    near = Pose(pose.pan_deg + 0.5, pose.tilt_deg, pose.zoom * 0.99)
    assert uncovered_part(evidence(pose), [observation(near)]) is None


@given(POSES)
def test_zooming_in_loses_the_border_and_zooming_out_loses_detail(pose: Pose) -> None:
    assume(1.5 <= pose.zoom <= 3.5)
    closer, wider = Pose(pose.pan_deg, pose.tilt_deg, pose.zoom * 1.2), Pose(pose.pan_deg, pose.tilt_deg, pose.zoom / 1.4)
    assert uncovered_part(evidence(pose), [observation(closer)]) is not None
    assert uncovered_part(evidence(pose), [observation(wider)]) is None
    density = density_px_per_deg(observation(pose))
    assert uncovered_part(evidence(pose, min_density_px_deg=density), [observation(pose)]) is None
    assert uncovered_part(evidence(pose, min_density_px_deg=density), [observation(wider)]) is not None


@given(POSES)
def test_two_halves_cover_a_view_together(pose: Pose) -> None:
    assume(abs(pose.tilt_deg) < 15)
    fov = FRAME.optics.hfov_deg(pose.zoom)
    halves = [observation(Pose(pose.pan_deg + side * fov * 0.25, pose.tilt_deg, pose.zoom * 0.8)) for side in (1, -1)]
    if pose.zoom * 0.8 >= 1:
        assert uncovered_part(evidence(pose), halves) is None
        assert uncovered_part(evidence(pose), halves[:1]) is not None


@given(POSES)
def test_only_a_sweep_covers_the_band_of_a_sweep(pose: Pose) -> None:
    sweep = FRAME.sweep()
    band = (sweep.bottom_tilt_deg + 1, sweep.top_tilt_deg - 1)
    around = evidence(pose, scope="full", band_deg=band)
    assert uncovered_part(around, [SWEEP]) is None
    assert uncovered_part(around, [observation(pose)]) is not None


def test_a_ring_of_frames_covers_the_same_as_a_sweep() -> None:
    around = evidence(Pose(), scope="full", band_deg=(-12.0, 12.0))
    assert uncovered_part(around, [observation(Pose(pan, 0.0, 1.0)) for pan in range(-180, 180, 30)]) is None
    assert uncovered_part(around, [observation(Pose(pan, 0.0, 1.0)) for pan in range(-180, 120, 30)]) is not None


@given(POSES, st.floats(0.5, 4.0), st.sampled_from([(1.0, 0.5), (0.0, 0.5), (0.5, 0.0), (0.5, 1.0), (1.0, 1.0)]))
def test_an_item_counts_if_its_whole_box_is_in_the_frame(pose: Pose, size: float, edge: tuple[float, float]) -> None:
    frame = observation(pose)
    assert is_clearly_shown(item_around(pose.pan_deg, pose.tilt_deg, size), frame)
    pan, tilt = pan_tilt_deg(frame.projection.directions(np.array(edge)))
    assert not is_clearly_shown(item_around(float(pan), float(tilt), size), frame)


def item_around(pan: float, tilt: float, size: float) -> Item:
    """Return an item centred on a direction. Its box of pans and tilts may cross 180 degrees."""
    low, high = pan - size / 2, pan + size / 2
    return Item(instance="x", box_deg=(low, tilt - size / 2, high if high <= 180 else high - 360, tilt + size / 2))


@given(PANS, st.floats(-30, 10), ZOOMS)
def test_objects_must_be_large_enough(pan: float, tilt: float, zoom: float) -> None:
    frame = observation(Pose(pan, tilt, zoom))
    pixels = density_px_per_deg(frame) * 1.0
    box = (pan - 0.25, tilt - 0.5, pan + 0.25, tilt + 0.5)
    assert is_clearly_shown(Item(instance="x", box_deg=box, min_px=pixels * 0.95), frame)
    assert not is_clearly_shown(Item(instance="x", box_deg=box, min_px=pixels * 1.1), frame)


@pytest.mark.parametrize(("zoom", "legible"), [(1.0, False), (5.0, True)])
def test_capitals_must_be_fourteen_pixels_high(zoom: float, legible: bool) -> None:
    text = Item(instance="t", box_deg=(0.0, 0.0, 2.0, 0.3), cap_height_deg=0.2)
    assert is_clearly_shown(text, observation(Pose(1.0, 0.1, zoom))) == legible


def test_only_perception_calls_about_the_object_at_that_time_count() -> None:
    pose = Pose(10, -10, 1)
    about = evidence(pose, about=("cone", "traffic cone"))
    assert uncovered_part(about, [observation(pose, request="orange traffic cones")]) is None
    assert uncovered_part(about, [observation(pose, request="How many cones are there?")]) is None
    assert uncovered_part(about, [observation(pose, request="clouds")]) is not None
    assert uncovered_part(about, [observation(pose, how="planner")]) is None
    timed = evidence(pose, window_s=(10.0, 20.0))
    assert uncovered_part(timed, [observation(pose, time_s=12.0)]) is None
    assert uncovered_part(timed, [observation(pose, time_s=22.0)]) is not None


@given(st.floats(-180, 180), st.floats(-40, 20), st.floats(0.1, 30), st.floats(0.1, 20))
def test_a_box_across_180_degrees_has_the_right_width(left: float, bottom: float, width: float, height: float) -> None:
    right = left + width
    outline = box_directions((left, bottom, right if right <= 180 else right - 360, bottom + height))
    pans, tilts = pan_tilt_deg(outline)
    turned = np.mod(pans - left + 180, 360) - 180
    assert turned.min() > -1e-6
    assert turned.max() < width + 1e-6
    assert tilts.max() < bottom + height + 1e-6


@given(POSES)
def test_reference_directions_are_in_the_reference_frame(pose: Pose) -> None:
    assert are_inside(observation(pose), reference_directions(evidence(pose))).all()
    assert not are_inside(observation(pose), direction([pose.pan_deg + 180.0], [-pose.tilt_deg])).any()


def test_a_perception_call_without_an_answer_covers_nothing() -> None:
    pose = Pose(10.0, -10.0, 1.0)
    assert uncovered_part(evidence(pose), [observation(pose, how="query", known=True)]) is None
    assert uncovered_part(evidence(pose), [observation(pose, how="query", known=False)]) is not None
