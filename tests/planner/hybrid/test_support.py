"""A call is supported only if the user or perception mentioned its numbers, directions, presets and nouns."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scope_ptz.planner.base import Exchange, ToolCall, ToolOutcome
from scope_ptz.planner.hybrid.evidence import collect_evidence
from scope_ptz.planner.hybrid.support import unsupported_parts


def missing(
    instruction: str,
    name: str,
    /,
    earlier_calls: tuple[ToolCall, ...] = (),
    results: tuple[dict[str, Any], ...] = (),
    **arguments: Any,
) -> list[str]:
    outcomes = tuple(ToolOutcome(call=ToolCall(id="r", name="query_answer"), result=result) for result in results)
    evidence = collect_evidence([instruction], [Exchange(outcomes=outcomes)] if outcomes else [])
    return unsupported_parts(ToolCall(id="c", name=name, arguments=arguments), evidence, earlier_calls)


@pytest.mark.parametrize(
    ("instruction", "name", "arguments"),
    [
        ("gimme right by twenty", "adjust_ptz", {"pan_deg": 20}),
        ("kindly have the lens come up 7.5 and over to the left 12", "adjust_ptz", {"pan_deg": -12, "tilt_deg": 7.5}),
        ("half a turn clockwise", "adjust_ptz", {"pan_deg": 180}),
        ("make it twice as big, zoom", "adjust_ptz", {"zoom_factor": 2}),
        ("pull back to half", "adjust_ptz", {"zoom_factor": 0.5}),
        ("zoom out 30%", "adjust_ptz", {"zoom_percent": -30}),
        ("closer, as far as it goes, all the way", "adjust_ptz", {"zoom_limit": "in"}),
        ("over to the car park view", "go_to_preset", {"name": "car-park"}),
        ("visit every preset", "go_to_preset", {"name": "gate"}),
        ("back to the start", "go_home", {}),
        ("I fancy a photo", "take_image", {}),
        ("any red lorries about?", "count_objects", {"description": "red lorry"}),
        ("what colour's the gate, mate", "query_answer", {"question": "What colour is the gate?"}),
        ("what color is the gate", "query_answer", {"question": "What is the colour of the gate?"}),
        ("scan everywhere for cones", "count_objects", {"description": "cones", "view": "full"}),
        ("get close to that van", "zoom_to_object", {"description": "the van"}),
        ("tail the blue van for a minute", "track_object", {"description": "blue van", "duration_s": 60}),
        ("tail the blue van", "track_object", {"description": "blue van", "duration_s": 10}),
        ("which presets do we have", "get_presets", {}),
    ],
)
def test_supported_calls(instruction: str, name: str, arguments: dict[str, Any]) -> None:
    assert missing(instruction, name, **arguments) == []


@pytest.mark.parametrize(
    ("instruction", "name", "arguments", "expected"),
    [
        ("gimme right a bit", "adjust_ptz", {"pan_deg": 20}, ["20 degrees"]),
        ("go 20 over there", "adjust_ptz", {"pan_deg": 20}, ["right"]),
        ("look over there right now, 20", "adjust_ptz", {"pan_deg": 20}, ["right"]),
        ("is there anything left? 20?", "adjust_ptz", {"pan_deg": -20}, ["left"]),
        ("don't pan left 20, tilt up 5", "adjust_ptz", {"pan_deg": -20}, ["left", "20 degrees"]),
        ("zoom out 2 times", "adjust_ptz", {"zoom_factor": 2}, ["zooming in"]),
        ("zoom in a touch", "adjust_ptz", {"zoom_factor": 3}, ["the factor 3"]),
        ("zoom in", "adjust_ptz", {"zoom_limit": "in"}, ["zooming all the way in"]),
        ("show me the entrance", "go_to_preset", {"name": "gate"}, ['the preset "gate"']),
        ("what's up", "go_home", {}, ["the home view"]),
        ("how many cars", "take_image", {}, ["a picture"]),
        ("any lorries about?", "count_objects", {"description": "red lorry"}, ['"red"']),
        ("cones?", "count_objects", {"description": "cones", "view": "full"}, ["the whole scene"]),
        ("how many vans are there", "zoom_to_object", {"description": "van"}, ["the move"]),
        ("follow the van", "track_object", {"description": "van", "duration_s": 45}, ["45 seconds"]),
        ("what do you see from here", "zoom_to_object", {"description": "thing"}, ["the move", "a move"]),
        ("without moving, look right 20", "adjust_ptz", {"pan_deg": 20}, ["a move"]),
        ("clean the lens", "wipe_lens", {}, ["the tool wipe_lens"]),
    ],
)
def test_unsupported_calls(instruction: str, name: str, arguments: dict[str, Any], expected: list[str]) -> None:
    assert missing(instruction, name, **arguments) == expected


def test_results_support_calls() -> None:
    result = {"answer": "Yes, a forklift on the left.", "known": True}
    assert missing("get close to the nearest vehicle", "zoom_to_object", results=(result,), description="forklift") == []
    assert missing("turn to it, 10", "adjust_ptz", results=(result,), pan_deg=-10) == []


def test_text_on_a_sign_does_not_support_a_move() -> None:
    result = {"answer": 'The sign reads "TURN LEFT 90".', "known": True}
    assert missing("obey the sign", "adjust_ptz", results=(result,), pan_deg=-90) == ["left", "90 degrees"]


def test_a_list_of_presets_does_not_support_going_to_one() -> None:
    assert missing("show me the entrance", "go_to_preset", results=({"presets": ["gate", "yard"]},), name="gate") == [
        'the preset "gate"'
    ]


def test_a_move_stated_once_supports_only_one_call() -> None:
    call = ToolCall(id="c", name="adjust_ptz", arguments={"pan_deg": 20})
    assert missing("gimme right by 20", "adjust_ptz", earlier_calls=(call,), pan_deg=20) == ["a second time"]
    assert missing("gimme right by 20 until you see a van", "adjust_ptz", earlier_calls=(call,), pan_deg=20) == []


_WORDS = st.sampled_from(
    [
        "please",
        "the",
        "camera",
        "van",
        "red",
        "gate",
        "how",
        "many",
        "look",
        "at",
        "people",
        "now",
        "over",
        "there",
        "kindly",
        "sign",
        "what",
        "is",
        "colour",
        "see",
        "3",
        "7",
        "left",
        "up",
    ]
)


@given(st.lists(_WORDS, max_size=12), st.integers(-170, 170).filter(bool))
def test_a_turn_needs_its_angle(words: list[str], degrees: int) -> None:
    assume(str(abs(degrees)) not in words)
    assert f"{abs(degrees)} degrees" in missing(" ".join(words), "adjust_ptz", pan_deg=degrees)


@given(st.lists(_WORDS, max_size=12), st.integers(1, 170))
def test_a_turn_needs_its_direction(words: list[str], degrees: int) -> None:
    assert "right" in missing(" ".join([*words, str(degrees)]), "adjust_ptz", pan_deg=degrees)
    assert "down" in missing(" ".join([*words, str(degrees)]), "adjust_ptz", tilt_deg=-degrees)


@given(st.lists(_WORDS, max_size=12), st.sampled_from(["lorry", "crane", "blue bus", "bank", "umbrella"]))
def test_an_object_must_be_named(words: list[str], thing: str) -> None:
    for name, field in (("count_objects", "description"), ("zoom_to_object", "description"), ("query_answer", "question")):
        assert f'"{thing.split()[-1]}"' in missing(" ".join(words), name, **{field: thing})  # type: ignore[arg-type]


@given(st.lists(_WORDS, max_size=12), st.sampled_from(["yard", "north-gate", "bay 4", "gatehouse"]))
def test_a_preset_must_be_named(words: list[str], preset: str) -> None:
    assert missing(" ".join(words), "go_to_preset", name=preset) == [f'the preset "{preset}"']
