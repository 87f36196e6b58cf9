"""Conditions that are negated, prohibitions after a command, and wordings on which the planner asks instead of moving."""

from __future__ import annotations

import re

import pytest

from scope_ptz.planner.grammar.execution.outline import OutlineBlock
from scope_ptz.planner.grammar.parsing.rewording.rewordings import rewordings
from scope_ptz.planner.grammar.parsing.rewording.tables.conditions import CONDITIONS
from scope_ptz.planner.grammar.parsing.rewording.tables.counts import COUNTS
from scope_ptz.planner.grammar.parsing.rewording.tables.courtesy import COURTESIES
from scope_ptz.planner.grammar.parsing.rewording.tables.moves import MOVES
from scope_ptz.planner.grammar.parsing.rewording.tables.questions import QUESTIONS
from scope_ptz.planner.grammar.parsing.rewording.tables.remarks import REMARKS
from scope_ptz.planner.grammar.parsing.rewording.tables.spelling import SPELLING
from scope_ptz.planner.grammar.parsing.rewording.tables.views import VIEWS
from scope_ptz.planner.grammar.parsing.rewording.tables.withdrawals import WITHDRAWALS
from scope_ptz.planner.plan import plan

PRESETS = ("main-gate", "yard", "loading-dock", "roof")

CONDITIONAL = [
    ("if you don't see a truck, go home", "if no trucks are visible:"),
    ("if you can't see the truck zoom out", "if no trucks are visible:"),
    ("take a picture when you don't see anyone", "if no people are visible:"),
    ("once there's a truck go to the roof", "if any trucks are visible:"),
    ("is there a car? then follow it", "if any cars are visible:"),
    ("go home as soon as the van has left", "if no vans are visible:"),
    ("pan left until you can't see the truck", "repeat until no trucks are visible, at most 24 times:"),
    ("if there are more cars at the yard than at the roof go to the yard", "if more cars are visible at yard than at roof:"),
]
"""Conditions with the headings of their blocks."""

ASKED = [
    "zoom in and pan left 10. Please don't zoom",
    "pan left 20, tilt up 5, zoom in. Don't tilt after all.",
    "go to the yard, zoom in and take a picture. No zoom though",
    "go to the yard and take a picture, actually don't take one",
    "count the cars and go home. Don't count",
    "go to the yard and the roof, not the roof",
    "check all presets for people but not the roof",
    "show me the truck but don't zoom in",
    "count the people at the roof but stay here",
    "if you can't read the plate zoom in",
    "if the man is wearing a helmet then don't do anything else take a picture",
    "take a picture at every other preset",
    "my wife thinks you should zoom in but I disagree",
    "Dave wants you to go to the roof, which is wrong",
    "how far can you pan left",
    "tell me before you zoom in",
    "from now on zoom in before each picture",
    "pan left 20 or until you see the truck",
    "follow the man 30 more seconds",
    "go to the yard in 5 minutes",
    "if there's a truck at any preset zoom in on it",
    "take a picture when everybody has left",
    "Roll the camera clockwise 20 and pan left 10.",
    "zoom in twice that",
    "zoom in please don't",
    "zoom in nah",
    "if the gate is open but not if there's a car zoom in",
    "make sure nobody is there before zooming in",
    "if all the doors are closed go home",
    "if the temperature is above 20 zoom in",
    "if someone left a bag zoom in on it",
    "someone left the door open, zoom in on it",
    "thanks for zooming in",
    "go home doesn't work",
    "he told me to zoom in and I did",
    "the boss wants to go home",
    "good picture",
    "show me the last picture",
    "follow the rules",
    "could the guard go home",
    "go to the roof last, the yard first",
    "pan left 20 sorry zoom in",
    "pan left 20 d",
    "zoom in on each car",
    "I need a picture of the roof by noon",
]
"""Instructions that the planner does not carry out."""


def headings(block: OutlineBlock) -> list[str]:
    inner = [heading for line in block.lines if isinstance(line, OutlineBlock) for heading in headings(line)]
    return [block.heading, *inner]


