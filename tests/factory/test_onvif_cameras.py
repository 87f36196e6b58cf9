"""Specs of ONVIF cameras: options are validated before a connection is opened."""

from __future__ import annotations

import pytest

from scope_ptz.errors import InputError
from scope_ptz.factory.cameras import parse_camera


@pytest.mark.parametrize(
    "text",
    [
        "onvif://op@10.0.0.7",
        "onvif://op@10.0.0.7:8080?tls=on&stream=snapshot&width=1920",
        "onvif://op@cam.local?pan_min=170&pan_max=-170&tilt_min=-90&tilt_max=20&hfov_wide=60&hfov_tele=3&profile=main",
    ],
)
def test_good_specs(text: str) -> None:
    assert parse_camera(text).scheme == "onvif"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("onvif://op:secret@10.0.0.7", "password"),
        ("onvif://op@10.0.0.7?stream=mjpeg", "rtsp or snapshot"),
        ("onvif://op@10.0.0.7?pan_min=1", "pan_max"),
        ("onvif://op@10.0.0.7?pan_min=1&pan_max=1", "different"),
        ("onvif://op@10.0.0.7?tilt_min=nan&tilt_max=1", "tilt_min"),
        ("onvif://op@10.0.0.7?hfov_wide=60", "hfov_tele"),
        ("onvif://op@10.0.0.7?channel=2", "channel"),
        ("onvif://", "user@host"),
    ],
)
def test_wrong_specs(text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason) as excinfo:
        parse_camera(text)
    assert "secret" not in str(excinfo.value)
