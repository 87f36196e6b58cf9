"""Answers to parsed questions about a view: one short English sentence, and whether the answer is known."""

from __future__ import annotations

from scope_ptz.perception.ground_truth.answers.compared_things import (
    compare,
    compare_count,
    count_kinds,
    how_far,
    most_common,
    which,
)
from scope_ptz.perception.ground_truth.answers.counted_things import count, exists
from scope_ptz.perception.ground_truth.answers.legible_text import read, text_exists
from scope_ptz.perception.ground_truth.answers.locations import identify, what, where
from scope_ptz.perception.ground_truth.answers.scene import describe, happening
from scope_ptz.perception.ground_truth.answers.thing_names import AnswerText, unknown
from scope_ptz.perception.ground_truth.answers.values import ask
from scope_ptz.perception.ground_truth.answers.verdicts import is_a, yes_no
from scope_ptz.perception.ground_truth.language import question_tree as s
from scope_ptz.perception.ground_truth.view import View

__all__ = ["AnswerText", "answer"]


def answer(view: View, question: s.Question | None) -> AnswerText:
    """Return the answer to a parsed question. None, a question that fits no rule, cannot be answered."""
    match question:
        case s.Exists():
            return exists(view, question)
        case s.Count():
            return count(view, question)
        case s.CountKinds():
            return count_kinds(view, question)
        case s.YesNo():
            return yes_no(view, question)
        case s.IsA():
            return is_a(view, question)
        case s.Ask():
            return ask(view, question)
        case s.Read():
            return read(view, question)
        case s.TextExists():
            return text_exists(view, question)
        case s.Where():
            return where(view, question)
        case s.What():
            return what(view, question)
        case s.Identify():
            return identify(view, question)
        case s.Which():
            return which(view, question)
        case s.HowFar():
            return how_far(view, question)
        case s.Compare():
            return compare(view, question)
        case s.CompareCount():
            return compare_count(view, question)
        case s.MostCommon():
            return most_common(view, question)
        case s.Describe():
            return describe(view, question)
        case s.Happening():
            return happening(view)
        case None:
            return unknown("I cannot tell: I can only answer about what is visible in the picture")
