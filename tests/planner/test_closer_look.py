"""The planner goes closer when something is too small to read or to tell, and only then."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.english.grammar.questions.positions import without_position
from scope_ptz.geometry import Pose
from scope_ptz.planner.grammar.execution.closer_look import is_too_small, offer_in, offer_text, thing_of, without_close_up
from scope_ptz.planner.grammar.execution.run_state import Offer
from tests.planner.stage import LIMITS, Stage

SMALL = {"answer": "There is text on the sign, but it is too small to read.", "known": False}
READ = {"answer": 'The sign reads "STOP".', "known": True}
CLOSE = Pose(12, -3, 4)


def test_it_zooms_in_looks_again_and_puts_the_camera_back() -> None:
    stage = Stage([SMALL, True, READ], pose=Pose(10, 0, 1), lands=CLOSE, simulated=True)
    finish = stage.run("what does the sign say?")
    assert [name for name, _ in stage.calls] == ["query_answer", "zoom_to_object", "query_answer", "adjust_ptz"]
    assert stage.calls[1] == ("zoom_to_object", {"description": "sign"})
    assert stage.calls[0] == stage.calls[2]
    assert stage.pose == Pose(10, 0, 1)
    assert finish.kind == "answered"
    assert finish.text.startswith(
        'I zoomed in on the sign to answer that, and put the camera back afterwards. The sign reads "STOP".'
    )


def test_it_reads_several_signs_one_after_the_other() -> None:
    several = {
        "answer": 'I can read 1 of the 3 signs in view: "50". The other 2 are too small to read from here. '
        "A closer view may help with the exit sign and the price card for leeks.",
        "known": True,
    }
    exit_sign = {"answer": 'The exit sign reads "EXIT".', "known": True}
    card = {"answer": "There is text on the price card for leeks, but it is seen too much from the side to read.", "known": False}
    stage = Stage([several, True, exit_sign, True, card], pose=Pose(10, 0, 1), lands=CLOSE, simulated=True)
    finish = stage.run("read all the signs please")
    assert [arguments.get("description") or arguments.get("question") for _, arguments in stage.calls] == [
        "What do the signs say?", "exit sign", "What does the exit sign say?", None,
        "price card for leeks", "What does the price card for leeks say?", None,
    ]  # fmt: skip
    assert stage.pose == Pose(10, 0, 1)
    assert finish.text.startswith(
        'I can read 1 of the 3 signs in view: "50". The other 2 are too small to read from here. '
        "I zoomed in on the exit sign and the price card for leeks, and put the camera back afterwards. "
        'The exit sign reads "EXIT". There is text on the price card for leeks, but it is seen too much from the side to read.'
    )


def test_they_are_read_one_by_one() -> None:
    stage = Stage([3, READ])
    counted = stage.turn("how many signs are there?")
    stage.run("read them one by one", (counted,))
    calls = [arguments for name, arguments in stage.calls if name == "query_answer"]
    assert calls == [{"question": "What do the signs say?", "view": "current"}]


def test_names_keep_their_capitals() -> None:
    several = {"answer": f"{SMALL['answer']} A closer view may help with the CCTV sign.", "known": False}
    read = {"answer": 'The cctv sign reads "ON".', "known": True}
    finish = Stage([several, True, read], lands=CLOSE, simulated=True).run("what do the signs say?")
    assert 'The CCTV sign reads "ON".' in finish.text


def test_a_name_that_forms_no_phrase_is_not_asked_for() -> None:
    several = {"answer": f"{SMALL['answer']} A closer view may help with the out of use sign.", "known": False}
    read = {"answer": 'The sign in the middle reads "OUT OF USE".', "known": True}
    stage = Stage([several, True, read], lands=CLOSE, simulated=True)
    assert 'The out of use sign reads "OUT OF USE".' in stage.run("what do the signs say?").text


def test_the_text_on_another_thing_is_asked_for_by_the_name_of_that_thing() -> None:
    small = {"answer": "The text is on the stone plinth, but it is too small to read.", "known": False}
    stage = Stage([small, True, {"answer": 'The stone plinth reads "ALDER".', "known": True}], lands=CLOSE, simulated=True)
    stage.run("what does the sign on the statue say?")
    assert [arguments["question"] for _, arguments in stage.calls if "question" in arguments][
        -1
    ] == "What does the stone plinth say?"


def test_it_says_how_many_signs_it_did_not_go_closer_to() -> None:
    several = {
        "answer": "There is text on the signs, but it is too small to read. "
        "A closer view may help with the exit sign, and with 7 more.",
        "known": False,
    }
    finish = Stage([several, True, READ], lands=CLOSE, simulated=True).run("read every sign you can see")
    assert finish.text.startswith(
        'I zoomed in on the exit sign, and put the camera back afterwards; I did not go closer to 7 more. The sign reads "STOP".'
    )


def test_signs_that_stay_illegible_are_not_read() -> None:
    several = {"answer": f"{SMALL['answer']} A closer view may help with the exit sign.", "known": False}
    finish = Stage([several, True, SMALL], lands=Pose(12, -3, LIMITS.max_zoom), simulated=True).run("what do the signs say?")
    assert finish.text.startswith(
        "I zoomed in on the exit sign, but that did not help, so I put the camera back. There is text on the sign"
    )


def test_it_stays_if_the_question_is_not_about_what_signs_say() -> None:
    several = {"answer": f"{SMALL['answer']} A closer view may help with the exit sign.", "known": False}
    stage = Stage([several], simulated=True)
    stage.run("which signs can you read from here?")
    assert [name for name, _ in stage.calls] == ["query_answer"]


SMALL_PLATE = {"answer": "There is a number plate on the van, but it is too small to read.", "known": False}


def test_zooming_in_until_something_can_be_read_keeps_it_in_view() -> None:
    stage = Stage([SMALL, True, READ], lands=CLOSE)
    finish = stage.run("zoom in until you can read the blue sign")
    assert [name for name, _ in stage.calls] == ["query_answer", "zoom_to_object", "query_answer"]
    assert stage.calls[1] == ("zoom_to_object", {"description": "blue sign"})
    assert finish.text.startswith('I zoomed in on the blue sign. The sign reads "STOP".')
    assert stage.pose == CLOSE


def test_a_plate_that_stays_illegible_leaves_the_camera_where_it_was() -> None:
    stage = Stage([SMALL_PLATE, *[True, SMALL_PLATE] * 3], pose=Pose(10, 0, 1), lands=CLOSE)
    finish = stage.run("zoom in until you can read the number plate of the van")
    assert [a["description"] for name, a in stage.calls if name == "zoom_to_object"] == [
        "number plate of the van", "van", "number plate of the van"
    ]  # fmt: skip
    assert stage.pose == Pose(10, 0, 1)
    assert "that did not help, so I put the camera back. There is a number plate on the van" in finish.text


def test_it_does_not_zoom_in_on_what_is_seen_from_the_side() -> None:
    oblique = {"answer": "There is text on the sign, but it is seen too much from the side to read.", "known": False}
    stage = Stage([oblique])
    stage.run("keep zooming in until you can read the sign")
    assert [name for name, _ in stage.calls] == ["query_answer"]


def test_only_perception_knows_how_many_signs_are_legible() -> None:
    stage = Stage([{"answer": "2 signs bear text that I can read.", "known": True}])
    stage.run("how many signs can you read from here?")
    assert stage.calls == [("query_answer", {"question": "How many signs can you read?", "view": "current"})]


def test_what_a_thing_lacks_is_no_second_thing() -> None:
    stage = Stage([True, True])
    finish = stage.run("zoom in on the man in the vest and no helmet")
    assert (stage.calls, finish.kind) == ([], "clarification")
    assert 'I did not understand "no helmet".' in finish.text


def test_the_nearest_sign_is_read() -> None:
    stage = Stage([READ])
    stage.run("read the nearest sign")
    assert stage.calls == [("query_answer", {"question": "What does the nearest sign say?", "view": "current"})]


def test_from_close_up_it_asks_without_the_position() -> None:
    stage = Stage([SMALL, True, READ], lands=CLOSE, simulated=True)
    stage.run("what does the sign at the bottom say?")
    assert stage.calls[1] == ("zoom_to_object", {"description": "sign at the bottom"})
    assert stage.calls[2][1]["question"] == "what does the sign say?"


@pytest.mark.parametrize(
    ("question", "closer"),
    [
        ("what does the van say?", "text on the van"),
        ("what is the number plate of the van?", "number plate of the van"),
    ],
)
def test_it_zooms_in_on_the_text_while_the_lens_has_room(question: str, closer: str) -> None:
    stage = Stage([SMALL, True, SMALL, True, READ], lands=CLOSE, simulated=True)
    finish = stage.run(question)
    assert [name for name, _ in stage.calls] == [
        "query_answer", "zoom_to_object", "query_answer", "zoom_to_object", "query_answer", "adjust_ptz"
    ]  # fmt: skip
    assert stage.calls[3] == ("zoom_to_object", {"description": closer})
    assert "STOP" in finish.text
    at_limit = Stage([SMALL, True, SMALL], lands=Pose(12, -3, LIMITS.max_zoom), simulated=True)
    at_limit.run(question)
    assert [name for name, _ in at_limit.calls] == ["query_answer", "zoom_to_object", "query_answer", "adjust_ptz"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("what does the yellow sign at the bottom say?", "what does the yellow sign say?"),
        ("what does the leftmost sign say?", "what does the sign say?"),
        ("what is written on the nearest van?", "what is written on the van?"),
        ("sign at the bottom left of the picture", "sign"),
        ("what does the sign in the distance say?", "what does the sign say?"),
        ("what does the sign on the left of the van say?", "what does the sign on the left of the van say?"),
        ("the van in front of the bus", "the van in front of the bus"),
        ("what colour is the left door?", "what colour is the left door?"),
    ],
)
def test_a_position_in_the_frame_is_removed(text: str, expected: str) -> None:
    assert without_position(text) == expected


@pytest.mark.parametrize(
    "answer",
    [
        READ,
        {"answer": "There is text on the sign, but it is seen too much from the side to read.", "known": False},
        {"answer": "There is text on the sign, but too much of it is hidden or cut off to read.", "known": False},
        {"answer": "I cannot tell: there is no sign in view.", "known": False},
        {"answer": "The letters are too small for a road sign, but it reads STOP.", "known": True},
    ],
)
def test_otherwise_it_stays(answer: dict[str, object]) -> None:
    stage = Stage([answer], simulated=True)
    stage.run("what does the sign say?")
    assert [name for name, _ in stage.calls] == ["query_answer"]


def test_it_stays_when_told_not_to_move() -> None:
    stage = Stage([SMALL], simulated=True)
    finish = stage.run("without moving the camera, what does the sign say?")
    assert [name for name, _ in stage.calls] == ["query_answer"]
    assert "too small" in finish.text


def test_a_thing_that_cannot_be_found_leaves_the_first_answer() -> None:
    stage = Stage([SMALL, False], simulated=True)
    finish = stage.run("what does the sign say?")
    assert [name for name, _ in stage.calls] == ["query_answer", "zoom_to_object"]
    assert "too small to read" in finish.text


def test_a_real_camera_asks_first() -> None:
    stage = Stage([SMALL, True, READ], pose=Pose(10, 0, 1), lands=CLOSE)
    asked = stage.turn("what does the sign say?")
    assert [name for name, _ in stage.calls] == ["query_answer"]
    assert asked.reply.endswith('Shall I zoom in on "sign" to answer "what does the sign say?"? Please answer yes or no.')
    finish = stage.run("yes please", (asked,))
    assert [name for name, _ in stage.calls[1:]] == ["zoom_to_object", "query_answer", "adjust_ptz"]
    assert finish.kind == "answered" and "STOP" in finish.text
    assert stage.pose == Pose(10, 0, 1)


def test_a_no_leaves_the_camera_where_it_is() -> None:
    stage = Stage([SMALL], pose=Pose(10, 0, 1))
    asked = stage.turn("what does the sign say?")
    stage.run("no", (asked,))
    assert len(stage.calls) == 1


def test_no_offer_after_the_camera_has_moved_on() -> None:
    finish = Stage([SMALL]).run("what does the sign say? then pan right 20 degrees")
    assert finish.kind == "answered"
    assert "Shall I" not in finish.text


@pytest.mark.parametrize(
    ("question", "plain"),
    [
        ("What does the docks sign say when you zoom in on it?", "What does the docks sign say?"),
        ("What does a close-up of the docks sign say?", "What does the docks sign say?"),
        ("What is the price on the card, seen from close up?", "What is the price on the card?"),
        ("What is written on the board, if you zoom in on it to read?", "What is written on the board?"),
        ("What does the zoom sign say?", "What does the zoom sign say?"),
    ],
)
def test_requests_for_a_close_up(question: str, plain: str) -> None:
    assert without_close_up(question) == plain


@pytest.mark.parametrize(
    ("question", "thing"),
    [
        ("What does the bank sign say?", "bank sign"),
        ("what is written on the sign next to the gate?", "sign next to the gate"),
        ("Which price does the price card for lettuce show?", "price card for lettuce"),
        ("What is the price on the price card for lettuce?", "price card for lettuce"),
        ("what words are on the side of the van?", "van"),
        ("what is the name of the shop?", "shop"),
        ("What is the price that the price card for roses shows?", "price card for roses"),
        ("What time does the clock show?", "clock"),
        ("read the text in view", ""),
        ("What time is it?", ""),
    ],
)
def test_the_thing_of_a_question(question: str, thing: str) -> None:
    assert thing_of(question) == thing


@pytest.mark.parametrize(
    "text", ["It is too small to read.", "I cannot make out the letters.", "The plate is illegible.", "It is too far away to tell."]
)
def test_reports_of_a_vision_model(text: str) -> None:
    assert is_too_small({"answer": text, "known": False})
    assert not is_too_small({"answer": text, "known": True})


@given(st.text(min_size=1), st.text(min_size=1))
def test_an_offer_can_be_read_back(thing: str, question: str) -> None:
    assert offer_in("It is too small. " + offer_text(Offer(thing, question, Pose()))) == (thing, question)


@given(st.text())
def test_other_replies_offer_nothing(text: str) -> None:
    assert offer_in(text) is None


def test_the_answer_says_that_it_went_closer_to_only_one_of_several() -> None:
    small = {"answer": "There is text on the signs, but it is too small to read.", "known": False}
    read = {"answer": 'The signs read "STOP".', "known": True}
    reply = Stage([small, 20, read], lands=CLOSE, simulated=True).run("read the signs").text
    assert reply.startswith(
        "I zoomed in on one of the 20 signs in view, and put the camera back afterwards; I did not go closer to the other 19."
    )
