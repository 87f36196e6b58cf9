"""Places: surfaces of which the frame shows only a part, the fronts of buildings, trades, and references that are not in view."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.view import View, read_view
from tests.perception import yard

SHOP = {
    "category": "shop",
    "name": "butcher's shop",
    "attributes": {"state": "open"},
    "box_min_m": (10.0, 20.0, 0.0),
    "box_max_m": (14.0, 60.0, 6.0),
}
CUSTOMER = {"box_min_m": (8.7, 39.75, 0.0), "box_max_m": (9.3, 40.25, 1.8)}


def yard_with(changes: dict[str, dict[str, Any]], cut_off: str = "") -> View:
    """Return a view of the yard with other things in some places; the frame cuts off most of ``cut_off``."""
    instances = [i.model_copy(update=changes.get(i.id, {})) for i in yard.SCENE.instances]
    boxes = {i.id: yard.sighting(i, i.box_min_m, i.box_max_m, yard.PROJECTION) for i in instances}
    truth = yard.truth()
    sightings = [boxes.get(s.instance.id, s) for s in truth.sightings]
    seen = tuple(replace(s, visible_fraction=0.1, cut=True) if s.instance.id == cut_off else s for s in sightings)
    return read_view(replace(truth, sightings=seen), yard.SCENE.model_copy(update={"instances": instances}), 5.0)


STREET = yard_with({"cabin-01": SHOP, "worker-01": CUSTOMER})


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is the butcher open?", "Yes, the butcher is open."),
        ("how many people are in front of the butcher?", "2 people are in front of the butcher."),
        ("how many people are behind the butcher?", "No people are behind the butcher."),
        ("who is nearest to the butcher?", "It is the worker on the right, about 40 m away."),
        ("who is nearest to the bus?", "There is no bus in view."),
        ("who is nearest to the crossing?", "I cannot tell who is nearest to the crossing."),
        ("which car is nearest to the crossing?", "I cannot tell which car is nearest to the crossing."),
    ],
)
def test_places(question: str, expected: str) -> None:
    assert answer(STREET, parse_question(question)).text == expected


def test_people_stand_on_a_road_of_which_the_frame_shows_a_part() -> None:
    question = parse_question("how many workers are on the road?")
    assert answer(yard_with({}, cut_off="road-01"), question) == answer(yard_with({}), question)
    assert answer(yard_with({}), question).text == "3 workers are on the road."


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("are there orange cones or a red one?", "Yes, there are 6 orange cones and no red cones."),
        (
            "is there a white car or a red one?",
            "Yes, there is 1 white car and 1 red car: a red saloon car on the left and a white hatchback on the left.",
        ),
    ],
)
def test_one_stands_for_the_noun_before_it(question: str, expected: str) -> None:
    assert answer(yard_with({}), parse_question(question)).text == expected


@pytest.mark.parametrize(
    "question",
    [
        "is the butcher a man?",
        "is the butcher wearing a helmet?",
        "is the butcher walking?",
        "what is the butcher wearing?",
        "how many butchers are there?",
    ],
)
def test_the_person_whose_trade_names_a_shop_is_not_the_shop(question: str) -> None:
    expected = "I can see a butcher's shop, but I cannot tell who is a butcher."
    assert answer(STREET, parse_question(question)) == (expected, False)


def test_an_office_does_not_show_its_manager() -> None:
    view = yard_with({"cabin-01": {"category": "cabin", "name": "manager's office", "attributes": {}}})
    assert answer(view, parse_question("how many managers are there?")).text == "There are no managers in view."


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is there a car outside the road?", "I cannot tell whether there is a car outside the road."),
        ("how many cars are outside the road?", "I cannot tell how many cars are outside the road."),
        ("is there a car outside the site?", "I cannot tell whether there is a car outside the site."),
        ("are there people outside the butcher's shop?", "Yes, there is a worker on the right."),
        ("how many people are outside the butcher?", "1 person is outside the butcher."),
    ],
)
def test_a_road_and_a_site_have_no_outside(question: str, expected: str) -> None:
    assert answer(STREET, parse_question(question)).text == expected


def test_nobody_inside_a_building_is_outside_it() -> None:
    inside = {"box_min_m": (11.7, 39.75, 0.2), "box_max_m": (12.3, 40.25, 2.0)}
    view = yard_with({"cabin-01": SHOP, "worker-01": inside})
    assert answer(view, parse_question("how many people are outside the butcher?")).text == "No people are outside the butcher."


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is there a bus and a car?", "No, there is no bus in view, but there are 4 cars."),
        ("is there a van, a bus and a car?", "No, there is no bus in view, but there is 1 van and 4 cars."),
        ("are there any cones and cars?", "Yes, there are 6 cones and 4 cars."),
        ("is there a woman and a car?", "I cannot tell whether there is a woman."),
        ("is there a woman or a car?", "Yes, there are 4 cars."),
    ],
)
def test_and_asks_for_all_kinds(question: str, expected: str) -> None:
    assert answer(yard_with({}), parse_question(question)).text == expected
