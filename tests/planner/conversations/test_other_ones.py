"""Turns with "one", "the other one", "both", "the nearest" and "them": which things they refer to."""

from __future__ import annotations

import pytest

from tests.planner.conversations.talk import last_calls
from tests.planner.stage import Stage

YES = {"answer": "Yes, there is one.", "known": True}
ASK, ZOOM = "query_answer", "zoom_to_object"


def test_ones_of_two_colours_are_the_things_spoken_of() -> None:
    calls, _ = last_calls("how many containers are there?", "are there more blue than red ones?", looks=(5, 3, 2))
    assert [arguments["description"] for _, arguments in calls] == ["blue containers", "red containers"]


def test_one_is_the_head_noun_of_the_last_description() -> None:
    calls, _ = last_calls("how many workers are wearing helmets?", "zoom in on the one on the left", looks=(2, True))
    assert calls == [("zoom_to_object", {"description": "worker on the left wearing helmets"})]


@pytest.mark.parametrize("named", ["platform one", "dock one", "number one bus"])
def test_one_is_a_number_after_a_noun_for_a_numbered_place(named: str) -> None:
    calls, _ = last_calls("how many cars are there?", f"zoom in on {named}", looks=(2, True))
    assert calls == [("zoom_to_object", {"description": named})]


def test_the_nearest_one_is_one_of_all_if_none_was_found() -> None:
    calls, _ = last_calls("how many taxis are there?", "and the white ones?", "which one is the nearest?", looks=(3, 0, YES))
    assert calls == [("query_answer", {"question": "which taxi is the nearest?", "view": "current"})]


@pytest.mark.parametrize("asked", ["zoom in on both", "look at both"])
def test_both_are_the_two_things_zoomed_in_on(asked: str) -> None:
    calls, _ = last_calls("zoom in on the crane", "zoom in on the bus", asked, looks=(True,))
    assert [arguments.get("description") for name, arguments in calls if name == "zoom_to_object"] == ["crane", "bus"]


def test_both_after_a_single_thing_is_asked_about() -> None:
    calls, reply = last_calls("zoom in on the bus", "zoom in on both", looks=(True,))
    assert not calls
    assert reply == "Which two things do you mean? Please name them."


def test_one_of_two_colours_is_of_the_kind_asked_about() -> None:
    calls, _ = last_calls("is there a red car or a blue one?", "zoom in on the blue one", looks=(YES, True))
    assert calls[-1] == ("zoom_to_object", {"description": "blue car"})


def test_the_other_one_of_many_is_asked_about() -> None:
    earlier = ("zoom in on the bus", "zoom out", "how many people are there?", "zoom in on the nearest one")
    calls, reply = last_calls(*earlier, "and the other one?", looks=(True, 5, True))
    assert not calls
    assert reply.startswith("Which other person do you mean?")


def test_the_other_one_of_three_is_not_the_one_looked_at_before() -> None:
    earlier = ("how many workers are there?", "zoom in on the left one", "zoom in on the nearest one")
    calls, reply = last_calls(*earlier, "and the other one?", looks=(3, True, True))
    assert not calls
    assert reply == "Which other worker do you mean? For example, the left one, the right one or the nearest one."


@pytest.mark.parametrize(("number", "things"), [(2, ["left worker", "right worker"]), (4, [])])
def test_them_are_all_zoomed_in_on_or_asked_about(number: int, things: list[str]) -> None:
    calls, reply = last_calls("how many workers are there?", "zoom in on them", looks=(number, True))
    assert [arguments["description"] for name, arguments in calls if name == "zoom_to_object"] == things
    assert bool(things) != reply.endswith("Which of the 4 workers do you mean?")


def test_both_are_not_two_things_of_long_ago() -> None:
    conversation = "how many cars are there?", "how many men are there?", "where is the red car?", "zoom in on both"
    calls, reply = last_calls(*conversation, looks=(2, 3, YES, True))
    assert (calls, reply) == ([], "Which of the 2 cars do you mean?")


