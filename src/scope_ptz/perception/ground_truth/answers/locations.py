"""Answers to "where is it" and "what is there"."""

from __future__ import annotations

from collections import Counter

from scope_ptz import english
from scope_ptz.perception.ground_truth.answers.counted_things import narrowed
from scope_ptz.perception.ground_truth.answers.restating import after_noun, none_of, noun, predicate_words
from scope_ptz.perception.ground_truth.answers.thing_names import AnswerText, metres, name, names, place, reply, several, unknown
from scope_ptz.perception.ground_truth.answers.values import UNSEEN, fact_in_view
from scope_ptz.perception.ground_truth.answers.verdicts import missing_reference
from scope_ptz.perception.ground_truth.language import question_tree as s
from scope_ptz.perception.ground_truth.relations import NEAR_M, relation_holds
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View

MAX_PLACED = 3
"""Up to this many things are located one by one; more are counted by region of the frame."""
_BACKDROP = frozenset({"surface", "sky", "plant life", "mountain"})


def where(view: View, question: s.Where) -> AnswerText:
    """Answer where the things that fit a description are."""
    found = find(view, question.what)
    if not found:
        return reply(none_of(view, question.what))
    if len(found) == 1:
        return reply(
            f"the {name(found[0])} is {place(found[0])}, about {metres(found[0].distance_m)} away{neighbour(view, found[0])}"
        )
    if len(found) > MAX_PLACED:
        spots = Counter(place(t) for t in found)
        places = english.listing([f"{n} {spot}" for spot, n in spots.items()])
    else:
        places = english.listing([f"{english.article(name(t))} {place(t)} about {metres(t.distance_m)} away" for t in found])
    return reply(f"there are {len(found)} {noun(view, question.what, many=True)}: {places}")


def neighbour(view: View, thing: Thing) -> str:
    """Return a thing's relation to the largest thing near it or in line with it (", next to the barrier"), or nothing."""
    others = [
        t
        for t in view.top_level()
        if t is not thing and t.name != thing.name and not t.concepts & _BACKDROP and thing.parent != t.id
    ]
    near = [t for t in others if thing.gap_m(t) <= NEAR_M]
    if near:
        best = max(near, key=lambda t: t.sighting.pixels)
        side = _depth_side(view, thing, best)
        return f", {f'just {side}' if side else 'next to'} the {name(best)}"
    aligned = [t for t in others if _depth_side(view, thing, t)]
    if aligned:
        best = max(aligned, key=lambda t: t.sighting.pixels)
        return f", {_depth_side(view, thing, best)} the {name(best)}"
    return ""


def _depth_side(view: View, thing: Thing, other: Thing) -> str:
    """Return "behind", "in front of", or an empty string."""
    if relation_holds(view, thing, "behind", other):
        return "behind"
    return "in front of" if relation_holds(view, thing, "front", other) else ""


def what(view: View, question: s.What) -> AnswerText:
    """Answer with the names of all things that fit."""
    if _is_a_list(question.what):
        return _listed_in_question(view, question)
    missing = next((m for m in (missing_reference(view, t) for t in question.tests) if m is not None), None)
    if missing is not None:
        return reply(none_of(view, missing))
    description = narrowed(question.what, question.tests)
    found = find(view, description)
    if not found:
        return _nothing(view, question, description)
    return things_in_words(view, question.tests, _by_nearness(view, question.tests, found))


def _is_a_list(description: s.Description) -> bool:
    """Return whether a description ("the following", "these") names no thing but refers to a list after it."""
    words = {word for phrase in description.phrases for word in phrase.words}
    return bool(words) and words <= {"following", "these", "those", "them"}


def _listed_in_question(view: View, question: s.What) -> AnswerText:
    tests = [test for asked in question.tests for test in (asked.tests if isinstance(asked, s.Any) else (asked,))]
    listed = tuple(s.Phrase(test.words) for test in tests if isinstance(test, s.Is))
    if not listed:
        return unknown("I cannot tell: I do not know which ones are meant")
    found = [thing for phrase in listed for thing in find(view, s.Description((phrase,)))[:1]]
    return reply(f"I can see {names(found)}" if found else none_of(view, s.Description(listed)))


def _nothing(view: View, question: s.What, description: s.Description) -> AnswerText:
    """Answer when no thing fits: with a stated fact ("which lane is closed"), or that nothing fits."""
    loose = [x for t in question.tests if isinstance(t, s.Is) for x in t.words]
    if loose and not find(view, question.what):
        return fact_in_view(view, (*question.what.phrases[0].words, *loose))
    if description.phrases[0].words == ("thing",):
        return reply(f"I can see nothing {english.listing([after_noun(view, t) for t in question.tests])}")
    return reply(none_of(view, description))


def _by_nearness(view: View, tests: tuple[s.Test, ...], found: list[Thing]) -> list[Thing]:
    """Sort things by their distance to the things that the relations refer to, if there are any."""
    anchors = [a for t in tests if isinstance(t, s.Relation) for a in find(view, t.other)]
    return sorted(found, key=lambda t: min(t.gap_m(a) for a in anchors)) if anchors else found


def things_in_words(view: View, tests: tuple[s.Test, ...], found: list[Thing]) -> AnswerText:
    """Answer with things and their places: "a white van and 2 traffic cones are behind the barrier"."""
    rest = tuple(t for t in tests if not isinstance(t, s.Order))
    if len(rest) < len(tests):
        return reply(f"it is the {name(found[0])} {place(found[0])}, about {metres(found[0].distance_m)} away")
    if not rest:
        return reply(several(found) if len(found) <= 3 else f"I can see {names(found)}")
    where_ = f", {place(found[0])}" if len(found) == 1 and not any(isinstance(t, s.Region) for t in rest) else ""
    return reply(f"{names(found)} {predicate_words(view, rest, len(found))}{where_}")


def identify(view: View, question: s.Identify) -> AnswerText:
    """Answer what a thing is. If the words name a fact ("the speed limit"), answer with that fact."""
    phrase = question.what.phrases[0]
    fact = fact_in_view(view, phrase.words)
    carried = all(isinstance(t, s.Relation) and t.kind == "on" for t in phrase.tests)
    if fact.known and carried and phrase.order is None:
        return fact
    found = find(view, question.what)
    if not found:
        return fact if fact.known or UNSEEN & set(phrase.words) else unknown(f"I cannot tell: {none_of(view, question.what)}")
    if len(found) == 1:
        return reply(f"it is {english.article(name(found[0]))} {place(found[0])}, about {metres(found[0].distance_m)} away")
    return reply(f"there are {len(found)}: {names(found)}")
