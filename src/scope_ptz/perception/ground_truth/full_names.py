"""Things that are referred to by the full name that the scene gives them: "mannequin in a red dress", "planter with pink
flowers".

Such a name parses as a noun with a property, which the scene may state nowhere else.
"""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.perception.ground_truth.language import question_tree as s
from scope_ptz.perception.ground_truth.view import Thing, View

_SMALL = frozenset({"a", "an", "the", "in", "on", "of", "at", "by", "to", "with"})


def named_in_full(view: View, phrase: s.Phrase) -> list[Thing]:
    """Return the things whose name has exactly the words of a phrase."""
    asked = _words(phrase)
    if not asked:
        return []
    return [t for t in view.things if {english.singular(x) for x in english.letters(t.name).split()} - _SMALL == asked]


def _words(phrase: s.Phrase) -> set[str]:
    """Return all words of a phrase, none when it says more than a name could."""
    if not phrase.tests or phrase.order is not None or phrase.ordinal is not None:
        return set()
    words = set(phrase.words)
    for test in phrase.tests:
        match test:
            case s.Has(what=what) | s.Relation(other=what) if len(what.phrases) == 1 and not what.phrases[0].tests:
                words |= set(what.phrases[0].words)
            case s.Is(words=loose):
                words |= set(loose)
            case _:
                return set()
    return {english.singular(word) for word in words} - _SMALL
