"""VAPIX replies: the documented ones are read, and anything else ends in a camera error."""

from __future__ import annotations

import json
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.axis import replies
from scope_ptz.camera.axis.replies import VapixError
from scope_ptz.camera.network.errors import CameraReplyError
from scope_ptz.errors import CameraError

PARSERS = [
    replies.parse_position,
    replies.parse_limits,
    replies.parse_presets,
    replies.parse_queue,
    lambda body: replies.parse_table(body, 1, "zoomSteps", "zoom"),
    replies.check_done,
]

LIMITS = b"MinPan=-170\nMaxPan=170\nMinTilt=-20\nMaxTilt=90\nMinZoom=1\nMaxZoom=9999\nMinFieldAngle=22\nMaxFieldAngle=623\n"


@pytest.mark.parametrize("parse", PARSERS)
@given(body=st.binary(max_size=300))
def test_any_bytes_are_read_or_refused(parse: object, body: bytes) -> None:
    assert callable(parse)
    try:
        parse(body)
    except CameraError as error:
        assert str(error).isprintable()


@given(text=st.text(max_size=300))
def test_an_error_of_the_device_is_shown_in_one_printable_line(text: str) -> None:
    with pytest.raises(VapixError) as caught:
        replies.parse_position(f"Error: {text}".encode("utf-8", "replace"))
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 200


def test_position() -> None:
    found = replies.parse_position(
        b"pan=51.2891\r\ntilt=-46.1914\r\nzoom=1\r\niris=6427\r\nfocus=8265\r\nautofocus=off\r\nautoiris=on\r\n"
    )
    assert (found.pan_deg, found.tilt_deg, found.zoom_units, found.autofocus, found.autoiris) == (
        51.2891,
        -46.1914,
        1.0,
        False,
        True,
    )


@pytest.mark.parametrize(
    "body", [b"", b"pan=1\ntilt=2", b"pan=nan\ntilt=1\nzoom=1", b"pan=1e999\ntilt=1\nzoom=1", b"<html>pan=1</html>"]
)
def test_a_position_without_numbers_is_refused(body: bytes) -> None:
    with pytest.raises(CameraReplyError):
        replies.parse_position(body)


def test_limits() -> None:
    found = replies.parse_limits(LIMITS)
    assert (found.min_pan_deg, found.max_tilt_deg, found.max_zoom_units) == (-170.0, 90.0, 9999.0)
    assert (found.min_field_angle, found.max_field_angle) == (22.0, 623.0)
    assert replies.parse_limits(LIMITS.replace(b"FieldAngle", b"Nothing")).max_field_angle is None


def test_limits_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(CameraReplyError, match="not below"):
        replies.parse_limits(LIMITS.replace(b"MaxPan=170", b"MaxPan=-170"))


def test_presets_come_in_the_order_of_their_numbers_and_in_either_encoding() -> None:
    text = "Preset Positions for camera 1\r\npresetposno10=Tür\r\npresetposno2=Gate 2=b\r\npresetposno1=Home\r\npresetposno3=\r\n"
    for encoding in ("utf-8", "iso-8859-1"):
        assert replies.parse_presets(text.encode(encoding)) == {1: "Home", 2: "Gate 2=b", 10: "Tür"}


def test_the_documented_zoom_table() -> None:
    steps = [("1", "1"), ("3868", "2"), ("7736", "3"), ("9999", "3.584961")]
    reply = {"Camera 1": {"maxOpticalZoomMag": "30", "zoomSteps": [{"value": v, "zoom": z} for v, z in steps]}}
    found = replies.parse_table(json.dumps(reply).encode(), 1, "zoomSteps", "zoom")
    assert found == ((1.0, 1.0), (3868.0, 2.0), (7736.0, 3.0), (9999.0, 3.584961))
    assert replies.parse_table(json.dumps(reply).encode(), 2, "zoomSteps", "zoom") == ()


@given(rows=st.lists(st.tuples(st.floats(), st.floats()), max_size=12))
def test_a_table_rises_whatever_the_device_says(rows: list[tuple[float, float]]) -> None:
    reply = {"Camera 1": {"speeds": [{"value": str(v), "speed": str(s)} for v, s in rows]}}
    found = replies.parse_table(json.dumps(reply).encode(), 1, "speeds", "speed")
    assert all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(found))
    assert all(speed > 0 for _, speed in found)


def test_queue() -> None:
    found = replies.parse_queue(b'<a name="3"></a><a name="410"></a><a name="5"></a>')
    assert (found.place, found.seconds, found.poll_s) == (3, 410, 5)
    assert replies.parse_queue(b'<a name="1"></a><a name="-1"></a><a name="0"></a>').seconds == -1
    with pytest.raises(VapixError, match="queue is full"):
        replies.parse_queue(b"Error: the queue is full")
    with pytest.raises(CameraReplyError):
        replies.parse_queue(b"<html></html>")


def test_errors_of_parameters() -> None:
    with pytest.raises(VapixError, match="getting param"):
        replies.decode_text(b"# Error: Error -1 getting param in group 'root.Nothing'")
    replies.check_done(b"")
