"""Turns that take back, correct or repeat earlier turns: where the camera ends, and what the planner says."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.base import PastTurn
from scope_ptz.planner.grammar.execution.move_sentences import offset_text
from tests.planner.stage import Stage

FOUNTAIN = Pose(42, -6, 4)
NOT_UNDERSTOOD = "The description 'exavator' is not understood."
PLACES = {"gate": ("mast", Pose(5, 0, 1)), "highway": ("bridge", Pose(-30, -5, 2))}


def talk(stage: Stage, *instructions: str) -> tuple[PastTurn, ...]:
    """Return the turns of a conversation. Afterwards, ``stage.calls`` holds the calls of the last turn."""
    turns: tuple[PastTurn, ...] = ()
    for instruction in instructions:
        stage.calls.clear()
        turns = (*turns, stage.turn(instruction, turns))
    return turns


# Undo -----------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("move", ["zoom in on the fountain", "go to the highway", "go home", "pan left 20 and tilt up 5"])
@pytest.mark.parametrize("undo", ["undo", "go back", "take me back"])
def test_the_first_move_of_a_conversation_is_undone(move: str, undo: str) -> None:
    stage = Stage([True], pose=Pose(10, -3, 1.5), lands=FOUNTAIN)
    talk(stage, move, undo)
    assert stage.pose == Pose(10, -3, 1.5)


@pytest.mark.parametrize(
    ("instructions", "pan_deg"),
    [
        (("pan right 20", "undo", "undo"), 0),
        (("pan right 20", "pan left 5", "go back", "go back"), 0),
        (("pan right 20", "pan left 5", "go back twice"), 0),
        (("pan right 20", "pan left 5", "tilt up 5", "undo the last two moves"), 20),
        (("pan right 20", "pan right 10", "undo", "pan left 5", "undo"), 20),
        (("pan right 20", "pan right 10", "undo", "pan left 5", "undo", "undo"), 0),
        (("pan right 20", "count the cones", "undo"), 0),
        (("pan right 20", "pan sideways", "undo"), 0),
        (("pan right 20", "pan right 5", "scrap that, go back", "go back"), 0),
        (("pan right 20", "pan right 5", "no, go back", "undo that please"), 0),
        (("pan right 20", "pan right 5", "pan right 5", "undo both"), 20),
        (("pan right 20", "go back", "back again"), 20),
        (("pan right 20", "go back", "and back again", "undo"), 0),
        (("pan right 20", "and back again"), 0),
        (("pan right 20", "pan left 5", "go back", "go back again"), 0),
        (("pan right 20", "go back", "go back again"), 0),
        (("pan right 20", "pan left 5", "tilt up 5", "go back two steps"), 20),
        (("pan right 20", "pan left 5", "go all the way back to where we started"), 0),
    ],
)
def test_undo_walks_back_through_the_moves(instructions: tuple[str, ...], pan_deg: float) -> None:
    stage = Stage([2])
    talk(stage, *instructions)
    assert stage.pose == Pose(pan_deg, 0, 1)


def test_a_close_look_that_was_put_back_is_no_move() -> None:
    small = {"answer": "It is too small to read.", "known": False}
    stage = Stage([small, True, {"answer": 'The sign reads "STOP".', "known": True}, True], lands=FOUNTAIN, simulated=True)
    turns = talk(stage, "pan right 20", "what does the sign say?")
    assert len(turns[-1].exchanges) == 4
    stage.turn("go back", turns)
    assert stage.pose == Pose(0, 0, 1)


@pytest.mark.parametrize(
    ("instructions", "pan_deg"),
    [
        (("pan right 20", "pan right 10", "undo", "one more time"), 0),
        (("pan right 20", "pan right 10", "go back", "and again"), 0),
        (("pan right 20", "pan right 10", "undo", "redo"), 30),
        (("pan right 20", "pan right 10", "undo", "redo", "undo", "undo"), 0),
        (("pan right 20", "undo", "undo the undo"), 20),
        (("pan right 20", "redo"), 40),
    ],
)
def test_an_undo_is_continued_and_taken_back(instructions: tuple[str, ...], pan_deg: float) -> None:
    stage = Stage()
    talk(stage, *instructions)
    assert stage.pose == Pose(pan_deg, 0, 1)


def test_nothing_to_redo_is_said() -> None:
    stage = Stage()
    reply = talk(stage, "pan right 10 or 20", "redo")[-1].reply
    assert not stage.calls
    assert reply == "Nothing was taken back just before, so I have nothing to redo. What shall I do?"


@pytest.mark.parametrize(
    ("instructions", "place"),
    [
        (("go to the highway", "pan left 5", "undo"), "preset highway"),
        (("zoom in 1.78x", "undo"), "pan 0.0, tilt 0.0, zoom 1.0x"),
        (("zoom in 1.78x", "zoom back out"), "pan 0.0, tilt 0.0, zoom 1.0x"),
        (("go home", "pan right 5", "go home", "go back"), "pan 5.0, tilt 0.0, zoom 1.0x"),
    ],
)
def test_every_return_is_reported_in_one_way(instructions: tuple[str, ...], place: str) -> None:
    assert talk(Stage(), *instructions)[-1].reply == f"I went back: the camera is at {place} again."


def test_nothing_is_left_to_undo() -> None:
    stage = Stage([2])
    reply = talk(stage, "pan right 20", "undo", "undo")[-1].reply
    assert not stage.calls
    assert reply == "There is no earlier position to go back to: the camera is still where it started."


def test_rounding_is_no_move() -> None:
    stage = Stage([True], pose=Pose(10.004, 0.0, 1.5004))
    turns = talk(stage, "pan right 20", "undo", "undo")
    assert not stage.calls
    assert "0 degrees" not in " ".join(turn.reply for turn in turns).replace("20 degrees", "")
    assert "did not move" in talk(Stage(pose=Pose(179, 0, 1)), "pan right 5")[-1].reply


@pytest.mark.parametrize(
    "start",
    [
        "the view I started with", "back to the start", "where we started", "go back to the first view", "go to the original view",
        "take me back to where we began", "back to the very beginning", "undo everything",
    ],
)  # fmt: skip
def test_the_start_is_that_of_the_conversation(start: str) -> None:
    stage = Stage([2], pose=Pose(30, -5, 2))
    talk(stage, "go to the gate", "pan left 7", start)
    assert stage.pose == Pose(30, -5, 2)
    reply = talk(stage, "count the cones", start)[-1].reply
    assert not stage.calls
    assert reply == "The camera is already where we started: pan 30.0, tilt -5.0, zoom 2.0x."


def test_the_start_within_an_instruction_is_that_of_the_instruction() -> None:
    stage = Stage([2])
    talk(stage, "pan right 20", "tilt up 5, count the cones, then go back to where you started")
    assert stage.pose == Pose(20, 0, 1)


# Viewpoints ------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("undo", ["undo", "back to the start"])
def test_the_camera_returns_to_the_viewpoint_that_it_left(undo: str) -> None:
    stage = Stage(places=PLACES, pose=Pose(12, 0, 1))
    reply = talk(stage, "pan right 3", "undo", "go to the highway", "tilt up 5", undo, "undo" if undo == "undo" else "go back")[
        -1
    ].reply
    if undo == "undo":
        assert (stage.viewpoint, stage.pose) == ("mast", Pose(12, 0, 1))
        assert stage.calls == [("go_to_preset", {"name": "gate"}), ("adjust_ptz", {"pan_deg": 7})]
        assert reply == "I went back: the camera is at pan 12.0, tilt 0.0, zoom 1.0x again."
    else:
        assert (stage.viewpoint, stage.pose) == ("bridge", Pose(-30, 0, 2))


def test_a_viewpoint_without_a_preset_cannot_be_returned_to() -> None:
    stage = Stage(places=PLACES, pose=Pose(12, 0, 1))
    stage.viewpoint = "roof"
    reply = talk(stage, "go to the highway", "undo")[-1].reply
    assert not stage.calls
    assert reply == "I cannot go back there: that was another viewpoint, and no preset leads to it."


# Corrections -----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("instructions", "pose"),
    [
        (("pan 20 degrees to the right", "sorry, I meant 30"), Pose(30)),
        (("pan right 20", "no, I meant 30"), Pose(30)),
        (("pan right 20", "no wait, 10"), Pose(10)),
        (("pan right 20", "make it 15"), Pose(15)),
        (("pan right 20", "no, just a bit"), Pose(5)),
        (("pan right 20", "I said left"), Pose(-20)),
        (("pan right 20", "no, left"), Pose(-20)),
        (("pan right 20", "sorry, left 30"), Pose(-30)),
        (("pan right 20", "I meant tilt up 5"), Pose(0, 5)),
        (("pan right 20", "no, I meant 30", "no, 25"), Pose(25)),
        (("pan right 20", "no, I meant 30", "undo"), Pose(0)),
        (("pan right 20", "no, I meant 30", "again"), Pose(60)),
        (("pan right 20", "no", "30"), Pose(30)),
        (("pan left 20", "no, the other way"), Pose(20)),
        (("pan left 20", "wrong way"), Pose(20)),
        (("pan left 20", "that's the wrong way"), Pose(20)),
        (("pan left 20", "now the other way"), Pose(0)),
        (("pan left 20", "and the other way"), Pose(0)),
        (("pan left 20", "the other way"), Pose(20)),
        (("tilt down 5", "other way", "again"), Pose(0, 10)),
        (("pan left 20", "pan sideways", "the other way", "by 25 degrees"), Pose(5)),
        (("pan left 20", "pan sideways", "the other way", "sorry, 10"), Pose(-10)),
        (("pan left 20", "pan sideways", "the other way", "the same"), Pose(0)),
        (("tilt up 5", "tilt down instead"), Pose(0, -5)),
        (("tilt up 5", "tilt down instead", "again"), Pose(0, -10)),
        (("pan left 20", "tilt up instead"), Pose(0, 10)),
        (("zoom in", "again", "no, 2x"), Pose(0, 0, 2)),
        (("pan left 20", "again", "again", "no, 20"), Pose(-20)),
        (("tilt up 50", "no, 10"), Pose(0, 10)),
        (("tilt up 50", "wrong way"), Pose(0, -50)),
        (("zoom in 3x", "no, 2x"), Pose(0, 0, 2)),
        (("zoom in 4x", "zoom out a bit", "zoom sideways", "the other way", "2"), Pose(0, 0, 5)),
        (("zoom in 2x", "zoom out a bit", "no, the other way"), Pose(0, 0, 2.5)),
        (("zoom in 2x", "zoom in 2x", "no, back out"), Pose(0, 0, 2)),
        (("zoom in 4x", "zoom out 2x", "no, back out"), Pose(0, 0, 1)),
        (("zoom in 2x", "3x"), Pose(0, 0, 3)),
        (("zoom in 2x", "make it 3x instead"), Pose(0, 0, 3)),
        (("zoom to 2x", "3x"), Pose(0, 0, 3)),
    ],
)
def test_a_correction_starts_from_where_the_corrected_command_started(instructions: tuple[str, ...], pose: Pose) -> None:
    stage = Stage([1])
    talk(stage, *instructions)
    assert stage.pose.as_dict() == pose.as_dict()


def test_a_correction_says_what_the_camera_did_instead() -> None:
    reply = talk(Stage(), "pan right 20", "sorry, I meant 30")[-1].reply
    pose = "pan 30.0, tilt 0.0, zoom 1.0x"
    assert reply == f"I panned right 10 degrees, so the camera has panned right 30 degrees instead; it is now at {pose}."


@pytest.mark.parametrize("said", ["2x", "no, 2x", "make it 2x instead", "sorry, I meant 2x"])
def test_a_factor_after_a_close_up_sets_the_zoom_on_the_thing(said: str) -> None:
    stage = Stage([True], pose=Pose(10, -3, 1.5), lands=FOUNTAIN)
    talk(stage, "zoom in on the fountain", said)
    assert stage.pose == Pose(42, -6, 3)


def test_a_factor_after_zooming_out_is_asked_about() -> None:
    stage = Stage(pose=Pose(0, 0, 4))
    assert talk(stage, "zoom out 2x", "3x")[-1].reply == "Shall I zoom in 3x, or zoom out 3x?"


@pytest.mark.parametrize(
    ("instructions", "pose"),
    [
        (("pan left 30", "too much"), Pose(-15)),
        (("pan left 30", "not that far"), Pose(-15)),
        (("pan left 30", "that was a bit too far"), Pose(-15)),
        (("pan left 30", "too far left"), Pose(-15)),
        (("tilt up 10", "too high"), Pose(0, 5)),
        (("zoom in 4x", "too much"), Pose(0, 0, 2)),
        (("zoom in 4x", "less"), Pose(0, 0, 2)),
        (("zoom in 4x", "way too close"), Pose(0, 0, 2)),
        (("zoom in 4x", "too much", "still too close"), Pose(0, 0, 1)),
        (("zoom in on the fountain", "too close"), Pose(42, -6, 2)),
        (("zoom in on the fountain", "it's too far away"), Pose(42, -6, 5)),
        (("zoom in 4x", "zoom out 4x", "too far away"), Pose(0, 0, 2)),
        (("zoom in 4x", "you went too far"), Pose(0, 0, 2)),
        (("zoom in on the fountain", "a bit more"), Pose(42, -6, 5)),
        (("pan left 20", "no, more"), Pose(-40)),
        (("pan left 20", "no, a bit further"), Pose(-25)),
        (("pan left 20", "a lot more"), Pose(-65)),
    ],
)
def test_a_move_that_went_too_far_or_not_far_enough_is_changed(instructions: tuple[str, ...], pose: Pose) -> None:
    stage = Stage([True], lands=FOUNTAIN)
    talk(stage, *instructions)
    assert stage.pose.as_dict() == pose.as_dict()


@pytest.mark.parametrize(
    ("instructions", "question"),
    [
        (("pan left 30", "too much", "too much"), "Shall I pan right further, or left again?"),
        (("pan left 20 and tilt up 5", "too much"), "Which way shall I turn, and how far?"),
        (("pan left 30", "too far right"), None),
        (("pan left 30", "too far away"), None),
        (("zoom in 4x", "too far"), "Shall I zoom in further, or out again?"),
        (("zoom in on the fountain", "that's still too far"), "Shall I zoom in further, or out again?"),
        (("zoom in 4x", "too much", "still too far"), "Shall I zoom in further, or out again?"),
        (("pan left 30", "no more"), None),
        (("count the cones", "no, the other way"), "Which way do you mean: left, right, up, down, in or out?"),
    ],
)
def test_a_complaint_that_is_unclear_moves_nothing(instructions: tuple[str, ...], question: str | None) -> None:
    stage = Stage([3], lands=FOUNTAIN)
    reply = talk(stage, *instructions)[-1].reply
    assert not stage.calls
    assert question is None or reply == question


@pytest.mark.parametrize("said", ["no, 10", "for 10 seconds", "make it 10 seconds", "10 seconds"])
def test_a_thing_is_followed_for_another_time_from_where_the_camera_is(said: str) -> None:
    stage = Stage([1])
    talk(stage, "how many men are there?", "follow him for 5 seconds", said)
    assert stage.calls == [("track_object", {"description": "man", "duration_s": 10})]


@pytest.mark.parametrize("said", ["no, the road roller", "no, road roller", "the road roller"])
def test_the_verb_of_a_thing_that_was_not_understood_stays(said: str) -> None:
    stage = Stage([True], fail={"zoom_to_object": 2}, error=NOT_UNDERSTOOD)
    talk(stage, "zoom in on the exavator", said)
    assert stage.calls == [("zoom_to_object", {"description": "road roller"})]


@pytest.mark.parametrize("said", ["a moment please", "no, typo", "no, bad idea", "no, the idea"])
def test_a_remark_after_a_thing_that_was_not_understood_names_no_thing(said: str) -> None:
    stage = Stage([True], fail={"zoom_to_object": 2}, error=NOT_UNDERSTOOD)
    talk(stage, "zoom in on the exavator", said)
    assert "zoom_to_object" not in [name for name, _ in stage.calls]


def test_a_thing_after_another_failure_is_no_correction() -> None:
    stage = Stage([True], fail={"zoom_to_object": 2})
    talk(stage, "zoom in on the van", "no, road roller")
    assert not stage.calls


def test_the_rejected_thing_is_not_zoomed_in_on_again() -> None:
    stage = Stage([True], lands=FOUNTAIN)
    talk(stage, "zoom in on the nearest man", "no, the one on the right")
    assert stage.calls[-1] == ("zoom_to_object", {"description": "man to the right of the nearest man"})


@pytest.mark.parametrize(
    "said",
    [
        "no, up",
        "no, not left",
        "no, 10 seconds",
        "no left",
        "make it 15 or 20",
        "no, 2x",
        "no, pan left 5",
        "no, that's right",
        "that should be right",
    ],
)
def test_an_unclear_correction_moves_nothing(said: str) -> None:
    stage = Stage()
    talk(stage, "pan right 20", said)
    assert not stage.calls


@pytest.mark.parametrize("before", ["pan right 20 and tilt up 5", "count the cones", "pan right 5 or 10"])
def test_what_is_no_single_move_is_not_corrected(before: str) -> None:
    stage = Stage([3])
    talk(stage, before, "no, I meant 30")
    assert not stage.calls


@pytest.mark.parametrize("hesitation", ["wait a bit", "hold on a bit", "wait 10", "hang on 5"])
def test_a_hesitation_corrects_nothing(hesitation: str) -> None:
    stage = Stage()
    talk(stage, "pan left 20", hesitation)
    assert not stage.calls


def test_a_correction_beyond_a_limit_names_the_limit() -> None:
    stage = Stage()
    reply = talk(stage, "tilt up 80", "no, I meant 120")[-1].reply
    assert reply == "I did not move: the camera is already tilted up as far as it can go."


@pytest.mark.parametrize(
    ("command", "tool"), [("zoom in on the van", "zoom_to_object"), ("follow the van for 20 seconds", "track_object")]
)
def test_another_thing_is_looked_for_from_the_start_of_the_command(command: str, tool: str) -> None:
    stage = Stage([True], lands=FOUNTAIN)
    talk(stage, command, "no, the red one")
    assert stage.calls[-1][0] == tool
    assert stage.calls[-1][1]["description"] == "red van"
    if tool == "zoom_to_object":
        assert stage.calls[0] == ("adjust_ptz", {"pan_deg": -42, "tilt_deg": 6, "zoom_factor": 0.25})


def test_another_number_of_a_preset_is_gone_to() -> None:
    stage = Stage()
    talk(stage, "go to the first preset", "no, the second one")
    assert stage.calls == [("go_to_preset", {"name": "highway"})]


def test_other_things_are_counted() -> None:
    stage = Stage([3])
    talk(stage, "count the vans", "no, the red ones")
    assert stage.calls == [("count_objects", {"description": "red vans", "view": "current"})]


# Again -----------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("between", [("undo",), ("no",), ("never mind",)])
@pytest.mark.parametrize("again", ["again", "do it again", "a bit more"])
def test_what_was_taken_back_is_not_repeated(between: tuple[str, ...], again: str) -> None:
    stage = Stage()
    reply = talk(stage, "pan left 20", *between, again)[-1].reply
    assert not stage.calls
    assert reply.endswith("?")


@pytest.mark.parametrize("asked", ["tilt", "pan right 10 or 20"])
def test_again_refers_to_the_last_command_that_was_carried_out(asked: str) -> None:
    stage = Stage()
    talk(stage, "pan left 20", asked, "again")
    assert stage.calls == [("adjust_ptz", {"pan_deg": -20})]


@pytest.mark.parametrize(
    ("instructions", "pose"),
    [
        (("zoom in 3x", "zoom out again"), Pose(0, 0, 1)),
        (("zoom in 3x", "pan right 10", "zoom back out"), Pose(10, 0, 1)),
        (("zoom in on the fountain", "zoom back out"), Pose(42, -6, 1)),
        (("zoom in 1.5x", "zoom in again"), Pose(0, 0, 2.25)),
        (("zoom in 3x", "double the zoom", "half of that"), Pose(0, 0, 3)),
        (("zoom in 2x", "double that"), Pose(0, 0, 4)),
        (("pan right 25", "pan right again"), Pose(50)),
        (("pan right 25", "pan left again"), Pose(0)),
        (("pan right 25", "back 5"), Pose(20)),
        (("pan right 25", "too far, back 10"), Pose(15)),
        (("pan right 20", "half of that back"), Pose(10)),
        (("pan right 20", "30 the other way"), Pose(-10)),
    ],
)
def test_a_move_about_the_same_axis_takes_its_amount(instructions: tuple[str, ...], pose: Pose) -> None:
    stage = Stage([True], lands=FOUNTAIN)
    replies = [turn.reply for turn in talk(stage, *instructions)]
    assert stage.pose.as_dict() == pose.as_dict()
    assert "limit" not in replies[-1]


# Absolute targets -------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("said", ["pan to 34 degrees, tilt -17", "pan to 34 and tilt -17", "pan to 34, tilt to -17"])
def test_both_angles_of_a_target_are_absolute(said: str) -> None:
    stage = Stage(pose=Pose(10, 5, 1))
    talk(stage, said)
    assert stage.pose == Pose(34, -17, 1)


def test_a_direction_after_a_target_is_relative() -> None:
    stage = Stage(pose=Pose(10, 5, 1))
    talk(stage, "pan to 34 and tilt down 7")
    assert stage.pose == Pose(34, -2, 1)


def test_where_the_camera_looks_is_said_from_the_last_preset() -> None:
    assert talk(Stage(), "go to the gate", "where are you looking?")[-1].reply.startswith("The camera is at preset gate: ")
    reply = talk(Stage(), "go to the gate", "pan left 20 and tilt down 3", "where are you looking now?")[-1].reply
    assert reply.startswith("I am looking 20 degrees to the left of and 3 degrees below preset gate: the camera is at pan -20.0")


# What ends or continues an earlier command ----------------------------------------------------------------------------
@pytest.mark.parametrize("said", ["hang on 5 minutes", "wait 10 seconds", "hold on 10 seconds"])
def test_a_hesitation_is_no_new_duration(said: str) -> None:
    stage = Stage([True])
    talk(stage, "follow the man for 5 seconds", said)
    assert not stage.calls


@pytest.mark.parametrize(
    ("instructions", "zoom"),
    [
        (("zoom in 2x", "to 3x"), 3),
        (("zoom in on the fountain", "to 2x"), 2),
        (("zoom in on the fountain", "no, to 2x"), 2),
        (("zoom in 2x", "no, to 3x"), 3),
        (("zoom to 4x", "zoom out 2x", "to 3x"), 3),
    ],
)
def test_a_magnification_after_to_is_absolute(instructions: tuple[str, ...], zoom: float) -> None:
    stage = Stage([True], pose=Pose(42, -6, 1.5), lands=FOUNTAIN)
    talk(stage, *instructions)
    assert stage.pose.as_dict() == Pose(42, -6, zoom).as_dict()


@pytest.mark.parametrize(("said", "pan_deg"), [("5 more", -25), ("instead", -10), ("5 instead", -5), ("more", -30)])
def test_the_question_about_a_share_is_answered_with_another_amount(said: str, pan_deg: float) -> None:
    stage = Stage()
    talk(stage, "pan left 20", "half of that", said)
    assert stage.pose == Pose(pan_deg, 0, 1)


@pytest.mark.parametrize("said", ["30", "no, 30", "again", "a bit more"])
def test_nothing_is_corrected_after_never_mind(said: str) -> None:
    stage = Stage()
    talk(stage, "pan left 20", "never mind", said)
    assert not stage.calls


def test_another_thing_after_never_mind_is_taken_from_here() -> None:
    stage = Stage([True], lands=FOUNTAIN)
    talk(stage, "zoom in on the van", "never mind", "the bus")
    assert stage.calls == [("zoom_to_object", {"description": "bus"})]


def test_a_command_that_was_dropped_can_still_be_undone() -> None:
    stage = Stage()
    talk(stage, "pan left 20", "no", "never mind", "undo")
    assert stage.pose == Pose(0, 0, 1)


@pytest.mark.parametrize(
    ("instructions", "axis"),
    [
        (("turn the camera", "what about left?"), "pan_deg"),
        (("turn the camera", "left please"), "pan_deg"),
        (("tilt the camera", "how about down?"), "tilt_deg"),
    ],
)
def test_the_question_which_way_to_turn_is_answered(instructions: tuple[str, ...], axis: str) -> None:
    stage = Stage()
    talk(stage, *instructions)
    assert [(name, list(arguments)) for name, arguments in stage.calls] == [("adjust_ptz", [axis])]
    assert stage.calls[0][1][axis] < 0


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        (Pose(0.3), "0.3 degrees to the right of"),
        (Pose(0.3, 0, 2), "closer at"),
        (Pose(20, -3), "20 degrees to the right of and 3 degrees below"),
        (Pose(), "at"),
    ],
)
def test_an_offset_names_what_differs(pose: Pose, words: str) -> None:
    assert offset_text(Pose(), pose) == words


def test_a_thing_instead_of_a_close_up_is_also_looked_for_in_the_wider_view() -> None:
    stage = Stage([True, True, False, True], lands=Pose(20, -5, 5), simulated=True)
    turns: tuple[PastTurn, ...] = (stage.turn("zoom in on the left car"),)
    stage.lands = Pose(40, -5, 5)
    turns = (*turns, stage.turn("zoom in on the van", turns))
    stage.calls.clear()
    stage.turn("wait, I meant the fox", turns)
    assert [name for name, _ in stage.calls] == ["adjust_ptz", "zoom_to_object", "adjust_ptz", "zoom_to_object"]


def test_a_camera_that_went_back_is_not_said_to_have_stayed() -> None:
    stage = Stage([True, False], lands=Pose(20, -5, 5))
    reply = talk(stage, "zoom in on the van", "wait, I meant the fox")[-1].reply
    assert reply.startswith(
        "I went back: the camera is at pan 0.0, tilt 0.0, zoom 1.0x again. I could not find the fox in this view."
    )
