"""Questions about the person whose trade names a shop: the place is in view, but nobody is known to be the butcher."""

from __future__ import annotations

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, coloured_name, unknown_answer
from scope_ptz.perception.ground_truth.thing_facts import fits_noun, is_sexed
from scope_ptz.perception.ground_truth.thing_search import split_after_noun
from scope_ptz.perception.ground_truth.view import Thing, View, trades_of


def answer_about_tradesperson(view: View, question: tree.Question | None) -> TruthAnswer | None:
    """Answer that the person is unknown, for questions about their number, sex, clothes and activity; None for other questions."""
    match question:
        case tree.Count(what=what, tests=tests) if not tests or any(map(_is_about_person, tests)):
            about = what
        case tree.YesNo(subject=about, tests=tests) if any(map(_is_about_person, (*tests, *_predicate(view, about)))):
            pass
        case tree.IsA(subject=about, what=kind) if is_sexed(kind.phrases[0].words) or is_person(kind.phrases[0].words):
            pass
        case tree.Ask(attribute=attribute, what=tree.Description() as about) if _PERSONAL.intersection(attribute):
            pass
        case _:
            return None
    place = _place_of_trade(view, about)
    if place is None:
        return None
    trade = english.singular(about.phrases[0].words[0])
    return unknown_answer(f"I can see {english.article(coloured_name(place))}, but I cannot tell who is {english.article(trade)}")


_PERSONAL = frozenset({"wearing", "clothes", "clothing", "outfit", "doing", "activity", "carrying", "holding"})
"""Attributes of people that a shop does not have."""


def _is_about_person(test: tree.Test) -> bool:
    match test:
        case tree.Not(test=inner):
            return _is_about_person(inner)
        case tree.Has(worn=worn):
            return worn
        case tree.Is(words=words):
            return is_sexed(words) or any(x.endswith("ing") for x in words)
    return False


def _predicate(view: View, subject: tree.Description) -> list[tree.Test]:
    """Return what follows the noun of a subject that includes its predicate, as in "butcher walking"."""
    after = split_after_noun(view, subject.phrases[0].words)[1]
    return [tree.Is(after)] if after else []


def _place_of_trade(view: View, about: tree.Description) -> Thing | None:
    """Return the shop that a description names only by its owner; None if it names something else, or also a person."""
    (phrase, *others) = about.phrases
    head = split_after_noun(view, phrase.words)[0]
    if others or len(head) != 1 or "'" in head[0]:
        return None
    if any("person" in t.concepts and fits_noun(view, t, head[0]) for t in view.things):
        return None
    return next((t for t in view.things if english.singular(head[0]) in trades_of(t.sighting.instance)), None)
