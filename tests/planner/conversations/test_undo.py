"""Turns that take back earlier moves: where the camera ends, and what the planner says."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.grammar.execution.move_sentences import offset_text
from tests.planner.conversations.talk import talk
from tests.planner.stage import Stage

FOUNTAIN = Pose(42, -6, 4)
PLACES = {"gate": ("mast", Pose(5, 0, 1)), "highway": ("bridge", Pose(-30, -5, 2))}


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


def test_a_command_that_was_dropped_can_still_be_undone() -> None:
    stage = Stage()
    talk(stage, "pan left 20", "no", "never mind", "undo")
    assert stage.pose == Pose(0, 0, 1)


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


def test_a_camera_that_went_back_is_not_said_to_have_stayed() -> None:
    stage = Stage([True, False], lands=Pose(20, -5, 5))
    reply = talk(stage, "zoom in on the van", "wait, I meant the fox")[-1].reply
    assert reply.startswith(
        "I went back: the camera is at pan 0.0, tilt 0.0, zoom 1.0x again. I could not find the fox in this view."
    )
