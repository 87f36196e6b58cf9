"""Descriptions in the answers of the planner have the right number and pronoun."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.execution.answer_sentences import chosen_text, noun, object_pronoun, sentence


@pytest.mark.parametrize(
    ("description", "plural"),
    [("man pointing", "men pointing"), ("worker carrying a box", "workers carrying a box"), ("market awning", "market awnings")],
)
def test_a_participle_after_a_person_has_no_plural(description: str, plural: str) -> None:
    assert noun(description, 6) == plural


def test_a_name_that_does_not_tell_things_apart_is_left_out() -> None:
    assert chosen_text("white van", 3, "white van") == "one of the 3 white vans in view"
    assert chosen_text("signs", 3, "the Plough sign") == "one of the 3 signs in view, the Plough sign"


@pytest.mark.parametrize(("description", "pronoun"), [("man in the vest", "them"), ("forklift", "it"), ("white van", "it")])
def test_people_are_no_things(description: str, pronoun: str) -> None:
    assert object_pronoun(description) == pronoun


def test_a_number_that_belongs_to_the_next_word_is_kept() -> None:
    assert chosen_text("one way signs", 3, "") == "one of the 3 one way signs in view"
    assert chosen_text("two skips", 2, "") == "one of the 2 skips in view"


def test_a_sentence_has_one_full_stop() -> None:
    assert sentence("there is one. (Source: the camera.)") == "There is one. (Source: the camera.)"
    assert sentence("there is one (at least)") == "There is one (at least)."


def test_a_number_before_a_name_that_begins_with_one_is_a_word() -> None:
    assert chosen_text("5 mph sign", 2, "5 mph sign") == "one of the two 5 mph signs in view"
    assert chosen_text("sign", 2, "the Plough sign") == "one of the 2 signs in view, the Plough sign"
