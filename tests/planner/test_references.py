"""What pronouns, "one" and short follow-ups refer to in a conversation."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.base import PastTurn
from scope_ptz.planner.grammar.binding.asked_things import asked_thing, with_other_thing
from scope_ptz.planner.grammar.binding.focus import Focus, which_one
from scope_ptz.planner.grammar.binding.narrowing import narrowed
from tests.planner.stage import Stage


class _Scripted(Stage):
    """A camera that finds everything, counts ``count`` things, or one after another of several numbers, and answers ``answer``."""

    def __init__(self, count: int | tuple[int, ...], answer: str, fail: dict[str, int] | None = None) -> None:
        super().__init__((), fail=fail)
        self.counts, self.answer = list(count) if isinstance(count, tuple) else [count], answer

    def do(self, name: str, arguments: dict[str, Any]) -> tuple[dict[str, Any] | None, str | None]:
        count = self.counts.pop(0) if name == COUNT and len(self.counts) > 1 else self.counts[0]
        looks: dict[str, Any] = {COUNT: count, ASK: {"answer": self.answer, "known": True}}
        self.looks = [looks.get(name, True)]
        return super().do(name, arguments)


def last_turn(*instructions: str, count: int | tuple[int, ...] = 1, answer: str = "Yes.") -> tuple[list[tuple[str, str]], str]:
    """Return the looks of the last turn, each with its description, question or preset, and the reply."""
    stage = _Scripted(count, answer)
    turns: tuple[PastTurn, ...] = ()
    for instruction in instructions:
        stage.calls.clear()
        turns = (*turns, stage.turn(instruction, turns))
    return [(name, str(a.get("description") or a.get("question") or a.get("name"))) for name, a in stage.calls], turns[-1].reply


ZOOM, COUNT, ASK, TRACK = "zoom_to_object", "count_objects", "query_answer", "track_object"


@pytest.mark.parametrize(
    ("question", "description"),
    [
        ("where is the forklift?", "forklift"),
        ("where's the man with the blue helmet?", "man with the blue helmet"),
        ("what is the nearest car?", "nearest car"),
        ("which sign is furthest?", "furthest sign"),
        ("which of the cars is the biggest?", "biggest car"),
        ("which of the people is nearest to the camera?", "nearest person"),
        ("which car is furthest to the left?", "car furthest to the left"),
        ("who is standing at the kiosk?", "person standing at the kiosk"),
        ("is there anybody in the shelter?", "person in the shelter"),
        ("which worker has an umbrella?", "worker with an umbrella"),
        ("what does the sign above the door say?", "sign above the door"),
        ("is the post office open?", "post office"),
        ("is the bus moving?", "bus"),
        ("is the pedestrian with a green umbrella walking?", "pedestrian with a green umbrella"),
        ("who has an umbrella?", "person with an umbrella"),
        ("what colour is the worker's helmet?", "worker"),
        ("does the man in the red jacket have a helmet?", "man in the red jacket"),
        ("is the man in the red jacket walking?", "man in the red jacket"),
        ("is the man in a red jacket?", "man"),
        ("who's there?", None),
        ("what text can you see?", None),
        ("is it raining?", None),
    ],
)
def test_a_question_is_about_a_thing(question: str, description: str | None) -> None:
    thing = asked_thing(question)
    assert (thing.description if thing else None) == description


@pytest.mark.parametrize(
    ("question", "other", "expected"),
    [
        ("what colour is the car?", "green lorry", "what colour is the green lorry?"),
        ("how much is the lettuce?", "apples", "how much are the apples?"),
        ("is there a dog?", "dog on the right", "is there a dog on the right?"),
        ("what does the middle sign say?", "left sign", "what does the left sign say?"),
    ],
)
def test_a_question_is_asked_about_another_thing(question: str, other: str, expected: str) -> None:
    assert with_other_thing(question, other) == expected


@pytest.mark.parametrize(
    ("description", "predicate", "expected"),
    [
        ("workers", "wear helmets", "workers wearing helmets"),
        ("cars", "are black", "black cars"),
        ("black cars", "blue", "blue cars"),
        ("people in the left half", "in the right half", "people in the right half"),
        ("people sitting down", "standing", "people standing"),
        ("workers", "have an umbrella", "workers with an umbrella"),
    ],
)
def test_a_description_is_narrowed(description: str, predicate: str, expected: str) -> None:
    assert narrowed(description, predicate) == expected


@pytest.mark.parametrize(
    "question", ["where is the truck?", "is the truck moving?", "what colour is the truck?", "describe the truck"]
)
def test_it_is_the_thing_of_the_last_question(question: str) -> None:
    calls, _ = last_turn("how many cones are there?", question, "zoom in on it", count=2)
    assert calls == [(ZOOM, "truck")]


def test_a_look_that_failed_is_not_what_it_refers_to() -> None:
    first = _Scripted(1, "Yes.").turn("how many cones are there?")
    second = _Scripted(1, "Yes.", fail={ASK: 2}).turn("is there a truck?", (first,))
    stage = _Scripted(1, "Yes.")
    stage.turn("zoom in on it", (first, second))
    assert stage.calls == [(ZOOM, {"description": "cone"})]


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("where is the man in the red coat?", "where is the van?", "follow him"), (TRACK, "man in the red coat")),
        (("is there anybody in the shelter?", "zoom in on her"), (ZOOM, "person in the shelter")),
        (("zoom in on the worker", "what is he holding?"), (ASK, "what is the worker holding?")),
        (("zoom in on the worker", "what colour is his jacket?"), (ASK, "what colour is the worker's jacket?")),
        (("where is the van?", "where is the man in the red coat?", "zoom in on it"), (ZOOM, "van")),
        (("where is the bus?", "is it moving?"), (ASK, "is the bus moving?")),
        (("where is the digger?", "what is it doing?"), (ASK, "what is the digger doing?")),
        (("is the post office open?", "read its sign please"), (ASK, "What does the sign of the post office say?")),
        (("zoom in on the bus", "zoom in on the man next to it"), (ZOOM, "man next to the bus")),
    ],
)
def test_a_pronoun_refers_to_something_of_its_kind(instructions: tuple[str, ...], expected: tuple[str, str]) -> None:
    calls, _ = last_turn(*instructions)
    assert calls == [expected]


def test_nobody_is_named() -> None:
    calls, reply = last_turn("where is the van?", "follow him")
    assert (calls, reply) == ([], "Who do you mean by 'him'? Please name the person.")
    assert last_turn("zoom in on her") == ([], "Who do you mean by 'her'? Please name the person.")


@pytest.mark.parametrize(
    "answer", ["There are 2 forklifts: one on the left and one on the right.", "The 2 yellow forklifts are on the left."]
)
def test_one_of_several_things_is_asked_about(answer: str) -> None:
    calls, reply = last_turn("where's the forklift?", "follow it", answer=answer)
    assert (calls, reply) == ([], "Which of the 2 forklifts do you mean?")
    answer = "Yes, there are 3 things with an umbrella: a man, a woman and a child."
    assert last_turn("who has an umbrella?", "zoom in on her", answer=answer)[0] == []
    answer = "A child, a man and 2 women are without helmets."
    calls, reply = last_turn("who is not wearing a helmet?", "zoom in on him", answer=answer)
    assert (calls, reply) == ([], "Which of the 4 people not wearing a helmet do you mean?")


def test_the_answer_to_which_one_completes_the_instruction() -> None:
    answer = "There are 2 forklifts: one on the left and one on the right."
    calls, _ = last_turn("where's the forklift?", "follow it", "the one on the left", answer=answer)
    assert calls == [(TRACK, "forklift on the left")]


@pytest.mark.parametrize(
    "question",
    [
        "is it raining?",
        "how far is it to Brampton?",
        "will it rain this afternoon?",
        "what time is it on the clock?",
        "does the bus have its lights on?",
    ],
)
def test_it_may_refer_to_nothing_or_to_the_question_itself(question: str) -> None:
    assert last_turn("zoom in on the van", question)[0] == [(ASK, question)]


def test_it_may_anticipate_the_thing() -> None:
    calls, _ = last_turn("zoom in on the van", "what does it say on the blue cabin?")
    assert calls == [(ASK, "what does the blue cabin say?")]


@pytest.mark.parametrize(
    ("follow_up", "expected"),
    [
        ("how many of them wear helmets?", (COUNT, "workers wearing helmets")),
        ("how many of them are walking?", (COUNT, "workers walking")),
        ("how many of them are in the left half?", (COUNT, "workers in the left half")),
        ("how many have an umbrella?", (COUNT, "workers with an umbrella")),
        ("are any of them wearing helmets?", (ASK, "are any of the workers wearing helmets?")),
        ("which of them has an umbrella?", (ASK, "which of the workers has an umbrella?")),
        ("any in hi-vis?", (ASK, "any of the workers in hi-vis?")),
        ("and in the right half?", (COUNT, "workers in the right half")),
        ("what about in the bottom right quarter?", (COUNT, "workers in the bottom right quarter")),
        ("and standing?", (COUNT, "workers standing")),
        ("where?", (ASK, "where are the workers?")),
        ("and the cones?", (COUNT, "cones")),
    ],
)
def test_a_count_is_followed_up(follow_up: str, expected: tuple[str, str]) -> None:
    assert last_turn("how many workers are there?", follow_up, count=8)[0] == [expected]


def test_shares_are_shares_of_the_same_whole() -> None:
    turns = ("how many workers are there?", "how many of them wear helmets?", "how many of them are walking?")
    assert last_turn(*turns, count=(8, 6, 1))[0] == [(COUNT, "workers walking")]
    asked = last_turn(*turns[:2], "zoom in on them", count=(8, 6))
    assert asked == ([], "Which of the 6 workers wearing helmets do you mean?")
    assert last_turn("how many cars are there?", "how many of them are black?", "and blue?", count=(8, 6, 1))[0] == [
        (COUNT, "blue cars")
    ]


@pytest.mark.parametrize(
    ("before", "follow_up", "expected"),
    [
        ("what colour is the bus?", "and the coach?", (ASK, "what colour is the coach?")),
        ("what does the middle sign say?", "what about the left one?", (ASK, "what does the left sign say?")),
        ("what does the middle sign say?", "and the one on the right?", (ASK, "what does the sign on the right say?")),
        ("which car is nearest?", "and the farthest?", (ASK, "What is the farthest car?")),
        ("how many taxis are there?", "what colour is the nearest one?", (ASK, "what colour is the nearest taxi?")),
        ("how many forklifts are there?", "what colour is each one?", (ASK, "what colour is each forklift?")),
        ("how many signs are there?", "which one is the biggest?", (ASK, "which sign is the biggest?")),
    ],
)
def test_a_question_is_followed_up(before: str, follow_up: str, expected: tuple[str, str]) -> None:
    assert last_turn(before, follow_up, count=3)[0] == [expected]


@pytest.mark.parametrize(
    ("before", "follow_up", "expected"),
    [
        ("zoom in on the red sign", "now the yellow one", (ZOOM, "yellow sign")),
        ("zoom in on the black car", "what about the silver one?", (ZOOM, "silver car")),
        ("follow the black car", "now the silver one", (TRACK, "silver car")),
        ("zoom in on the worker", "and the one with the blue helmet", (ZOOM, "worker with the blue helmet")),
    ],
)
def test_a_command_is_followed_up(before: str, follow_up: str, expected: tuple[str, str]) -> None:
    assert last_turn(before, follow_up)[0] == [expected]


def test_another_one_is_asked_about() -> None:
    assert last_turn("how many signs are there?", "zoom in on one of them", count=3)[0] == [(ZOOM, "sign")]
    assert last_turn("zoom in on the red sign", "and the other one") == (
        [], "Which other sign do you mean? For example, the left one, the right one or the nearest one.",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("how many people in the top left quarter?", "and in the bottom right one?"), "people in the bottom right quarter"),
        (("how many people in the top left quarter?", "and the bottom right one?"), "people in the bottom right quarter"),
        (("how many people are there?", "and the left half?"), "people in the left half"),
        (("how many people are there?", "and in the right half, how many people?"), "people in the right half"),
        (("how many people are in the left half, and how many in the right?",), "people in the right half"),
        (("how many dogs are there?", "do they have collars?", "undo", "and in the left half?"), "dogs in the left half"),
    ],
)
def test_another_part_of_the_picture_is_counted(instructions: tuple[str, ...], expected: str) -> None:
    assert last_turn(*instructions, count=3)[0][-1] == (COUNT, expected)


def test_one_of_the_things_counted_is_asked_about() -> None:
    earlier = ("how many taxis are there?", "what about the left one?")
    assert last_turn(*earlier, count=2) == ([], "What would you like to know about the left taxi?")
    assert last_turn(*earlier, "what colour is it?", count=2)[0] == [(ASK, "what colour is the left taxi?")]
    assert last_turn(*earlier, "and the right one?", count=2) == ([], "What would you like to know about the right taxi?")


def test_a_topic_and_its_question_are_read_together() -> None:
    both = ("how many taxis are there?", "what about the left one, what colour is it?")
    assert last_turn(*both, count=2)[0] == [(ASK, "what colour is the left taxi?")]
    statue = "what about the statue, what colour is it?"
    assert last_turn(statue)[0] == [(ASK, "what colour is the statue?")]
    assert last_turn(statue, "and the fountain?")[0] == [(ASK, "what colour is the fountain?")]


@pytest.mark.parametrize("wording", ["zoom in on him please", "zoom into him please", "zoom in on him thanks"])
def test_courtesy_leaves_the_object_of_a_zoom(wording: str) -> None:
    assert last_turn("where is the man at the kiosk?", wording)[0] == [(ZOOM, "man at the kiosk")]
    assert not last_turn(wording)[0]


@pytest.mark.parametrize(
    ("follow_up", "expected"),
    [
        ("where?", (ASK, "where are the red vehicles?")),
        ("which is farthest?", (ASK, "which red vehicle is farthest?")),
        ("zoom in on the red one", (ZOOM, "red vehicle")),
    ],
)
def test_follow_ups_stay_with_the_things_that_were_narrowed_to(follow_up: str, expected: tuple[str, str]) -> None:
    assert last_turn("how many vehicles?", "and the red ones?", follow_up, count=3)[0] == [expected]


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("where are the taxi and the bus?", "zoom in on the taxi", "now the other one"), "bus"),
        (("zoom in on the taxi", "zoom in on the bus", "no, the other one"), "taxi"),
        (("zoom in on the dog", "no, the woman on the left"), "woman on the left"),
        (("zoom in on the dog", "no, on the van"), "van"),
        (("zoom in on the red stall", "and the one next to it?"), "stall next to the red stall"),
    ],
)
def test_the_other_thing_is_zoomed_in_on(instructions: tuple[str, ...], expected: str) -> None:
    assert last_turn(*instructions)[0] == [(ZOOM, expected)]


@pytest.mark.parametrize(
    ("instructions", "question"),
    [
        (
            ("zoom in on the dog", "no, the other dog"),
            "Which other dog do you mean? For example, the left one, the right one or the nearest one.",
        ),
        (("zoom in on the dog", "and the others?"), "Which other dogs do you mean? Please describe them."),
        (("zoom in on the stall", "and the one next to it?"), "Which other stall do you mean? Please describe it."),
        (("how many dogs are there?", "zoom in on both"), "Which of the 3 dogs do you mean?"),
        (("how many dogs are there?", "zoom in on both", "both of them"), "Which of the 3 dogs do you mean?"),
        (
            ("zoom in on the dog", "no, 20 percent"),
            "A thing I zoom in on fills the view. Shall I do that, or zoom where I look now?",
        ),
        (("how many dogs are there?", "and altogether?"), "What shall I add up? Please name the things to count."),
    ],
)
def test_what_is_unclear_is_asked_about_by_name(instructions: tuple[str, ...], question: str) -> None:
    assert last_turn(*instructions, count=3) == ([], question)


def test_the_answer_to_which_one_completes_the_zoom() -> None:
    assert last_turn("how many dogs are there?", "zoom in on both", "the left one", count=3)[0] == [(ZOOM, "left dog")]


def test_the_latest_counts_are_added() -> None:
    assert last_turn("how many dogs are there?", "how many cats?", "and altogether?")[0] == [(COUNT, "dogs"), (COUNT, "cats")]


def test_a_question_about_it_is_about_the_place_just_visited() -> None:
    assert last_turn("is there a sign?", "go to the gate", "is it full?")[0] == [(ASK, "is the gate full?")]
    assert last_turn("is there a sign?", "go to the gate", "zoom in on it")[0] == [(ZOOM, "sign")]


def test_several_people_are_named_in_the_plural() -> None:
    assert which_one(Focus("man pointing", 6, "query_answer")) == "Which of the 6 men pointing do you mean?"


def test_one_with_clothes_is_a_person() -> None:
    calls, _ = last_turn("how many workers are there?", "how many cones are there?", "zoom in on the one with the blue helmet")
    assert calls == [(ZOOM, "worker with the blue helmet")]


def test_boards_that_were_counted_are_read() -> None:
    calls, _ = last_turn("how many headline boards are there?", "read them all", count=3)
    assert calls == [(ASK, "What do the headline boards say?")]


def test_a_list_after_altogether_names_no_other_things() -> None:
    assert last_turn("how many cars are there altogether, taxis and others?", "how many of them are black?", count=4)[0] == [
        (COUNT, "black cars")
    ]


def test_a_tour_is_compared_from_its_counts() -> None:
    tour = ("go to each preset and count the cones", "which one had the most?")
    calls, reply = last_turn(*tour, count=(4, 1))
    assert not calls
    assert reply.startswith("Preset gate had more cones, with 4.")
    assert last_turn(*tour, "go there", count=(4, 1))[0] == [("go_to_preset", "gate")]


def test_more_compares_the_two_presets_that_were_counted() -> None:
    earlier = ("how many cones are there at the gate?", "and at the highway?", "which preset has more cones?")
    assert [look for look in last_turn(*earlier)[0] if look[0] == "go_to_preset"] == [
        ("go_to_preset", "gate"),
        ("go_to_preset", "highway"),
    ]


@pytest.mark.parametrize("question", ["where did it go?", "where has the forklift gone?", "where did the forklift drive off to?"])
def test_where_a_followed_thing_went(question: str) -> None:
    stage = Stage([True], after_tracking=Pose(pan_deg=-12))
    reply = stage.run(question, (stage.turn("follow the forklift"),)).text
    assert reply == "The forklift went to the left: I turned 12 degrees to follow it, and had it in view to the end."


def test_where_a_thing_went_that_was_not_followed() -> None:
    assert last_turn("follow the forklift", "where did the van go?")[0] == [(ASK, "where is the van?")]
    assert last_turn("is there a van?", "where did it go?")[0] == [(ASK, "where is the van?")]


def test_a_followed_thing_is_named_by_whole_words() -> None:
    assert last_turn("follow the caravan", "where did the van go?")[0] == [(ASK, "where is the van?")]