@pytest.mark.parametrize(
    ("said", "thing"),
    [("zoom in on the nearer one", "crane"), ("zoom in on the farther one", "red skip"), ("zoom in on it", "crane")],
)
@pytest.mark.parametrize("asked", ["which is nearer, the red skip or the crane?", "is the red skip or the crane closer?"])
def test_the_nearer_one_is_the_thing_that_the_answer_named(asked: str, said: str, thing: str) -> None:
    nearer = {"answer": "The crane is closer: it is about 20 m away, the red skip about 30 m.", "known": True}
    calls, _ = last_calls("zoom in on the nearest man", asked, said, looks=(True, nearer, True))
    assert calls[-1] == (ZOOM, {"description": thing})


def test_the_nearer_one_is_asked_about_if_the_answer_named_none() -> None:
    unknown = {"answer": "I cannot tell which one is closer.", "known": False}
    asked = "which is nearer, the red skip or the crane?"
    calls, reply = last_calls("zoom in on the nearest man", asked, "zoom in on the nearer one", looks=(True, unknown, True))
    assert (calls, reply) == ([], "Which of the 2 do you mean: the red skip or the crane?")


def test_the_other_one_is_not_a_thing_of_before_the_camera_went_home() -> None:
    calls, reply = last_calls(
        "zoom in on the man with a hat", "go home", "zoom in on the left man", "no, the other one", looks=(True,)
    )
    assert not any(arguments.get("description") == "man with a hat" for _, arguments in calls)
    assert reply.startswith("Which other man do you mean?")


@pytest.mark.parametrize("said", ["no, the other clock", "the other one", "zoom in on the other one"])
@pytest.mark.parametrize("number", [2, 4])
def test_the_other_one_is_never_the_thing_that_the_camera_chose(said: str, number: int) -> None:
    stage = Stage([True])
    turn = stage.turn("zoom in on the clock")
    (exchange,) = turn.exchanges
    (outcome,) = exchange.outcomes
    found = outcome.model_copy(update={"result": {**(outcome.result or {}), "matches": number, "chosen": "jeweller's clock"}})
    turn = turn.model_copy(update={"exchanges": (exchange.model_copy(update={"outcomes": (found,)}),)})
    stage.calls.clear()
    assert stage.turn(said, (turn,)).reply.startswith("Which ")
    assert not stage.calls


@pytest.mark.parametrize("said", ["and back to the first one", "go to the first one", "now go to the second one"])
def test_a_numbered_one_after_close_ups_is_not_taken_for_a_preset(said: str) -> None:
    calls, reply = last_calls("zoom in on the left man", said, looks=(True,))
    assert not calls
    assert reply.startswith("Which one do you mean")
    assert last_calls("count the cars", said)[0][0][0] == "go_to_preset"


def test_the_nearest_is_one_of_all_if_none_is_as_asked() -> None:
    conversation = "how many vans are there?", "how many are moving?", "which is the nearest?", "zoom in on it"
    calls, _ = last_calls(*conversation, looks=(4, 0, YES, True))
    assert calls == [(ZOOM, {"description": "nearest van"})]


@pytest.mark.parametrize(
    ("said", "thing"),
    [
        ("zoom in on the yellow skip. sorry, the blue one", "blue skip"),
        ("zoom in on the yellow skip, er, the blue one", "blue skip"),
        ("zoom in on the red phone box. no, the black one", "black phone box"),
        ("look at the dog on the left, I mean the one on the right", "dog on the right"),
        ("zoom in on the big crane, no wait, the small one", "small crane"),
    ],
)
def test_one_in_a_correction_is_of_the_kind_that_it_replaces(said: str, thing: str) -> None:
    assert last_calls(said, looks=(True,))[0] == [(ZOOM, {"description": thing})]
