"""Turns that compare, add up or follow up counts of earlier turns, and the places where they were made."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.planner.base import PastTurn
from tests.planner.conversations.talk import last_calls
from tests.planner.stage import Stage

YES = {"answer": "Yes, there is one.", "known": True}


def test_another_number_asks_about_the_same_thing_there() -> None:
    calls, _ = last_calls("is there a lorry at dock 5?", "what about dock 6?", looks=(YES, YES))
    assert calls == [("query_answer", {"question": "is there a lorry at dock 6?", "view": "current"})]


def test_a_question_is_repeated_at_another_preset() -> None:
    calls, _ = last_calls("how many cones are there?", "and at the gate?")
    assert calls == [("go_to_preset", {"name": "gate"}), ("count_objects", {"description": "cones", "view": "current"})]


def test_a_share_of_the_last_count_is_counted() -> None:
    calls, _ = last_calls("how many people are there?", "how many are sitting down?")
    assert calls == [("count_objects", {"description": "people sitting down", "view": "current"})]


def test_counts_of_earlier_turns_are_compared() -> None:
    calls, reply = last_calls("go to the highway", "count the cones", "and at the gate?", "which has more?", looks=(4, 1, 4, 1))
    assert [name for name, _ in calls] == ["go_to_preset", "count_objects"] * 2
    assert reply.endswith("Preset highway shows more cones. (Source: the simulator's ground truth.)")


def test_there_is_the_preset_that_was_found() -> None:
    calls, _ = last_calls("which preset has the most cones?", "go there", looks=(4, 1))
    assert calls == [("go_to_preset", {"name": "gate"})]
    assert last_calls("which preset has the fewest cones?", "go there", looks=(4, 1))[0] == [("go_to_preset", {"name": "highway"})]
    calls, _ = last_calls("which preset has the most cones?", "thanks", "go there", looks=(4, 1))
    assert calls == [("go_to_preset", {"name": "gate"})]
    earlier = ("go to the highway", "count the cones", "and at the gate?", "which has more?")
    assert last_calls(*earlier, "go there", looks=(4, 1, 4, 1))[0] == [("go_to_preset", {"name": "highway"})]
    calls, reply = last_calls("which preset has the most cones?", "go there", looks=(2,))
    assert not calls
    assert reply == "Where is 'there'? gate and highway show the same number."


@pytest.mark.parametrize(
    ("asked", "answer"),
    [
        ("are there more cones here than at the gate?", "Yes: I can see 4 cones here and 1 at gate."),
        ("are there fewer cones here than at the gate?", "No: I can see 4 cones here and 1 at gate."),
    ],
)
def test_here_is_compared_with_a_preset(asked: str, answer: str) -> None:
    calls, reply = last_calls("go to the highway", "pan left 10", asked, looks=(4, 1))
    assert [name for name, _ in calls] == ["count_objects", "go_to_preset", "count_objects"]
    assert reply == f"{answer} (Source: the simulator's ground truth.)"


def test_there_is_the_view_with_more_things() -> None:
    stage, turns = Stage([4, 1]), tuple[PastTurn, ...]()
    for instruction in ("go to the highway", "pan left 10", "are there more cones here than at the gate?", "go there"):
        turns = (*turns, stage.turn(instruction, turns))
    assert turns[-1].reply == "I went back: the camera is at pan -10.0, tilt 0.0, zoom 1.0x again."


def test_a_survey_says_where_it_leaves_the_camera() -> None:
    _, reply = last_calls("is there a cone at any preset?", looks=(4, 1))
    assert "The camera is now at highway." in reply
    assert "The camera is now" not in last_calls("go to the highway", "is there a cone at any preset?", looks=(4, 1))[1]


def test_a_comparison_without_counts_is_asked_about() -> None:
    assert last_calls("go home", "which has more?") == ([], "Which presets shall I compare, and what shall I count there?")


@pytest.mark.parametrize(
    ("instruction", "looks", "reply"),
    [
        ("how many pigeons are there?", ((2, False),), "I can see at least 2 pigeons in this view."),
        (
            "how many pigeons are there?",
            ((0, False),),
            "I cannot make out any pigeons from here, but there may be some that are too small or hidden.",
        ),
        (
            "count the pigeons at the gate and at the highway",
            (3, (0, False)),
            "I can see 3 pigeons at gate. I cannot make out any pigeons at highway, but there may be some that are too small or "
            "hidden.",
        ),
    ],
)
def test_things_that_cannot_be_made_out_are_not_absent(instruction: str, looks: tuple[Any, ...], reply: str) -> None:
    assert last_calls(instruction, looks=looks)[1].startswith(reply)


@pytest.mark.parametrize("question", ["which one has the most?", "which preset has the most people?"])
@pytest.mark.parametrize(
    ("found", "reply"),
    [
        (((4, False), (6, False)), "As far as I could see, preset highway had more people, with at least 6."),
        ((2, 5), "Preset highway had more people, with 5."),
        ((5, 5), "It is a tie between gate and highway, with 5 each."),
    ],
)
def test_presets_are_compared_by_the_counts_of_the_tour(question: str, found: tuple[Any, ...], reply: str) -> None:
    calls, said = last_calls("at each preset, count the people", question, looks=found)
    assert not calls
    assert said == reply


@pytest.mark.parametrize("instruction", ["go to it", "go to that one", "show me that one", "take me to the busier one"])
def test_the_preset_that_has_the_most_is_gone_to(instruction: str) -> None:
    tour = "at each preset, count the people"
    calls, _ = last_calls(tour, "which one has the most?", instruction, looks=((7, False), (3, False)))
    assert calls == [("go_to_preset", {"name": "gate"})]


def test_the_quieter_of_two_presets_needs_no_comparison_before() -> None:
    calls, _ = last_calls("at each preset, count the people", "go to the quieter one", looks=(7, 3))
    assert calls == [("go_to_preset", {"name": "highway"})]


@pytest.mark.parametrize("instruction", ["go to it", "take me to the busier one"])
def test_no_preset_is_gone_to_if_none_was_compared(instruction: str) -> None:
    calls, reply = last_calls("is there a bus?", instruction, looks=(YES,))
    assert not calls
    assert reply.endswith(("?", "."))


@pytest.mark.parametrize(
    ("earlier", "looks"),
    [
        (("zoom in on the bus",), (True, 2)),
        (("how much is the soup?", "go to the gate"), (YES, 2)),
        (("read the sign", "pan left 20"), (YES, 2)),
    ],
)
def test_other_things_are_counted_if_nothing_else_was_asked(earlier: tuple[str, ...], looks: tuple[Any, ...]) -> None:
    calls, _ = last_calls(*earlier, "what about the cars?", looks=looks)
    assert calls == [("count_objects", {"description": "cars", "view": "current"})]


def test_both_sides_are_added() -> None:
    sides = ("how many people are on the left?", "and on the right?")
    _, reply = last_calls(*sides, "and both together?", looks=(2, 3, 2, 3))
    assert "5 altogether" in reply


def test_the_presets_are_compared_for_one_thing_after_another() -> None:
    compared = "which preset has the most people?", "and forklifts?", "and skips?"
    calls, _ = last_calls(*compared, looks=(1, 2, 1, 2, 7, 3))
    assert [name for name, _ in calls] == ["go_to_preset", "count_objects"] * 2
    calls, _ = last_calls(*compared, "go there", looks=(1, 2, 1, 2, 7, 3))
    assert calls == [("go_to_preset", {"name": "gate"})]


@pytest.mark.parametrize("said", ["and forklifts?", "what about the forklifts?"])
def test_other_things_are_looked_for_at_the_same_presets(said: str) -> None:
    calls, _ = last_calls("which presets show people?", said)
    assert calls == [
        call
        for preset in ("gate", "highway")
        for call in (("go_to_preset", {"name": preset}), ("count_objects", {"description": "forklifts", "view": "current"}))
    ]


@pytest.mark.parametrize(
    "asked",
    [
        "are there more vans here or at the highway?",
        "are there more vans at the highway or here?",
        "do you see more vans here or at the highway",
    ],
)
def test_here_or_there_is_counted_here_before_the_camera_leaves(asked: str) -> None:
    calls, reply = last_calls(asked, looks=(5, 2))
    assert [name for name, _ in calls] == ["count_objects", "go_to_preset", "count_objects"]
    assert reply.startswith("I can see 5 vans here and 2 at highway. There are more vans here than at highway.")
