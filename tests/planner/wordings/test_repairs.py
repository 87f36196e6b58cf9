"""Corrections, denials, order and amounts that refer to the turn before."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.planner.plan import plan

PRESETS = ("gate", "dock", "yard")


def calls(instruction: str) -> list[tuple[str, dict[str, Any]]] | None:
    made = plan(instruction, PRESETS)
    return [(call.name, call.arguments) for call in made.calls] if made.understood else None


def pan(degrees: float) -> tuple[str, dict[str, Any]]:
    return ("adjust_ptz", {"pan_deg": degrees})


def tilt(degrees: float) -> tuple[str, dict[str, Any]]:
    return ("adjust_ptz", {"tilt_deg": degrees})


def go(name: str) -> tuple[str, dict[str, Any]]:
    return ("go_to_preset", {"name": name})


PICTURE: tuple[str, dict[str, Any]] = ("take_image", {})


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("pan left 20, sorry, I meant right 30", [pan(30)]),
        ("pan left, I mean right, 20", [pan(20)]),
        ("pan right thirty, no, the other way", [pan(-30)]),
        ("pan right 10, no, 20 the other way", [pan(-20)]),
        ("pan left 20, scratch that, tilt down 5", [tilt(-5)]),
        ("left 12, excuse me, I do mean right 12", [pan(12)]),
        ("up 10, negative, up 14", [tilt(14)]),
        ("go to the gate - actually make that the dock", [go("dock")]),
        ("pan left 20 and tilt up 10, no, down 5", [("adjust_ptz", {"pan_deg": -20, "tilt_deg": -5})]),
    ],
)
def test_repairs_replace_what_they_name(instruction: str, expected: list[Any]) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "left 20 up 10, no, right 20",
        "pan left 20, tilt up 5, scratch that, go home",
        "pan left 20, wait, tilt down 5",
        "pan left 20 degrees, no, 2x",
        "zoom out - sorry, in - 2x",
        "gate, no hang on, let's do the other thing",
    ],
)
def test_unclear_repairs_are_asked_about(instruction: str) -> None:
    assert calls(instruction) is None


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("pan right, not left, 20", [pan(20)]),
        ("go to the gate, not the dock", [go("gate")]),
        ("not the dock, I want the yard", [go("yard")]),
        ("pan left 20 without zooming", [pan(-20)]),
    ],
)
def test_denials_beside_what_is_meant_change_nothing(instruction: str, expected: list[Any]) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("pan left 20, but first take a picture", [PICTURE, pan(-20)]),
        ("pan left 20, take a picture first", [PICTURE, pan(-20)]),
        ("take a picture first, then pan left 20", [PICTURE, pan(-20)]),
        ("tilt up 5, having first panned left 30", [pan(-30), tilt(5)]),
        ("tilt down 6 once you are at the gate", [go("gate"), tilt(-6)]),
        ("first up 10, second left 20, third a photo", [tilt(10), pan(-20), PICTURE]),
    ],
)
def test_order_follows_the_words(instruction: str, expected: list[Any]) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("pan right 40, then half of that back", [pan(40), pan(-20)]),
        ("pan left 30, then twice as much to the right", [pan(-30), pan(60)]),
        ("pan left 30 and then half as far up", [pan(-30), tilt(15)]),
        ("left 20, then 30 the other way", [pan(-20), pan(30)]),
        ("ten left, then the same again right", [pan(-10), pan(10)]),
    ],
)
def test_amounts_refer_to_the_turn_before(instruction: str, expected: list[Any]) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "look at 3 o'clock",
        "the camera panned left",
        "you should have panned left 20",
        "pan left 20 but do not move",
        "left 20 and at the same time right 20",
        "pan left by two screens",
        "three times as far to the right",
        "turn left at the lights",
    ],
)
def test_doubtful_moves_are_asked_about(instruction: str) -> None:
    assert calls(instruction) is None


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Pan right eighteen degrees. On second thoughts, make that eleven.", [pan(11)]),
        ("Pan left 14. Wait, wrong sign: pan right 14.", [pan(14)]),
        ("Tilt down 9. My mistake, up 9.", [tilt(9)]),
        ("pan left 30, wait no, make that 35", [pan(-35)]),
    ],
)
def test_words_that_introduce_a_correction_do_not_take_it_back(instruction: str, expected: list[Any]) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    "instruction", ["Pan right eighteen degrees. On second thoughts.", "Pan left 14, then tilt up 3. Wrong sign."]
)
def test_the_same_words_at_the_end_are_asked_about(instruction: str) -> None:
    assert calls(instruction) is None


def zoom(factor: float) -> tuple[str, dict[str, Any]]:
    return ("adjust_ptz", {"zoom_factor": factor})


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("tilt up a bit... no, down a bit", tilt(-5)),
        ("right a little - sorry, left a little", pan(-5)),
        ("zoom out a bit, no, in a bit", zoom(1.25)),
        ("zoom in twice, sorry, only once", zoom(2)),
        ("pan left 40... less, say 15", pan(-15)),
        ("pan left 40 degrees. That's too far, make it 15", pan(-15)),
        ("zoom in 5x, too much, 3x", zoom(3)),
        ("tilt down 12. No, left 7", pan(-7)),
        ("pan left 12, sorry, up 7", tilt(7)),
        ("follow the white van, sorry, the green one", ("track_object", {"description": "green van", "duration_s": 10})),
        ("zoom in on the tall crane... no, the small one", ("zoom_to_object", {"description": "small crane"})),
        ("count the empty barrows, no, the full ones", ("count_objects", {"description": "full barrows", "view": "current"})),
    ],
)
def test_the_second_half_of_a_message_replaces_the_first(instruction: str, expected: tuple[str, dict[str, Any]]) -> None:
    assert calls(instruction) == [expected]


@pytest.mark.parametrize(
    "instruction",
    [
        "pan right 30, less, say 45",
        "pan right 30. Too much, 10",
        "pan left 20 and tilt up 10, no, right 5",
    ],
)
def test_a_second_half_that_does_not_fit_is_asked_about(instruction: str) -> None:
    assert calls(instruction) is None
