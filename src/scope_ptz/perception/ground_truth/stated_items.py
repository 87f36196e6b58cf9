"""Tell apart the items that a thing lacks and those about which the scene says nothing.

A scene that lists the helmets of its workers states that the others wear none. It lists no awnings of market stalls and no clothes
of some pedestrians, so these may or may not have them.
"""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.thing_facts import (
    CLOTHING_KEYS,
    attribute_has,
    facts,
    is_worn,
    names_clothes,
    names_of,
)
from scope_ptz.perception.ground_truth.view import Thing, View, concepts_of

_EVERYDAY_CLOTHES = frozenset({"jacket", "trouser"})
"""Clothes that everybody wears, so that a scene does not list them unless it describes the person's clothes."""


def as_worn(test: tree.Test) -> tree.Has | None:
    """Return a test for clothes, however it is worded, as "wearing ...": "with a red jacket", "in red"; None for other tests."""
    match test:
        case tree.Has(worn=True):
            return test
        case tree.Has(what=what, sold=False) if all(names_clothes(p.words[-1]) for p in what.phrases):
            return tree.Has(what, worn=True)
        case tree.Relation(kind="on", other=what, preposition="in") if all(
            names_clothes(p.words[-1]) or english.COLOURS.issuperset(p.words) for p in what.phrases
        ):
            return tree.Has(what, worn=True)
    return None


def is_open_item(view: View, thing: Thing, what: tree.Description, worn: bool) -> bool:
    """Return whether the scene leaves open if a thing has, or with ``worn`` wears, the items that a description names."""
    if "person" in thing.concepts:
        return worn and any(map(_is_everyday, what.phrases)) and not any(k in CLOTHING_KEYS or is_worn(k) for k, _ in facts(thing))
    return not worn and not all(_is_listed(view, thing, phrase) for phrase in what.phrases)


def _is_everyday(phrase: tree.Phrase) -> bool:
    return phrase.words[-1] in english.COLOURS or lexicon().concept(phrase.words[-1]) in _EVERYDAY_CLOTHES


def _is_listed(view: View, thing: Thing, phrase: tree.Phrase) -> bool:
    """Return whether the scene lists such items, as facts or as parts, for any thing of the same category."""
    spans = nouns_in(phrase.words, view.nouns)
    noun = " ".join(phrase.words[slice(*spans[0])]) if spans else ""
    concept = lexicon().concept(noun) if noun else None
    if concept is None or concept == "thing" or concept not in view.concepts:
        return True  # an adjective or an unknown word, which other rules answer, or something that is nowhere in the scene
    alike = {i.id for i in view.instances.values() if i.category == thing.category}
    return any(
        attribute_has(key, value, names_of(noun), [], None) or key in names_of(noun)
        for i in view.instances.values()
        if i.id in alike
        for key, value in i.attributes.items()
    ) or any(concept in concepts_of(view.instances[part]) for part, whole in view.parents.items() if whole in alike)
