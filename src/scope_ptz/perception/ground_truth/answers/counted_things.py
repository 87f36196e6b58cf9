"""Answers to questions of the forms "is there ...?" and "how many ...?"."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz import english
from scope_ptz.perception.ground_truth.answers.restating import none_of, noun, predicate_words, unmodelled_background
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, is_or_are, name, reply, things_with_places, unknown
from scope_ptz.perception.ground_truth.language import question_tree as tree
from scope_ptz.perception.ground_truth.thing_facts import has_item
from scope_ptz.perception.ground_truth.thing_search import find, things_named
from scope_ptz.perception.ground_truth.view import Thing, View

MAX_LISTED = 3
"""Maximum number of things to list individually. For more things, only their number is given."""


def with_tests(description: tree.Description, tests: tuple[tree.Test, ...]) -> tree.Description:
    """Return a description with additional tests. A superlative among the tests becomes the order of the description."""
    orders = [t for t in tests if isinstance(t, tree.Order)]
    rest = tuple(t for t in tests if not isinstance(t, tree.Order))
    return tree.Description(
        tuple(replace(p, tests=(*p.tests, *rest), order=orders[0] if orders else p.order) for p in description.phrases)
    )


def exists(view: View, question: tree.Exists) -> TruthAnswer:
    """Answer whether anything in view matches the description."""
    if background := unmodelled_background(view, question.what):
        return unknown(f"I cannot tell: the scene says nothing about the {background}")
    matches = find(view, question.what)
    if question.least != 1 or question.most is not None:
        yes = question.least <= len(matches) and (question.most is None or len(matches) <= question.most)
        total = len(matches)
        return reply(f"{'yes' if yes else 'no'}, there {is_or_are(total)} {total} {noun(view, question.what, total != 1)}")
    if not matches and not question.negated and (owner := _owner(view, question.what)) is not None:
        return reply(f"yes, the {name(owner)} has {english.article(' '.join(question.what.phrases[0].words))}")
    if not matches:
        return reply(f"{'yes' if question.negated else 'no'}, {none_of(view, question.what)}")
    return reply(f"{'no' if question.negated else 'yes'}, {there_are(view, question.what, matches)}")


def _owner(view: View, what: tree.Description) -> Thing | None:
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


def there_are(view: View, what: tree.Description, matches: list[Thing]) -> str:
    """Describe the things that were found: "there are 2 cars: a red car on the left and a white car in the middle"."""
    worn = not things_named(view, what)
    if len(matches) == 1:
        return (
            f"there is {english.article(noun(view, what))} on {things_with_places(matches)}"
            if worn
            else f"there is {things_with_places(matches)}"
        )
    statement = f"there are {len(matches)} {noun(view, what, many=True)}"
    return f"{statement}{', on' if worn else ':'} {things_with_places(matches)}" if len(matches) <= MAX_LISTED else statement


def count(view: View, question: tree.Count) -> TruthAnswer:
    """Answer how many things match the description and the tests."""
    if background := unmodelled_background(view, question.what):
        return unknown(f"I cannot tell: the scene says nothing about the {background}")
    total = len(find(view, with_tests(question.what, question.tests)))
    if len(question.what.phrases) > 1:
        return reply(f"there {is_or_are(total)} {total} in view: {_each(view, question)}")
    statement = f"{total or 'no'} {noun(view, question.what, many=total != 1)}"
    if question.tests:
        return reply(f"{statement} {predicate_words(view, question.tests, total)}")
    return reply(f"there {is_or_are(total)} {statement} in view")


def _each(view: View, question: tree.Count) -> str:
    """Return the count for each noun phrase of a description: "4 cars and 1 van"."""
    parts = [tree.Description((p,)) for p in question.what.phrases]
    counts = [(len(find(view, with_tests(p, question.tests))), p) for p in parts]
    return english.listing([f"{n} {noun(view, p, many=n != 1)}" for n, p in counts])
