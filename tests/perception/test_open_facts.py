"""What a scene leaves open about people, such as their clothes and their sex, is neither affirmed nor denied."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.errors import NotUnderstoodError
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.view import View, read_view
from tests.perception import yard

PEOPLE: dict[str, dict[str, Any]] = {
    "worker-01": {"name": "woman with a pram", "attributes": {"state": "walking", "pushing": "pram", "top": "green"}},
    "worker-02": {"name": "pedestrian", "attributes": {"state": "standing", "holding": "bag"}},
    "worker-03": {"name": "pedestrian", "attributes": {"state": "standing", "holding": "umbrella"}},
}


def street(attributes: Mapping[str, dict[str, Any]] = MappingProxyType({})) -> View:
    """Return a view of the yard in which the workers are pedestrians, about whom little is stated but the given attributes."""
    truth = yard.truth()
    people = {id_: {**change, "attributes": attributes.get(id_, change["attributes"])} for id_, change in PEOPLE.items()}
    instances = {
        i.id: i.model_copy(update={"category": "pedestrian", **people[i.id]}) if i.id in people else i for i in yard.SCENE.instances
    }
    scene = yard.SCENE.model_copy(update={"instances": list(instances.values())})
    sightings = tuple(replace(s, instance=instances.get(s.instance.id, s.instance)) for s in truth.sightings)
    return read_view(replace(truth, sightings=sightings), scene, 5.0)


VIEW = street()


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        # clothes
        ("how many people have red jackets?", "I cannot tell how many people have red jackets."),
        ("does anyone have a red jacket?", "I cannot tell whether anyone is wearing a red jacket."),
        ("is anyone in a red jacket?", "I cannot tell whether anyone is wearing a red jacket."),
        ("are there any people with red jackets?", "I cannot tell whether there are any people with red jackets."),
        ("how many people are in red?", "I cannot tell how many people are in red."),
        ("is there anyone in green?", "Yes, there is a woman with a pram on the right."),
        ("how many people have helmets?", "No people have helmets."),  # which a scene lists, unlike everyday clothes
        # sex
        ("how many people are women?", "At least 1 person is a woman; I cannot tell which of 2 people are women."),
        ("how many people are men?", "I cannot tell how many people are men."),
        ("is anyone a woman?", "Yes, at least 1 of the 3 people is a woman."),
        ("is anyone a man?", "I cannot tell whether anyone is a man."),
        ("are all the people women?", "I cannot tell whether the people are women."),
        ("is the person with the pram a man or a woman?", "It is a woman."),
        ("is the person with the bag a man or a woman?", "I cannot tell whether the person with a bag is a man or a woman."),
        ("is a man or a woman holding the umbrella?", "I cannot tell whether a man or a woman has an umbrella."),
        ("is there a man with a bag?", "There is a person with a bag, on the left, but I cannot tell whether it is a man."),
        ("where is the man?", "I cannot tell which of 2 people is a man."),
        # activities
        ("is anyone driving?", "I cannot tell whether anyone is driving."),
        ("how many people are driving?", "I cannot tell how many people are driving."),
        ("is anyone crossing?", "I cannot tell whether anyone is crossing."),
        ("how many people are crossing?", "I cannot tell how many people are crossing."),
        ("how many people are walking?", "1 person is walking."),
        # one person has one bag
        ("how many people are carrying bags?", "1 person has a bag."),
    ],
)
def test_what_the_scene_leaves_open_is_neither_affirmed_nor_denied(question: str, expected: str) -> None:
    text, known = answer(VIEW, parse_question(question))
    assert text == expected
    assert known is not ("I cannot tell" in text and not text.startswith("At least"))


def test_a_person_of_unknown_sex_is_not_called_a_lady() -> None:
    assert answer(VIEW, parse_question("what is the lady with the bag doing?")).text == "The person with a bag is standing."
    assert answer(VIEW, parse_question("what is the lady with the pram doing?")).text == "The lady with a pram is walking."


@pytest.mark.anyio
async def test_people_of_whom_an_activity_is_not_stated_are_not_counted_as_none() -> None:
    truth = GroundTruthPerception(lambda _: yard.StandInScene(), lambda *_: yard.truth())  # type: ignore[arg-type, return-value]
    with pytest.raises(NotUnderstoodError, match="I cannot tell which of 3 people are sweeping"):
        await truth.detect(yard.frame(), "people sweeping")


def test_a_yellow_helmet_is_not_yellow_clothing() -> None:
    dressed = street({"worker-01": {"vest": "orange", "helmet": "yellow"}, "worker-02": {"vest": "yellow", "helmet": "blue"}})
    assert answer(dressed, parse_question("how many people are wearing yellow?")).text.startswith("At least 1 person")
    assert answer(dressed, parse_question("how many people have yellow helmets?")).text == "1 person has a yellow helmet."
