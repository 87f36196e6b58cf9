"""Descriptions of calls can be parsed back exactly, including those in a question."""

from __future__ import annotations

from typing import Any

from hypothesis import example, given
from hypothesis import strategies as st

from scope_ptz.planner.base import ToolCall
from scope_ptz.planner.hybrid.call_words import call_from_words, call_in_words
from scope_ptz.planner.hybrid.confirmation import confirmation_question, proposed_calls

_DEGREES = st.floats(-400, 400, allow_nan=False).filter(bool)
_TEXTS = st.text(min_size=1, max_size=60)
_VIEWS = st.sampled_from(["current", "full"])


def _moves() -> st.SearchStrategy[dict[str, Any]]:
    zooms: st.SearchStrategy[dict[str, Any]] = st.one_of(
        st.just({}),
        st.fixed_dictionaries({"zoom_factor": st.floats(0.01, 100)}),
        st.fixed_dictionaries({"zoom_percent": st.floats(-99, 900)}),
        st.fixed_dictionaries({"zoom_limit": st.sampled_from(["in", "out"])}),
    )
    turns = st.fixed_dictionaries({}, optional={"pan_deg": _DEGREES, "tilt_deg": _DEGREES})
    return st.builds(lambda turn, zoom: {**turn, **zoom}, turns, zooms)


CALLS = st.one_of(
    st.tuples(st.just("adjust_ptz"), _moves()),
    st.tuples(st.just("go_to_preset"), st.fixed_dictionaries({"name": _TEXTS})),
    st.tuples(st.sampled_from(["go_home", "take_image", "get_presets"]), st.just({})),
    st.tuples(st.just("count_objects"), st.fixed_dictionaries({"description": _TEXTS, "view": _VIEWS})),
    st.tuples(st.just("query_answer"), st.fixed_dictionaries({"question": _TEXTS, "view": _VIEWS})),
    st.tuples(st.just("zoom_to_object"), st.fixed_dictionaries({"description": _TEXTS})),
    st.tuples(st.just("track_object"), st.fixed_dictionaries({"description": _TEXTS, "duration_s": st.floats(0.1, 600)})),
    st.tuples(st.just("wipe_lens"), st.dictionaries(_TEXTS, st.one_of(_TEXTS, st.integers()))),
)


@given(CALLS)
@example(("wipe_lens", {"view": "front"}))
def test_a_described_call_can_be_parsed_back(call: tuple[str, dict[str, Any]]) -> None:
    words = call_in_words(ToolCall(id="c", name=call[0], arguments=call[1]))
    assert call_from_words(words) == call


@given(st.lists(CALLS, min_size=1, max_size=4))
def test_the_calls_in_a_question_can_be_parsed_back(calls: list[tuple[str, dict[str, Any]]]) -> None:
    question = confirmation_question([ToolCall(id="c", name=n, arguments=a) for n, a in calls], ["left"])
    assert [(call.name, call.arguments) for call in proposed_calls(question)] == calls


@given(st.text(max_size=200))
def test_other_replies_propose_nothing(reply: str) -> None:
    assert proposed_calls(reply) == ()


def test_a_question_names_the_call_and_what_was_not_mentioned() -> None:
    question = confirmation_question([ToolCall(id="c", name="adjust_ptz", arguments={"pan_deg": -20})], ["left", "20 degrees"])
    assert question == "You did not mention left and 20 degrees. Shall I do this: pan left 20 degrees? Please answer yes or no."
