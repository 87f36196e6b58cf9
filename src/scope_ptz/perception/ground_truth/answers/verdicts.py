"""Yes-or-no answers about what is in view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.perception.ground_truth.answers.counted_things import exists
from scope_ptz.perception.ground_truth.answers.restating import (
    after_noun,
    as_asked,
    definite,
    none_of,
    noun,
    plural,
    predicate_words,
)
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, name, place, reply, unknown
from scope_ptz.perception.ground_truth.answers.values import absent, part_values
from scope_ptz.perception.ground_truth.language import question_tree as tree
from scope_ptz.perception.ground_truth.thing_facts import canonical, colour_of, fact_words, fits_noun, opposite
from scope_ptz.perception.ground_truth.thing_search import find, holds, noun_of
from scope_ptz.perception.ground_truth.view import Thing, View

_ANYBODY = frozenset(["anyone", "anybody", "someone", "somebody", "anything", "something"])
_EVERYBODY = frozenset(["everyone", "everybody", "everything", "they"])


def yes_no(view: View, question: tree.YesNo) -> TruthAnswer:
    """Answer whether the tests hold for the subject."""
    subject, tests = _parts(view, question)
    if not tests:
        return exists(view, tree.Exists(subject))
    if (text := _as_text(view, subject, tests)) is not None:
        return text
    things = find(view, subject)
    if not things:
        return _answer_about_part(view, subject, tests) or absent(view, subject)
    missing = next((m for m in (missing_reference(view, t) for t in tests) if m is not None), None)
    if missing is not None:
        return unknown(f"I cannot tell: {none_of(view, missing)}")
    answers = [_every([holds(view, t, test) for test in tests]) for t in things]
    if None in answers and True not in answers:
        predicate = english.listing([after_noun(view, t) for t in tests])
        return unknown(f"I cannot tell whether {as_asked(view, subject)} {'are' if plural(subject) else 'is'} {predicate}")
    choice = _choice(view, subject, tests, things)
    if choice is not None:
        return choice
    return _verdict(view, question.scope, subject, tests, things, [t for t, ok in zip(things, answers, strict=True) if ok])


def _as_text(view: View, subject: tree.Description, tests: tuple[tree.Test, ...]) -> TruthAnswer | None:
    """Answer "is Brampton on the sign?" as a question about text, if "Brampton" is not the name of a thing."""
    phrase = subject.phrases[0]
    if len(tests) != 1 or not isinstance(tests[0], tree.Relation) or tests[0].kind != "on" or nouns_in(phrase.words, view.nouns):
        return None
    texts = [text for t in find(view.for_reading(), tests[0].other) for text in t.texts]
    if not texts:
        return None
    requested = english.letters(" ".join(phrase.words))
    yes = any(requested in english.letters(text) for text in texts)
    quoted = english.listing([f'"{text}"' for text in dict.fromkeys(texts)])
    return reply(f"{'yes' if yes else 'no'}, {as_asked(view, tests[0].other)} reads {quoted}")


def _answer_about_part(view: View, subject: tree.Description, tests: tuple[tree.Test, ...]) -> TruthAnswer | None:
    """Answer "is the cabin door open?" if the scene states the door as a fact about the cabin."""
    values = part_values(view, subject)
    if not values or len(tests) != 1 or not isinstance(tests[0], tree.Is):
        return None
    requested = canonical(tests[0].words[-1])
    value = canonical(values[0][1].lower())
    part = subject.phrases[0].words[-1]
    statement = f"the {part} {'are' if english.is_plural(part) else 'is'} {value}"
    return reply(f"{'yes' if requested in value.split() else 'no'}, {statement}")


def missing_reference(view: View, test: tree.Test) -> tree.Description | None:
    """Return the description that a relation refers to, if nothing in view matches it; otherwise None."""
    match test:
        case tree.Not(test=inner):
            return missing_reference(view, inner)
        case tree.Relation(kind=kind, other=other) if kind != "on":
            others: tuple[tree.Description, ...] = (other,)
        case tree.Measured(other=other):
            others = (other,)
        case tree.Between(first=first, second=second):
            others = (first, second)
        case _:
            others = ()
    return next((o for o in others if not find(view, o)), None)


def _parts(view: View, question: tree.YesNo) -> tuple[tree.Description, tuple[tree.Test, ...]]:
    """Split a question into the subject and the tests.

    The predicate may follow the noun within the subject ("gate open"), or be the subject's last restriction.
    """
    *others, last = question.subject.phrases
    tests = list(question.tests)
    if tests and isinstance(tests[0], tree.Is) and not last.tests and not last.order:
        last = replace(last, words=(*last.words, *tests.pop(0).words))  # type: ignore[union-attr]
    head, after = noun_of(view, last.words)
    if after:
        tests.insert(0, tree.Is(after))
        last = replace(last, words=head)
    if not tests and last.tests:
        tests = [last.tests[-1]]
        last = replace(last, tests=last.tests[:-1])
        others = [replace(p, tests=tuple(t for t in p.tests if t not in tests)) for p in others]
    if tests and isinstance(relation := tests[-1], tree.Relation):
        last_phrase = relation.other.phrases[-1]
        head, after = noun_of(view, last_phrase.words)
        if after and nouns_in(last_phrase.words, view.nouns):
            tests[-1] = replace(relation, other=tree.Description((*relation.other.phrases[:-1], replace(last_phrase, words=head))))
            tests.append(tree.Is(after))
    while len(tests) > 1 and (
        isinstance(tests[0], tree.Region | tree.Relation | tree.Between) or (isinstance(tests[0], tree.Has) and not tests[0].worn)
    ):
        last = replace(last, tests=(*last.tests, tests.pop(0)))
    return tree.Description((*others, last)), tuple(tests)


def _every(answers: Sequence[bool | None]) -> bool | None:
    """Return whether all answers are yes; None stands for unknown."""
    return False if False in answers else None if None in answers else True


def _choice(view: View, subject: tree.Description, tests: Sequence[tree.Test], things: list[Thing]) -> TruthAnswer | None:
    """Answer "red or white?" by naming the alternative that holds; None if none is known to hold."""
    if len(tests) != 1 or not isinstance(tests[0], tree.Any):
        return None
    options = tests[0].tests
    true_options = [o for o in options if any(holds(view, t, o) for t in things)]
    total = len(things)
    if true_options and total == 1:
        return reply(f"the {name(things[0])} {predicate_words(view, true_options, 1)}")
    if true_options:
        counts = [(sum(holds(view, t, o) is True for t in things), o) for o in true_options]
        many = noun(view, subject, many=True)
        if len(counts) == 1 and counts[0][0] == total:
            return reply(f"{_all_of(total)} {many} {predicate_words(view, true_options, total)}")
        (first, option), *rest = counts
        others = [f"{n} {predicate_words(view, [o], n)}" for n, o in rest]
        return reply(english.listing([f"{first} of the {total} {many} {predicate_words(view, [option], first)}", *others]))
    fact = _actual_value(view, options[0], things)
    return reply(f"neither: {fact}") if fact else None


def _verdict(
    view: View, scope: str, subject: tree.Description, tests: tuple[tree.Test, ...], things: list[Thing], yes: list[Thing]
) -> TruthAnswer:
    """Answer yes or no.

    Args:
        view: The view.
        scope: The scope of the question: "the", "all", "any" or "none".
        subject: The description of the things in question.
        tests: The tests.
        things: The things in question.
        yes: Those of ``things`` for which the tests hold.
    """
    total, many = len(things), noun(view, subject, many=True)
    if any(p.words[-1] in _EVERYBODY for p in subject.phrases if p.words):
        scope = "all"
    some = scope == "any" or any(p.words[-1] in _ANYBODY for p in subject.phrases if p.words)
    share = f"{len(yes)} of the {total} {many} {predicate_words(view, tests, len(yes))}"
    if scope == "none":
        return reply(f"no, {share}" if yes else f"yes, none of the {many} {predicate_words(view, tests, total)}")
    if not yes:
        return _none_of_them(view, subject, tests, things, some=some)
    if len(yes) == total:
        several = total > 1 and len(subject.phrases) == 1
        every = f"{_all_of(total)} {many}" if several else _subject_words(view, subject, total)
        return reply(f"yes, {every} {predicate_words(view, tests, total)}")
    if scope == "all" or (plural(subject) and not some):
        return reply(f"no, only {share}")
    where = f": the one {place(yes[0])}" if len(yes) == 1 else ""
    return reply(f"yes, {share}{where}")


def _all_of(total: int) -> str:
    """Return "both", or "all" with the number of things; numbers up to twelve are words."""
    return "both" if total == 2 else f"all {english.number_word(total) if total <= _MAX_SPELLED else total}"


_MAX_SPELLED = 12


def _none_of_them(
    view: View, subject: tree.Description, tests: tuple[tree.Test, ...], things: list[Thing], *, some: bool
) -> TruthAnswer:
    """Answer no, and state the actual value if it is known. ``some`` is True if the question is about any of the things."""
    total, union = len(things), len(subject.phrases) > 1
    if total > 1 and not union and len(tests) == 1 and isinstance(tests[0], tree.Not):
        # Not "none of them does not wear a helmet".
        return reply(
            f"no, {_all_of(total)} {noun(view, subject, many=True)} in view {predicate_words(view, [tests[0].test], total)}"
        )
    fact = _actual_value(view, tests[-1], things) if len(tests) == 1 and not union else None
    if fact:
        return reply(f"no, {fact}")
    if some or (total > 1 and not union):
        return reply(f"no, none of the {total} {noun(view, subject, many=True)} in view {predicate_words(view, tests, total)}")
    return reply(f"no, {_subject_words(view, subject, total)} {predicate_words(view, tests, total, negated=True)}")


def _subject_words(view: View, subject: tree.Description, total: int) -> str:
    """Return the subject in words: "the red car", "the cars"."""
    return definite(view, subject) if total == 1 and len(subject.phrases) == 1 else as_asked(view, subject)


def _actual_value(view: View, test: tree.Test, things: list[Thing]) -> str | None:
    """Return the actual state or colour of the things that a question is about: "the van is white", "the gate is closed"."""
    if not isinstance(test, tree.Is) or len({name(t) for t in things}) > 1:
        return None
    thing, requested = things[0], canonical(test.words[-1])
    colour = colour_of(thing)
    kind = thing.category
    if requested in english.COLOURS and colour:
        return f"the {kind} is {colour}" if len(things) == 1 else f"the {english.plural(kind)} are {colour}"
    for fact in sorted(fact_words(thing)):
        if opposite(requested, fact):
            return f"the {kind} is {fact}" if len(things) == 1 else f"the {english.plural(kind)} are {fact}"
    if nouns_in(test.words) and not fits_noun(view, thing, test.words[-1]):
        return f"it is {english.article(name(thing))}"
    return None


def is_a(view: View, question: tree.IsA) -> TruthAnswer:
    """Answer whether a thing is of a kind."""
    things = find(view, question.subject)
    if not things:
        return unknown(f"I cannot tell: {none_of(view, question.subject)}")
    matches = find(view, question.what)
    return reply(f"{'yes' if things[0] in matches else 'no'}, it is {english.article(name(things[0]))}")
