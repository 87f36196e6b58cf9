"""Answer questions of the forms "is there ...?" and "how many ...?"."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.restating import (
    definite_as_asked,
    is_plural,
    none_in_view,
    noun_phrase,
    predicate_words,
    unmodelled_background,
    unmodelled_place,
)
from scope_ptz.perception.ground_truth.answers.text_regions import find_sign_regions, may_be_lettering
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    coloured_name,
    is_or_are,
    known_answer,
    names_with_positions,
    position_words,
    unknown_answer,
)
from scope_ptz.perception.ground_truth.answers.unclear import answer_unclear, more_may_be
from scope_ptz.perception.ground_truth.answers.undecided import (
    undecided_people,
    undecided_reason,
    with_plural_sex,
    without_open_sex,
)
from scope_ptz.perception.ground_truth.answers.vehicle_interiors import answer_about_occupants, asked_vehicle
from scope_ptz.perception.ground_truth.thing_facts import SEXES, has_item
from scope_ptz.perception.ground_truth.thing_search import find, find_excluding_wearers, holds, without_waiting
from scope_ptz.perception.ground_truth.unclear_things import unclear_matches
from scope_ptz.perception.ground_truth.view import Thing, View

MAX_LISTED = 3
"""Maximum number of things to list individually. If there are more, the answer states only their number."""


def add_tests(description: tree.Description, tests: tuple[tree.Test, ...]) -> tree.Description:
    """Return a description with additional tests. A superlative among the tests becomes the description's order."""
    orders = [t for t in tests if isinstance(t, tree.Order)]
    rest = tuple(t for t in tests if not isinstance(t, tree.Order))
    return tree.Description(
        tuple(replace(p, tests=(*p.tests, *rest), order=orders[0] if orders else p.order) for p in description.phrases)
    )


def answer_exists(view: View, question: tree.Exists) -> TruthAnswer:
    """Answer whether anything in view matches the description."""
    question = replace(question, what=_without_preference(question.what))
    plural = is_plural(question.what)
    named = noun_phrase(view, question.what, plural)
    whether = f"I cannot tell whether there {'are any' if plural else 'is'} {named if plural else english.article(named)}"
    if unmodelled_background(view, question.what):
        return unknown_answer(whether)
    if (not_every := _answer_not_every(view, question)) is not None:
        return not_every
    what = question.what
    matches = find(view, what)
    if len(matches) > 1 or any(x in SEXES for p in what.phrases for x in p.words):
        what = with_plural_sex(what)  # nobody is called a man or a woman if their sex is unknown
        matches = find(view, what)
    if not matches and unmodelled_place(view, what):
        return unknown_answer(whether)
    if not matches and (vehicle := asked_vehicle(view, question.what)) is not None:
        return answer_about_occupants(view, question.what, vehicle)
    if not matches and (people := undecided_people(view, what)):
        is_only_sex_open = not plural and find(view, question.what) == people
        return unknown_answer(
            _person_of_open_sex(view, question.what, people[0]) if is_only_sex_open and len(people) == 1 else whether
        )
    if not matches and may_be_lettering(view, what):
        return _answer_lettering_exists(view, question) or unknown_answer(whether)
    if question.least != 1 or question.most is not None:
        if possible := unclear_matches(view, what):
            return _answer_unclear_bounds(view, question, len(matches), len(possible))
        yes = question.least <= len(matches) and (question.most is None or len(matches) <= question.most)
        total = len(matches)
        return known_answer(
            f"{'yes' if yes else 'no'}, there {is_or_are(total)} {total} {noun_phrase(view, question.what, total != 1)}"
        )
    if not matches and not question.negated and (owner := _owner_of_part(view, question.what)) is not None:
        return known_answer(f"yes, the {coloured_name(owner)} has {english.article(' '.join(question.what.phrases[0].words))}")
    if not matches and (unclear := answer_unclear(view, question.what)) is not None:
        return unclear
    if not matches:
        return known_answer(f"{'yes' if question.negated else 'no'}, {none_in_view(view, question.what)}")
    return known_answer(f"{'no' if question.negated else 'yes'}, {describe_matches(view, _decided(view, question.what), matches)}")


def _person_of_open_sex(view: View, what: tree.Description, person: Thing) -> str:
    """Describe the only person who may be "a man walking", and say that their sex is unknown."""
    described = without_open_sex(view, what)
    is_placed = any(isinstance(t, tree.Region) for p in described.phrases for t in p.tests)
    seen = english.article(noun_phrase(view, described)) + ("" if is_placed else f", {position_words(person)}")
    sexed = next((x for p in what.phrases for x in p.words if x in SEXES), noun_phrase(view, what))
    return f"there is {seen}, but I cannot tell whether it is {english.article(sexed)}"


