"""Answer parsed questions about a view. An answer is a short English sentence, with a flag for whether the answer is known."""

from __future__ import annotations

from scope_ptz.perception.ground_truth.answers.compared_things import (
    compare,
    compare_count,
    count_kinds,
    difference,
    how_far,
    most_common,
    which,
)
from scope_ptz.perception.ground_truth.answers.counted_things import count, exists
from scope_ptz.perception.ground_truth.answers.legible_text import read, text_exists
from scope_ptz.perception.ground_truth.answers.locations import identify, kind_of, present, what, where
from scope_ptz.perception.ground_truth.answers.ordered_things import in_order, quarter
from scope_ptz.perception.ground_truth.answers.scene import describe, happening
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, unknown
from scope_ptz.perception.ground_truth.answers.values import ask
from scope_ptz.perception.ground_truth.answers.verdicts import is_a, yes_no
from scope_ptz.perception.ground_truth.language import question_tree as tree
from scope_ptz.perception.ground_truth.view import View

__all__ = ["TruthAnswer", "answer"]


def answer(view: View, question: tree.Question | None) -> TruthAnswer:
    """Return the answer to a parsed question. The question is None if the parser did not understand it."""
    match question:
        case tree.Exists():
            return exists(view, question)
        case tree.Count():
            return count(view, question)
        case tree.CountKinds():
            return count_kinds(view, question)
        case tree.YesNo():
            return yes_no(view, question)
        case tree.IsA():
            return is_a(view, question)
        case tree.Ask():
            return ask(view, question)
        case tree.Read():
            return read(view, question)
        case tree.TextExists():
            return text_exists(view, question)
        case tree.Where():
            return where(view, question)
        case tree.Quarter():
            return quarter(view, question)
        case tree.InOrder():
            return in_order(view, question)
        case tree.Present():
            return present(view, question)
        case tree.KindOf():
            return kind_of(view, question)
        case tree.What():
            return what(view, question)
        case tree.Identify():
            return identify(view, question)
        case tree.Which():
            return which(view, question)
        case tree.HowFar():
            return how_far(view, question)
        case tree.Compare():
            return compare(view, question)
        case tree.CompareCount():
            return compare_count(view, question)
        case tree.Difference():
            return difference(view, question)
        case tree.MostCommon():
            return most_common(view, question)
        case tree.Describe():
            return describe(view, question)
        case tree.Happening():
            return happening(view)
        case None:
            return unknown("I cannot tell: I did not understand the question")
