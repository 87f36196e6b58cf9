"""Answer comparison questions: which of several, how far, more or fewer, and the most common."""

from __future__ import annotations

from collections import Counter

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.restating import (
    COMPARATIVES,
    EQUAL_WORDS,
    FIRST_OF_SEVERAL,
    definite_phrase,
    none_in_view,
    noun_phrase,
)
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    coloured_name,
    distance_words,
    is_or_are,
    known_answer,
    position_words,
    unknown_answer,
)
from scope_ptz.perception.ground_truth.answers.undecided import undecided_reason
from scope_ptz.perception.ground_truth.answers.values import value_of
from scope_ptz.perception.ground_truth.relations import rank_key
from scope_ptz.perception.ground_truth.thing_facts import colour_of
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View

_EQUALITY_TOLERANCE = 0.02
"""Maximum relative difference between values that are reported as equal."""


def answer_which(view: View, question: tree.Which) -> TruthAnswer:
    """Answer which of several things ranks first in a comparison."""
    options = question.options.phrases
    if len(options) == 1:
        matches = sorted(find(view, question.options), key=rank_key(question.key))
        if not matches:
            return unknown_answer(f"I cannot tell: {none_in_view(view, question.options)}")
        return known_answer(
            f"it is the {coloured_name(matches[0])} {position_words(matches[0])}, "
            f"about {distance_words(matches[0].distance_m)} away"
        )
    things: list[Thing] = []
    for phrase in options:
        matches = [t for t in find(view, tree.Description((phrase,))) if t not in things]
        if not matches:
            return unknown_answer(f"I cannot tell: {none_in_view(view, tree.Description((phrase,)))}")
        things.append(matches[0])
    ranked = sorted(zip(things, options, strict=True), key=lambda pair: rank_key(question.key)(pair[0]))
    (first, phrase), (second, other) = ranked[:2]
    if _are_equal(question.key, first, second):
        return known_answer(
            f"{_definite_phrase(view, phrase)} and {_definite_phrase(view, other)} are about {EQUAL_WORDS[question.key]}"
        )
    detail = ""
    if question.key in {"nearest", "furthest"}:
        near, far = distance_words(first.distance_m), distance_words(second.distance_m)
        detail = f": it is about {near} away, {_definite_phrase(view, other)} about {far}" if near != far else ""
    words = COMPARATIVES if len(ranked) == 2 else FIRST_OF_SEVERAL
    return known_answer(f"{_definite_phrase(view, phrase)} is {words[question.key]}{detail}")


def _definite_phrase(view: View, phrase: tree.Phrase) -> str:
    return definite_phrase(view, tree.Description((phrase,)))


def _are_equal(key: tree.OrderKey, a: Thing, b: Thing) -> bool:
    x, y = (abs(rank_key(key)(t)) for t in (a, b))
    return abs(x - y) <= _EQUALITY_TOLERANCE * max(x, y, 1e-9)


def answer_compare(view: View, question: tree.Compare) -> TruthAnswer:
    """Answer whether the first thing ranks before the second in a comparison, as in "is the van nearer than the bus?"."""
    for description in (question.first, question.second):
        if not find(view, description):
            return unknown_answer(f"I cannot tell: {none_in_view(view, description)}")
    first = find(view, question.first)[0]
    second = next((t for t in find(view, question.second) if t is not first), first)
    key = rank_key(question.key)
    statement = (
        f"{definite_phrase(view, question.first)} is {{}}{COMPARATIVES[question.key]} than {definite_phrase(view, question.second)}"
    )
    if question.key in {"nearest", "furthest"}:
        statement += f" (about {distance_words(first.distance_m)} against {distance_words(second.distance_m)})"
    ranks_first = key(first) < key(second) and not _are_equal(question.key, first, second)
    return known_answer(f"yes, {statement.format('')}" if ranks_first else f"no, {statement.format('not ')}")


def answer_how_far(view: View, question: tree.HowFar) -> TruthAnswer:
    """Answer how far a thing is from the camera, or from something else, in metres."""
    for description in (question.what, question.other):
        if description is not None and not find(view, description):
            return unknown_answer(f"I cannot tell: {none_in_view(view, description)}")
    first = find(view, question.what)
    if question.other is None:
        if len(first) > 1 and not any(p.order for p in question.what.phrases):
            low, high = (limit(t.distance_m for t in first) for limit in (min, max))
            plural_noun = noun_phrase(view, question.what, plural=True)
            return known_answer(
                f"there are {len(first)} {plural_noun}, from about {distance_words(low)} to about {distance_words(high)} away"
            )
        return known_answer(f"the {coloured_name(first[0])} is about {distance_words(first[0].distance_m)} away")
    second = [t for t in find(view, question.other) if t is not first[0]]
    if not second:
        return unknown_answer(f"I cannot tell: I can see only one {noun_phrase(view, question.other)}")
    gap = min(first[0].gap_m(t) for t in second)
    return known_answer(
        f"the {coloured_name(first[0])} is about {distance_words(gap)} from {definite_phrase(view, question.other)}"
    )


