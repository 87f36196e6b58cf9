"""Answer questions about things that may be in view, but that the frame does not show well enough to say so."""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.restating import is_plural, noun_phrase
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, unknown_answer
from scope_ptz.perception.ground_truth.unclear_things import unclear_because, unclear_matches
from scope_ptz.perception.ground_truth.view import View


def answer_unclear(view: View, description: tree.Description) -> TruthAnswer | None:
    """Answer that nobody can tell whether something is in view; None if the frame shows that it is not."""
    if not (unclear := unclear_matches(view, description)):
        return None
    plural = is_plural(description)
    named = noun_phrase(view, description, plural)
    whether = f"there {'are any' if plural else 'is'} {named if plural else english.article(named)} in view"
    return unknown_answer(f"I cannot tell whether {whether}; there may be {_some(plural, unclear_because(unclear))}")


def _some(plural: bool, quality: str) -> str:
    return f"some that are {quality}" if plural else f"one that is {quality}"


def more_may_be(view: View, description: tree.Description) -> str:
    """Return the statement that a count is only a lower bound: "there may be more that are mostly hidden"; empty if it is exact."""
    unclear = unclear_matches(view, description)
    return f"there may be more that are {unclear_because(unclear)}" if unclear else ""
