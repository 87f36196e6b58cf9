"""The conversion of actions to tool calls and moves, in both directions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from gymnasium import Space
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.errors import InputError, ScopeError, ToolCallError, UnknownNameError
from scope_ptz.gym import MoveScale, finish_action, move_action, tool_action
from scope_ptz.gym.move_actions import move_of, move_space
from scope_ptz.gym.observations import CHARSET, clean_text, text_space
from scope_ptz.gym.tool_actions import CHOICES, MAX_PHRASE_CHARS, OUTCOMES, Call, Finish, decode_action, tool_space
from scope_ptz.tools.registry import TOOLS, parse_call

SPACE: Space[Any] = tool_space()
phrases = st.text(sorted(CHARSET), min_size=1, max_size=60).filter(lambda text: bool(text.strip()))
views = st.sampled_from(["current", "full"])
degrees = st.floats(-180, 180, allow_nan=False)
adjustments = st.fixed_dictionaries(
    {},
    optional={
        "pan_deg": degrees, "tilt_deg": degrees, "zoom_factor": st.floats(0.02, 50), "zoom_limit": st.sampled_from(["in", "out"]),
    },
).filter(lambda arguments: not {"zoom_factor", "zoom_limit"} <= set(arguments))  # fmt: skip
calls = st.one_of(
    adjustments.map(lambda arguments: ("adjust_ptz", arguments)),
    st.sampled_from(["go_home", "get_presets", "take_image"]).map(lambda name: (name, {})),
    phrases.map(lambda name: ("go_to_preset", {"name": name})),
    st.tuples(phrases, views).map(lambda part: ("count_objects", {"description": part[0], "view": part[1]})),
    st.tuples(phrases, views).map(lambda part: ("query_answer", {"question": part[0], "view": part[1]})),
    phrases.map(lambda text: ("zoom_to_object", {"description": text})),
    st.tuples(phrases, st.floats(0.1, 600)).map(lambda part: ("track_object", {"description": part[0], "duration_s": part[1]})),
)


def test_the_choices_are_the_tools_and_the_outcomes() -> None:
    assert (*TOOLS, "answered", "clarification", "refused") == CHOICES


@given(calls)
def test_a_call_survives_as_an_action(call: tuple[str, dict[str, Any]]) -> None:
    name, arguments = call
    action = tool_action(name, **arguments)
    assert action in SPACE
    decoded = decode_action(action)
    assert isinstance(decoded, Call)
    # An argument that changes nothing may be left out; the tool then uses its default.
    neutral = {"pan_deg": 0.0, "tilt_deg": 0.0, "zoom_factor": 1.0}
    assert decoded.arguments == {key: value for key, value in arguments.items() if neutral.get(key) != value}


@given(phrases, st.sampled_from(OUTCOMES))
def test_an_answer_survives_as_an_action(text: str, outcome: str) -> None:
    action = finish_action(text, outcome)
    assert action in SPACE
    assert decode_action(action) == Finish(outcome, text)  # type: ignore[arg-type]


@given(st.integers(0, 2**32 - 1))
def test_every_action_of_the_space_is_a_valid_call_or_an_answer(seed: int) -> None:
    SPACE.seed(seed)
    action = SPACE.sample()
    decoded = decode_action(action)
    if isinstance(decoded, Call):
        if not action["text"].strip():
            return  # the tool reports an empty text to the agent
        parse_call(decoded.name, decoded.arguments)


def test_percent_is_a_factor() -> None:
    decoded = decode_action(tool_action("adjust_ptz", zoom_percent=50.0))
    assert decoded == Call("adjust_ptz", {"zoom_factor": 1.5})


def test_wrong_tool_actions() -> None:
    with pytest.raises(ToolCallError):
        tool_action("jump")
    with pytest.raises(ToolCallError):
        tool_action("count_objects")
    with pytest.raises(InputError, match="pan_deg"):
        tool_action("adjust_ptz", pan_deg=400.0)
    with pytest.raises(UnknownNameError):
        finish_action("yes", "agreed")
    good = tool_action("count_objects", description="cars")
    for broken in ({**good, "tool": 99}, {**good, "tool": -1}, {**good, "view": 7}, {"tool": 5}, {**good, "tool": "cars"}):
        with pytest.raises(InputError, match="action space"):
            decode_action(broken)


@given(st.text(max_size=MAX_PHRASE_CHARS))
def test_clean_text_is_in_the_space(text: str) -> None:
    assert clean_text(text) in text_space()


@given(st.floats(-180, 180), st.floats(-90, 90), st.floats(0.2, 5.0), st.booleans())
def test_a_move_survives_as_an_action(pan_deg: float, tilt_deg: float, zoom_factor: float, finish: bool) -> None:
    action = move_action(pan_deg, tilt_deg, zoom_factor, finish=finish)
    assert action in move_space()
    move = move_of(action, MoveScale())
    assert move.finish == finish
    assert math.isclose(move.pan_deg, pan_deg, abs_tol=1e-4)
    assert math.isclose(move.tilt_deg, tilt_deg, abs_tol=1e-4)
    assert math.isclose(move.zoom_factor, zoom_factor, rel_tol=1e-5)


@given(st.lists(st.floats(-1e6, 1e6), min_size=4, max_size=4))
def test_actions_beyond_the_space_are_clipped(action: list[float]) -> None:
    scale = MoveScale(60.0, 30.0, 2.0)
    assert move_of(action, scale) == move_of(np.clip(action, -1, 1), scale)
    move = move_of(action, scale)
    assert abs(move.pan_deg) <= 60
    assert abs(move.tilt_deg) <= 30
    assert 0.5 <= move.zoom_factor <= 2


@pytest.mark.parametrize("action", [[0, 0, 0], [[0, 0, 0, 0]], [0, 0, math.nan, 0], [math.inf, 0, 0, 0], "left", None, {"pan": 1}])
def test_wrong_moves(action: Any) -> None:
    with pytest.raises(InputError, match="four finite numbers"):
        move_of(action, MoveScale())


@pytest.mark.parametrize("scale", [(0, 1, 2), (1, -1, 2), (1, 1, 1), (1, math.nan, 2)])
def test_wrong_scales(scale: tuple[float, float, float]) -> None:
    with pytest.raises(ScopeError, match="MoveScale"):
        MoveScale(*scale)
