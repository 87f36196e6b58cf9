"""Collect the words and numbers on which a call may be based: the instruction and the results of earlier calls."""

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
_BREAKS = frozenset(",;:.!?()\n") | {"and", "then", "but", "or", "so", "just"}
_NEGATING = frozenset({"not", "never", "without", "no", "avoid", "cannot", "instead", "don't", "dont", "doesn't", "won't", "can't"})
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
_LONGEST_NUMBER = 8  # words
_TEXTS = ("answer", "caption", "chosen")
"""The fields of results that contain what perception saw in words."""

_KEEPS_STILL = re.compile(
    r"\b(?:without (?:moving|turning|panning|any move)"
    r"|(?:do not|don'?t|never) (?:move|turn|touch)\b(?! (?:it |the camera )?(?:to|left|right))"
    r"|from here|keep (?:the camera |it )?still|stay (?:put|where you are)|leave the camera(?: where it is| as it is| alone))",
    re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class Grounds:
    """The words and numbers on which a call may be based.

    Attributes:
        said: The words of the user that are not part of a negated clause, in order, in lower case.
        words: The base forms of all words of the user and of what perception saw.
        seen: The words of what perception saw, in lower case, without the texts on signs.
        numbers: The numbers that the user gave, and those in results.
        is_still: Whether the user asks not to move the camera.
    """

    said: tuple[str, ...] = ()
    words: frozenset[str] = frozenset()
    seen: tuple[str, ...] = ()
    numbers: tuple[float, ...] = ()
    is_still: bool = False


def grounds_of(texts: Sequence[str], exchanges: Iterable[Exchange]) -> Grounds:
    """Return the grounds in the user's texts and in the results of earlier calls.

    Texts on signs, which perception quotes, support descriptions of things, but no directions and no numbers: what stands on a sign
    must not steer the camera.
    """
    results = [outcome.result for exchange in exchanges for outcome in exchange.outcomes if outcome.result]
    observed = [str(result[name]) for result in results for name in _TEXTS if result.get(name)]
    described = [str(result["description"]) for result in results if result.get("description")]
    said = tuple(word for text in texts for word in _not_negated(words_of(text)))
    seen = tuple(word for text in observed for word in words_of(_QUOTED.sub(" ", text)))
    counts = tuple(float(result["count"]) for result in results if isinstance(result.get("count"), int | float))
    return Grounds(
        said=said,
        words=frozenset(base_form(word) for text in (*texts, *observed, *described) for word in words_of(text)),
        seen=seen,
        numbers=(*numbers_in(said), *numbers_in(seen), *counts),
        is_still=any(_KEEPS_STILL.search(text) for text in texts),
    )


def words_of(text: str) -> list[str]:
    """Return the words, numbers and punctuation marks of a text in lower case."""
    plain = unicodedata.normalize("NFKC", text).lower().replace("’", "'").replace("−", "-")
    return _WORD.findall(plain)


def base_form(word: str) -> str:
    """Return a word in the singular and in British spelling, so that forms of one word are equal."""
    word = _SPELLINGS.get(word, word).removesuffix("'s")
    return english.singular(word) if word.isalpha() else word


def numbers_in(words: Sequence[str]) -> tuple[float, ...]:
    """Return the numbers among words: digits, number words, fractions and multiples such as "twice"."""
    return tuple(_numbers(list(words)))


def _numbers(words: list[str]) -> Iterator[float]:
    i = 0
    while i < len(words):
        if words[i] in _MULTIPLES:
            yield _MULTIPLES[words[i]]
        number = read_number(words[i : i + _LONGEST_NUMBER])
        if number.used and number.kind != "ORDINAL":
            yield abs(number.value)
        i += max(number.used, 1)


def _not_negated(words: Sequence[str]) -> Iterator[str]:
    """Yield the words that are not part of a clause such as "but do not zoom"."""
    is_negated = False
    for word in words:
        is_negated = word not in _BREAKS and (is_negated or word in _NEGATING)
        if not is_negated:
            yield word
