"""Courtesy, requests that no camera can carry out, and questions that are not understood."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.base import Briefing, Finish, State
from scope_ptz.planner.grammar import decide
from scope_ptz.planner.grammar.answerable import answerable_questions
from scope_ptz.planner.grammar.binding.small_talk import reply_to_small_talk
from scope_ptz.planner.grammar.binding.unknowable import why_unknowable
from scope_ptz.planner.plan import plan
from tests.planner.stage import LIMITS, PRESETS, Stage


def reply_to(instruction: str) -> tuple[str, str]:
    """Return the outcome and the text of an instruction that needs no calls."""
    decision = decide(State(instruction=instruction, briefing=Briefing(presets=PRESETS, pose=Pose(), limits=LIMITS)))
    assert isinstance(decision, Finish)
    return decision.kind, decision.text


def reply_to_first_step(instruction: str) -> str:
    """Return the text of a reply without calls; empty if the instruction needs any."""
    decision = decide(State(instruction=instruction, briefing=Briefing(presets=PRESETS, pose=Pose(), limits=LIMITS)))
    return decision.text if isinstance(decision, Finish) else ""


@pytest.mark.parametrize(
    "instruction",
    [
        "thanks", "thanks, that's all", "thank you for your help",
        "no thanks, that's all", "thank you, that was very helpful", "that's all for now, thank you",
    ],
)  # fmt: skip
def test_thanks_are_answered_and_nothing_else(instruction: str) -> None:
    assert reply_to(instruction) == ("answered", "You're welcome.")


@pytest.mark.parametrize(
    ("instruction", "reply"),
    [
        ("hello, how are you?", "I am well, thank you. "),
        ("hey, how's it going?", "I am well, thank you. "),
        ("cheers, that was great", "You're welcome."),
        ("thank you very much, you are doing great", "You're welcome."),
        ("what a great job", "Thank you. "),
        ("you did well", "Thank you. "),
        ("cheers, bye", "Goodbye."),
        ("many thanks, good night", "Goodbye."),
        ("radio check, over", "Receiving you. "),
    ],
)
def test_pleasantries_are_returned(instruction: str, reply: str) -> None:
    kind, text = reply_to(instruction)
    assert kind == "answered"
    assert text.startswith(reply)


@pytest.mark.parametrize("instruction", ["that was too far", "that is good enough for the gate", "how is the yard?"])
def test_remarks_about_a_move_or_a_place_are_no_pleasantries(instruction: str) -> None:
    assert "thank you" not in reply_to_first_step(instruction).lower()


@pytest.mark.parametrize("instruction", ["that is the wrong one", "no, not that one", "that's not the right one", "wrong car"])
def test_after_a_rejection_the_question_is_which_one_is_meant(instruction: str) -> None:
    assert reply_to(instruction) == ("clarification", "Which one do you mean? Please describe it.")


@pytest.mark.parametrize(
    ("question", "reason"),
    [
        ("who owns the van?", "A picture does not show who owns something."),
        ("whose car is it?", "A picture does not show who owns something."),
        ("who does the van belong to?", "A picture does not show who owns something."),
        ("can you tell me his name?", "I cannot know people's names."),
        ("what's the man's name?", "I cannot know people's names."),
        ("how long until the next tram?", "I cannot know when something will happen."),
        ("when does the next bus come?", "I cannot know when something will happen."),
        ("what time is it?", "I have no clock or calendar of my own."),
        ("what day is it?", "I have no clock or calendar of my own."),
    ],
)
def test_a_question_that_no_picture_answers_gets_the_reason(question: str, reason: str) -> None:
    kind, text = reply_to(question)
    assert kind == "clarification"
    assert text.startswith(reason)


@pytest.mark.parametrize(
    "question", ["what is the name of the shop?", "what is the shop called?", "what time does the clock show?", "whose van is red?"]
)
def test_a_similar_question_that_a_picture_may_answer_is_asked(question: str) -> None:
    assert [call.name for call in plan(question, PRESETS).calls] == ["query_answer"]


@pytest.mark.parametrize("instruction", ["hello", "hi there", "good morning, camera"])
def test_a_greeting_is_answered_with_an_example(instruction: str) -> None:
    kind, text = reply_to(instruction)
    assert kind == "answered"
    assert text.startswith("Hello. ") and "how many people are there?" in text


@pytest.mark.parametrize("instruction", ["never mind", "ok. never mind", "oh, forget it", "nvm"])
def test_what_is_no_longer_wanted_is_dropped(instruction: str) -> None:
    assert reply_to(instruction) == ("answered", "OK.")


@pytest.mark.parametrize("instruction", ["say again", "come again?", "what did you say?", "could you say that again, please?"])
def test_the_last_reply_is_repeated(instruction: str) -> None:
    stage = Stage([3])
    asked = stage.turn("zoom in on it", (counted := stage.turn("how many cones are there?"),))
    repeated = stage.turn(instruction, (counted, asked))
    assert repeated.reply == asked.reply == "Which of the 3 cones do you mean?"
    stage.calls.clear()
    stage.looks = [True]
    stage.turn("the left one", (counted, asked, repeated))
    assert stage.calls == [("zoom_to_object", {"description": "left cone"})]


@pytest.mark.parametrize("instruction", ["stop", "please cancel", "stop moving!", "stop panning now", "stop the camera"])
def test_stop_on_its_own_does_nothing(instruction: str) -> None:
    assert reply_to(instruction) == ("answered", "I am not moving. The camera stays where it is.")


@pytest.mark.parametrize(
    ("instruction", "call"),
    [
        ("thanks, now pan right 10 degrees", "adjust_ptz"),
        ("hello, how many people are there?", "count_objects"),
        ("great, thanks. Zoom in on the sign, please", "zoom_to_object"),
    ],
)
def test_a_command_with_a_courtesy_is_carried_out(instruction: str, call: str) -> None:
    assert [planned.name for planned in plan(instruction, PRESETS).calls] == [call]


@pytest.mark.parametrize(
    ("instruction", "deed"),
    [
        ("switch on the floodlights", "switch anything on or off"),
        ("please turn the radio off", "switch anything on or off"),
        ("tell the worker to put his helmet on", "talk to anyone"),
        ("open the barrier", "touch or operate what I see"),
        ("could you move the van?", "touch or operate what I see"),
    ],
)
def test_a_request_that_no_camera_can_carry_out_gets_the_reason(instruction: str, deed: str) -> None:
    kind, text = reply_to(instruction)
    assert kind == "clarification"
    assert text == f"I can only move the camera and answer questions about what it sees; I cannot {deed}. What shall I look at?"


@pytest.mark.parametrize("instruction", ["is the news kiosk open?", "is the film poster on the wall?"])
def test_a_topic_in_the_name_of_a_thing_is_about_the_picture(instruction: str) -> None:
    assert [call.name for call in plan(instruction, PRESETS).calls] == ["query_answer"]


def test_where_the_camera_is() -> None:
    assert Stage().run("where are you?").text == "The camera is at pan 0.0, tilt 0.0, zoom 1.0x."
    assert (
        Stage().run("go to the gate. Where are you?").text.endswith("The camera is at preset gate: pan 0.0, tilt 0.0, zoom 1.0x.")
    )
    (call,) = plan("what is in front of you?", PRESETS).calls
    assert call.arguments["question"] == "Describe the scene."


def test_a_question_that_is_not_understood_gets_an_example_about_the_same_thing() -> None:
    error = "The question 'is the bus of a sort to go with?' is not understood. Ask one question."
    stage = Stage()
    stage.do = lambda *_: (None, error)  # type: ignore[method-assign]
    reply = stage.run("is the bus of a sort to go with?").text
    assert reply.startswith("I did not understand that question. ")
    assert reply.endswith('for example: "how many buses are there?" or "where is the bus?".')


@pytest.mark.parametrize(
    ("question", "example"),
    [
        ("is the worker of a sort to go with?", "what is the worker doing?"),
        ("is the timetable of a sort to go with?", "what does the timetable say?"),
        ("is it of a sort to go with?", "what does the sign say?"),
    ],
)
def test_the_examples_suit_the_kind_of_thing(question: str, example: str) -> None:
    assert answerable_questions(question).endswith(f'or "{example}".')


def test_what_is_not_counted_is_not_offered_to_be_counted() -> None:
    assert answerable_questions("any smoke from the chimney?").startswith('I can answer, for example: "is there any smoke?"')


@pytest.mark.parametrize("instruction", ["a good picture", "perfect picture please", "a nice shot of the gate"])
def test_a_good_picture_is_asked_for_and_no_praise(instruction: str) -> None:
    assert "take_image" in [call.name for call in plan(instruction, PRESETS).calls]


@pytest.mark.parametrize("instruction", ["what a great shot", "that is a great picture", "great work", "that's a perfect view"])
def test_a_picture_that_was_taken_is_praised(instruction: str) -> None:
    assert reply_to(instruction)[1].startswith(("Thank you. ", "All right. "))


def test_how_a_thing_is_doing_is_no_question_about_the_planner() -> None:
    assert not reply_to_first_step("how is it doing?").startswith("I am well")
    assert reply_to_first_step("how is it going?").startswith("I am well")


def test_a_full_circle_is_where_to_look_only_for_a_question() -> None:
    assert [call.arguments for call in plan("look all around, the full circle", PRESETS).calls] == [{"pan_deg": 360}]
    asked = plan("how many cars are there all around, the full circle?", PRESETS).calls
    assert [call.arguments for call in asked] == [{"description": "cars", "view": "full"}]


@pytest.mark.parametrize("text", ["who are you?", "so what are you exactly?"])
def test_the_planner_says_what_it_is(text: str) -> None:
    assert reply_to_small_talk(text).startswith("I steer the camera")


@pytest.mark.parametrize("text", ["where are you?", "what are those?", "who is there?"])
def test_other_questions_ask_for_something(text: str) -> None:
    assert not reply_to_small_talk(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("who is he?", "people's names"),
        ("who's that woman over there?", "people's names"),
        ("where is she heading?", "going"),
        ("where's the tractor going?", "going"),
    ],
)
def test_what_no_picture_shows_is_said(text: str, expected: str) -> None:
    assert expected in why_unknowable(text)


@pytest.mark.parametrize("text", ["who is wearing a hat?", "where is the tractor?", "who is the tallest?"])
def test_what_a_picture_shows_is_looked_up(text: str) -> None:
    assert not why_unknowable(text)
