"""Answer parsed questions about a view. Each answer is a short English sentence with a flag ``known``."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.compared_things import (
    answer_compare,
    answer_compare_count,
    answer_count_kinds,
    answer_difference,
    answer_how_far,
    answer_most_common,
    answer_which,
)
from scope_ptz.perception.ground_truth.answers.counted_things import answer_count, answer_exists
from scope_ptz.perception.ground_truth.answers.legible_text import answer_read, answer_text_exists
from scope_ptz.perception.ground_truth.answers.locations import (
    answer_identify,
    answer_kind_of,
    answer_present,
    answer_what,
    answer_where,
)
from scope_ptz.perception.ground_truth.answers.ordered_things import answer_in_order, answer_quarter
from scope_ptz.perception.ground_truth.answers.scene import answer_describe, answer_happening
from scope_ptz.perception.ground_truth.answers.stated_facts import answer_stated_fact
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, unknown_answer
from scope_ptz.perception.ground_truth.answers.tradespeople import answer_about_tradesperson
from scope_ptz.perception.ground_truth.answers.undecided import undecided_sex, without_open_sex
from scope_ptz.perception.ground_truth.answers.unread_texts import unread_reason
from scope_ptz.perception.ground_truth.answers.values import answer_attribute
from scope_ptz.perception.ground_truth.answers.verdicts import answer_is_a, answer_yes_no
from scope_ptz.perception.ground_truth.view import View

__all__ = ["TruthAnswer", "answer"]


def answer(view: View, question: tree.Question | None) -> TruthAnswer:
    """Return the answer to a parsed question; ``question`` is None if the parser did not understand the text."""
    if isinstance(question, tree.Exists | tree.Count | tree.What | tree.YesNo) and (reason := unread_reason(view, question)):
        return unknown_answer(reason)
    if (person := answer_about_tradesperson(view, question)) is not None:
        return person
    if isinstance(question, tree.Ask | tree.Where | tree.HowFar) and question.what is not None:
        if reason := undecided_sex(view, question.what):
            return unknown_answer(reason)
        question = replace(question, what=without_open_sex(view, question.what))
    return _answer_by_form(view, question)


def _answer_by_form(view: View, question: tree.Question | None) -> TruthAnswer:
    """Return the answer to a question, by the form of the question."""
    match question:
        case tree.Exists():
            return answer_exists(view, question)
        case tree.Count():
            return answer_count(view, question)
        case tree.CountKinds():
            return answer_count_kinds(view, question)
        case tree.YesNo():
            return answer_yes_no(view, question)
        case tree.IsA():
            return answer_is_a(view, question)
        case tree.Ask():
            return answer_attribute(view, question)
        case tree.Read() | tree.TextExists() | tree.Price() | tree.Time():
            return _answer_about_text(view, question)
        case tree.Where():
            return answer_where(view, question)
        case tree.Quarter():
            return answer_quarter(view, question)
        case tree.InOrder():
            return answer_in_order(view, question)
        case tree.Present():
            return answer_present(view, question)
        case tree.KindOf():
            return answer_kind_of(view, question)
        case tree.What():
            return answer_what(view, question)
        case tree.Identify():
            return answer_identify(view, question)
        case tree.Which():
            return answer_which(view, question)
        case tree.HowFar():
            return answer_how_far(view, question)
        case tree.Compare():
            return answer_compare(view, question)
        case tree.CompareCount():
            return answer_compare_count(view, question)
        case tree.Difference():
            return answer_difference(view, question)
        case tree.MostCommon():
            return answer_most_common(view, question)
        case tree.Describe():
            return answer_describe(view, question)
        case tree.Happening():
            return answer_happening(view)
        case None:
            return unknown_answer("I cannot tell: I did not understand the question")


def _answer_about_text(view: View, question: tree.Read | tree.TextExists | tree.Price | tree.Time) -> TruthAnswer:
    """Return the answer to a question about text, or about a fact that only text states."""
    match question:
        case tree.Read():
            return answer_read(view, question)
        case tree.TextExists():
            return answer_text_exists(view, question)
        case _:
            return answer_stated_fact(view, question)
