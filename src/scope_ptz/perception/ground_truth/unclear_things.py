"""Find the things that may match a description although the frame does not show them well enough to count as visible.

They are too small, hidden or cut off by the frame. Nothing is said about them, but while there are any, a count is only a lower
bound and nothing may be called absent.
"""

from __future__ import annotations

from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View
from scope_ptz.simulator.truth import MIN_VISIBLE_PX

_COUNTABLE_PX = 40
"""A thing with more visible pixels than this may be counted by an attentive person, although it is not clearly visible.

Smaller ones are nothing but specks beside things that can be counted.
"""


def unclear_matches(view: View, description: tree.Description) -> list[Thing]:
    """Return the unclear things that match a description, largest first.

    If clearly visible things match as well, only those are returned that an attentive person may count with them.
    """
    if any(p.order or p.ordinal for p in description.phrases):
        return []  # a superlative or an ordinal selects among the things that can be seen
    unclear = set(view.unclear)
    matches = [t for t in find(view.with_unclear(), description) if t in unclear]
    if matches and find(view, description):
        return [t for t in matches if t.sighting.pixels > _COUNTABLE_PX]
    return matches


def unclear_because(things: list[Thing]) -> str:
    """Return why unclear things cannot be made out, in words that can follow "one that is": "too small to make out"."""
    largest = things[0].sighting
    if largest.pixels < MIN_VISIBLE_PX:
        return "too small to make out"
    return "only partly in the picture" if largest.cut else "mostly hidden"
