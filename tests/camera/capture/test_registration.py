"""Registration of frames whose rotations, fields of view and tone are known exactly."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from scope_ptz.camera.capture.adjustment import adjust, rotation_angle_deg, rotation_matrix
from scope_ptz.camera.capture.matching import PairMatches, find_features, match_frames, overlapping_pairs
from scope_ptz.camera.capture.placed_frames import PlacedFrame
from scope_ptz.camera.capture.registration import measured_optics
from scope_ptz.camera.capture.tone import cell_means, gains
from scope_ptz.geometry import AXIS_M5075_G, Perspective, angle_between_deg, direction
from scope_ptz.geometry.sphere import camera_axes
from tests.camera.capture.worlds import HEIGHT, WIDTH, ray, seen

vectors = st.tuples(*[st.floats(-3, 3)] * 3).map(np.array)


def views_of_a_ring(count: int = 9, tilts: tuple[float, ...] = (-12.0, 12.0)) -> list[Perspective]:
    return [Perspective(-180 + 360 * k / count, tilt, 71.0, 1280, 720) for tilt in tilts for k in range(count)]


def exact_matches(views: list[Perspective], true: list[NDArray[np.float64]], focal_px: float, seed: int = 0) -> list[PairMatches]:
    """Return matches of random directions, as seen by cameras with the true axes and focal length."""
    random = np.random.default_rng(seed)
    found = []
    for i, j in overlapping_pairs(views):
        one = PlacedFrame(true[i], focal_px, 1280, 720)
        two = PlacedFrame(true[j], focal_px, 1280, 720)
        rays = one.directions(random.uniform(0, 1, (200, 2)))
        there = two.points(rays)
        shown = np.all((there > 0) & (there < 1), axis=-1)
        if shown.sum() >= 12:
            size = np.array([1280, 720])
            points = [(p[shown] - 0.5) * size * (1, -1) for p in (one.points(rays), there)]
            found.append(PairMatches(i, j, *points))
    return found


@given(vectors)
def test_a_rotation_keeps_lengths_and_turns_by_its_angle(vector: NDArray[np.float64]) -> None:
    turn = rotation_matrix(vector)
    assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    assert np.allclose(turn @ vector, vector, atol=1e-9)
    angle = float(np.linalg.norm(vector))
    expected = math.degrees(min(angle % (2 * math.pi), 2 * math.pi - angle % (2 * math.pi)))
    assert rotation_angle_deg(np.eye(3), turn) == pytest.approx(expected, abs=1e-4)


@pytest.mark.full
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**31), st.floats(0.0, 0.4), st.floats(0.97, 1.03), st.floats(-1.5, 1.5))
def test_errors_of_poses_and_of_the_focal_length_and_a_drift_are_found(
    seed: int, noise_deg: float, focal_factor: float, drift_deg: float
) -> None:
    views = views_of_a_ring()
    random = np.random.default_rng(seed)
    true = []
    for k, view in enumerate(views):
        pan = view.pan_deg + drift_deg * k / (len(views) - 1) + random.normal(0, noise_deg)
        axes = camera_axes(pan, view.tilt_deg + random.normal(0, noise_deg))
        true.append(axes @ rotation_matrix(random.normal(0, math.radians(noise_deg), 3)).T)
    focal_px = views[0].focal_px * focal_factor
    found = adjust(views, exact_matches(views, true, focal_px, seed))
    assert all(found.registered)
    assert found.focal_px[0] == pytest.approx(focal_px, rel=1e-3)
    # Only the reported poses determine the absolute orientation, so all errors share a common rotation.
    common = [own.T @ other for own, other in zip(found.axes, true, strict=True)]
    assert max(rotation_angle_deg(common[0], each) for each in common) < 0.02
    absolute_deg = [rotation_angle_deg(own, other) for own, other in zip(found.axes, true, strict=True)]
    assert max(absolute_deg) < 0.05 + 2.5 * noise_deg


def test_without_matches_reported_poses_stay() -> None:
    views = views_of_a_ring()
    found = adjust(views, [])
    assert not any(found.registered)
    assert found.residual_px is None
    assert all(np.allclose(own, camera_axes(v.pan_deg, v.tilt_deg)) for own, v in zip(found.axes, views, strict=True))


def test_wrong_matches_do_not_bend_the_result() -> None:
    views = views_of_a_ring()
    true = [camera_axes(view.pan_deg, view.tilt_deg) for view in views]
    matches = exact_matches(views, true, views[0].focal_px)
    random = np.random.default_rng(2)
    spoilt = []
    for pair in matches:
        points = pair.second_px.copy()
        wrong = random.random(len(points)) < 0.2
        points[wrong] += random.normal(0, 30, (int(wrong.sum()), 2))
        spoilt.append(replace(pair, second_px=points))
    found = adjust(views, spoilt)
    assert max(rotation_angle_deg(own, other) for own, other in zip(found.axes, true, strict=True)) < 0.02


@pytest.mark.parametrize("zoom", [1.0, 2.0])
def test_frames_are_matched_near_where_their_poses_expect_it(zoom: float) -> None:
    wide = Perspective(0.0, 0.0, 60.0, WIDTH, HEIGHT)
    other = Perspective(8.0, 4.0, 60.0 / zoom, WIDTH, HEIGHT)
    reported = [wide, replace(other, pan_deg=8.7, tilt_deg=3.4)]
    features = [find_features(seen(view)) for view in (wide, other)]
    matches = match_frames(reported, features.__getitem__)
    (pair,) = matches
    found = adjust(reported, matches)
    relative = found.axes[1] @ found.axes[0].T
    expected = camera_axes(other.pan_deg, other.tilt_deg) @ camera_axes(0.0, 0.0).T
    assert len(pair.first_px) >= 12
    assert rotation_angle_deg(relative, expected) < 0.3  # a pixel is 0.19 degrees, and the reported error 0.9


def test_hidden_parts_of_frames_have_no_features() -> None:
    image = seen(Perspective(0.0, 0.0, 60.0, WIDTH, HEIGHT))
    hidden = np.zeros((HEIGHT, WIDTH), bool)
    hidden[:, WIDTH // 2 :] = True
    assert len(find_features(image).points) > 0
    assert find_features(image, hidden).points[:, 0].max() <= 0
    assert len(find_features(np.full_like(image, 90)).points) == 0


def test_frames_get_the_same_tone() -> None:
    placed = [PlacedFrame(camera_axes(pan, 0.0), 300.0, WIDTH, HEIGHT) for pan in (0.0, 15.0, 30.0)]
    factors = np.array([[1.0, 1.0, 1.0], [0.8, 0.85, 0.9], [1.15, 1.1, 1.0]])
    images = [np.clip(seen(place.upright) * factor, 0, 255).astype(np.uint8) for place, factor in zip(placed, factors, strict=True)]
    found = gains(placed, [cell_means(image, None) for image in images], [(0, 1), (1, 2), (0, 2)])
    relative = found * factors
    assert np.allclose(relative, relative[0], rtol=0.04)


def test_the_zoom_table_is_corrected_by_what_was_measured() -> None:
    assert measured_optics(AXIS_M5075_G, []) == AXIS_M5075_G
    found = measured_optics(AXIS_M5075_G, [(1.0, 1.02), (4.0, 0.98)])
    assert found.focal(1.0) == pytest.approx(1.02 * AXIS_M5075_G.focal(1.0))
    assert found.focal(5.0) == pytest.approx(0.98 * AXIS_M5075_G.focal(5.0))
    assert measured_optics(AXIS_M5075_G, [(2.0, 1.0), (2.5, 0.5)]) == AXIS_M5075_G  # no lens has such a table


def test_a_placed_frame_is_the_view_of_its_pose() -> None:
    view = Perspective(30.0, -20.0, 50.0, WIDTH, HEIGHT)
    placed = PlacedFrame(camera_axes(30.0, -20.0), view.focal_px, WIDTH, HEIGHT)
    points = np.random.default_rng(0).random((20, 2))
    assert np.allclose(placed.directions(points), view.directions(points))
    assert np.allclose(placed.points(view.directions(points)), points)
    assert angle_between_deg(ray(placed.upright), direction(30.0, -20.0)) < 1e-9
    assert placed.max_off_axis_deg == pytest.approx(view.max_off_axis_deg)
