"""The cameras of a .blend file as the viewpoints of one camera, from the worker's description."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.blender.file_cameras import file_cameras

DESCRIPTION: dict[str, Any] = {
    "name": "my-yard",
    "title": "My Yard.blend",
    "blender_version": "5.0.1",
    "active": "tele",
    "cameras": [
        {"name": "wide", "title": "Wide", "position_m": [0.0, 0.0, 6.0], "bearing_deg": 20.0, "tilt_deg": -20.0, "hfov_deg": 80.0},
        {"name": "tele", "title": "TELE", "position_m": [9.0, 1.0, 4.0], "bearing_deg": -40.0, "tilt_deg": -90.0, "hfov_deg": 10.0},
    ],
}


def test_each_camera_is_a_viewpoint_with_a_preset_of_its_view() -> None:
    made = file_cameras(DESCRIPTION)
    assert [viewpoint.name for viewpoint in made.scene.viewpoints] == ["wide", "tele"]
    assert made.scene.home_preset == "tele"
    for preset, camera in zip(made.scene.presets, DESCRIPTION["cameras"], strict=True):
        assert made.optics.hfov_deg(preset.zoom) == pytest.approx(camera["hfov_deg"])
        assert preset.tilt_deg == camera["tilt_deg"]


def test_zoom_and_tilt_limits_include_every_camera() -> None:
    made = file_cameras(DESCRIPTION)
    assert made.limits.max_zoom == pytest.approx(made.scene.presets[1].zoom) == pytest.approx(9.59, abs=0.01)
    assert made.limits.min_tilt_deg == -90.0
    assert made.limits.pan_endless


def test_a_single_camera_can_zoom() -> None:
    made = file_cameras({**DESCRIPTION, "active": "wide", "cameras": DESCRIPTION["cameras"][:1]})
    assert made.limits.max_zoom == 5.0
    assert made.optics.hfov_deg(1.0) == 80.0