def _decided(view: View, what: tree.Description) -> tree.Description:
    """Return a description without those of several alternatives of which it is open whether anybody matches them."""
    if len(what.phrases) == 1:
        return what
    parts = [with_plural_sex(tree.Description((p,))) for p in what.phrases]
    return tree.Description(tuple(p.phrases[0] for p in parts if find(view, p) or not undecided_people(view, p)))


def _without_preference(what: tree.Description) -> tree.Description:
    """Return a description of any such thing ("any barrier"), and not of the one that "the barrier" most likely means."""
    return replace(what, phrases=tuple(replace(p, article=p.article or "a") for p in what.phrases))


def _answer_not_every(view: View, question: tree.Exists) -> TruthAnswer | None:
    """Answer no to "is there a bus and a car?" if there are only cars; None if there is everything or nothing."""
    parts = [tree.Description((p,)) for p in question.what.phrases]
    present = [p for p in map(with_plural_sex, parts) if find(view, p)]
    absent = [p for p in parts if with_plural_sex(p) not in present]
    if not question.what.by_and or question.negated or not present or not absent:
        return None
    replies = [answer_exists(view, tree.Exists(p)) for p in absent]
    if not all(reply.known for reply in replies):
        return next(reply for reply in replies if not reply.known)
    if not all(reply.text.startswith("No") for reply in replies):
        return None  # "a beacon and a car", of which the beacon is a part of a van
    missing = none_in_view(view, tree.Description(tuple(p for part in absent for p in part.phrases)))
    seen = tree.Description(tuple(p for part in present for p in part.phrases))
    first = _numbers_per_phrase(view, seen)[0]
    return known_answer(f"no, {missing}, but there {is_or_are(first)} {_counts_per_phrase(view, seen)}")


def _answer_lettering_exists(view: View, question: tree.Exists) -> TruthAnswer | None:
    """Answer whether there are signs that are no things of their own. Their number is a minimum; None if that decides nothing."""
    plain = tree.Description(tuple(replace(p, amount=None) for p in question.what.phrases))
    total = len(find_sign_regions(view, plain))
    if not total or (question.most is None and total < question.least) or (question.most is not None and total <= question.most):
        return None
    yes = question.most is None and not question.negated
    signs = noun_phrase(view, question.what, plural=total != 1)
    return known_answer(f"{'yes' if yes else 'no'}, there {is_or_are(total)} at least {total} {signs}")


def _answer_unclear_bounds(view: View, question: tree.Exists, total: int, unclear: int) -> TruthAnswer:
    """Answer whether there are at least or at most so many things, if only ``total`` of ``total + unclear`` are clearly visible."""
    counted = f"there {is_or_are(total)} at least {total} {noun_phrase(view, question.what, total != 1)}"
    if total >= question.least and question.most is None:
        return known_answer(f"yes, {counted}")
    if question.most is not None and total > question.most:
        return known_answer(f"no, {counted}")
    seen = f"I can make out {'only ' if total else ''}{total or 'no'} {noun_phrase(view, question.what, total != 1)}"
    if total + unclear < question.least:
        return known_answer(f"no, {seen}")
    return unknown_answer(f"I cannot tell: {seen}, but {more_may_be(view, question.what)}")


def _owner_of_part(view: View, what: tree.Description) -> Thing | None:
    """Return the thing that has the described part as an attribute ("a beacon on the van": the van), or None."""
    phrase = what.phrases[0]
    if (
        len(what.phrases) != 1
        or len(phrase.tests) != 1
        or not isinstance(test := phrase.tests[0], tree.Relation)
        or test.kind != "on"
    ):
        return None
    return next((t for t in find(view, test.other) if has_item(view, t, phrase.words)), None)


def describe_matches(view: View, what: tree.Description, matches: list[Thing]) -> str:
    """Describe the matching things: "there are 2 cars: a red car on the left and a white car in the middle"."""
    are_wearers = not find_excluding_wearers(view, what)
    on = "with" if are_wearers and _is_animal(what) else "on"
    if len(matches) == 1:
        return (
            f"there is {english.article(noun_phrase(view, what))} {on} {names_with_positions(matches)}"
            if are_wearers
            else f"there is {names_with_positions(matches)}"
        )
    statement = f"there are {len(matches)} {noun_phrase(view, what, plural=True)}"
    if len(what.phrases) > 1 and sum(counts := _numbers_per_phrase(view, what)) == len(matches):
        statement = f"there {is_or_are(counts[0])} {_counts_per_phrase(view, what)}"
    elif len(what.phrases) > 1 and len(matches) > MAX_LISTED:
        return f"there are {_counts_per_phrase(view, what)}"
    return (
        f"{statement}{f', {on}' if are_wearers else ':'} {names_with_positions(matches)}"
        if len(matches) <= MAX_LISTED
        else statement
    )


