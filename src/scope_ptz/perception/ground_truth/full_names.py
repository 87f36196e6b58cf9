"""Search for things by their full names in the scene: "mannequin in a red dress", "planter with pink flowers".

The parser reads such a name as a noun with a property, but the scene may state that property only in the name.
"""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.numerals import ORDINALS
from scope_ptz.perception.ground_truth.view import Thing, View

_FUNCTION_WORDS = frozenset({"a", "an", "the", "in", "on", "of", "at", "by", "to", "with"})


def find_by_full_name(view: View, phrase: tree.Phrase) -> list[Thing]:
    """Return the things whose names consist of exactly the words in a phrase."""
    phrase_words = _name_words(phrase)
    if not phrase_words:
        return []
    return [
        t for t in view.things if {english.singular(x) for x in english.letters(t.name).split()} - _FUNCTION_WORDS == phrase_words
    ]


def _name_words(phrase: tree.Phrase) -> set[str]:
    """Return all words in a phrase; an empty set if the phrase states no property, or one that cannot be part of a name."""
    if not (phrase.tests or phrase.ordinal) or phrase.order is not None:
        return set()
    words = {*phrase.words, *(word for word, value in ORDINALS.items() if value == phrase.ordinal)}  # "the Second Chance sign"
    for test in phrase.tests:
        match test:
            case tree.Has(what=what) | tree.Relation(other=what) if len(what.phrases) == 1 and not what.phrases[0].tests:
                words |= set(what.phrases[0].words)
            case tree.Is(words=state_words):
                words |= set(state_words)
            case _:
                return set()
    return {english.singular(word) for word in words} - _FUNCTION_WORDS
