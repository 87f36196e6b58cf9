"""Descriptions and questions about the synthetic yard: the objects found, and the answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from scope_ptz import english
from scope_ptz.english.grammar.questions.question_parser import parse_description, parse_question
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import concepts_of, read_view
from scope_ptz.simulator.models import SceneInstance
from tests.perception import yard

VIEW = read_view(yard.truth(), yard.SCENE, 5.0)
HERE = Path(__file__).parent


def table(name: str) -> list[tuple[str, str]]:
    rows = [line.split(" => ", 1) for line in (HERE / name).read_text("utf-8").splitlines() if " => " in line]
    return [(left.strip(), right.strip()) for left, right in rows]


@pytest.mark.parametrize(("description", "ids"), table("descriptions.txt"))
def test_description(description: str, ids: str) -> None:
    assert " ".join(t.id for t in find(VIEW, parse_description(description))) == ids.replace("-", "", ids == "-")


@pytest.mark.parametrize(("question", "expected"), table("questions.txt"))
def test_question(question: str, expected: str) -> None:
    text, known = answer(VIEW, parse_question(question))
    assert ("" if known else "(?) ") + text == expected


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        ("van with pink stripes", "the van with pink stripes"),
        ("golden van on a lead", "golden van on a lead"),
    ],
)
def test_objects_are_found_by_their_full_name(name: str, asked: str) -> None:
    truth = yard.truth()
    named = [
        replace(s, instance=s.instance.model_copy(update={"name": name})) if s.instance.id == "van-01" else s
        for s in truth.sightings
    ]
    found = find(read_view(replace(truth, sightings=tuple(named)), yard.SCENE, 5.0), parse_description(asked))
    assert [t.id for t in found] == ["van-01"]


@pytest.mark.parametrize("absent", yard.ABSENT)
def test_objects_that_the_scene_lists_as_absent_are_not_found(absent: str) -> None:
    assert find(VIEW, parse_description(absent)) == []
    assert answer(VIEW, parse_question(f"is there a {absent}?")) == (f"No, there is no {absent} in view.", True)
    assert answer(VIEW, parse_question(f"how many {absent}s are there?"))[0].startswith("There are no ")


@pytest.mark.parametrize("prefix", ["", "please ", "can you tell me ", "Hey, "])
def test_polite_words_do_not_change_the_answer(prefix: str) -> None:
    assert answer(VIEW, parse_question(prefix + "how many cars are there right now?")) == ("There are 4 cars in view.", True)


def test_illegible_text_is_never_read() -> None:
    for question in (
        "what does the cabin say?",
        "read all the text",
        "describe the cabin",
        "what do you see?",
        "is there text on the cabin?",
    ):
        assert "SITE OFFICE" not in answer(VIEW, parse_question(question)).text
    assert find(VIEW, parse_description("the cabin that says site office")) == []


def test_attributes_that_repeat_a_text_are_not_used() -> None:
    rows = [r if r[0] != "sign-03" else (*r[:5], {**r[5], "reads": "ROAD CLOSED"}, r[6]) for r in yard.ROWS]
    (row,) = (r for r in rows if r[0] == "sign-03")
    instance = yard.INSTANCES[0].model_copy(update={"id": row[0], "name": row[2], "category": row[1], "attributes": row[5]})
    scene = yard.SCENE.model_copy(update={"instances": [instance if i.id == row[0] else i for i in yard.SCENE.instances]})
    view = read_view(yard.truth(), scene, 5.0)
    assert find(view, parse_description("the road closed sign")) == []
    assert find(view, parse_description("the sign that says road closed")) == []


def test_nonsense_is_answered_as_unknown() -> None:
    for question in ("", "???", "flibber the wug", "why?", "a " * 200):
        assert answer(VIEW, parse_question(question)).known is False
    for description in ("???", "a " * 200, "the wug"):
        assert find(VIEW, parse_description(description)) == []


@pytest.mark.parametrize(
    ("many", "one"),
    [
        ("lorries", "lorry"), ("buses", "bus"), ("people", "person"), ("men", "man"), ("boxes", "box"), ("benches", "bench"),
        ("cones", "cone"), ("passers-by", "passer-by"), ("children", "child"), ("sheep", "sheep"), ("taxis", "taxi"),
    ],
)  # fmt: skip
def test_plurals(many: str, one: str) -> None:
    assert english.singular(many) == one
    assert english.plural(one) == many


@pytest.mark.parametrize(("word", "value"), [("7", 7), ("twelve", 12), ("twenty-five", 25), ("zero", 0), ("fivety", None)])
def test_numbers(word: str, value: int | None) -> None:
    assert english.cardinal(word) == value


def test_the_short_form_of_a_category_is_not_another_category() -> None:
    """A "lit cream lamp" in a shop window is a table lamp, although "lamp" in a street mostly means a lamp post."""
    lamp = SceneInstance(
        id="x", number=1, category="table lamp", name="lit cream lamp", attributes={}, box_min_m=(0, 0, 0), box_max_m=(1, 1, 1)
    )
    assert "table lamp" in concepts_of(lamp) and "lamp post" not in concepts_of(lamp)
    assert "lamp post" in concepts_of(lamp.model_copy(update={"category": "lamp post", "name": "street lamp"}))
