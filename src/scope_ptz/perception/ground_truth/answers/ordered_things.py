"""Answer questions about the order of several named things, and about the quarter of the frame that a thing is in."""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.restating import definite_phrase, none_in_view, noun_phrase
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, coloured_name, known_answer, unknown_answer
from scope_ptz.perception.ground_truth.relations import rank_key
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View

_ENDS = {
    "left": ("left", "right"), "right": ("right", "left"), "top": ("top", "bottom"), "bottom": ("bottom", "top"),
    "nearest": ("nearest", "furthest"), "furthest": ("furthest", "nearest"),
    "most": ("most", "fewest"), "fewest": ("fewest", "most"),
}  # fmt: skip
"""The words for the first and the last position in each order."""


def answer_in_order(view: View, question: tree.InOrder) -> TruthAnswer:
    """List the named things in an order, such as left to right or nearest to furthest, or list kinds of things by count."""
    kinds = [tree.Description((phrase,)) for phrase in question.options.phrases]
    if question.key in {"most", "fewest"}:
        counts = [(len(find(view, kind)), kind) for kind in kinds]
        counts.sort(key=lambda pair: pair[0] if question.key == "fewest" else -pair[0])
        listed = [english.counted(count, noun_phrase(view, kind)) for count, kind in counts]
    else:
        found: list[tuple[Thing, tree.Description]] = []
        for kind in kinds:
            things = [t for t in find(view, kind) if all(t is not other for other, _ in found)]
            if not things:
                return unknown_answer(f"I cannot tell: {none_in_view(view, kind)}")
            found.append((things[0], kind))
        rank = rank_key(question.key)  # type: ignore[arg-type]
        listed = [definite_phrase(view, kind) for _, kind in sorted(found, key=lambda pair: rank(pair[0]))]
    first, last = _ENDS[question.key]
    return known_answer(f"from {first} to {last}: {english.listing(listed)}")


def answer_quarter(view: View, question: tree.Quarter) -> TruthAnswer:
    """State which quarter of the frame contains the centre of each thing."""
    things = find(view, question.what)
    if not things:
        return known_answer(none_in_view(view, question.what))
    if len(things) == 1:
        return known_answer(f"the {coloured_name(things[0])} is in the {_quarter_of(things[0])} quarter")
    places = english.listing([f"one in the {_quarter_of(thing)} quarter" for thing in things])
    return known_answer(f"there are {len(things)} {noun_phrase(view, question.what, plural=True)}: {places}")


def _quarter_of(thing: Thing) -> str:
    x, y = thing.box.centre
    return f"{'top' if y < 0.5 else 'bottom'} {'left' if x < 0.5 else 'right'}"
