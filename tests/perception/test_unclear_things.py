"""Things too small, hidden or cut off to count as visible: a count is a lower bound, and none of them is called absent."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.view import read_view
from scope_ptz.simulator.truth import ViewTruth
from tests.perception import yard


def seen(**pixels: int) -> ViewTruth:
    """Return the ground truth of the yard, in which some things have only so many visible pixels; keys have no hyphens."""
    truth = yard.truth()
    sightings = tuple(replace(s, pixels=pixels.get(s.instance.id.replace("-", ""), s.pixels)) for s in truth.sightings)
    return replace(truth, sightings=sightings)


def cut_off(thing: str) -> ViewTruth:
    """Return the ground truth of the yard, in which the frame cuts off most of one thing."""
    truth = yard.truth()
    sightings = tuple(replace(s, visible_fraction=0.1, cut=True) if s.instance.id == thing else s for s in truth.sightings)
    return replace(truth, sightings=sightings)


AT_LEAST_3 = "There are at least 3 cars in view; there may be more that are "
NO_GATE = "I cannot tell whether there is a gate in view; there may be one that is too small to make out."
NO_GATES = "I cannot tell whether there are any gates in view; there may be some that are too small to make out."


def ask(truth: ViewTruth, question: str) -> tuple[str, bool]:
    return tuple(answer(read_view(truth, yard.SCENE, 5.0), parse_question(question)))  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("truth", "question", "expected"),
    [
        (seen(car02=60), "how many cars are there?", AT_LEAST_3 + "too small to make out."),
        (cut_off("car-02"), "how many cars are there?", AT_LEAST_3 + "only partly in the picture."),
        (seen(car02=60), "are there at least 3 cars?", "Yes, there are at least 3 cars."),
        (seen(car02=60), "are there at least 9 cars?", "No, I can make out only 3 cars."),
        (seen(car02=60), "how many red cars are there?", "There is 1 red car in view."),
        (seen(car02=30), "how many cars are there?", "There are 3 cars in view."),  # a speck beside cars
        (seen(gate01=15), "is there a gate?", "No, there is no gate in view."),
    ],
)  # fmt: skip
def test_a_count_that_may_be_incomplete_is_a_lower_bound(truth: ViewTruth, question: str, expected: str) -> None:
    assert ask(truth, question) == (expected, True)


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is there a gate?", NO_GATE),
        ("are there any gates?", NO_GATES),
        ("how many gates are there?", NO_GATES),
        ("where is the gate?", NO_GATE),
    ],
)  # fmt: skip
def test_what_is_too_small_is_not_absent(question: str, expected: str) -> None:
    assert ask(seen(gate01=30), question) == (expected, False)


@pytest.mark.anyio
@pytest.mark.parametrize(("description", "found", "complete"), [("cars", 3, False), ("red cars", 1, True), ("gates", 0, False)])
async def test_a_search_that_may_miss_things_is_incomplete(description: str, found: int, complete: bool) -> None:
    truth = GroundTruthPerception(lambda _: yard.StandInScene(), lambda *_: seen(car02=60, gate01=30))  # type: ignore[arg-type, return-value]
    detections = await truth.detect(yard.frame(), description)
    assert (len(detections.boxes), detections.complete) == (found, complete)
