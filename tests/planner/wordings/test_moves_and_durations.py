"""Wordings of moves, fractions, zooms, the home view and how long to follow something."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.plan import plan
from tests.planner.stage import Stage
from tests.planner.wordings.planned_calls import planned_calls

PRESETS = ("gate", "dock")


def calls(instruction: str) -> str:
    return planned_calls(instruction, PRESETS, with_names=True)


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Tilt all the way up, I want to inspect the gutter", "adjust_ptz(tilt_deg=90)"),
        ("Pan right 35. We need to examine the hinge.", "adjust_ptz(pan_deg=35)"),
        ("Pan right 35, I need to examine the hinge up close", "adjust_ptz(pan_deg=35); zoom_to_object(description=hinge)"),
        ("I want to inspect the gutter", "zoom_to_object(description=gutter)"),
        ("Go to the dock, I want to inspect the ladder", "go_to_preset(name=dock); zoom_to_object(description=ladder)"),
    ],
)
def test_wish_to_inspect_after_a_turn_is_its_reason(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Tilt up 3 x 2.5 degrees in one move", "adjust_ptz(tilt_deg=7.5)"),
        ("Pan right 12 degrees twice in a single move", "adjust_ptz(pan_deg=24)"),
        ("Pan left twice 10 degrees as a single command", "adjust_ptz(pan_deg=-20)"),
        ("Pan right 8 and tilt up 3, carried out as a single movement", "adjust_ptz(pan_deg=8, tilt_deg=3)"),
        ("Pan right 12 degrees twice", "adjust_ptz(pan_deg=12); adjust_ptz(pan_deg=12)"),
    ],
)
def test_repetitions_in_one_move_are_added(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


def test_steps_in_one_move_are_asked_about() -> None:
    assert not plan("Pan left 60 degrees in 3 steps in one move", PRESETS).understood


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Pan right two thirds of a degree", "adjust_ptz(pan_deg=0.666667)"),
        ("Tilt up three quarters of a degree", "adjust_ptz(tilt_deg=0.75)"),
        ("Pan left three eighths of a full circle", "adjust_ptz(pan_deg=-135)"),
        ("Perform a rotation to the right of one sixth of a circle", "adjust_ptz(pan_deg=60)"),
        ("Reduce the zoom to one quarter of its present value", "adjust_ptz(zoom_factor=0.25)"),
    ],
)
def test_counted_fractions(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Relative tilt: -4 degrees", "adjust_ptz(tilt_deg=-4)"),
        ("Minor correction: 0.25 deg right", "adjust_ptz(pan_deg=0.25)"),
        ("Run the tilt axis to its upper limit", "adjust_ptz(tilt_deg=90)"),
        ("Zoom out 20 percent to reproduce the earlier framing", "adjust_ptz(zoom_percent=-20)"),
        ("Pan left 20 to clear the pillar", "adjust_ptz(pan_deg=-20)"),
        ("Look all the way up at the sky", "adjust_ptz(tilt_deg=90)"),
        ("Point it straight down at the tarmac", "adjust_ptz(tilt_deg=-90)"),
        ("If it's no bother, a quarter turn to the left", "adjust_ptz(pan_deg=-90)"),
        ("Pan left 15, only the hedge I can see here", "adjust_ptz(pan_deg=-15)"),
        ("Pan all the way left, end switch test", "adjust_ptz(pan_deg=-360)"),
        ("Halve the current magnification", "adjust_ptz(zoom_factor=0.5)"),
        ("Make everything half the size", "adjust_ptz(zoom_factor=0.5)"),
        ("Could you zoom in so it's three times as close?", "adjust_ptz(zoom_factor=3)"),
        ("As wide as the zoom will go please, all the way out", "adjust_ptz(zoom_limit=out)"),
        ("Home the camera, then pan left 10", "go_home(); adjust_ptz(pan_deg=-10)"),
        ("Go home please, my break's almost over", "go_home()"),
        ("I don't know what I've done. Put it back to its home position.", "go_home()"),
        ("Could you find the bench... actually no, never mind that, just go home", "go_home()"),
    ],
)
def test_moves(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize("instruction", ["Pan left 20 to reach 40 degrees", "Look all the way down at the bin"])
def test_other_goals_of_a_move_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    ("instruction", "factor"),
    [
        ("make everything twice as big", 2),
        ("make it twice the size", 2),
        ("make it half the size", 0.5),
        ("set the zoom to 1.5x", 0.75),
    ],
)
def test_multiples_of_the_size_are_relative_to_the_current_zoom(instruction: str, factor: float) -> None:
    stage = Stage(pose=Pose(zoom=2.0))
    stage.run(instruction)
    assert stage.calls == [("adjust_ptz", {"zoom_factor": factor})]


@pytest.mark.parametrize(
    ("instruction", "description", "duration_s"),
    [
        ("could you stay on the grey van for 40 seconds while it backs in?", "grey van", 40),
        ("keep following the nurse while she walks past, about two minutes should do it", "nurse", 120),
        ("Start tracking the barge, duration 30 s.", "barge", 30),
        ("Begin following the jogger and carry on for a minute and a half", "jogger", 90),
        ("Follow the digger for 20 s, checking tilt smoothness", "digger", 20),
        ("Track the coach for 25 s so I can time its left turn", "coach", 25),
    ],
)
def test_how_long_to_follow(instruction: str, description: str, duration_s: int) -> None:
    assert calls(instruction) == f"track_object(description={description}, duration_s={duration_s})"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("look down and to the left, six each", "adjust_ptz(tilt_deg=-6, pan_deg=-6)"),
        ("Pan right and tilt up, 8 degrees each", "adjust_ptz(pan_deg=8, tilt_deg=8)"),
        ("turn left, then look up, 12 each", "adjust_ptz(pan_deg=-12); adjust_ptz(tilt_deg=12)"),
        ("4 degree steps: left, left, up", "adjust_ptz(pan_deg=-4); adjust_ptz(pan_deg=-4); adjust_ptz(tilt_deg=4)"),
        ("In steps of 7 degrees: tilt down, pan right", "adjust_ptz(tilt_deg=-7); adjust_ptz(pan_deg=7)"),
        ("20 degrees, direction left. Pan.", "adjust_ptz(pan_deg=-20)"),
        ("A rightward pan of 17 degrees, please", "adjust_ptz(pan_deg=17)"),
        ("an upward tilt of 5 degrees", "adjust_ptz(tilt_deg=5)"),
        ("Aim at minus 30 degrees pan and 8 degrees below the horizon", "adjust_ptz(pan_deg=-30, tilt_deg=-8)"),
        ("Move to 25 degrees pan and minus 5 degrees tilt", "adjust_ptz(pan_deg=25, tilt_deg=-5)"),
        ("set the pan to 35 degrees left of centre", "adjust_ptz(pan_deg=-35)"),
        ("Hard left, all the way to the end.", "adjust_ptz(pan_deg=-360)"),
        ("tilt up, all the way to the stop", "adjust_ptz(tilt_deg=90)"),
        ("make it turn right twenty", "adjust_ptz(pan_deg=20)"),
        ("Could you spin the camera right around so that I can see the car park behind it?", "adjust_ptz(pan_deg=180)"),
    ],
)
def test_where_angles_and_directions_stand(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize("instruction", ["a leftward tilt of 5", "Set the pan to 40 degrees left of 10"])
def test_angles_that_do_not_fit_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    "instruction",
    [
        "left a lot bruv", "pan left a lot my man", "pan left a lot if you can, cheers", "pleeease pan leffft a lot",
        "Don't recall any preset, just pan left a lot",
    ],
)  # fmt: skip
def test_addresses_stretched_words_and_courtesy_change_nothing(instruction: str) -> None:
    assert calls(instruction) == calls("pan left a lot")


def test_people_who_are_named_are_no_addresses() -> None:
    assert calls("zoom in on the lads") == "zoom_to_object(description=lads)"
    assert calls("zoom in on the left man") == "zoom_to_object(description=left man)"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Preset recall: dock.", "go_to_preset(name=dock)"),
        ("Preset list first, then recall gate, then image.", "get_presets(); go_to_preset(name=gate); take_image()"),
        ("Starting from the home position, pan left 12", "go_home(); adjust_ptz(pan_deg=-12)"),
        ("Duration 35 seconds. Follow the tractor.", "track_object(description=tractor, duration_s=35)"),
        ("Tracking check, 20 s, the red forklift.", "track_object(description=red forklift, duration_s=20)"),
        ("keep the cam on the skid steer for like two minutes", "track_object(description=skid steer, duration_s=120)"),
        (
            "follow the lad w the watering can, had words with him last nite",
            "track_object(description=lad with the watering can, duration_s=10)",
        ),
    ],
)
def test_terse_orders(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected
