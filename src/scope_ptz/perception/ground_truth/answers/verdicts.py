"""Answer yes-or-no questions about what is in view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz import english
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.counted_things import add_tests, answer_exists
from scope_ptz.perception.ground_truth.answers.restating import (
    definite_as_asked,
    definite_phrase,
    is_plural,
    none_in_view,
    noun_phrase,
    predicate_words,
    unmodelled_background,
    unmodelled_place,
    words_after_noun,
)
from scope_ptz.perception.ground_truth.answers.sexes import answer_sex, answer_which_sex
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    coloured_name,
    is_or_are,
    known_answer,
    position_words,
    unknown_answer,
)
from scope_ptz.perception.ground_truth.answers.undecided import undecided_people, undecided_words
from scope_ptz.perception.ground_truth.answers.values import answer_absent, is_unmodelled_part, part_values, value_of
from scope_ptz.perception.ground_truth.answers.vehicle_interiors import answer_about_occupants, asked_vehicle
from scope_ptz.perception.ground_truth.thing_facts import (
    ABSENT_VALUES,
    TEXT_KEYS,
    colour_of,
    contains_words,
    fact_words,
    fits_noun,
    has_form_in,
    is_sexed,
)
from scope_ptz.perception.ground_truth.thing_search import (
    compound_categories,
    find,
    find_references,
    holds,
    is_place,
    split_after_numbered_noun,
    without_waiting,
)
from scope_ptz.perception.ground_truth.view import Thing, View
from scope_ptz.perception.ground_truth.vocabulary import are_opposites, canonical_form

_ANYBODY_WORDS = frozenset(["anyone", "anybody", "someone", "somebody", "anything", "something"])
_EVERYBODY_WORDS = frozenset(["everyone", "everybody", "everything", "they"])


def answer_yes_no(view: View, question: tree.YesNo) -> TruthAnswer:
    """Answer whether the tests hold for the subject."""
    if (sex := answer_which_sex(view, question) or _answer_about_sex(view, question)) is not None:
        return sex
    whole = add_tests(question.subject, question.tests)
    if (vehicle := asked_vehicle(view, whole)) is not None and not find(view, whole):
        return answer_about_occupants(view, whole, vehicle)
    if undecided_people(view, whole) and not find(view, whole):
        return unknown_answer(f"I cannot tell whether anyone is {undecided_words(view, whole)}")
    subject, tests = _split_question(view, question)
    scope = question.scope
    if tests and (parts := _parts_of_whole(subject)) is not None:
        subject, scope = parts, "all"
    if not tests:
        if not find(view, subject) and (activity := _unstated_activity(view, subject)):
            return unknown_answer(f"I cannot tell whether anyone is {activity}")
        return answer_exists(view, tree.Exists(subject))
    if (text := _answer_as_text(view, subject, tests)) is not None:
        return text
    things = find(view, subject)
    if not things and (activity := _unstated_activity(view, subject)):
        return unknown_answer(f"I cannot tell whether anyone is {activity}")
    if not things and (part := _answer_about_part(view, subject, tests)) is not None:
        return part
    if not things and (unmodelled_background(view, subject) or is_unmodelled_part(view, subject)):
        return _cannot_tell_whether(view, subject, tests)
    if not things:
        return answer_absent(view, subject)
    missing = next((m for m in (missing_reference(view, t) for t in tests) if m is not None), None)
    if missing is not None:
        return unknown_answer(f"I cannot tell: {none_in_view(view, missing)}")
    if all("boom gate" in t.concepts for t in things) and (arms := _answer_about_compound(view, question, subject, tests)):
        return arms
    answers = [_all_hold([holds(view, t, test) for test in tests]) for t in things]
    if True not in answers and False not in answers:
        return _answer_about_compound(view, question, subject, tests) or _cannot_tell_whether(view, subject, tests)
    is_unknown = None in answers or any(_is_unknown_place(view, t) or unmodelled_place(view, _at(t)) for t in tests)
    if is_unknown and True not in answers:
        return _cannot_tell_whether(view, subject, tests)
    choice = _answer_choice(view, subject, tests, things)
    if choice is not None:
        return choice
    return _answer_verdict(view, scope, subject, tests, things, [t for t, answer in zip(things, answers, strict=True) if answer])


def _answer_about_sex(view: View, question: tree.YesNo) -> TruthAnswer | None:
    """Answer "are all the people women?", in which the subject includes the predicate; None for other questions."""
    (phrase, *others) = question.subject.phrases
    people, noun = phrase.words[:-1], phrase.words[-1:]
    if others or question.tests or not is_sexed(noun) or not is_person(people):
        return None
    return answer_sex(view, tree.Description((replace(phrase, words=people),)), *noun)


def _parts_of_whole(subject: tree.Description) -> tree.Description | None:
    """Return the parts by which a whole is judged: "the parking spaces" for "the car park"; None for other things.

    The whole has a state only if all of its parts have it.
    """
    (phrase, *others) = subject.phrases
    if others or phrase.words[-2:] not in _WHOLES:
        return None
    return tree.Description((replace(phrase, words=(*phrase.words[:-2], *_WHOLES[phrase.words[-2:]])),))


_WHOLES: dict[tuple[str, ...], tuple[str, ...]] = {
    ("car", "park"): ("parking", "spaces"),
    ("parking", "lot"): ("parking", "spaces"),
}
"""Wholes that scenes model only by their parts, with the parts."""


def _answer_about_compound(
    view: View, question: tree.YesNo, subject: tree.Description, tests: tuple[tree.Test, ...]
) -> TruthAnswer | None:
    """Answer "is the barrier raised?" about the barrier arms in view, if no other barrier can be raised."""
    phrase = subject.phrases[0]
    noun = english.singular(phrase.words[-1])
    for category in compound_categories(view, noun):
        compound = tree.Description((replace(phrase, words=(*phrase.words[:-1], *category.split())),))
        if any(_states(view, t, test) for t in find(view, compound) for test in tests):
            return answer_yes_no(view, tree.YesNo(compound, tests, question.scope))
    return None


def _states(view: View, thing: Thing, test: tree.Test) -> bool:
    """Return whether the scene states that a test holds for a thing, or states the opposite."""
    if isinstance(test, tree.Any):
        return any(_states(view, thing, option) for option in test.tests)
    requested = {canonical_form(x) for x in test.words} if isinstance(test, tree.Is) else set[str]()
    return holds(view, thing, test) is True or any(are_opposites(x, fact) for x in requested for fact in fact_words(thing))


def _cannot_tell_whether(view: View, subject: tree.Description, tests: Sequence[tree.Test]) -> TruthAnswer:
    """Answer that it is unknown whether the tests hold for the subject."""
    predicate = english.listing([words_after_noun(view, t) for t in tests])
    is_anyone = subject.phrases[0].words[0] in _ANYBODY_WORDS
    subject_words = subject.phrases[0].words[0] if is_anyone else definite_as_asked(view, subject)
    number = 2 if is_plural(subject) and not is_anyone else 1
    if any(isinstance(t, tree.Has) for t in tests):
        return unknown_answer(f"I cannot tell whether {subject_words} {predicate_words(view, tests, number)}")
    return unknown_answer(f"I cannot tell whether {subject_words} {is_or_are(number)} {predicate}")


def _at(test: tree.Test) -> tree.Description:
    """Return the description of anything for which a test holds."""
    return tree.Description((tree.Phrase(("thing",), (test,)),))


def _unstated_activity(view: View, subject: tree.Description) -> str:
    """Return the activity in "anyone unloading" if nothing in the scene has such an activity; otherwise an empty string."""
    words = subject.phrases[0].words
    if len(words) < 2 or words[0] not in _ANYBODY_WORDS or not words[1].endswith("ing"):
        return ""
    stated = frozenset[str]().union(*(words for key, words in view.values.items() if key not in TEXT_KEYS))
    return "" if has_form_in(words[1], stated) and len(words) == 2 else words[1]


def _answer_as_text(view: View, subject: tree.Description, tests: tuple[tree.Test, ...]) -> TruthAnswer | None:
    """Answer "is Brampton on the sign?" as a question about text, if "Brampton" is not the name of a thing."""
    phrase = subject.phrases[0]
    if len(tests) != 1 or not isinstance(tests[0], tree.Relation) or tests[0].kind != "on" or nouns_in(phrase.words, view.nouns):
        return None
    texts = [text for t in find(view.with_cut_off_texts(), tests[0].other) for text in t.texts]
    if not texts:
        return None
    yes = any(contains_words(text, phrase.words) for text in texts)
    quoted = english.listing([f'"{text}"' for text in dict.fromkeys(texts)])
    return known_answer(f"{'yes' if yes else 'no'}, {definite_as_asked(view, tests[0].other)} reads {quoted}")


def _answer_about_part(view: View, subject: tree.Description, tests: tuple[tree.Test, ...]) -> TruthAnswer | None:
    """Answer "is the cabin door open?" if the scene states the door as a fact about the cabin."""
    values = part_values(view, subject)
    if not values or len(tests) != 1 or not isinstance(tests[0], tree.Is):
        return None
    requested = canonical_form(tests[0].words[-1])
    value = canonical_form(values[0][1].lower())
    part = subject.phrases[0].words[-1]
    statement = f"the {part} {'are' if english.is_plural(part) else 'is'} {value}"
    return known_answer(f"{'yes' if requested in value.split() else 'no'}, {statement}")


def missing_reference(view: View, test: tree.Test) -> tree.Description | None:
    """Return the description that a relation refers to if nothing in view matches that description; otherwise None."""
    match test:
        case tree.Not(test=inner):
            return missing_reference(view, inner)
        case tree.Relation(kind=kind, other=other) if kind != "on":
            others: tuple[tree.Description, ...] = (other,)
        case tree.Measured(other=other) | tree.Order(reference=tree.Description() as other):
            others = (other,)
        case tree.Any(tests=tests):
            return next((m for m in (missing_reference(view, t) for t in tests) if m is not None), None)
        case tree.Between(first=first, second=second):
            others = (first, second)
        case _:
            others = ()
    return next((o for o in others if not find_references(view, o)), None)


def _is_unknown_place(view: View, test: tree.Test) -> bool:
    """Return whether a test such as "in use" has the form of a place but names nothing that the lexicon or the scene knows."""
    return (
        isinstance(test, tree.Relation)
        and test.kind == "on"
        and not any(
            nouns_in(p.words, view.nouns) or is_common_noun(" ".join(p.words)) or find(view, test.other) for p in test.other.phrases
        )
    )


def _split_question(view: View, question: tree.YesNo) -> tuple[tree.Description, tuple[tree.Test, ...]]:
    """Split a question into the subject and the tests.

    The predicate may follow the noun within the subject ("gate open"), or be the subject's last restriction.
    """
    *others, last = question.subject.phrases
    tests = list(question.tests)
    if tests and isinstance(tests[0], tree.Is) and tests[0].words[0] != "waiting" and not last.tests and not last.order:
        last = replace(last, words=(*last.words, *tests.pop(0).words))  # type: ignore[union-attr]
    head, after = split_after_numbered_noun(view, last.words)
    if after:
        tests.insert(0, tree.Is(after))
        last = replace(last, words=head)
    if not tests and last.tests:
        tests = [last.tests[-1]]
        last = replace(last, tests=last.tests[:-1])
        others = [replace(p, tests=tuple(t for t in p.tests if t not in tests)) for p in others]
    if tests and isinstance(relation := tests[-1], tree.Relation):
        last_phrase = relation.other.phrases[-1]
        head, after = split_after_numbered_noun(view, last_phrase.words)
        if after and nouns_in(last_phrase.words, view.nouns):
            tests[-1] = replace(relation, other=tree.Description((*relation.other.phrases[:-1], replace(last_phrase, words=head))))
            tests.append(tree.Is(after))
    while len(tests) > 1 and (
        isinstance(tests[0], tree.Region | tree.Relation | tree.Between) or (isinstance(tests[0], tree.Has) and not tests[0].worn)
    ):
        last = replace(last, tests=(*last.tests, tests.pop(0)))
    if "waiting" in last.words and any(map(is_place, tests)):  # "is anyone waiting at the bus stop?"
        last = replace(last, words=tuple(x for x in last.words if x != "waiting"))
    return tree.Description((*others, last)), without_waiting(tuple(tests))


def _all_hold(answers: Sequence[bool | None]) -> bool | None:
    """Return True if all answers are True, False if any is False, and None otherwise."""
    return False if False in answers else None if None in answers else True


def _answer_choice(view: View, subject: tree.Description, tests: Sequence[tree.Test], things: list[Thing]) -> TruthAnswer | None:
    """Answer "red or white?" with the alternative that holds. Return None if no alternative is known to hold."""
    if len(tests) != 1 or not isinstance(tests[0], tree.Any):
        return None
    options = tests[0].tests
    true_options = [o for o in options if any(holds(view, t, o) for t in things)]
    total = len(things)
    if true_options and total == 1:
        return known_answer(f"the {coloured_name(things[0])} {predicate_words(view, true_options, 1)}")
    if true_options:
        counts = [(sum(holds(view, t, o) is True for t in things), o) for o in true_options]
        plural_noun = noun_phrase(view, subject, plural=True)
        if len(counts) == 1 and counts[0][0] == total:
            return known_answer(f"{_all_words(total)} {plural_noun} {predicate_words(view, true_options, total)}")
        (first, option), *rest = counts
        others = [f"{n} {predicate_words(view, [o], n)}" for n, o in rest]
        return known_answer(
            english.listing([f"{first} of the {total} {plural_noun} {predicate_words(view, [option], first)}", *others])
        )
    fact = _actual_value(view, options[0], things)
    return known_answer(f"neither: {fact}") if fact else None


def _answer_verdict(
    view: View, scope: str, subject: tree.Description, tests: tuple[tree.Test, ...], things: list[Thing], matches: list[Thing]
) -> TruthAnswer:
    """Answer yes or no, with the number of things for which the tests hold.

    Args:
        view: The view.
        scope: The scope of the question: "the", "all", "any" or "none".
        subject: The description of the things in question.
        tests: The tests.
        things: The things in question.
        matches: Those of ``things`` for which the tests hold.
    """
    if (carried := _answer_carried(view, subject, tests, things)) is not None:
        return carried
    total, plural_noun = len(things), noun_phrase(view, subject, plural=True)
    if any(p.words[-1] in _EVERYBODY_WORDS for p in subject.phrases if p.words):
        scope = "all"
    asks_any = scope == "any" or any(p.words[-1] in _ANYBODY_WORDS for p in subject.phrases if p.words)
    share = f"{len(matches)} of the {total} {plural_noun} {predicate_words(view, tests, len(matches))}"
    if scope == "none":
        return known_answer(f"no, {share}" if matches else f"yes, none of the {plural_noun} {predicate_words(view, tests, total)}")
    if not matches:
        return _answer_no(view, subject, tests, things, asks_any=asks_any)
    if len(matches) == total:
        several = total > 1 and len(subject.phrases) == 1
        every = f"{_all_words(total)} {plural_noun}" if several else _subject_words(view, subject, total)
        return known_answer(f"yes, {every} {predicate_words(view, tests, total)}")
    if scope == "all" or (is_plural(subject) and not asks_any):
        return known_answer(f"no, only {share}")
    where = f": {_one_words(matches[0])}" if len(matches) == 1 else ""
    return known_answer(f"yes, {share}{where}")


def _one_words(thing: Thing) -> str:
    """Return which of several things one is. A side in its name ("middle door") may differ from its side of the picture."""
    if not set(thing.name.lower().split()) & _SIDES_IN_NAMES:
        return f"the one {position_words(thing)}"
    return f"the {thing.name}, {position_words(thing)} of the picture"


_SIDES_IN_NAMES = frozenset({"left", "right", "middle", "centre", "upper", "lower", "front", "rear"})


def _answer_carried(view: View, subject: tree.Description, tests: tuple[tree.Test, ...], things: list[Thing]) -> TruthAnswer | None:
    """Answer "is the forklift carrying anything?" with what it carries, and "is the worker wearing anything?" with the clothes.

    None for other questions, and about several things.
    """
    if len(things) != 1 or len(tests) != 1 or not isinstance(test := tests[0], tree.Has) or test.sold:
        return None
    if any(len(p.words) != 1 or p.words[0] not in _ANYBODY_WORDS for p in test.what.phrases):
        return None
    verb = "wearing" if test.worn else "carrying"
    stated = value_of(things[0], (verb,))
    if stated is None:
        return unknown_answer(f"I cannot tell what {definite_phrase(view, subject)} is wearing") if test.worn else None
    if stated in ABSENT_VALUES:
        return known_answer(f"no, {definite_phrase(view, subject)} is {verb} nothing")
    return known_answer(f"yes, {definite_phrase(view, subject)} is {verb} {stated}")


def _all_words(total: int) -> str:
    """Return "both", or "all" followed by the number of things. Numbers up to twelve are words."""
    return "both" if total == 2 else f"all {english.number_word(total) if total <= _MAX_SPELLED_NUMBER else total}"


_MAX_SPELLED_NUMBER = 12


def _answer_no(
    view: View, subject: tree.Description, tests: tuple[tree.Test, ...], things: list[Thing], *, asks_any: bool
) -> TruthAnswer:
    """Answer no, and state the actual value if it is known. ``asks_any`` is True if the question asks about any of the things."""
    total, has_several_phrases = len(things), len(subject.phrases) > 1
    if total > 1 and not has_several_phrases and len(tests) == 1 and isinstance(tests[0], tree.Not):
        # Avoid "none of them does not wear a helmet".
        plural_noun = noun_phrase(view, subject, plural=True)
        return known_answer(f"no, {_all_words(total)} {plural_noun} in view {predicate_words(view, [tests[0].test], total)}")
    fact = _actual_value(view, tests[-1], things) if len(tests) == 1 and not has_several_phrases else None
    if fact:
        return known_answer(f"no, {fact}")
    if asks_any and total == 1:
        return known_answer(f"no, the only {noun_phrase(view, subject)} in view {predicate_words(view, tests, 1, negated=True)}")
    if asks_any or (total > 1 and not has_several_phrases):
        return known_answer(
            f"no, none of the {total} {noun_phrase(view, subject, plural=True)} in view {predicate_words(view, tests, total)}"
        )
    return known_answer(f"no, {_subject_words(view, subject, total)} {predicate_words(view, tests, total, negated=True)}")


def _subject_words(view: View, subject: tree.Description, total: int) -> str:
    """Return the subject in words: "the red car", "the cars"."""
    return definite_phrase(view, subject) if total == 1 and len(subject.phrases) == 1 else definite_as_asked(view, subject)


def _actual_value(view: View, test: tree.Test, things: list[Thing]) -> str | None:
    """Return the actual state or colour of the things that a question is about: "the van is white", "the gate is closed"."""
    if not isinstance(test, tree.Is) or len({coloured_name(t) for t in things}) > 1:
        return None
    thing, requested = things[0], canonical_form(test.words[-1])
    colour = colour_of(thing)
    kind = thing.category
    if requested in english.COLOURS and colour:
        return f"the {kind} is {colour}" if len(things) == 1 else f"the {english.plural(kind)} are {colour}"
    for fact in sorted(fact_words(thing)):
        if are_opposites(requested, fact):
            return f"the {kind} is {fact}" if len(things) == 1 else f"the {english.plural(kind)} are {fact}"
    if nouns_in(test.words) and not fits_noun(view, thing, test.words[-1]):
        return f"it is {english.article(coloured_name(thing))}"
    return None


def answer_is_a(view: View, question: tree.IsA) -> TruthAnswer:
    """Answer whether a thing is of a kind."""
    kind = question.what.phrases[0]
    if is_sexed(kind.words) and not kind.tests and (sex := answer_sex(view, question.subject, kind.words[-1])) is not None:
        return sex
    things = find(view, question.subject)
    if not things:
        return unknown_answer(f"I cannot tell: {none_in_view(view, question.subject)}")
    matches = find(view, question.what)
    return known_answer(f"{'yes' if things[0] in matches else 'no'}, it is {english.article(coloured_name(things[0]))}")
