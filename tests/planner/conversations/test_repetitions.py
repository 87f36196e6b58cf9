"""Turns that repeat an earlier command, take its amount, or state a target or an amount that was asked for."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from tests.planner.conversations.talk import talk
from tests.planner.stage import Stage

FOUNTAIN = Pose(42, -6, 4)


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
