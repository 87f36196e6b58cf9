"""VAPIX requests: every value that a caller gives ends within what the device reads."""

from __future__ import annotations

import math
import re
from urllib.parse import parse_qs, urlencode

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.axis import requests
from scope_ptz.errors import InputError

ANY = st.floats(allow_nan=False, allow_infinity=False)


@given(pan=ANY, tilt=ANY, zoom=st.integers(-(10**6), 10**6))
def test_absolute_is_within_the_documented_ranges(pan: float, tilt: float, zoom: int) -> None:
    query = requests.absolute(1, pan, tilt, zoom).query
    assert all(re.fullmatch(r"-?\d+(\.\d+)?", query[axis]) for axis in ("pan", "tilt")), query
    assert -180 <= float(query["pan"]) <= 180
    assert -180 <= float(query["tilt"]) <= 180
    assert 1 <= int(query["zoom"]) <= 19999
    if abs(pan) <= 180:
        assert float(query["pan"]) == pytest.approx(pan, abs=1e-4)


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_absolute_refuses_what_is_no_number(wrong: float) -> None:
    with pytest.raises(InputError, match="finite"):
        requests.absolute(1, wrong, 0.0, 1)
    with pytest.raises(InputError, match="finite"):
        requests.absolute(1, 0.0, wrong, 1)


@given(pan=st.integers(), tilt=st.integers(), zoom=st.integers())
def test_speeds_are_within_a_hundred(pan: int, tilt: int, zoom: int) -> None:
    speeds = [int(v) for v in requests.continuous_pan_tilt(1, pan, tilt).query["continuouspantiltmove"].split(",")]
    assert [abs(v) <= 100 for v in speeds] == [True, True]
    assert [np_sign(v) for v in speeds] == [np_sign(pan), np_sign(tilt)]
    assert abs(int(requests.continuous_zoom(1, zoom).query["continuouszoommove"])) <= 100


def np_sign(value: int) -> int:
    return (value > 0) - (value < 0)


@given(name=st.text(max_size=40))
def test_a_preset_name_is_refused_or_sent_as_it_is(name: str) -> None:
    try:
        request = requests.save_preset(1, name)
    except InputError:
        assert not name.strip() or name != name.strip() or not name.isprintable() or len(name) > 31 or set(name) & set('"<>~:')
        return
    sent = parse_qs(urlencode(request.query, errors="surrogatepass"), errors="surrogatepass")
    assert sent["setserverpresetname"] == [name]
    assert set(request.query) == {"camera", "setserverpresetname"}


def test_stop_ends_every_kind_of_motion() -> None:
    sent = [next(iter({k: v for k, v in r.query.items() if k != "camera"}.items())) for r in requests.stop(1)]
    assert sent == [("continuouspantiltmove", "0,0"), ("continuouszoommove", "0"), ("move", "stop")]


def test_only_commands_that_add_up_are_not_repeated() -> None:
    assert not requests.relative_focus(1, 5).retryable
    assert not requests.relative_iris(1, 5).retryable
    assert requests.absolute(1, 0, 0, 1).retryable
    assert all(request.retryable for request in requests.stop(1))


def test_a_device_that_scales_velocities_is_told_not_to() -> None:
    assert requests.continuous_pan_tilt(1, 1, 1, proportional=True).query["proportionalspeed"] == "disabled"
    assert "proportionalspeed" not in requests.continuous_pan_tilt(1, 1, 1).query


def test_channels_begin_at_one() -> None:
    with pytest.raises(InputError, match="channel"):
        requests.home(0)
    assert requests.home(3).query == {"camera": "3", "move": "home"}
