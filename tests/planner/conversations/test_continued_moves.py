"""Turns that continue, change or repeat the last move or pursuit."""

from __future__ import annotations

from typing import Any

import pytest

from tests.planner.conversations.talk import last_calls
from tests.planner.stage import Stage

YES = {"answer": "Yes, there is one.", "known": True}
BEHIND = {"answer": "A fence and a green skip are to the left of the crane.", "known": True}


@pytest.mark.parametrize(
    ("instructions", "arguments"),
    [
        (("pan left 20", "a bit more"), {"pan_deg": -5}),
        (("pan left 20", "another 7"), {"pan_deg": -7}),
        (("tilt up 10", "3 degrees more"), {"tilt_deg": 3}),
        (("pan left 20", "again", "a touch further"), {"pan_deg": -5}),
        (("pan left 20", "another 7", "again"), {"pan_deg": -7}),
        (("zoom in", "a bit more"), {"zoom_factor": 1.25}),
        (("pan left 20", "more"), {"pan_deg": -20}),
        (("pan left 20", "pan sideways", "the other way", "30"), {"pan_deg": 30}),
        (("pan left 20", "the other way", "again"), {"pan_deg": 20}),
    ],
)
def test_a_turn_continues_the_last_move(instructions: tuple[str, ...], arguments: dict[str, float]) -> None:
    calls, _ = last_calls(*instructions)
    assert calls == [("adjust_ptz", arguments)]


@pytest.mark.parametrize("before", ["go to the gate", "count the cones", "pan left 20 and tilt up 5"])
def test_more_of_nothing_is_asked_about(before: str) -> None:
    calls, reply = last_calls(before, "a bit more")
    assert not calls
    assert reply.endswith("?")


def test_the_other_way_asks_how_far_once_other_words_came_between() -> None:
    assert last_calls("pan left 20", "pan", "the other way") == ([], "By how many degrees shall I pan right?")
    assert last_calls("zoom in 3x", "pan", "the other way") == ([], "By what factor shall I zoom out?")


@pytest.mark.parametrize(("instruction", "preset"), [("go to the next preset", "highway"), ("and the previous one", "highway")])
def test_presets_have_neighbours(instruction: str, preset: str) -> None:
    assert last_calls("go to the gate", instruction)[0] == [("go_to_preset", {"name": preset})]


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("go to the gate", "no, the highway"), [("go_to_preset", {"name": "highway"})]),
        (("count the vans", "and the cars?"), [("count_objects", {"description": "cars", "view": "current"})]),
        (("count the vans", "and now?"), [("count_objects", {"description": "vans", "view": "current"})]),
        (("take a picture", "two more"), [("take_image", {}), ("take_image", {})]),
        (("track the van", "for 20 seconds"), [("track_object", {"description": "van", "duration_s": 20})]),
        (("go home", "and the gate?"), [("go_to_preset", {"name": "gate"})]),
    ],
)
def test_a_turn_changes_or_repeats_the_last_one(instructions: tuple[str, ...], expected: list[tuple[str, dict[str, Any]]]) -> None:
    assert last_calls(*instructions)[0] == expected


def test_long_conversations_stay_fast() -> None:
    turn = Stage([1]).turn("pan left 20")
    more = [turn.model_copy(update={"instruction": "a bit more"}) for _ in range(3000)]
    assert Stage([1]).turn("a bit more", (turn, *more[:20])).exchanges[0].outcomes[0].call.arguments == {"pan_deg": -5}
    Stage([1]).run("again", (turn, *more))


def test_no_is_not_a_command() -> None:
    assert last_calls("pan left 20", "no") == ([], "Then I do nothing. What shall I do instead?")


def test_another_thing_is_followed_for_as_long_from_where_the_camera_is() -> None:
    earlier = "follow the man with the clipboard for 5 seconds"
    calls, _ = last_calls(earlier, "now the one with the wheelbarrow")
    assert calls == [("track_object", {"description": "man with the wheelbarrow", "duration_s": 5})]


@pytest.mark.parametrize("instruction", ["zoom in on it 3x", "zoom in 3x on the van", "zoom in on the van by 3x"])
def test_a_factor_for_a_close_up_of_a_thing_is_asked_about(instruction: str) -> None:
    calls, reply = last_calls("is there a van?", instruction, looks=(YES,))
    assert not calls
    assert reply == "A thing I zoom in on fills the view. Shall I do that, or zoom where I look now?"


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("zoom in on the statue", "now on the fountain"), ("zoom_to_object", {"description": "fountain"})),
        (("zoom in on the red car", "no not that, the green car"), ("zoom_to_object", {"description": "green car"})),
        (
            ("how many people are in the left half?", "sorry, the right half"),
            ("count_objects", {"description": "people in the right half", "view": "current"}),
        ),
    ],
)
def test_the_same_is_done_with_another_thing(instructions: tuple[str, ...], expected: tuple[str, dict[str, Any]]) -> None:
    assert last_calls(*instructions, looks=(True,))[0][-1] == expected


def test_half_of_a_turn_is_asked_about() -> None:
    assert last_calls("pan left 20", "half of that") == ([], "Shall I pan left 10 degrees instead, or 10 degrees more?")
    assert last_calls("pan left 20", "half of that", "instead")[0] == [("adjust_ptz", {"pan_deg": 10})]
    assert last_calls("pan left 20", "half of that", "more")[0] == [("adjust_ptz", {"pan_deg": -10})]


def test_nothing_is_followed_until_something_happens() -> None:
    calls, reply = last_calls("is there a worker?", "follow him until he leaves", looks=(YES,))
    assert not calls
    assert reply == "I follow things for a time that you give me. For how many seconds shall I follow it?"


@pytest.mark.parametrize("before", ["pan left 20", "zoom in on the crane"])
def test_to_the_right_turns_the_camera_after_other_turns(before: str) -> None:
    calls, _ = last_calls("what is to the left of the crane?", before, "to the right 10", looks=(BEHIND, True, True))
    assert calls == [("adjust_ptz", {"pan_deg": 10})]


@pytest.mark.parametrize("said", ["copy that, now back to centre", "back to the centre", "go back to the centre please"])
def test_the_centre_to_go_back_to_is_asked_about(said: str) -> None:
    calls, reply = last_calls("pan left 20", said)
    assert not calls
    assert reply.startswith("Where is the centre?")