def answer_compare_count(view: View, question: tree.CompareCount) -> TruthAnswer:
    """Answer which of two kinds is more or less numerous, or whether a stated comparison between their numbers is true."""
    if not question.second.phrases:
        return unknown_answer("I cannot tell: I see one picture, and nothing else to compare it with")
    if question.which and len(question.second.phrases) > 1:
        return _answer_most_numerous(view, question)
    if reason := undecided_reason(view, question.first) or undecided_reason(view, question.second):
        return unknown_answer(reason)
    a, b = len(find(view, question.first)), len(find(view, question.second))
    first, second = noun_phrase(view, question.first, plural=True), noun_phrase(view, question.second, plural=True)
    counts = f"{english.counted(a, noun_phrase(view, question.first))} and {english.counted(b, noun_phrase(view, question.second))}"
    if question.which:
        is_first = (a > b) == (question.sense == "more")
        verdict = "there are equally many" if a == b else f"there are {question.sense} {first if is_first else second}"
        return known_answer(f"{verdict}: {counts}")
    yes = {"more": a > b, "fewer": a < b, "same": a == b}[question.sense]
    comparative = {"more": "more", "fewer": "fewer"}.get(question.sense)
    statement = f"{comparative} {first} than {second}" if comparative else f"as many {first} as {second}"
    return known_answer(f"{'yes' if yes else 'no'}, there are {'' if yes else 'not '}{statement}: {counts}")


def answer_difference(view: View, question: tree.Difference) -> TruthAnswer:
    """Answer how many more things of one kind there are than of another."""
    if reason := undecided_reason(view, question.first) or undecided_reason(view, question.second):
        return unknown_answer(reason)
    first, second = (len(find(view, what)) for what in (question.first, question.second))
    a = english.counted(first, noun_phrase(view, question.first))
    b = english.counted(second, noun_phrase(view, question.second))
    if first == second:
        return known_answer(f"there are equally many: {a} and {b}, so the difference is 0")
    number, sense = abs(first - second), "more" if first > second else "fewer"
    kind = noun_phrase(view, question.first, plural=number != 1)
    return known_answer(
        f"there {is_or_are(number)} {number} {sense} {kind} than {noun_phrase(view, question.second, plural=True)}: {a} and {b}"
    )


def _answer_most_numerous(view: View, question: tree.CompareCount) -> TruthAnswer:
    """Answer "which are there most of: cars, vans or lorries?"."""
    kinds = [tree.Description((phrase,)) for phrase in (*question.first.phrases, *question.second.phrases)]
    counts = [len(find(view, kind)) for kind in kinds]
    target = (min if question.sense == "fewer" else max)(counts)
    first = [noun_phrase(view, kind, plural=True) for kind, count in zip(kinds, counts, strict=True) if count == target]
    listed = english.listing([english.counted(count, noun_phrase(view, kind)) for kind, count in zip(kinds, counts, strict=True)])
    sense = "fewest" if question.sense == "fewer" else "most"
    verdict = f"there are {sense} {first[0]}" if len(first) == 1 else f"there are equally many {english.listing(first)}"
    return known_answer(f"{verdict}: {listed}")


def answer_count_kinds(view: View, question: tree.CountKinds) -> TruthAnswer:
    """Answer how many different colours or kinds there are among things."""
    colour = question.attribute == ("colour",)
    values = Counter(v for t in find(view, question.what) if (v := _kind(t, colour)) is not None)
    suffix = "" if len(values) == 1 else "s"
    anything = question.what.phrases[0].words == ("thing",)
    of = "" if anything else f" of {noun_phrase(view, question.what)}"
    listed = f": {english.listing(list(values))}" if values else ""
    return known_answer(f"I can see {len(values)} {'colour' if colour else 'kind'}{suffix}{of}{listed}")


def _kind(thing: Thing, colour: bool) -> str | None:
    return colour_of(thing) if colour else str(thing.attributes.get("kind", thing.category))


def answer_most_common(view: View, question: tree.MostCommon) -> TruthAnswer:
    """Answer with the most or least common colour or kind."""
    matches = find(view, question.what)
    if not matches:
        return unknown_answer(f"I cannot tell: {none_in_view(view, question.what)}")
    colour = question.attribute == ("colour",)
    values = [value_of(t, ("colour",)) if colour else t.category for t in matches]
    counts = Counter(v for v in values if v is not None)
    if not counts:
        return unknown_answer(
            f"I cannot tell the {'colours' if colour else 'kinds'} of {definite_phrase(view, question.what, plural=True)}"
        )
    target = (min if question.least else max)(counts.values())
    best = [v for v, n in counts.items() if n == target]
    kind = f"{'least' if question.least else 'most'} common {'colour' if colour else 'kind'}"
    if len(best) > 1:
        return known_answer(f"{english.listing(best)} are equally common ({target} each)")
    return known_answer(f"the {kind} is {best[0]}: {target} of {len(matches)} {noun_phrase(view, question.what, plural=True)}")
