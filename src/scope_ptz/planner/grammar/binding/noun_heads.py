"""The head noun of a description, and what kind of thing it names."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache

from scope_ptz.english import is_plural, singular
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in
from scope_ptz.english.grammar.questions.question_parser import parse_description
from scope_ptz.planner.grammar.execution.answer_sentences import head_and_rest

_ANYONE = frozenset({"anyone", "anybody", "someone", "somebody", "everyone", "everybody", "who"})


_NUMBERED = frozenset({
    "bay", "berth", "block", "building", "bus", "channel", "dock", "door", "exit", "floor", "gate", "hall", "hangar",
    "lane", "level", "line", "number", "pad", "phase", "pier", "platform", "pump", "room", "row", "runway", "section",
    "sector", "shed", "silo", "slot", "space", "stage", "stand", "terminal", "tower", "track", "unit", "warehouse",
    "yard", "zone",
})  # fmt: skip
"""Nouns after which "one" is a number: "platform one"."""

_ONES = re.compile(r"\b(?:(?P<before>[\w'’-]+) )?(?P<one>ones?)\b", re.IGNORECASE)


def has_one(text: str) -> bool:
    """Return whether "one" or "ones" in a text stands for a noun: "the nearest one", unlike "platform one" and "number one"."""
    return any(_stands_for_noun(match) for match in _ONES.finditer(text))


def with_ones_replaced(text: str, replacement: Callable[[str], str]) -> str:
    """Return a text in which each "one" or "ones" that stands for a noun is replaced.

    Args:
        text: The text.
        replacement: Returns the noun for "one" or "ones".
    """

    def replaced(match: re.Match[str]) -> str:
        before = f"{match['before']} " if match["before"] else ""
        return f"{before}{replacement(match['one'].lower())}" if _stands_for_noun(match) else match[0]

    return _ONES.sub(replaced, text)


def _stands_for_noun(match: re.Match[str]) -> bool:
    return match["one"].lower() == "ones" or (match["before"] or "").lower() not in _NUMBERED


@lru_cache(maxsize=1024)
def head_noun(description: str) -> str:
    """Return the head noun of a description with its number: "workers" for "workers in orange vests"; empty for none."""
    words = _head(description).split(" ")
    return words[-1] if words else ""


@lru_cache(maxsize=1024)
def noun_end(description: str) -> int:
    """Return the index at which the last known noun before any preposition ends: 11 for "post office open"; 0 for none."""
    words = _head(description).lower().split(" ")
    ends = [end for end in range(1, len(words) + 1) if any(span[1] == end for span in nouns_in(tuple(words[:end])))]
    end = ends[-1] if ends else 0
    while end < len(words) and is_common_noun(words[end]):
        end += 1  # "post office"
    return len(" ".join(words[:end]))


def without_predicate(words: str) -> str:
    """Return words up to their last noun: "bus" for "bus moving", "man with an umbrella" for "man with an umbrella walking"."""
    kept = words.split(" ")
    while kept and lexicon().concept(kept[-1].lower()) is None and not is_common_noun(kept[-1].lower()) and not kept[-1].isdigit():
        kept.pop()
    return " ".join(kept)


@lru_cache(maxsize=1024)
def bare_noun(description: str) -> str:
    """Return the longest known noun that ends the head: "headline boards" for "two yellow headline boards"."""
    words = (description[: noun_end(description)] or _head(description)).split(" ")
    spans = [start for start, end in nouns_in(tuple(word.lower() for word in words)) if end == len(words)]
    return " ".join(words[min(spans, default=len(words) - 1) :])


def is_ranked(description: str) -> bool:
    """Return whether a description picks one thing by a superlative or an ordinal: "nearest car"."""
    return any(phrase.order is not None or phrase.ordinal is not None for phrase in parse_description(description).phrases)


def names_person(description: str) -> bool:
    """Return whether a description names a person or people."""
    return _is_kind(description, "person") or description.split(" ")[0].lower() in _ANYONE


def names_animal(description: str) -> bool:
    """Return whether a description names an animal, which people call "it", "he" or "she"."""
    return _is_kind(description, "animal")


def names_vehicle(description: str) -> bool:
    """Return whether a description names a vehicle, which has a number plate."""
    return _is_kind(description, "vehicle")


def may_name_person(description: str) -> bool:
    """Return whether "he" or "she" may refer to a thing: to a person, an animal, or something that the lexicon does not know."""
    if names_person(description) or names_animal(description):
        return True
    return lexicon().concept(head_noun(description).lower()) is None


def names_several(description: str) -> bool:
    """Return whether the head noun is a plural."""
    return is_plural(head_noun(description).lower())


def _head(description: str) -> str:
    return head_and_rest(description)[0]


def _is_kind(description: str, kind: str) -> bool:
    words = tuple(_head(description).lower().split(" "))
    concepts = (lexicon().concept(" ".join(words[start:end])) for start, end in nouns_in(words))
    return any(concept is not None and kind in lexicon().kinds(concept) for concept in concepts)


def is_same_kind(one: str, other: str) -> bool:
    """Return whether two descriptions have the same noun: "black dogs" and "dog on the left"."""
    return _singular(head_noun(one)) == _singular(head_noun(other))


def _singular(word: str) -> str:
    return singular(word.lower())
