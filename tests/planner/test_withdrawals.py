"""Statements beside a command: harmless ones change nothing, others take the command back, and the planner asks."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.parsing.remark_detection.withdrawing_segments import withdrawing_segments
from scope_ptz.planner.plan import plan
from tests.planner.withdrawals import PRESETS, rows

MIN_CARRIED_OUT = 0.65
MAX_MOVED_IN_SPITE = 0.33


@pytest.mark.parametrize("step", [4, pytest.param(1, marks=pytest.mark.full)])
def test_statements_that_nobody_has_seen_are_told_apart(step: int) -> None:
    moved = {
        carried_out: [
            row.moves_the_camera() for row in [each for each in rows("held-out") if each.carried_out == carried_out][::step]
        ]
        for carried_out in (True, False)
    }
    assert len(moved[True]) == len(moved[False]) == -(-370 // step)
    assert sum(moved[True]) / len(moved[True]) > MIN_CARRIED_OUT
    assert sum(moved[False]) / len(moved[False]) < MAX_MOVED_IN_SPITE


@pytest.mark.parametrize(
    ("harmless", "binding"),
    [
        ("the rain has stopped at last", "this was meant for the drone"),
        ("my sister lives there", "I was talking to my sister"),
        ("she sings on the radio", "I was quoting the radio"),
        ("we paint the lines tomorrow", "we will do that tomorrow"),
    ],
)
@pytest.mark.parametrize("command", ["go to the yard", "pan right 35 degrees", "zoom in on the red tractor"])
def test_the_meaning_of_a_statement_decides(command: str, harmless: str, binding: str) -> None:
    assert plan(f"{command}, {harmless}", PRESETS).calls == plan(command, PRESETS).calls != ()
    asked = plan(f"{command}, {binding}", PRESETS)
    assert not asked.understood
    assert asked.clarification


@pytest.mark.parametrize(
    "instruction",
    [
        "tilt up 5, no, 15",
        "go to the yard, I mean the silos",
        "zoom in twice and pan left 10, then go home",
    ],
)
def test_what_the_plan_depends_on_takes_nothing_back(instruction: str) -> None:
    assert plan(instruction, PRESETS).understood


def test_questions_are_answered_whatever_is_said_beside_them() -> None:
    assert plan("how many cars are there? I must ask my wife about it first", PRESETS).understood


def test_withdrawing_segments_come_with_the_text_without_them() -> None:
    (found,) = withdrawing_segments("Go to the yard. I was only joking. Thanks.", PRESETS)
    assert (found.text, found.rest) == ("I was only joking", "Go to the yard. Thanks.")


def test_long_and_single_texts_have_none() -> None:
    assert list(withdrawing_segments("go to the yard", PRESETS)) == []
    assert list(withdrawing_segments("Go to the yard. I was only joking. " * 20, PRESETS)) == []
