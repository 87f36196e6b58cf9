"""Lists and predicates in answers are sentences that a native speaker would say."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_description
from scope_ptz.perception.ground_truth.answers.restating import none_in_view
from scope_ptz.perception.ground_truth.answers.thing_names import list_names, names_with_positions
from scope_ptz.perception.ground_truth.view import Thing, View, read_view
from tests.perception import yard


def view() -> View:
    return read_view(yard.truth(), yard.SCENE, 5.0)


def named(*names: str) -> list[Thing]:
    """Return copies of one thing with other names."""
    thing = next(t for t in view().things if t.category == "tree")
    return [
        replace(thing, sighting=replace(thing.sighting, instance=thing.sighting.instance.model_copy(update={"name": name})))
        for name in names
    ]


def test_numbered_things_are_listed_together() -> None:
    assert list_names(named("dock door 5", "gatehouse", "dock door 2", "dock door 7")) == "dock doors 2, 5 and 7 and a gatehouse"
    assert list_names(named("dock door 5", "gatehouse")) == "dock door 5 and a gatehouse"


def test_a_long_list_ends_with_smaller_things() -> None:
    things = named(*"abcdefghij")
    larger = replace(things[9], sighting=replace(things[9].sighting, pixels=10**6))
    listed = list_names([*things[:9], larger])
    assert listed.startswith("a j, ")
    assert listed.endswith(" and smaller things")


def test_equal_things_in_one_place_are_counted() -> None:
    (barrier,) = named("works barrier")
    assert names_with_positions([barrier, barrier]).startswith("2 works barriers ")


@pytest.mark.parametrize(
    ("description", "expected"),
    [
        ("doors on tram", "there are no doors on the tram in view"),
        ("doors on the tram", "there are no doors on the tram in view"),
        ("worker wearing red", "there is no worker wearing red in view"),
    ],
)
def test_an_article_that_is_left_out_is_added(description: str, expected: str) -> None:
    assert none_in_view(view(), parse_description(description)) == expected
