"""Relative moves, presets, home and pictures: the pose after every call and the clamped axes."""

from __future__ import annotations

import json
from typing import Any

import anyio
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.errors import ToolCallError, UnknownNameError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.get_presets import PresetsResult
from scope_ptz.tools.registry import TOOLS, parse_call, run_tool, schemas
from scope_ptz.tools.results import MoveResult, Result
from scope_ptz.tools.take_image import ImageResult
from tests.support.analytic import AnalyticCamera, AnalyticPerception, MemoryStore

NAMES = [
    "adjust_ptz",
    "go_to_preset",
    "go_home",
    "get_presets",
    "take_image",
    "count_objects",
    "query_answer",
    "zoom_to_object",
    "track_object",
]


def call(camera: AnalyticCamera, tool: str, **arguments: Any) -> Result:
    return anyio.run(run_tool, ToolContext(camera, AnalyticPerception([]), MemoryStore()), tool, arguments)


def test_the_papers_nine_tools_in_openai_format() -> None:
    listed = schemas()
    assert [s["function"]["name"] for s in listed] == NAMES
    for schema in listed:
        assert schema["type"] == "function"
        assert schema["function"]["description"]
        assert schema["function"]["parameters"]["type"] == "object"
        assert schema["function"]["parameters"]["additionalProperties"] is False
    json.dumps(listed, allow_nan=False)


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(pan=finite, tilt=finite, factor=st.floats(min_value=1e-300, allow_infinity=False))
def test_any_finite_move_ends_within_the_limits(pan: float, tilt: float, factor: float) -> None:
    camera = AnalyticCamera(start=Pose(170, 20, 2))
    result = call(camera, "adjust_ptz", pan_deg=pan, tilt_deg=tilt, zoom_factor=factor)
    limits = Limits()
    assert limits.min_pan_deg <= camera.now.pan_deg <= limits.max_pan_deg
    assert limits.min_tilt_deg <= camera.now.tilt_deg <= limits.max_tilt_deg
    assert limits.min_zoom <= camera.now.zoom <= limits.max_zoom
    assert ("pan" in result.clamped) == (not limits.min_pan_deg <= 170 + pan <= limits.max_pan_deg)
    assert ("tilt" in result.clamped) == (not limits.min_tilt_deg <= 20 + tilt <= limits.max_tilt_deg)


def test_right_is_positive_and_the_pan_stop_does_not_cause_a_turn_the_other_way() -> None:
    camera = AnalyticCamera()
    assert call(camera, "adjust_ptz", pan_deg=20, tilt_deg=-10).pose.pan_deg == 20
    assert call(camera, "adjust_ptz", pan_deg=300).pose.pan_deg == 179
    assert "stopped by the pan limit" in call(camera, "adjust_ptz", pan_deg=1).message


@pytest.mark.parametrize(
    ("arguments", "zoom"),
    [
        ({"zoom_factor": 2}, 4.0),
        ({"zoom_factor": 0.5}, 1.0),
        ({"zoom_percent": 50}, 3.0),
        ({"zoom_percent": -50}, 1.0),
        ({"zoom_limit": "in"}, 5.0),
        ({"zoom_limit": "out"}, 1.0),
        ({"zoom_factor": 1e300}, 5.0),
    ],
)
def test_zoom(arguments: dict[str, Any], zoom: float) -> None:
    assert call(AnalyticCamera(start=Pose(0, 0, 2)), "adjust_ptz", **arguments).pose.zoom == zoom


@pytest.mark.parametrize(
    ("name", "arguments", "says"),
    [
        ("fly", {}, "no tool 'fly'"),
        ("adjust_ptz", {"pan_deg": float("nan")}, "finite"),
        ("adjust_ptz", {"pan_deg": float("inf")}, "finite"),
        ("adjust_ptz", {"pan_deg": "20"}, "valid number"),
        ("adjust_ptz", {"pan_deg": True}, "valid number"),
        ("adjust_ptz", {"pan": 20}, "pan: Extra inputs"),
        ("adjust_ptz", {"zoom_factor": 2, "zoom_percent": 10}, "at most one"),
        ("adjust_ptz", {"zoom_factor": 0}, "greater than 0"),
        ("adjust_ptz", {"zoom_percent": -100}, "greater than -100"),
        ("go_to_preset", {}, "name"),
        ("go_to_preset", {"name": "  "}, "name"),
        ("count_objects", {"description": "cones", "view": "panorama"}, "view"),
        ("track_object", {"description": "van", "duration_s": -1}, "duration_s"),
        ("go_home", [], "JSON object"),
    ],
)
def test_invalid_calls_report_the_error_and_do_nothing(name: str, arguments: Any, says: str) -> None:
    with pytest.raises(ToolCallError, match=says):
        parse_call(name, arguments)


@given(name=st.sampled_from(NAMES), arguments=st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(), lambda c: st.lists(c) | st.dictionaries(st.text(), c)
))  # fmt: skip
def test_no_argument_value_breaks_the_parser(name: str, arguments: Any) -> None:
    try:
        tool, _ = parse_call(name, arguments)
    except ToolCallError as error:
        assert str(error)
    else:
        assert tool is TOOLS[name]


def test_presets_home_and_pictures() -> None:
    camera = AnalyticCamera()
    moved = call(camera, "go_to_preset", name="gate")
    assert isinstance(moved, MoveResult)
    assert (moved.pose.pan_deg, moved.pose.tilt_deg, moved.pose.zoom) == (40, -5, 2)
    assert call(camera, "go_home").pose.pan_deg == 0
    listed = call(camera, "get_presets")
    assert isinstance(listed, PresetsResult)
    assert listed.presets == ("gate",)
    picture = call(camera, "take_image")
    assert isinstance(picture, ImageResult)
    assert picture.file == "picture-1.png"


def test_an_unknown_preset_names_the_known_ones_and_moves_nothing() -> None:
    camera = AnalyticCamera()
    with pytest.raises(UnknownNameError, match=r"no preset 'gatte'.*Did you mean 'gate'"):
        call(camera, "go_to_preset", name="gatte")
    assert camera.visited == []
