"""Questions that refer to the thing or the answer of an earlier turn."""

from __future__ import annotations

import pytest

from tests.planner.conversations.talk import last_calls

YES = {"answer": "Yes, there is one.", "known": True}
ASK, ZOOM = "query_answer", "zoom_to_object"
BEHIND = {"answer": "A fence and a green skip are to the left of the crane.", "known": True}


def test_it_is_the_thing_that_was_asked_about() -> None:
    calls, _ = last_calls("how many cones are there?", "is there a truck?", "zoom in on it", looks=(2, YES, True))
    assert calls == [("zoom_to_object", {"description": "truck"})]


@pytest.mark.parametrize(
    ("before", "asked", "expected"),
    [
        ("how many people are on the left?", "what about the right?", ("count_objects", "people on the right")),
        ("what can you see?", "what about the left?", ("query_answer", "what can you see on the left?")),
        ("describe the scene", "how about the middle?", ("query_answer", "what can you see in the middle?")),
    ],
)
def test_a_side_of_the_picture_is_asked_about(before: str, asked: str, expected: tuple[str, str]) -> None:
    calls, _ = last_calls(before, asked, looks=(3,) if before.startswith("how") else (YES,))
    assert [(name, arguments.get("question", arguments.get("description"))) for name, arguments in calls] == [expected]


@pytest.mark.parametrize("before", [(), ("pan left",)])
def test_a_side_of_the_picture_moves_nothing(before: tuple[str, ...]) -> None:
    calls, reply = last_calls(*before, "what about the right?")
    assert not calls
    assert reply.endswith("?")


@pytest.mark.parametrize(
    ("earlier", "question"),
    [
        (("how many people have umbrellas?", "is there a dog?"), "where is the dog?"),
        (("how many taxis are there?", "is there a bus?"), "where is the bus?"),
    ],
)
def test_where_is_about_the_thing_asked_about_last(earlier: tuple[str, ...], question: str) -> None:
    calls, _ = last_calls(*earlier, "where?", looks=(3, YES))
    assert calls == [("query_answer", {"question": question, "view": "current"})]


@pytest.mark.parametrize("asked", ["read the number plate", "what about the number plate?"])
@pytest.mark.parametrize(
    ("before", "vehicle"),
    [
        ("zoom in on the blue van", "blue van"),
        ("zoom in on the farthest car", "car in the middle"),  # in the close-up, another car may be the farthest
    ],
)
def test_the_number_plate_is_that_of_the_vehicle_looked_at(before: str, vehicle: str, asked: str) -> None:
    calls, _ = last_calls(before, asked, looks=(True, YES))
    assert calls == [("query_answer", {"question": f"What does the number plate of the {vehicle} say?", "view": "current"})]


def test_the_number_plate_of_several_vehicles_is_not_that_of_one() -> None:
    calls, _ = last_calls("how many cars are there?", "read the number plate", looks=(3, YES))
    assert calls == [("query_answer", {"question": "What does the number plate say?", "view": "current"})]


def test_its_part_is_the_part_spoken_of() -> None:
    calls, _ = last_calls("zoom in on the van", "read the number plate", "what is its number plate?", looks=(True, YES, YES))
    assert calls[0][1]["question"] == "what is the number plate of the van?"


@pytest.mark.parametrize(
    ("before", "asked", "question"),
    [
        ("what is behind the forklift?", "and in front of it?", "what is in front of the forklift?"),
        ("is the red car the nearest?", "and the farthest?", "is the red car the farthest?"),
        ("which dock doors are open?", "are any of them closed?", "are any of the dock doors closed?"),
    ],
)
def test_the_same_is_asked_in_another_respect(before: str, asked: str, question: str) -> None:
    calls, _ = last_calls(before, asked, looks=(YES, YES))
    assert calls == [("query_answer", {"question": question, "view": "current"})]


def test_a_thing_is_named_once_for_the_condition_and_the_close_up() -> None:
    instruction = "zoom in on the bus if there is one, otherwise go home"
    assert last_calls(instruction, looks=(1, True))[0][-1] == ("zoom_to_object", {"description": "bus"})
    assert last_calls(instruction, looks=(0,))[0][-1] == ("go_home", {})


def test_still_begins_a_question() -> None:
    calls, _ = last_calls("track the van", "still see it?", looks=(YES,))
    assert calls == [("query_answer", {"question": "can you still see the van?", "view": "current"})]


def test_what_else_there_is_is_described() -> None:
    calls, _ = last_calls("how many vans are there?", "what else is there?", looks=(1, YES))
    assert calls == [("query_answer", {"question": "Describe the scene.", "view": "current"})]


def test_earlier_messages_are_recalled() -> None:
    assert last_calls("pan left 20", "tilt up 5", "what did I ask first?") == ([], 'Your first message was "pan left 20".')
    assert last_calls("pan left 20", "tilt up 5", "what did I ask last?") == ([], 'Your last message was "tilt up 5".')


@pytest.mark.parametrize("question", ["when will the gate be finished?", "how long will it take?", "when is the gate ready?"])
def test_questions_about_the_future_move_nothing(question: str) -> None:
    calls, reply = last_calls("pan left 20", question)
    assert not calls
    assert reply.startswith("I cannot know when something will happen.")


@pytest.mark.parametrize(
    ("said", "place"),
    [
        ("and to the right?", "to the right of"),
        ("to the right?", "to the right of"),
        ("and on its right", "to the right of"),
        ("and behind?", "behind"),
        ("what about above it?", "above"),
        ("and in front?", "in front of"),
    ],
)
def test_another_direction_from_a_thing_is_asked_about_and_moves_nothing(said: str, place: str) -> None:
    calls, _ = last_calls("where is the crane?", "what is to the left of it?", said, looks=(YES, BEHIND, YES))
    assert calls == [(ASK, {"question": f"what is {place} the crane?", "view": "current"})]


@pytest.mark.parametrize(
    ("asked", "answer", "said"),
    [
        ("is anyone wearing a helmet?", "There is no person in view.", "zoom in on him"),
        ("is anybody carrying a ladder?", "No, none of the 5 people in view are carrying ladders.", "follow her"),
        ("is there a swan?", "No, there is no swan in view.", "zoom in on it"),
    ],
)
def test_nothing_is_referred_to_after_an_answer_that_there_is_none(asked: str, answer: str, said: str) -> None:
    calls, reply = last_calls(asked, said, looks=({"answer": answer, "known": True}, True))
    assert not calls
    assert "I found no " in reply
