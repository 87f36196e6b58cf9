"""Names: what else could bear one rules it out."""

from __future__ import annotations

import pytest

from scope_ptz.simulator.models import SceneInstance
from scope_ptz.taskgen.authoring.noun_phrases import the
from scope_ptz.taskgen.authoring.object_names import alike, bears, spoken


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
def test_what_people_would_call_the_same(named: tuple[str, str], other: tuple[str, str]) -> None:
    assert bears(thing(*other), named[1], thing(*named))


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
def test_what_people_tell_apart(named: tuple[str, str], other: tuple[str, str]) -> None:
    assert not bears(thing(*other), named[1], thing(*named))


def test_attributes_bear_a_name_too() -> None:
    assert bears(thing("worker", "kneeling worker", vest="orange"), "worker in an orange vest", thing("worker", "x"))
    assert not bears(thing("worker", "kneeling worker", vest="green"), "worker in an orange vest", thing("worker", "x"))


def test_articles_before_names() -> None:
    assert the("bakery sign") == "the bakery sign"
    assert the("dock door 5") == "dock door 5"
    assert the(spoken("The Copper Kettle sign")) == "the Copper Kettle sign"
    assert spoken("price of apples") == "price card for apples"
    assert spoken("pedestrian waiting") == "waiting pedestrian"


@pytest.mark.parametrize(("one", "other"), [("navy", "blue"), ("dark red", "red"), ("grey", "silver"), ("black", None)])
def test_boards_of_colours_like_these_are_not_told_apart(one: str, other: str | None) -> None:
    assert alike(one, other)


def test_boards_of_different_colours_are() -> None:
    assert not alike("navy", "dark red") and not alike("green", "brown")
