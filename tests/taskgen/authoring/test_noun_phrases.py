"""Noun phrases: plurals, articles, lists and attributes."""

from __future__ import annotations

import pytest

from scope_ptz.taskgen.authoring.categories.descriptor_tasks import options_with
from scope_ptz.taskgen.authoring.noun_phrases import (
    answer_words,
    join_names,
    object_words,
    plain_colour,
    plural_noun,
    pluralise,
    singular_noun,
    with_article,
)
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
    assert pluralise(one) == many


@pytest.mark.parametrize(
    ("noun", "expected"),
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
def test_articles(noun: str, expected: str) -> None:
    assert with_article(noun) == expected


def test_lists() -> None:
    assert join_names(["a"]) == "a"
    assert join_names(["a", "b", "c"], "or") == "a, b or c"


def test_names_of_kinds() -> None:
    assert singular_noun(Kind("traffic cone", "orange")) == "orange traffic cone"
    assert singular_noun(Kind("worker", None, ("vest", "orange"))) == "worker in an orange vest"
    assert plural_noun(Kind("worker", None, ("helmet", "white"))) == "workers in white helmets"
    assert plural_noun(Kind("person", None, ("state", "sitting"))) == "people who are sitting"
    assert plural_noun(Kind("cross")) == "pharmacy crosses"
    assert plural_noun(Kind("tyre stack")) == "stacks of tyres"
    assert answer_words(Kind("traffic cone")) == ("traffic cone", "cone")
    assert object_words(Kind("car", "red")) == ("car",)


def test_shades_map_to_their_plain_colour() -> None:
    assert plain_colour("dark blue") == "blue"
    assert plain_colour("red and white") is None


def test_values_with_the_same_meaning_share_an_option() -> None:
    kinds = ["road", "road bicycle", "step-through bicycle", "town"]
    assert options_with("road bicycle", kinds, "bicycle") == {
        "road bicycle": ("road",),
        "step-through bicycle": ("step-through",),
        "town": (),
    }
    assert "cast iron" in options_with("iron", ["cast iron", "iron", "stone"], "bench")["iron"]
    assert list(options_with("box", ["box", "horsebox", "tipper"], "lorry")) == ["box", "horsebox", "tipper"]
