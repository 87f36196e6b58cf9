"""States of parts with a compound name, loads, drivers, and answers that tell several things apart."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_description, parse_question
from scope_ptz.errors import NotUnderstoodError
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import View, read_view
from tests.perception import yard

CHANGES: dict[str, dict[str, Any]] = {
    "gate-01": {"category": "barrier arm", "name": "raised barrier arm", "attributes": {"state": "raised"}},
    "fence-panel-01": {"category": "barrier arm", "name": "lowered barrier arm", "attributes": {"state": "lowered"}},
    "excavator-01": {
        "category": "forklift",
        "name": "forklift",
        "attributes": {"colour": "yellow", "carrying": "pallet of crates"},
    },
    "roller-01": {"category": "door", "name": "middle station door", "attributes": {"state": "open"}},
    "lamp-post-01": {"category": "door", "name": "left station door", "attributes": {"state": "closed"}},
    "lamp-post-02": {"category": "dock light", "name": "dock light", "attributes": {"colour": "green", "state": "lit"}},
    "cone-01": {"category": "worker", "name": "worker", "attributes": {"helmet": "red"}},
    "cone-02": {"category": "worker", "name": "worker", "attributes": {"helmet": "blue"}},
    "tree-01": {"category": "pallet", "name": "pallet", "attributes": {"load": "crates"}},
    "sign-03": {"category": "pallet", "name": "pallet", "attributes": {"load": "cartons"}},
}


def yard_with(changes: dict[str, dict[str, Any]]) -> View:
    """Return a view of the yard in which other things stand in some places."""
    truth = yard.truth()
    instances = {i.id: i.model_copy(update=changes.get(i.id, {})) for i in yard.SCENE.instances}
    scene = yard.SCENE.model_copy(update={"instances": list(instances.values())})
    sightings = tuple(replace(s, instance=instances.get(s.instance.id, s.instance)) for s in truth.sightings)
    return read_view(replace(truth, sightings=sightings), scene, 5.0)


VIEW = yard_with(CHANGES)


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("how many barriers are open?", "1 barrier is open."),
        ("how many barriers are lowered?", "1 barrier is lowered."),
        ("is the barrier raised?", "Yes, 1 of the 2 barrier arms is raised: the one on the left."),
        ("is there a raised barrier?", "Yes, there is a raised barrier arm on the left."),
        (
            "is the station door open?",
            "Yes, 1 of the 2 station doors is open: the middle station door, on the right of the picture.",
        ),
        ("are there any traffic lights?", "Yes, there is a green dock light on the right."),
        ("is the forklift carrying anything?", "Yes, the forklift is carrying a pallet of crates."),
        ("what colour is the load of the forklift?", "I cannot tell the colour of the load of the forklift."),
        ("who is driving forklift?", "I cannot see who is in the forklift."),
        ("how many cats and dogs are there?", "There are no cats or dogs in view."),
        ("what is the load of the pallets?", "Of the 2 pallets, 1 is carrying crates and 1 is carrying cartons."),
        (
            "what colour is the helmet of the worker on the left?",
            "The helmet of the worker on the left is yellow and the helmets of the 2 workers at the bottom left are red and blue.",
        ),
    ],
)
def test_states_and_loads(question: str, expected: str) -> None:
    assert answer(VIEW, parse_question(question))[0] == expected


def test_the_barrier_is_the_barrier_arm_and_not_a_block_beside_it() -> None:
    assert [t.name for t in find(VIEW, parse_description("barrier"))] == ["raised barrier arm", "lowered barrier arm"]
    assert [t.name for t in find(VIEW, parse_description("water-filled barrier"))] == ["water-filled barrier"]


@pytest.mark.parametrize(
    ("driver", "expected"), [("yes", "Yes, the excavator has a driver."), ("no", "No, the excavator has no driver.")]
)
def test_a_driver_whom_the_scene_states_can_be_seen(driver: str, expected: str) -> None:
    view = yard_with({"excavator-01": {"attributes": {"colour": "yellow", "driver": driver}}})
    assert answer(view, parse_question("is anyone driving the excavator?"))[0] == expected


@pytest.mark.anyio
@pytest.mark.parametrize("question", ["who is not wearing one?", "how many people have one?"])
async def test_one_without_an_earlier_sentence_is_not_understood(question: str) -> None:
    truth = GroundTruthPerception(lambda _: yard.StandInScene(), lambda *_: yard.truth())  # type: ignore[arg-type, return-value]
    with pytest.raises(NotUnderstoodError, match="'one'"):
        await truth.query(yard.frame(), question)


def test_what_somebody_carries_is_not_what_they_wear() -> None:
    cyclist = {"category": "cyclist", "name": "cyclist"}
    view = yard_with({"worker-01": {**cyclist, "attributes": {"carrying": "clipboard", "vest": "orange"}}})
    assert answer(view, parse_question("is the cyclist carrying anything?")).text == "Yes, the cyclist is carrying a clipboard."
    assert answer(view, parse_question("is the cyclist wearing anything?")).text == "Yes, the cyclist is wearing an orange vest."
    bare = yard_with({"worker-01": {**cyclist, "attributes": {"carrying": "clipboard"}}})
    assert not answer(bare, parse_question("is the cyclist wearing anything?")).known


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is there a barrier in the middle?", "Yes, there is a red and white water-filled barrier in the middle."),
        ("is there any barrier in the middle?", "Yes, there is a red and white water-filled barrier in the middle."),
        ("is there a barrier next to the lorry?", "Yes, there is a red and white water-filled barrier in the middle."),
        ("how many barriers are there?", "There are 3 barriers in view."),
        ("are there at least 3 barriers?", "Yes, there are 3 barriers."),
    ],
)
def test_any_barrier_may_be_an_arm_or_a_block(question: str, expected: str) -> None:
    assert answer(VIEW, parse_question(question)).text == expected


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("how many buses are empty?", "No buses are empty."),
        ("is there an empty bus?", "No, there is no empty bus in view."),
        ("how many full lorries are there?", "There are no full lorries in view."),
    ],
)
def test_a_bus_shelter_is_no_bus(question: str, expected: str) -> None:
    changes: dict[str, dict[str, Any]] = {
        "cabin-01": {"category": "bus shelter", "name": "bus shelter", "attributes": {"state": "empty"}},
        "lorry-01": {"category": "lorry park", "name": "lorry park", "attributes": {"state": "full"}},
    }
    assert answer(yard_with(changes), parse_question(question)).text == expected


def test_the_woman_is_who_is_stated_to_be_one() -> None:
    view = yard_with({"worker-01": {"name": "woman"}})
    assert [t.id for t in find(view, parse_description("the woman"))] == ["worker-01"]
    assert answer(view, parse_question("how far away is the woman?")).text == "The woman is about 35 m away."


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("is there a man walking?", "There is a person walking, at the bottom, but I cannot tell whether it is a man."),
        ("is there a man on the left?", "There is a person on the left, but I cannot tell whether it is a man."),
    ],
)
def test_a_person_of_unknown_sex_is_described_once(question: str, expected: str) -> None:
    assert answer(yard_with({}), parse_question(question)).text == expected
