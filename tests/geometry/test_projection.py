"""Conversion between pixels and directions for any pose, with the sign conventions of operators."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.geometry import (
    AXIS_M5075_G,
    Equirectangular,
    Limits,
    Optics,
    Perspective,
    Pose,
    angle_between_deg,
    direction,
    pan_tilt_deg,
    wrap_pan_deg,
)

pans = st.floats(-180, 180)
tilts = st.floats(-89, 89)
unit = st.floats(0, 1)
zooms = st.floats(1, 5)
views = st.builds(Perspective, pans, tilts, st.floats(2, 120), st.sampled_from([64, 1280]), st.sampled_from([48, 720]))


@given(pans, tilts)
def test_direction_and_back(pan: float, tilt: float) -> None:
    back_pan, back_tilt = pan_tilt_deg(direction(pan, tilt))
    assert float(back_tilt) == pytest.approx(tilt, abs=1e-9)
    assert wrap_pan_deg(float(back_pan) - pan) == pytest.approx(0, abs=1e-6)


@given(st.floats(-1e6, 1e6))
def test_wrapping_keeps_the_direction_and_the_range(pan: float) -> None:
    wrapped = wrap_pan_deg(pan)
    assert -180 < wrapped <= 180
    assert math.isclose(math.cos(math.radians(pan)), math.cos(math.radians(wrapped)), abs_tol=1e-6)


@given(views, unit, unit)
def test_view_pixel_to_direction_and_back(view: Perspective, x: float, y: float) -> None:
    ray = view.directions((x, y))
    assert float(np.linalg.norm(ray)) == pytest.approx(1.0)
    np.testing.assert_allclose(view.points(ray), (x, y), atol=1e-9)


@given(views)
def test_middle_of_a_view_is_its_aim(view: Perspective) -> None:
    assert float(angle_between_deg(view.directions((0.5, 0.5)), direction(view.pan_deg, view.tilt_deg))) < 1e-6


@given(views)
def test_field_of_view_is_the_angle_between_its_sides(view: Perspective) -> None:
    sides = view.directions([[0.0, 0.5], [1.0, 0.5]])
    assert float(angle_between_deg(sides[0], sides[1])) == pytest.approx(view.hfov_deg, abs=1e-6)
    ends = view.directions([[0.5, 0.0], [0.5, 1.0]])
    assert float(angle_between_deg(ends[0], ends[1])) == pytest.approx(view.vfov_deg, abs=1e-6)


@given(views, unit, unit)
def test_reach_holds_every_pixel(view: Perspective, x: float, y: float) -> None:
    assert float(angle_between_deg(view.directions((x, y)), view.directions((0.5, 0.5)))) <= view.max_off_axis_deg + 1e-6


@given(pans, st.floats(-60, 30), st.floats(1, 60))
def test_right_is_right_and_up_is_up(pan: float, tilt: float, by_deg: float) -> None:
    view = Perspective(pan, tilt, 71.0, 1280, 720)
    by = by_deg * 0.3
    assert view.points(direction(pan, tilt + by))[1] < 0.5
    assert view.points(direction(pan + by, tilt))[0] > 0.5


@given(views)
def test_points_behind_the_camera_have_no_pixel(view: Perspective) -> None:
    assert np.isnan(view.points(-view.directions((0.5, 0.5)))).all()


@given(pans, st.floats(10, 360), unit, unit)
def test_panorama_pixel_to_direction_and_back(left: float, span: float, x: float, y: float) -> None:
    panorama = Equirectangular(left, span, 50.0, -80.0, 1000, 400)
    px, py = panorama.points(panorama.directions((x, y)))
    assert py == pytest.approx(y, abs=1e-9)
    assert (px - x) * span == pytest.approx(0, abs=1e-6) or abs((px - x) * span) == pytest.approx(360, abs=1e-6)


def test_panorama_columns_run_clockwise_from_the_left_edge() -> None:
    panorama = Equirectangular(-180.0, 360.0, 90.0, -90.0, 360, 180)
    np.testing.assert_allclose(panorama.points(direction([-90.0, 0.0, 90.0], 0.0))[:, 0], [0.25, 0.5, 0.75])


@given(zooms, zooms)
def test_more_zoom_is_a_narrower_field_of_view(a: float, b: float) -> None:
    if a < b:
        assert AXIS_M5075_G.hfov_deg(a) > AXIS_M5075_G.hfov_deg(b) or b - a < 1e-9


@given(zooms)
def test_zoom_to_field_and_back(zoom: float) -> None:
    assert AXIS_M5075_G.zoom_for_hfov(AXIS_M5075_G.hfov_deg(zoom)) == pytest.approx(zoom, abs=1e-6)


def test_the_zoom_table_ends_at_the_values_of_the_data_sheet() -> None:
    assert AXIS_M5075_G.hfov_deg(1.0) == pytest.approx(71.0)
    assert AXIS_M5075_G.hfov_deg(5.0) == pytest.approx(14.0)
    assert AXIS_M5075_G.hfov_deg(0.1) == pytest.approx(71.0)
    assert AXIS_M5075_G.hfov_deg(99.0) == pytest.approx(14.0)


@pytest.mark.parametrize(
    "table", [((1.0, 71.0),), ((1.0, 71.0), (1.0, 60.0)), ((1.0, 50.0), (2.0, 60.0)), ((2.0, 50.0), (1.0, 60.0))]
)
def test_a_zoom_table_out_of_order_is_refused(table: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ValueError, match="zoom table"):
        Optics(table)


@given(st.floats(-1000, 1000), st.floats(-1000, 1000), st.floats(0.01, 100), st.booleans())
def test_clamping_respects_limits_and_names_the_clamped_axes(pan: float, tilt: float, zoom: float, endless: bool) -> None:
    limits = Limits(pan_endless=endless)
    wanted = Pose(pan, tilt, zoom)
    got, cut = limits.clamp(wanted)
    assert limits.clamp(got) == (got, ())
    assert ("tilt" in cut) == (not -60 <= tilt <= 30)
    assert ("zoom" in cut) == (not 1 <= zoom <= 5)
    assert ("pan" in cut) == (not endless and not -179 <= pan <= 179)
    if not endless and "pan" in cut:
        assert got.pan_deg == math.copysign(179.0, pan)


@given(st.floats(-1000, 1000))
def test_aiming_takes_the_turn_that_the_stops_allow(pan: float) -> None:
    limits = Limits(min_pan_deg=-10.0, max_pan_deg=340.0)
    aim = limits.aim_pan_deg(pan)
    assert wrap_pan_deg(aim - pan) == pytest.approx(0.0, abs=1e-6) or abs(wrap_pan_deg(aim - pan)) == pytest.approx(360.0)
    if (pan + 10) % 360 <= 350:
        assert -10.0 <= aim <= 340.0 or (pan + 10) % 360 < 1e-6 or (pan + 10) % 360 > 350 - 1e-6


@pytest.mark.parametrize("bad", [(math.nan, 0, 1), (0, math.inf, 1), (0, 0, 0), (0, 0, -2)])
def test_an_invalid_pose_is_refused(bad: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match=r"finite|positive"):
        Pose(*bad)