def _is_animal(what: tree.Description) -> bool:
    concept = lexicon().concept(what.phrases[0].words[-1])
    return concept is not None and "animal" in lexicon().kinds(concept)


def answer_count(view: View, question: tree.Count) -> TruthAnswer:
    """Answer how many things match the description and the tests."""
    tests = without_waiting(question.tests)
    description = add_tests(question.what, tests)
    total = len(find(view, description))
    open_number = len(undecided_people(view, description))
    kind = noun_phrase(view, question.what, plural=True)
    how_many = f"I cannot tell how many {kind} {predicate_words(view, tests, 2) if tests else 'there are'}"
    if unmodelled_background(view, question.what) or (not total and unmodelled_place(view, description)):
        return unknown_answer(how_many)
    if not total and (vehicle := asked_vehicle(view, description)) is not None:
        return answer_about_occupants(view, description, vehicle, is_yes_no=False)
    if not total and (signs := find_sign_regions(view, description)):
        least = f"at least {len(signs)} {noun_phrase(view, question.what, plural=len(signs) != 1)}"
        return known_answer(
            f"{least} {predicate_words(view, tests, len(signs))}" if tests else f"there {is_or_are(len(signs))} {least}"
        )
    if not total and may_be_lettering(view, description):
        return unknown_answer(how_many)
    is_open = any(
        holds(view, t, test) is None
        for t in find(view, question.what)
        for test in tests
        if isinstance(test, tree.Has) or (isinstance(test, tree.Is) and "person" in t.concepts)
    )
    if not total and (open_number or is_open or _asks_for_parts(view, question)):
        return unknown_answer(_how_many_parts(view, question) or how_many)
    if open_number:
        least = f"at least {total} {noun_phrase(view, question.what, plural=total != 1)}"
        statement = f"{least} {predicate_words(view, tests, total)}" if tests else f"there {is_or_are(total)} {least}"
        return known_answer(f"{statement}; {undecided_reason(view, description)}")
    if not total and (unclear := answer_unclear(view, description)) is not None:
        return unclear
    if not total and len(question.what.phrases) > 1:
        return known_answer(none_in_view(view, description))
    if len(question.what.phrases) > 1:
        return known_answer(f"there {is_or_are(total)} {total} in view: {_counts_per_phrase(view, question.what, question.tests)}")
    more = more_may_be(view, description)
    statement = f"{'at least ' if more else ''}{total or 'no'} {noun_phrase(view, question.what, plural=total != 1)}"
    if question.tests:
        return known_answer("; ".join(filter(None, [f"{statement} {predicate_words(view, tests, total)}", more])))
    return known_answer("; ".join(filter(None, [f"there {is_or_are(total)} {statement} in view", more])))


def _asks_for_parts(view: View, question: tree.Count) -> bool:
    """Return whether a question is about the parts of things in view: "how many windows does the hotel have?"."""
    return any(
        isinstance(t, tree.Relation) and t.kind == "on" and not t.preposition and find(view, t.other) for t in question.tests
    )


def _how_many_parts(view: View, question: tree.Count) -> str:
    """Return that the number of parts is unknown, in the words of the question; empty if it does not ask for parts."""
    if not _asks_for_parts(view, question):
        return ""
    (owner,) = [t.other for t in question.tests if isinstance(t, tree.Relation)][:1]
    verb = "have" if is_plural(owner) else "has"
    return f"I cannot tell how many {noun_phrase(view, question.what, plural=True)} {definite_as_asked(view, owner)} {verb}"


def _counts_per_phrase(view: View, what: tree.Description, tests: tuple[tree.Test, ...] = ()) -> str:
    """Return the count for each noun phrase in a description: "4 cars and 1 van"."""
    parts = [tree.Description((p,)) for p in what.phrases]
    counts = zip(_numbers_per_phrase(view, what, tests), parts, strict=True)
    return english.listing([f"{n or 'no'} {noun_phrase(view, p, plural=n != 1)}" for n, p in counts])


def _numbers_per_phrase(view: View, what: tree.Description, tests: tuple[tree.Test, ...] = ()) -> list[int]:
    """Return how many things match each noun phrase in a description, together with additional tests."""
    return [len(find(view, add_tests(tree.Description((p,)), tests))) for p in what.phrases]
