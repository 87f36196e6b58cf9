"""Turns that refer to earlier turns of the conversation."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.planner.base import PastTurn
from tests.planner.stage import Stage

YES = {"answer": "Yes, there is one.", "known": True}


def last_calls(*instructions: str, looks: tuple[Any, ...] = (1,)) -> tuple[list[tuple[str, dict[str, Any]]], str]:
    """Return the calls and the reply of the last turn of a conversation."""
    stage = Stage(looks)
    turns: tuple[PastTurn, ...] = ()
    for instruction in instructions:
        stage.calls.clear()
        turns = (*turns, stage.turn(instruction, turns))
    return list(stage.calls), turns[-1].reply


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


def test_another_number_asks_about_the_same_thing_there() -> None:
    calls, _ = last_calls("is there a lorry at dock 5?", "what about dock 6?", looks=(YES, YES))
    assert calls == [("query_answer", {"question": "is there a lorry at dock 6?", "view": "current"})]


def test_ones_of_two_colours_are_the_things_spoken_of() -> None:
    calls, _ = last_calls("how many containers are there?", "are there more blue than red ones?", looks=(5, 3, 2))
    assert [arguments["description"] for _, arguments in calls] == ["blue containers", "red containers"]


@pytest.mark.parametrize("before", ["go to the gate", "count the cones", "pan left 20 and tilt up 5"])
def test_more_of_nothing_is_asked_about(before: str) -> None:
    calls, reply = last_calls(before, "a bit more")
    assert not calls
    assert reply.endswith("?")


def test_the_other_way_asks_how_far_once_other_words_came_between() -> None:
    assert last_calls("pan left 20", "pan", "the other way") == ([], "By how many degrees shall I pan right?")
    assert last_calls("zoom in 3x", "pan", "the other way") == ([], "By what factor shall I zoom out?")


def test_it_is_the_thing_that_was_asked_about() -> None:
    calls, _ = last_calls("how many cones are there?", "is there a truck?", "zoom in on it", looks=(2, YES, True))
    assert calls == [("zoom_to_object", {"description": "truck"})]


def test_one_is_the_head_noun_of_the_last_description() -> None:
    calls, _ = last_calls("how many workers are wearing helmets?", "zoom in on the one on the left", looks=(2, True))
    assert calls == [("zoom_to_object", {"description": "worker on the left wearing helmets"})]


@pytest.mark.parametrize("named", ["platform one", "dock one", "number one bus"])
def test_one_is_a_number_after_a_noun_for_a_numbered_place(named: str) -> None:
    calls, _ = last_calls("how many cars are there?", f"zoom in on {named}", looks=(2, True))
    assert calls == [("zoom_to_object", {"description": named})]


def test_a_question_is_repeated_at_another_preset() -> None:
    calls, _ = last_calls("how many cones are there?", "and at the gate?")
    assert calls == [("go_to_preset", {"name": "gate"}), ("count_objects", {"description": "cones", "view": "current"})]


def test_a_share_of_the_last_count_is_counted() -> None:
    calls, _ = last_calls("how many people are there?", "how many are sitting down?")
    assert calls == [("count_objects", {"description": "people sitting down", "view": "current"})]


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


def test_the_nearest_one_is_one_of_all_if_none_was_found() -> None:
    calls, _ = last_calls("how many taxis are there?", "and the white ones?", "which one is the nearest?", looks=(3, 0, YES))
    assert calls == [("query_answer", {"question": "which taxi is the nearest?", "view": "current"})]


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


@pytest.mark.parametrize("asked", ["zoom in on both", "look at both"])
def test_both_are_the_two_things_zoomed_in_on(asked: str) -> None:
    calls, _ = last_calls("zoom in on the crane", "zoom in on the bus", asked, looks=(True,))
    assert [arguments.get("description") for name, arguments in calls if name == "zoom_to_object"] == ["crane", "bus"]


def test_both_after_a_single_thing_is_asked_about() -> None:
    calls, reply = last_calls("zoom in on the bus", "zoom in on both", looks=(True,))
    assert not calls
    assert reply == "Which two things do you mean? Please name them."


def test_both_sides_are_added() -> None:
    sides = ("how many people are on the left?", "and on the right?")
    _, reply = last_calls(*sides, "and both together?", looks=(2, 3, 2, 3))
    assert "5 altogether" in reply


def test_another_thing_is_followed_for_as_long_from_where_the_camera_is() -> None:
    earlier = "follow the man with the clipboard for 5 seconds"
    calls, _ = last_calls(earlier, "now the one with the wheelbarrow")
    assert calls == [("track_object", {"description": "man with the wheelbarrow", "duration_s": 5})]


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


def test_a_thing_is_named_once_for_the_condition_and_the_close_up() -> None:
    instruction = "zoom in on the bus if there is one, otherwise go home"
    assert last_calls(instruction, looks=(1, True))[0][-1] == ("zoom_to_object", {"description": "bus"})
    assert last_calls(instruction, looks=(0,))[0][-1] == ("go_home", {})


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


def test_still_begins_a_question() -> None:
    calls, _ = last_calls("track the van", "still see it?", looks=(YES,))
    assert calls == [("query_answer", {"question": "can you still see the van?", "view": "current"})]


def test_nothing_is_followed_until_something_happens() -> None:
    calls, reply = last_calls("is there a worker?", "follow him until he leaves", looks=(YES,))
    assert not calls
    assert reply == "I follow things for a time that you give me. For how many seconds shall I follow it?"


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


ASK, ZOOM = "query_answer", "zoom_to_object"
BEHIND = {"answer": "A fence and a green skip are to the left of the crane.", "known": True}


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


@pytest.mark.parametrize("before", ["pan left 20", "zoom in on the crane"])
def test_to_the_right_turns_the_camera_after_other_turns(before: str) -> None:
    calls, _ = last_calls("what is to the left of the crane?", before, "to the right 10", looks=(BEHIND, True, True))
    assert calls == [("adjust_ptz", {"pan_deg": 10})]


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


def test_the_nearest_is_one_of_all_if_none_is_as_asked() -> None:
    conversation = "how many vans are there?", "how many are moving?", "which is the nearest?", "zoom in on it"
    calls, _ = last_calls(*conversation, looks=(4, 0, YES, True))
    assert calls == [(ZOOM, {"description": "nearest van"})]


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


@pytest.mark.parametrize("said", ["copy that, now back to centre", "back to the centre", "go back to the centre please"])
def test_the_centre_to_go_back_to_is_asked_about(said: str) -> None:
    calls, reply = last_calls("pan left 20", said)
    assert not calls
    assert reply.startswith("Where is the centre?")


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
