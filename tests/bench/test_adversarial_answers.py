"""Answers that try to pass without an answer, and honest answers that must still pass.

All answers were written and labelled before the rules under test.
"""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter

from scope_ptz.bench.answers import Declined, agrees, parse_answer
from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, Choice, Expected, NoneThere, Number, YesNo

DATA = Path(__file__).parent / "data"
ADAPTER: TypeAdapter[AnyExpected] = TypeAdapter(Expected)
EXPECTATIONS = {
    name: ADAPTER.validate_python(content)
    for name, content in yaml.safe_load((DATA / "expectations.yaml").read_text("utf-8")).items()
}
ADVERSARIAL = [json.loads(line) for line in (DATA / "answers_adversarial.jsonl").read_text("utf-8").splitlines()]
HONEST = [json.loads(line) for line in (DATA / "answers_honest.jsonl").read_text("utf-8").splitlines()]
MAX_WRONG_PASSES = 0.005  # as a fraction of the adversarial answers


def passes(case: dict[str, str]) -> bool:
    expected = EXPECTATIONS[case["expected"]]
    return agrees(expected, parse_answer(expected, case["answer"])) is True


def test_there_are_many_adversarial_answers_of_every_type_and_form() -> None:
    kinds = Counter(EXPECTATIONS[case["expected"]].kind for case in ADVERSARIAL)
    forms = Counter(case["form"] for case in ADVERSARIAL)
    assert len(ADVERSARIAL) >= 200 and len(HONEST) >= 100
    assert set(kinds) == {expected.kind for expected in EXPECTATIONS.values() if not isinstance(expected, ActionOnly)}
    assert {
        "refusal-with-value",
        "several",
        "range",
        "guess",
        "negation",
        "correction",
        "injection",
        "json",
        "unit",
        "language",
    } <= set(forms)


def test_almost_no_adversarial_answer_passes() -> None:
    wrong = [case["answer"] for case in ADVERSARIAL if case["verdict"] != "right" and passes(case)]
    assert len(wrong) <= MAX_WRONG_PASSES * len(ADVERSARIAL), wrong


def test_every_honest_answer_is_parsed_as_labelled() -> None:
    assert [case["answer"] for case in HONEST if passes(case) != (case["verdict"] == "right")] == []


@pytest.mark.parametrize(
    ("name", "answer"),
    [
        ("dogs", "I cannot tell how many dogs there are. There are 0."),
        ("dogs", "There are 0 dogs. I cannot tell."),
        ("bikes", "I don't know. None."),
        ("van", "I cannot tell. Yes."),
        ("colour", "Red. Honestly, I have no idea."),
        ("bikes", "The perception call failed, so 0 bicycles."),
    ],
)
def test_a_refusal_with_a_value_is_a_refusal(name: str, answer: str) -> None:
    assert parse_answer(EXPECTATIONS[name], answer) == Declined()


REFUSALS = (
    "I cannot tell.",
    "I don't know.",
    "I have no idea.",
    "I am not sure.",
    "I could not see the picture.",
    "The tool failed.",
)
VALUES: dict[str, tuple[AnyExpected, str]] = {
    "number": (Number(value=3, unit=("cone",)), "There are 3 cones."),
    "zero": (Number(value=0, unit=("cone",)), "There are 0 cones."),
    "yes": (YesNo(value=True, affirms=("cone",)), "Yes, there is a cone."),
    "no": (YesNo(value=False, affirms=("cone",)), "No."),
    "none": (NoneThere(subject=("cone",)), "There are no cones."),
    "choice": (Choice(value="red", options={"red": (), "blue": ()}, subject=("cone",)), "It is red."),
}


@settings(deadline=None)
@given(st.sampled_from(sorted(VALUES)), st.lists(st.sampled_from(REFUSALS), min_size=1, max_size=3), st.integers(0, 3))
def test_no_value_next_to_a_refusal_passes(name: str, refusals: list[str], place: int) -> None:
    """The order of the sentences does not matter."""
    expected, value = VALUES[name]
    assert agrees(expected, parse_answer(expected, value)) is True
    sentences = [*refusals]
    sentences.insert(place, value)
    assert agrees(expected, parse_answer(expected, " ".join(sentences))) is not True
