"""Choose the cheapest reading of ambiguous text. The cost does not depend on the scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from scope_ptz.english.grammar.lexicon import lexicon, nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree

_SPECIFIC_QUESTIONS: tuple[type[Any], ...] = (
    tree.CompareCount, tree.Compare, tree.Which, tree.HowFar, tree.MostCommon, tree.TextExists, tree.Read, tree.IsA, tree.Where,
    tree.Count, tree.CountKinds, tree.Happening, tree.Quarter, tree.InOrder, tree.Present, tree.KindOf, tree.Difference, tree.Price,
    tree.Time,
)  # fmt: skip
"""Specific question types, which are preferred to the general ones."""

_TEXT_AND_PROPERTY_NOUNS = frozenset(
    [
        "text",
        "texts",
        "writing",
        "words",
        "lettering",
        "written",
        "printed",
        "painted",
        "name",
        "number",
        "colour",
        "colours",
        "color",
        "colors",
    ]
)
"""Nouns for text and properties, which are not things."""


def cheapest(readings: Sequence[Any]) -> Any:
    """Return the reading with the lowest cost; None if there are no readings.

    Readings that cost the same are ordered by their text, so that the choice never depends on the parser's order.
    """
    cache: dict[int, float] = {}
    costs = [(0.0 if isinstance(reading, _SPECIFIC_QUESTIONS) else 20.0) + _cost(reading, cache) for reading in readings]
    lowest = min(costs, default=0.0)
    return min((reading for reading, cost in zip(readings, costs, strict=True) if cost == lowest), key=repr, default=None)


def _cost(node: Any, cache: dict[int, float]) -> float:
    """Return the cost of a part of a reading; lower is better. ``cache`` stores the costs of parts that readings share."""
    if id(node) not in cache:
        if isinstance(node, tuple):
            cache[id(node)] = sum(_cost(child, cache) for child in node)
        else:
            cache[id(node)] = _cost_of_node(node, cache) if is_dataclass(node) else 0.0
    return cache[id(node)]


def _cost_of_node(node: Any, cache: dict[int, float]) -> float:
    """Return the cost of a dataclass node, including the costs of its fields."""
    total: float = sum(_cost(getattr(node, field.name), cache) for field in fields(node))
    match node:
        case tree.Phrase(words=("thing",)):
            total += 1.5
        case tree.Phrase(words=words):
            spans = nouns_in(words)
            total += 1.0 if spans else 2.0
            total += 4.0 if words and words[-1] in _TEXT_AND_PROPERTY_NOUNS else 0.0
            total += 0.3 if spans and spans[0][1] < len(words) else 0.0
            total += 0.2 * max(0, len(node.tests) - 1)
        case tree.Is(words=words):
            total += 3.0 if nouns_in(words) else 0.5
        case tree.Which(options=tree.Description(phrases=(_,))):
            total += 24.0  # a single option is not a choice: in "who is nearest the van", the van is the reference, not an option
        case tree.Identify(what=tree.Description(phrases=(tree.Phrase(article="", words=words),))) if not nouns_in(words):
            total += 1.0  # "what is parked in bay 12?" names no thing
        case tree.Has(what=tree.Description(phrases=(first, *others))) if first.article != "the":
            # In "the worker with a clipboard, the clock and the van", the clock is another item of the list.
            total += 6.0 * any(other.article == "the" for other in others)
        case tree.Order(reference=reference):
            total += 3.0 if reference is not None else 0.0
        case tree.Ask(attribute=words):
            total += 3.0 if nouns_in(words) else 0.0
        case _:
            pass
    return total + 0.1 * _misplaced_clothing(node)


def _misplaced_clothing(node: Any) -> float:
    """Return the cost of a phrase in which something other than a person wears clothes.

    In "the worker next to the van wearing a helmet", the helmet belongs to the worker.
    """
    if not isinstance(node, tree.Phrase) or not any(isinstance(t, tree.Has) and t.worn for t in node.tests):
        return 0.0
    return 0.0 if is_person(node.words) else 50.0


def is_person(words: Sequence[str]) -> bool:
    """Return whether the noun of a phrase is a kind of person."""
    spans = nouns_in(words)
    concept = lexicon().concept(" ".join(words[slice(*spans[0])])) if spans else None
    return concept is not None and "person" in lexicon().kinds(concept)
