"""Collect the words and numbers that can support a call, from the instruction and from the results of earlier calls."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from scope_ptz import english
from scope_ptz.english.grammar.numbers import read_number
from scope_ptz.planner.base import Exchange

_WORD = re.compile(r"\d+/\d+|[-+]?\d+(?:\.\d+)?|[^\W\d_]+(?:'[^\W\d_]+)?|[,;:.!?()\n]")
_QUOTED = re.compile(r'"[^"]*"|“[^”]*”')
_CLAUSE_ENDS = frozenset(",;:.!?()\n") | {"and", "then", "but", "or", "so", "just"}
_NEGATIONS = frozenset(
    {"not", "never", "without", "no", "avoid", "cannot", "instead", "don't", "dont", "doesn't", "won't", "can't"}
)
_MULTIPLES = {
    "once": 1.0,
    "twice": 2.0,
    "double": 2.0,
    "doubled": 2.0,
    "thrice": 3.0,
    "triple": 3.0,
    "quadruple": 4.0,
    "halve": 0.5,
}
_SPELLINGS = {"color": "colour", "colors": "colour", "gray": "grey", "center": "centre", "meter": "metre", "meters": "metre"}
_MAX_NUMBER_WORDS = 8  # words
_OBSERVATION_FIELDS = ("answer", "caption", "chosen")
"""The fields of tool results that contain text from perception."""

_KEEP_STILL = re.compile(
    r"\b(?:without (?:moving|turning|panning|any move)"
    r"|(?:do not|don'?t|never) (?:move|turn|touch)\b(?! (?:it |the camera )?(?:to|left|right))"
    r"|from here|keep (?:the camera |it )?still|stay (?:put|where you are)|leave the camera(?: where it is| as it is| alone))",
    re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class Evidence:
    """The words and numbers that can support a call.

    Attributes:
        user_words: The user's words outside negated clauses, in order and in lower case.
        base_forms: The base forms of all words from the user and from perception.
        observed_words: The words in text from perception, in lower case, without quoted text on signs.
        numbers: The numbers in the user's words and in results.
        keep_still: Whether the user forbids camera moves.
    """

    user_words: tuple[str, ...] = ()
    base_forms: frozenset[str] = frozenset()
    observed_words: tuple[str, ...] = ()
    numbers: tuple[float, ...] = ()
    keep_still: bool = False


def collect_evidence(texts: Sequence[str], exchanges: Iterable[Exchange]) -> Evidence:
    """Collect the evidence in the user's texts and in the results of earlier calls.

    Text on signs, which perception quotes, supports object descriptions but not directions or numbers, because a sign must not
    steer the camera.
    """
    results = [outcome.result for exchange in exchanges for outcome in exchange.outcomes if outcome.result]
    observed = [str(result[name]) for result in results for name in _OBSERVATION_FIELDS if result.get(name)]
    described = [str(result["description"]) for result in results if result.get("description")]
    user_words = tuple(word for text in texts for word in _without_negated(words_of(text)))
    observed_words = tuple(word for text in observed for word in words_of(_QUOTED.sub(" ", text)))
    counts = tuple(float(result["count"]) for result in results if isinstance(result.get("count"), int | float))
    return Evidence(
        user_words=user_words,
        base_forms=frozenset(base_form(word) for text in (*texts, *observed, *described) for word in words_of(text)),
        observed_words=observed_words,
        numbers=(*numbers_in(user_words), *numbers_in(observed_words), *counts),
        keep_still=any(_KEEP_STILL.search(text) for text in texts),
    )


def words_of(text: str) -> list[str]:
    """Return the words, numbers and punctuation marks of a text, in lower case."""
    plain = unicodedata.normalize("NFKC", text).lower().replace("’", "'").replace("−", "-")
    return _WORD.findall(plain)


def base_form(word: str) -> str:
    """Return a word's singular in British spelling, so that different forms of a word compare equal."""
    word = _SPELLINGS.get(word, word).removesuffix("'s")
    return english.singular(word) if word.isalpha() else word


def numbers_in(words: Sequence[str]) -> tuple[float, ...]:
    """Return the numbers among words: digits, number words, fractions, and multiples such as "twice"."""
    return tuple(_numbers(list(words)))


def _numbers(words: list[str]) -> Iterator[float]:
    i = 0
    while i < len(words):
        if words[i] in _MULTIPLES:
            yield _MULTIPLES[words[i]]
        number = read_number(words[i : i + _MAX_NUMBER_WORDS])
        if number.used and number.kind != "ORDINAL":
            yield abs(number.value)
        i += max(number.used, 1)


def _without_negated(words: Sequence[str]) -> Iterator[str]:
    """Yield the words that are not part of a clause such as "but do not zoom"."""
    is_negated = False
    for word in words:
        is_negated = word not in _CLAUSE_ENDS and (is_negated or word in _NEGATIONS)
        if not is_negated:
            yield word
