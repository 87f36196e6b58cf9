"""Turns that correct an earlier command: where the camera ends, and what the planner says."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.base import PastTurn
from tests.planner.conversations.talk import talk
from tests.planner.stage import Stage

FOUNTAIN = Pose(42, -6, 4)
NOT_UNDERSTOOD = "The description 'exavator' is not understood."


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


@pytest.mark.parametrize("said", ["30", "no, 30", "again", "a bit more"])
def test_nothing_is_corrected_after_never_mind(said: str) -> None:
    stage = Stage()
    talk(stage, "pan left 20", "never mind", said)
    assert not stage.calls


def test_another_thing_after_never_mind_is_taken_from_here() -> None:
    stage = Stage([True], lands=FOUNTAIN)
    talk(stage, "zoom in on the van", "never mind", "the bus")
    assert stage.calls == [("zoom_to_object", {"description": "bus"})]


def test_a_thing_instead_of_a_close_up_is_also_looked_for_in_the_wider_view() -> None:
    stage = Stage([True, True, False, True], lands=Pose(20, -5, 5), simulated=True)
    turns: tuple[PastTurn, ...] = (stage.turn("zoom in on the left car"),)
    stage.lands = Pose(40, -5, 5)
    turns = (*turns, stage.turn("zoom in on the van", turns))
    stage.calls.clear()
    stage.turn("wait, I meant the fox", turns)
    assert [name for name, _ in stage.calls] == ["adjust_ptz", "zoom_to_object", "adjust_ptz", "zoom_to_object"]
