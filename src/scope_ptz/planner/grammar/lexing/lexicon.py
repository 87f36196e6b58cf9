"""The classes of words and fixed expressions of instructions with all their forms, and the spelling lists."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from scope_ptz.english.colours import COLOURS
from scope_ptz.english.grammar.closed_class import instruction_classes, misspellings
from scope_ptz.english.grammar.numbers import NUMBER_WORDS, ORDINAL_WORDS
from scope_ptz.english.grammar.tokens import token_texts
from scope_ptz.planner.grammar.lexing.morphology import noun_forms, verb_forms

_OTHER_LISTS = frozenset({"fixed", "short", "real", "elsewhere"})


@cache
def phrases() -> Mapping[tuple[str, ...], frozenset[str]]:
    """Return the classes of every word and fixed expression, by the words of the expression."""
    table: dict[tuple[str, ...], set[str]] = {}
    for name, (kind, members) in instruction_classes().items():
        if name in _OTHER_LISTS:
            continue
        for member in members:
            for phrase, label in _forms(member, kind, name):
                table.setdefault(token_texts(phrase), set()).add(label)
    return {words: frozenset(classes) for words, classes in table.items()}


def _forms(member: str, kind: str, name: str) -> list[tuple[str, str]]:
    """Return the forms of a member with the class of each form."""
    if kind == "v":
        return [
            (form, f"{name}-{label.upper()}" if label else name) for label, forms in verb_forms(member).items() for form in forms
        ]
    return [(form, name) for form in (noun_forms(member) if kind == "n" else (member,))]


@cache
def longest_phrase() -> int:
    """Return the number of words of the longest expression."""
    return max(len(words) for words in phrases())


@cache
def known_words() -> frozenset[str]:
    """Return all words of the lexicon, numerals and colours."""
    return frozenset({word for words in phrases() for word in words} | {*NUMBER_WORDS, *ORDINAL_WORDS, *COLOURS})


@cache
def spelling_lists() -> Mapping[str, Any]:
    """Return the lists for the correction of spelling: "fixed" maps misspellings to words; "short" and "real" contain words."""
    classes = instruction_classes()
    return {"fixed": misspellings(), "short": classes["short"].members, "real": frozenset(classes["real"].members)}


def off_topic_phrases() -> tuple[str, ...]:
    """Return the phrases of questions that are not about what a camera sees."""
    return tuple(instruction_classes()["elsewhere"].members)
