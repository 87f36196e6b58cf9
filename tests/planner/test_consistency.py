"""A plan accounts for every number, direction, preset and act of its instruction; otherwise the planner asks back."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.english import number_word
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.consistency.check import objection
from scope_ptz.planner.plan import Plan, plan
from tests.planner.stage import Stage

PRESETS = ("gate", "yard", "loading-dock")
SIGNS = {"left": ("pan_deg", -1), "right": ("pan_deg", 1), "up": ("tilt_deg", 1), "down": ("tilt_deg", -1)}
MOVING = {"adjust_ptz", "go_home", "go_to_preset", "zoom_to_object", "track_object"}
NONSENSE = st.text(alphabet="bdfgklmnprstvz", min_size=2, max_size=4).map(lambda text: f"qu{text}ox")


def moves(made: Plan) -> list[tuple[str, dict[str, Any]]]:
    return [(call.name, call.arguments) for call in made.calls if call.name in MOVING]


def turn(direction: str, degrees: float) -> ast.Move:
    key, sign = SIGNS[direction]
    return ast.Move((ast.Turn("pan" if key == "pan_deg" else "tilt", sign, ast.Amount("degrees", degrees)),))


# The check by itself: plans that do not fit the instruction


@given(st.sampled_from(sorted(SIGNS)), st.sampled_from(sorted(SIGNS)), st.integers(2, 99), st.integers(2, 99))
def test_only_a_turn_in_the_stated_direction_by_the_stated_amount_is_accepted(one: str, other: str, said: int, made: int) -> None:
    problem = objection(f"turn it {one} {said} degrees", (turn(other, made),))
    assert (problem is None) == (one == other and said == made)
    if said != made:
        assert str(said) in (problem or "")


@pytest.mark.parametrize(
    ("instruction", "steps", "named"),
    [
        ("pan right 20 and take a picture", (turn("right", 20),), "picture"),
        ("pan right 20, then go home", (turn("right", 20),), "home"),
        ("pan right 20, then tilt up 5", (turn("right", 20),), "tilt up 5"),
        ("go to the yard and pan right 20", (turn("right", 20),), "yard"),
        ("zoom in 2x", (ast.Move((ast.Zoom("factor", 0.5),)),), "in"),
        ("zoom out 2x", (ast.Move((ast.Zoom("factor", 2.0),)),), "out"),
        ("pan right 90 in 10 degree steps", (ast.Repeat((turn("right", 10),), 8),), "90"),
        ("count the cars, then pan left 20", (ast.Count((ast.Thing("cars, then pan left 20"),)),), "then pan left 20"),
    ],
)
def test_what_a_plan_leaves_out_is_named(instruction: str, steps: tuple[ast.Step, ...], named: str) -> None:
    assert f'"{named}"' in (objection(instruction, steps, PRESETS) or "")


@pytest.mark.parametrize(
    ("instruction", "steps"),
    [
        ("pan right 90 in 10 degree steps", (ast.Repeat((turn("right", 10),), 9),)),
        ("pan right 20 but do not tilt up 5", (turn("right", 20),)),
        ("right now, pan left 20", (turn("left", 20),)),
        ("count the 3 cars on the left", (ast.Count((ast.Thing("3 cars on the left"),)),)),
        ("follow the van for two minutes", (ast.Track(ast.Thing("van"), 120.0),)),
    ],
)
def test_a_plan_that_does_everything_is_accepted(instruction: str, steps: tuple[ast.Step, ...]) -> None:
    assert objection(instruction, steps, PRESETS) is None


# The planner


@settings(max_examples=150, deadline=None)
@given(
    st.sampled_from(
        [
            "pan {direction} {number}",
            "turn the camera {number} degrees to the {direction}",
            "go to the yard and then turn {direction} {number} degrees",
            "turn {direction} {number} because the sun is low",
            "could you turn {direction} by {number} degrees and count the cars?",
            "how many vans are there? Then turn {direction} {number}.",
            "take a picture, turn {direction} {number} degrees and take another",
            "if you see a van, turn {direction} {number}",
            "turn {number} degrees {direction} twice",
        ]
    ),
    st.sampled_from(["left", "right"]),
    st.integers(2, 99),
    st.booleans(),
)
def test_a_stated_turn_is_made_exactly_or_not_at_all(template: str, direction: str, number: int, is_spelled: bool) -> None:
    made = plan(template.format(direction=direction, number=number_word(number) if is_spelled else number), PRESETS)
    key, sign = SIGNS[direction]
    turns = [arguments for name, arguments in moves(made) if name == "adjust_ptz"]
    assert all(arguments == {key: sign * number} for arguments in turns)
    assert turns or not made.understood


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["go to {}", "show me the {}", "take the camera to {}", "at {}, count the cars", "from {} take a photo"]),
    st.sampled_from(PRESETS),
)
def test_a_stated_preset_is_used_or_nothing_is(template: str, preset: str) -> None:
    made = plan(template.format(preset), PRESETS)
    assert moves(made) == [("go_to_preset", {"name": preset})] or not made.understood


@settings(max_examples=250, deadline=None)
@given(
    st.sampled_from(
        [
            "pan left 20 degrees", "go to the yard and count the cars", "zoom in 2x then take a picture",
            "tilt up 10 and pan right 5", "if you see a bus go home", "pan right in 10 degree steps until you see a van",
            "follow the van for 20 seconds", "go home",
        ]
    ),
    NONSENSE,
    st.integers(0, 12),
)  # fmt: skip
def test_an_unknown_word_never_vanishes(instruction: str, word: str, place: int) -> None:
    words = instruction.split()
    words.insert(place % (len(words) + 1), word)
    made = plan(" ".join(words), PRESETS)
    if made.understood:
        assert any(word in str(call.arguments) for call in made.calls)
    else:
        assert made.clarification


@settings(max_examples=100, deadline=None)
@given(st.floats(0.1, 8).map(lambda value: round(value, 1)), st.sampled_from(["x", " times", " fold", ""]), st.booleans())
def test_zooming_in_never_zooms_out(factor: float, unit: str, is_in: bool) -> None:
    made = plan(f"zoom {'in' if is_in else 'out'} {factor}{unit}", PRESETS)
    for _, arguments in moves(made):
        value = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0) / 100)
        assert value >= 1 if is_in else value <= 1


@pytest.mark.parametrize("instruction", ["pan left 10 " * 300, "count the cars and " * 200 + "go home", "( " * 900, "gate " * 380])
def test_a_long_instruction_is_never_carried_out_in_part(instruction: str) -> None:
    assert not plan(instruction, PRESETS).calls


@pytest.mark.parametrize(
    ("instruction", "named"),
    [
        ("pan left glorp 20 degrees", "glorp"),
        ("wibble the flange", "wibble the flange"),
        ("go to the yard and wibble the flange", "wibble the flange"),
        ("zoom in 2x, tilt up 5 and frobnicate it", "frobnicate"),
    ],
)
def test_the_words_that_were_not_understood_are_named(instruction: str, named: str) -> None:
    assert named in (plan(instruction, PRESETS).clarification or "")


@pytest.mark.parametrize(
    ("instruction", "arguments"),
    [
        ("pan left 20, sorry, I meant right 20", {"pan_deg": 20}),
        ("pan left 20, no, right 30", {"pan_deg": 30}),
        ("tilt up 10, no wait, 15", {"tilt_deg": 15}),
        ("pan right 30, I mean 20, degrees", {"pan_deg": 20}),
        ("go to the gate, no, the yard", {"name": "yard"}),
        ("pan right 30, make that forty", {"pan_deg": 40}),
    ],
)
def test_a_correction_replaces_what_it_corrects(instruction: str, arguments: dict[str, Any]) -> None:
    assert [call.arguments for call in plan(instruction, PRESETS).calls] == [arguments]


# Conditions


def test_if_so_without_a_look_is_asked_about() -> None:
    assert "if so" in (plan("pan left 20; if so, take a picture", PRESETS).clarification or "")


@pytest.mark.parametrize(
    "instruction",
    [
        "is the gate open? if so, pan left 30, otherwise pan right 30",
        "is the gate open? if not, pan left 30",
        "if the gate is open, pan left 30, otherwise pan right 30",
        "unless the gate is open, pan left 30",
    ],
)
def test_what_cannot_be_told_decides_nothing(instruction: str) -> None:
    stage = Stage([{"answer": "It is too small to tell.", "known": False}])
    finish = stage.run(instruction)
    assert [name for name, _ in stage.calls if name in MOVING] == []
    assert "cannot tell" in finish.text


def test_a_failed_look_decides_nothing() -> None:
    stage = Stage([0], fail={"count_objects": 9})
    stage.run("count the cars; if none, pan left 30")
    assert "adjust_ptz" not in [name for name, _ in stage.calls]


def test_otherwise_belongs_to_the_last_look() -> None:
    stage = Stage([3, 0])
    stage.run("count the cars. count the vans. if there are none, pan left 30, otherwise go home")
    assert stage.calls[-1] == ("adjust_ptz", {"pan_deg": -30})
    found = Stage([3, False])
    found.run("count the cars, then zoom in on the red van; if not, pan left 30")
    assert found.calls[-1] == ("adjust_ptz", {"pan_deg": -30})


def test_a_zoom_target_in_the_other_direction_is_not_approached() -> None:
    from scope_ptz.geometry import Pose

    stage = Stage([0], pose=Pose(zoom=4))
    assert "4x" in stage.run("zoom in to 2x").text
    assert stage.calls == []


@pytest.mark.parametrize("courtesy", ["", "please ", "can you please ", "could you, ", "would you kindly "])
@pytest.mark.parametrize("condition", ["if there is a van", "unless the gate is shut", "if that sidewalk's icy"])
@pytest.mark.parametrize("command", [", go home", " return home", " take a picture", ", pan left 10, otherwise zoom in"])
def test_a_condition_is_tested_before_its_command_or_asked_about(courtesy: str, condition: str, command: str) -> None:
    made = plan(f"{courtesy}{condition}{command}", ("yard",))
    assert not made.understood or made.calls[0].name in {"count_objects", "query_answer"}
