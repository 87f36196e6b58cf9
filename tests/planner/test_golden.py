"""The exact plans of the design's example instructions."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.planner.plan import plan

PRESETS = ("gate", "highway")
GOLDEN: list[tuple[str, list[tuple[str, dict[str, Any]]]]] = [
    ("pan right 20 degrees and tilt down ten", [("adjust_ptz", {"pan_deg": 20, "tilt_deg": -10})]),
    ("pan right 20, then tilt down 10", [("adjust_ptz", {"pan_deg": 20}), ("adjust_ptz", {"tilt_deg": -10})]),
    ("zoom in 2x", [("adjust_ptz", {"zoom_factor": 2})]),
    ("zoom out 50%", [("adjust_ptz", {"zoom_percent": -50})]),
    ("zoom all the way out", [("adjust_ptz", {"zoom_limit": "out"})]),
    ("how many cones are visible right now?", [("count_objects", {"description": "cones", "view": "current"})]),
    ("sweep the scene and count all cars", [("count_objects", {"description": "cars", "view": "full"})]),
    (
        "zoom in on the gantry sign and read it",
        [
            ("zoom_to_object", {"description": "gantry sign"}),
            ("query_answer", {"question": "What does the gantry sign say?", "view": "current"}),
        ],
    ),
    ("go to gate, take a picture, go home", [("go_to_preset", {"name": "gate"}), ("take_image", {}), ("go_home", {})]),
    (
        "go to the highway preset, then pan right in 15 degree steps until you see six cones",
        [("go_to_preset", {"name": "highway"}), ("count_objects", {"description": "cones", "view": "current"})],
    ),
    (
        "if you see a truck, zoom in on it",
        [("count_objects", {"description": "truck", "view": "current"}), ("zoom_to_object", {"description": "truck"})],
    ),
    (
        "which preset shows more cars, gate or highway?",
        [
            ("go_to_preset", {"name": "gate"}),
            ("count_objects", {"description": "cars", "view": "current"}),
            ("go_to_preset", {"name": "highway"}),
            ("count_objects", {"description": "cars", "view": "current"}),
        ],
    ),
    ("track the white van for 15 seconds", [("track_object", {"description": "white van", "duration_s": 15})]),
    ("what colour is the door?", [("query_answer", {"question": "what colour is the door?", "view": "current"})]),
]


@pytest.mark.parametrize(("instruction", "calls"), GOLDEN, ids=[text for text, _ in GOLDEN])
def test_golden_plan(instruction: str, calls: list[tuple[str, dict[str, Any]]]) -> None:
    made = plan(instruction, PRESETS)
    assert made.understood
    assert made.clarification is None
    assert [(call.name, call.arguments) for call in made.calls] == calls
