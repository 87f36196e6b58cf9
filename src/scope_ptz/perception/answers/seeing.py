"""Where is it, what is there."""

from __future__ import annotations

from scope_ptz.perception.answers.counting import narrowed
from scope_ptz.perception.answers.facts import anywhere
from scope_ptz.perception.answers.naming import (
    Reply,
    are,
    metres,
    name,
    names,
    none_of,
    noun,
    place,
    reply,
    several,
    test_words,
)
from scope_ptz.perception.language import syntax as s
from scope_ptz.perception.language import words as w
from scope_ptz.perception.matching import NEAR_M, find, relation_holds
from scope_ptz.perception.view import Thing, View

MAX_NAMED = 6
_BACKDROP = frozenset({"surface", "sky", "plant life", "mountain"})


def where(view: View, question: s.Where) -> Reply:
    found = find(view, question.what)
    if not found:
        return reply(none_of(view, question.what))
    if len(found) == 1:
        return reply(
            f"the {name(found[0])} is {place(found[0])}, about {metres(found[0].distance_m)} away{neighbour(view, found[0])}"
        )
    if len(found) > MAX_NAMED:
        spots = list(dict.fromkeys(place(t) for t in found))
        return reply(f"there are {len(found)} {noun(view, question.what, many=True)}: {w.listing(spots)}")
    spots = [f"{w.article(name(t))} {place(t)} about {metres(t.distance_m)} away" for t in found]
    return reply(f"there are {len(found)} {noun(view, question.what, many=True)}: {w.listing(spots)}")


def neighbour(view: View, thing: Thing) -> str:
    """ ", next to the barrier": its relation to the most telling thing around, or nothing."""
    others = [
        t
        for t in view.top_level()
        if t is not thing and t.name != thing.name and not t.concepts & _BACKDROP and not thing.parent == t.id
    ]
    near = [t for t in others if thing.gap_m(t) <= NEAR_M]
    if near:
        best = max(near, key=lambda t: t.sighting.pixels)
        kind = (
            "behind"
            if relation_holds(view, thing, "behind", best)
            else "front"
            if relation_holds(view, thing, "front", best)
            else "near"
        )
        words = {"behind": "just behind", "front": "just in front of", "near": "next to"}[kind]
        return f", {words} the {name(best)}"
    sides = [(t, k) for t in others for k in ("behind", "front") if relation_holds(view, thing, k, t)]  # type: ignore[arg-type]
    if sides:
        best, side = max(sides, key=lambda pair: pair[0].sighting.pixels)
        return f", {'behind' if side == 'behind' else 'in front of'} the {name(best)}"
    return ""


def what(view: View, question: s.What) -> Reply:
    """Names everything that fits."""
    missing = _missing(view, question.tests)
    if missing is not None:
        return reply(none_of(view, missing))
    if (
        len(question.what.phrases) == 1
        and question.what.phrases[0].order is None
        and question.tests
        and not question.what.phrases[0].tests
    ):
        said = anywhere(
            view,
            (*question.what.phrases[0].words, *(x for t in question.tests if isinstance(t, s.Is) for x in t.words)),
        )
        if said.known and not find(view, narrowed(question.what, question.tests)):
            return said
    description = narrowed(question.what, question.tests)
    anything = any(p.words == ("thing",) for p in description.phrases)
    found = [
        t for t in find(view, description) if not anything or (t in view.top_level() and not t.concepts & _BACKDROP)
    ]
    return told(view, description, question.tests, found)


def told(view: View, description: s.Description, tests: tuple[s.Test, ...], found: list[Thing]) -> Reply:
    """ "A white van and 2 traffic cones are behind the barrier"."""
    said = (
        w.listing([test_words(view, t) for t in tests if not isinstance(t, s.Order)])
        if any(not isinstance(t, s.Order) for t in tests)
        else "in view"
    )
    if not found:
        anything = any(p.words == ("thing",) for p in description.phrases)
        return reply(f"I can see nothing {said}" if anything else none_of(view, description))
    if len(found) == 1:
        where_ = place(found[0])
        ending = f", {where_}" if where_ not in said else ""
        if any(p.order for p in description.phrases):
            return reply(f"it is the {name(found[0])} {where_}, about {metres(found[0].distance_m)} away")
        return reply(f"{w.article(name(found[0]))} is {said}{ending}")
    if said == "in view" and len(found) <= 3:
        return reply(several(found))
    return reply(f"{names(found)} {are(len(found))} {said}")


def _missing(view: View, tests: tuple[s.Test, ...]) -> s.Description | None:
    """The first thing that a relation refers to and that is not in view."""
    for test in tests:
        for other in (
            (test.other,)
            if isinstance(test, s.Relation)
            else (test.first, test.second)
            if isinstance(test, s.Between)
            else ()
        ):
            if not find(view, other):
                return None if isinstance(test, s.Relation) and test.kind == "on" else other
    return None


def identify(view: View, question: s.Identify) -> Reply:
    """What a thing is; or, when the words name a fact rather than a thing ("the speed limit"), that fact."""
    phrase = question.what.phrases[0]
    fact = anywhere(view, phrase.words)
    if fact.known and not phrase.tests and phrase.order is None:
        return fact
    found = find(view, question.what)
    if not found:
        return fact if fact.known else Reply(w.sentence(f"I cannot tell: {none_of(view, question.what)}"), known=False)
    if len(found) == 1:
        return reply(f"it is {w.article(name(found[0]))} {place(found[0])}, about {metres(found[0].distance_m)} away")
    return reply(f"there are {len(found)}: {names(found)}")
