"""English number words and noun forms."""

from __future__ import annotations

from importlib.resources import files

import pytest

from scope_ptz import english
from scope_ptz.english import grammar
from scope_ptz.english.grammar.questions.recognition import looks_like_description
from scope_ptz.english.grammar.questions.word_splitting import split
from scope_ptz.english.grammar.tokens import tokenise
from scope_ptz.english.numerals import CARDINALS


@pytest.mark.parametrize("number", range(100))
def test_number_words_are_parsed_back(number: int) -> None:
    assert english.cardinal(english.number_word(number)) == number
    assert english.cardinal(str(number)) == number


def test_number_words_outside_the_range_are_errors() -> None:
    for number in (-1, 100):
        with pytest.raises(ValueError, match="0 to 99"):
            english.number_word(number)


def test_words_that_are_not_numbers() -> None:
    assert english.cardinal("fivety") is None and english.cardinal("twenty-eleven") is None
    assert english.ordinal("car") is None and "hundred" not in CARDINALS


@pytest.mark.parametrize(
    ("number", "text"),
    [(1, "1st"), (2, "2nd"), (3, "3rd"), (4, "4th"), (11, "11th"), (13, "13th"), (22, "22nd"), (101, "101st"), (111, "111th")],
)
def test_ordinals(number: int, text: str) -> None:
    assert f"{number}{english.ordinal_suffix(number)}" == text
    assert english.ordinal(text) == number


@pytest.mark.parametrize(
    ("phrase", "plural"),
    [("red lorry", "red lorries"), ("lorry with crane", "lorries with crane"), ("glass", "glasses"), ("passer-by", "passers-by")],
)
def test_plural_inflects_the_head_noun(phrase: str, plural: str) -> None:
    assert english.plural(phrase) == plural


@pytest.mark.parametrize(
    ("phrase", "expected"), [("car", "a car"), ("orange cone", "an orange cone"), ("unit", "a unit"), ("cars", "cars")]
)
def test_articles(phrase: str, expected: str) -> None:
    assert english.article(phrase) == expected


def test_lists_and_counts() -> None:
    assert [english.listing(items) for items in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == ["", "a", "a and b", "a, b and c"]
    assert [english.counted(n, "bus") for n in (0, 1, 2)] == ["0 buses", "1 bus", "2 buses"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a hi-vis T-shirt, 24/7", ["a", "hi-vis", "t-shirt", ",", "24/7"]),
        ("the 2nd van's roof isn't 3m", ["the", "2nd", "van", "'s", "roof", "is", "not", "3m"]),
        ("who’s there? nobody", ["who", "is", "there", "no", "person"]),
        ("the sign “Don't Walk” and 'STOP'", ["the", "sign", '"don\'t walk"', "and", '"stop"']),
        ("the workers' ID at the café (closed)", ["the", "workers", "id", "at", "the", "café", "closed"]),
        ("1,000 cones", ["1000", "cones"]),
        ("hw mny poeple at the inn", ["how", "many", "people", "at", "the", "inn"]),
    ],
)
def test_descriptions_are_split_into_words(text: str, expected: list[str]) -> None:
    assert split(text) == expected


@pytest.mark.parametrize(
    ("text", "expected"), [("id like to see", ["i", "would", "like", "to", "see"]), ("the id badge", ["the", "id", "badge"])]
)
def test_id_is_a_contraction_only_before_some_verbs(text: str, expected: list[str]) -> None:
    assert [token.text for token in tokenise(text)] == expected


@pytest.mark.parametrize(
    "text",
    [
        "red cars next to the van", "price list", "meter", "third window", "cars parked there", "man pushing the blue trolley",
        "dust coming off the heap", "sign on it", "zyzzyva in the left lane",
    ],
)  # fmt: skip
def test_noun_phrases_have_the_form_of_descriptions(text: str) -> None:
    assert looks_like_description(text)


@pytest.mark.parametrize("text", ["", "chairs the table on the left", "how many cars", "next to the", "of of", "word " * 50])
def test_other_texts_do_not_have_the_form_of_descriptions(text: str) -> None:
    assert not looks_like_description(text)


def test_shared_word_classes_are_used_by_instructions_and_by_questions() -> None:
    lines = files(grammar).joinpath("closed_class.txt").read_text("utf-8").splitlines()
    classes = [line.partition(": ")[::2] for line in lines if line and not line.startswith("#")]
    assert len({head for head, _ in classes}) == len(classes)
    for head, members in classes:
        if head.startswith("@"):
            assert ", " in members, head
            users = [other for other, words in classes if head in words.split(", ")]
            assert {user.startswith("?") for user in users} == {True, False}, head
