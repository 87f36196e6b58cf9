"""Names of objects: a name is not used when it could mean another object in the view."""

from __future__ import annotations

import pytest

from scope_ptz.simulator.models import SceneInstance
from scope_ptz.taskgen.authoring.noun_phrases import with_the
from scope_ptz.taskgen.authoring.object_names import are_confusable_colours, name_could_refer_to, name_in_instruction


def thing(category: str, name: str, **attributes: str) -> SceneInstance:
    return SceneInstance(
        id=name, number=1, category=category, name=name, attributes=dict(attributes), box_min_m=(0, 0, 0), box_max_m=(1, 1, 1)
    )


@pytest.mark.parametrize(
    ("named", "other"),
    [
        (("car", "red saloon"), ("car", "dark red hatchback")),
        (("car", "silver saloon"), ("car", "grey SUV")),
        (("van", "white van"), ("van", "white security van")),
        (("person", "person in navy"), ("person", "customer in black")),
        (("worker", "standing worker"), ("worker", "pointing worker")),
        (("pickup truck", "grey pickup truck"), ("van", "grey van")),
        (("lamp post", "tall lamp post"), ("lamp post", "street lamp")),
    ],
)
def test_names_that_could_mean_another_object(named: tuple[str, str], other: tuple[str, str]) -> None:
    assert name_could_refer_to(thing(*other), named[1], thing(*named))


@pytest.mark.parametrize(
    ("named", "other"),
    [
        (("car", "red saloon"), ("car", "blue saloon")),
        (("van", "white security van"), ("van", "white van")),
        (("sign", "visitor parking sign"), ("sign", "staff parking sign")),
        (("worker", "worker with a shovel"), ("worker", "worker with a clipboard")),
        (("car", "red saloon"), ("post box", "red post box")),
    ],
)
def test_names_that_mean_one_object_only(named: tuple[str, str], other: tuple[str, str]) -> None:
    assert not name_could_refer_to(thing(*other), named[1], thing(*named))


def test_attributes_count_as_part_of_a_name() -> None:
    assert name_could_refer_to(thing("worker", "kneeling worker", vest="orange"), "worker in an orange vest", thing("worker", "x"))
    assert not name_could_refer_to(
        thing("worker", "kneeling worker", vest="green"), "worker in an orange vest", thing("worker", "x")
    )


def test_articles_before_names() -> None:
    assert with_the("bakery sign") == "the bakery sign"
    assert with_the("dock door 5") == "dock door 5"
    assert with_the(name_in_instruction("The Copper Kettle sign")) == "the Copper Kettle sign"
    assert name_in_instruction("price of apples") == "price card for apples"
    assert name_in_instruction("pedestrian waiting") == "waiting pedestrian"


@pytest.mark.parametrize(("one", "other"), [("navy", "blue"), ("dark red", "red"), ("grey", "silver"), ("black", None)])
def test_boards_of_similar_colours_are_confusable(one: str, other: str | None) -> None:
    assert are_confusable_colours(one, other)


def test_boards_of_different_colours_are_not_confusable() -> None:
    assert not are_confusable_colours("navy", "dark red") and not are_confusable_colours("green", "brown")
