"""English number words and noun forms."""

from __future__ import annotations

import pytest

from scope_ptz import english
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
