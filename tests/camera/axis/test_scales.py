"""Units of AXIS devices: what goes there comes back."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.axis.scales import SpeedScale, ZoomScale, build_optics, build_zoom_scale
from scope_ptz.geometry import AXIS_M5075_G

DOCUMENTED = ZoomScale(((1, 1), (3868, 2), (7736, 3), (9999, 3.584961)))
SPEEDS = SpeedScale(((1, 0.05), (9, 0.16), (14, 2), (24, 2.1), (40, 9), (58, 28), (80, 74), (100, 150)))


@given(zoom=st.floats(1.0, 3.584961))
def test_zoom_comes_back(zoom: float) -> None:
    assert DOCUMENTED.to_zoom(DOCUMENTED.to_units(zoom)) == pytest.approx(zoom, abs=2e-4)


@given(low=st.floats(1.0, 3.5), high=st.floats(1.0, 3.5))
def test_more_zoom_is_more_units(low: float, high: float) -> None:
    assert (DOCUMENTED.to_units(low) <= DOCUMENTED.to_units(high)) == (
        low <= high or DOCUMENTED.to_units(low) == DOCUMENTED.to_units(high)
    )


@given(dps=st.floats(-1000, 1000, allow_subnormal=False))
def test_a_speed_keeps_its_sign_and_moves(dps: float) -> None:
    speed = SPEEDS.to_speed(dps)
    assert -100 <= speed <= 100
    assert (speed > 0) == (dps > 0)
    assert (speed < 0) == (dps < 0)


def test_documented_speeds() -> None:
    assert [SPEEDS.to_speed(dps) for dps in (28, -74, 150, 9999)] == [58, -80, 100, 100]


def test_the_optics_of_the_m5075_follow_from_its_two_fields_of_view() -> None:
    scale = build_zoom_scale(((1, 1), (9999, 5)), 1, 9999, 71.0, 14.0)
    optics = build_optics(scale, ((0.0, 71.0), (1.0, 14.0)))
    for zoom, hfov_deg in AXIS_M5075_G.table:
        assert optics.hfov_deg(zoom) == pytest.approx(hfov_deg, abs=0.1)


def test_digital_zoom_is_left_out() -> None:
    scale = build_zoom_scale(((1, 1), (9999, 30), (19999, 360)), 1, 19999, 60.0, 2.0)
    assert scale.max_zoom == 30
    assert build_zoom_scale((), 1, 19999, 60.0, 2.0).table[-1][0] == 9999
