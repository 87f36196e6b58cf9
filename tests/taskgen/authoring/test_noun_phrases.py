"""Noun phrases: plurals, articles, lists and attributes."""

from __future__ import annotations

import pytest

from scope_ptz.taskgen.authoring.categories.descriptor_tasks import one_of
from scope_ptz.taskgen.authoring.noun_phrases import about, article, listing, many_of, noun_of, plain_colour, plural, unit_of
from scope_ptz.taskgen.facts.kinds import Kind


@pytest.mark.parametrize(
    ("one", "many"),
    [
        ("car", "cars"), ("bus", "buses"), ("lorry", "lorries"), ("bench", "benches"), ("box lorry", "box lorries"),
        ("person", "people"), ("woman", "women"), ("banksman", "banksmen"), ("toolbox", "toolboxes"), ("tram", "trams"),
        ("child", "children"), ("pile of sand", "piles of sand"), ("emergency phone", "emergency phones"), ("shelf", "shelves"),
        ("traffic cone", "traffic cones"), ("gantry", "gantries"), ("tray", "trays"), ("pallet of bags", "pallets of bags"),
        ("loaf", "loaves"), ("stack of tyres", "stacks of tyres"), ("hanging basket", "hanging baskets"),
    ],
)  # fmt: skip
def test_plurals(one: str, many: str) -> None:
    assert plural(one) == many


@pytest.mark.parametrize(
    ("noun", "said"),
    [
        ("orange cone", "an orange cone"),
        ("car", "a car"),
        ("umbrella", "an umbrella"),
        ("used car", "a used car"),
        ("excavator", "an excavator"),
        ("SUV", "an SUV"),
        ("estate agent board", "an estate agent board"),
    ],
)
def test_articles(noun: str, said: str) -> None:
    assert article(noun) == said


def test_lists() -> None:
    assert listing(["a"]) == "a"
    assert listing(["a", "b", "c"], "or") == "a, b or c"


def test_names_of_kinds() -> None:
    assert noun_of(Kind("traffic cone", "orange")) == "orange traffic cone"
    assert noun_of(Kind("worker", None, ("vest", "orange"))) == "worker in an orange vest"
    assert many_of(Kind("worker", None, ("helmet", "white"))) == "workers in white helmets"
    assert many_of(Kind("person", None, ("state", "sitting"))) == "people who are sitting"
    assert many_of(Kind("cross")) == "pharmacy crosses"
    assert many_of(Kind("tyre stack")) == "stacks of tyres"
    assert unit_of(Kind("traffic cone")) == ("traffic cone", "cone")
    assert about(Kind("car", "red")) == ("car",)


def test_shades_map_to_their_plain_colour() -> None:
    assert plain_colour("dark blue") == "blue"
    assert plain_colour("red and white") is None


def test_values_with_the_same_meaning_share_an_option() -> None:
    kinds = ["road", "road bicycle", "step-through bicycle", "town"]
    assert one_of("road bicycle", kinds, "bicycle") == {
        "road bicycle": ("road",),
        "step-through bicycle": ("step-through",),
        "town": (),
    }
    assert "cast iron" in one_of("iron", ["cast iron", "iron", "stone"], "bench")["iron"]
    assert list(one_of("box", ["box", "horsebox", "tipper"], "lorry")) == ["box", "horsebox", "tipper"]