@pytest.mark.parametrize(("text", "heading"), CONDITIONAL)
def test_conditions_are_not_reversed(text: str, heading: str) -> None:
    outline = plan(text, PRESETS).outline
    assert outline is not None
    assert heading in headings(outline)


@pytest.mark.parametrize("text", ASKED)
def test_the_planner_asks(text: str) -> None:
    made = plan(text, PRESETS)
    assert not made.understood, made.calls
    assert made.clarification


@pytest.mark.parametrize("text", ["visit all presets but skip the roof", "go through all presets, no need to do the roof"])
def test_a_preset_that_is_left_out_is_not_visited(text: str) -> None:
    assert [call.arguments["name"] for call in plan(text, PRESETS).calls] == ["main-gate", "yard", "loading-dock"]


def test_a_skip_is_a_thing() -> None:
    assert plan("look for a skip at the yard preset", PRESETS).calls[0].name == "go_to_preset"


@pytest.mark.parametrize("forbidden", ["without moving the camera", "without zooming", ", don't move"])
def test_a_picture_without_moving_is_taken_of_the_current_view(forbidden: str) -> None:
    assert [call.name for call in plan(f"take a picture of the sign {forbidden}", PRESETS).calls] == ["take_image"]


@pytest.mark.parametrize("patterns", [COUNTS, MOVES, QUESTIONS, REMARKS, SPELLING, CONDITIONS, COURTESIES, VIEWS, WITHDRAWALS])
def test_every_pattern_compiles(patterns: tuple) -> None:  # type: ignore[type-arg]
    for rewording in rewordings(patterns):
        assert re.compile(rewording.pattern, re.IGNORECASE)


@pytest.mark.parametrize(
    "instruction",
    [
        "pan left 20, retract that",
        "pan left 20, belay that",
        "pan left 20, strike that",
        "pan left 20, disregard",
        "pan left 20, you shouldn't",
        "pan left 20, assuming Dave signs it off",
        "pan left 20, Sarah objected",
        "pan left 20, we need permission for that",
        "pan left 20, the camera stays where it is",
        "pan left 20, nobody asked for it",
        "pan left 20, my finger slipped",
        "dave, pan left 20, that was for the other camera",
        "imagine i said pan left 20, funny",
        "pan left 20? bad idea",
        "zoom in, i think we had better leave it",
        "pan left 20, i refuse",
        "pan left 20, abort",
        "pan left 20, that is not what i want",
        "pan left 20, nobody told you to",
        "pan left 20, the camera must stay put",
        "pan left 20, we shouldn't",
        "zoom in on the van, he meant the bus",
        "pan left 20, the client has withdrawn the request",
        "pan left 20, that order is void",
        "pan left 20, I am only testing what you would say",
        "zoom in. give up on that",
        "go to the yard. I give up",
        "pan left 20 degrees and tilt up 10 degrees. just the first one",
        "pan left 20 degrees, cancel",
        "pan left 20 degrees. nope",
        "pan left 20 degrees. no way",
        "go to the yard. skip it",
        "go to the yard. as you were",
        "pan left 20 degrees. that's not what I meant",
        "zoom in. quit it",
        "go to the yard. let's stay here",
        "go to the yard. plans have changed",
        "go to the yard. I didn't mean to send that",
        "follow the truck. you don't need to",
        "pan left 20 degrees and tilt up 10 degrees. swap the numbers",
        "go to the yard. Bob vetoed it",
        "zoom in, which is forbidden",
        "pan left 20 degrees. wrong way",
        "pan left 20 degrees, on my mark",
        "follow the truck. that depends on Bob",
        "yesterday I said go to the yard",
        "I doubt we should go to the yard",
        "pan left 20 degrees, he told me",
        "zoom in. sorry, I was talking to Dave",
        "here is an example. zoom in",
        "do not execute this. zoom in",
    ],
)
def test_statements_that_take_a_command_back_in_any_words_move_nothing(instruction: str) -> None:
    assert not plan(instruction, ("gate", "yard")).calls
