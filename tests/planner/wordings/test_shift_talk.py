"""What operators, guards and engineers type on a shift: labels of tests, head counts, what colleagues said, and slips."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import plan
from tests.planner.wordings.planned_calls import ask, count, planned_calls, zoom

PRESETS = ("main-gate", "yard", "pump-house")


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("Test step 3: pan right 25 degrees", "adjust_ptz(25)"),
        ("Trial 7, tilt down by 12 degrees", "adjust_ptz(-12)"),
        ("Evening round: count the vans in the yard", f"go_to_preset(yard); {count('vans')}"),
        ("count the vans in the yard, evening round", f"go_to_preset(yard); {count('vans')}"),
        ("follow the tractor for 15 seconds, tracking test number three", "track_object(tractor, 15)"),
    ],
)
def test_labels_of_tests_and_rounds_ask_for_nothing(text: str, calls: str) -> None:
    assert planned_calls(text, PRESETS) == calls


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("I need a headcount for the drill, how many people are in the yard", f"go_to_preset(yard); {count('people')}"),
        ("headcount at the yard: how many welders can you see?", f"go_to_preset(yard); {count('welders')}"),
        ("yard, number of forklifts?", f"go_to_preset(yard); {count('forklifts')}"),
        ("how many cars and how many bikes at the yard?", f"go_to_preset(yard); {count('cars')}; {count('bikes')}"),
        ("scan round the whole site and count the cones", count("cones", "full")),
        ("count the cones, I need the figure for the shift handover", count("cones")),
    ],
)
def test_head_counts(text: str, calls: str) -> None:
    assert planned_calls(text, PRESETS) == calls


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("Count the barrels, suppliers say they brought sixteen.", count("barrels")),
        ("zoom in on the stain, engineers think it's oil", zoom("stain")),
        ("count the people in the picture? guards want to know if they can go home", count("people")),
        ("zoom in on the tent, it should be out there somewhere", zoom("tent")),
        ("Keep following the red car for a minute, it has been past four times now.", "track_object(red car, 60)"),
        ("zoom out 20 percent, the roof is cut off on both sides", "adjust_ptz(-20)"),
    ],
)
def test_what_colleagues_said_changes_nothing(text: str, calls: str) -> None:
    assert planned_calls(text, PRESETS) == calls


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("take a photo of whatever the camera is looking at now", "take_image()"),
        ("zoom in 2x on what we see now", "adjust_ptz(2)"),
        ("turn a bit, about 7 degrees, to the right", "adjust_ptz(7)"),
        ("tilt up 5 and under no circumstances go home", "adjust_ptz(5)"),
        ("pn left 4", "adjust_ptz(-4)"),
        ("how many trucks can u see", count("trucks")),
    ],
)
def test_views_amounts_and_slips(text: str, calls: str) -> None:
    assert planned_calls(text, PRESETS) == calls


def test_an_amount_that_a_colleague_states_is_asked_about() -> None:
    assert planned_calls("pan left 20, drivers say thirty", PRESETS).startswith("I did not understand")


def test_a_question_in_the_form_of_a_statement_is_asked() -> None:
    text = "I would like to know which letters are on the board. Tilt down by 10, then zoom in 2x."
    assert planned_calls(text, PRESETS) == f"{ask('which letters are on the board')}; adjust_ptz(-10); adjust_ptz(2)"


@pytest.mark.parametrize(
    "text",
    [
        "pan left 20, that is too dangerous",
        "go home, my supervisor thinks it is pointless",
        "zoom in on the tent, farmers say they object",
    ],
)
def test_objections_are_asked_about(text: str) -> None:
    assert plan(text, PRESETS).clarification


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("head for the site office", "go_to_preset(site-office)"),
        ("how many bikes are there at the yard and how many are there at the quay?",
         f"go_to_preset(yard); {count('bikes')}; go_to_preset(quay); {count('bikes')}"),
        ("go home, that's me done for today", "go_home()"),
        ("how many vans are at the quay? they're not meant to park there", f"go_to_preset(quay); {count('vans')}"),
    ],
)  # fmt: skip
def test_only_remarks_are_left_out(text: str, calls: str) -> None:
    assert planned_calls(text, ("yard", "quay", "site-office")) == calls


def test_a_direction_after_the_word_check_is_not_lost() -> None:
    assert plan("follow the van, zoom check left", PRESETS).calls == ()
