"""Answer whether people are men or women. A scene states the sex of few people, and a picture does not always show it."""

from __future__ import annotations

from collections import Counter

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import singular_phrase
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.counted_things import add_tests
from scope_ptz.perception.ground_truth.answers.restating import (
    definite_as_asked,
    is_plural,
    none_in_view,
    noun_phrase,
    predicate_words,
)
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, is_or_are, known_answer, unknown_answer
from scope_ptz.perception.ground_truth.thing_facts import is_sexed, sex_fits, stated_sex
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import View

_NOUNS = {"male": "man", "female": "woman"}
_ANYBODY = frozenset({"anyone", "anybody", "someone", "somebody"})


def answer_sex(view: View, subject: tree.Description, noun: str) -> TruthAnswer | None:
    """Answer whether people are of the sex that a noun states: "is the driver a woman?"; None if there are no such people."""
    people = [t for t in find(view, subject) if "person" in t.concepts]
    if not people:
        return None
    answers = [sex_fits(person, noun) for person in people]
    one, total = singular_phrase(noun), len(people)
    asks_anyone = subject.phrases[0].words[0] in _ANYBODY
    number = answers.count(True)
    if asks_anyone and number:
        least = "at least " if None in answers else ""
        return known_answer(f"yes, {least}{number} of the {english.counted(total, 'person')} {_is_a(one, number)}")
    named = subject.phrases[0].words[0] if asks_anyone else definite_as_asked(view, subject)
    if None in answers:
        return unknown_answer(f"I cannot tell whether {named} {_is_a(one, 2 if is_plural(subject) and not asks_anyone else 1)}")
    if asks_anyone:
        return known_answer(f"no, none of the {english.counted(total, 'person')} in view {_is_a(one, total)}")
    if number == total:
        return known_answer(f"yes, {named} {_is_a(one, total)}")
    share = f"{number} of the {total} {noun_phrase(view, subject, plural=True)} {_is_a(one, number)}"
    return known_answer(f"no, only {share}" if number else f"no, {named} {is_or_are(total)} not {_a(one, total)}")


def answer_which_sex(view: View, question: tree.YesNo) -> TruthAnswer | None:
    """Answer "is a man or a woman holding it?" and "is the driver a man or a woman?"; None for other questions."""
    phrases = question.subject.phrases
    last = phrases[-1]
    doing, tests = _split_activity(last.words[1:], question.tests)
    match tests:
        case _ if (tests or doing) and len(phrases) == 2 and all(is_sexed(p.words[:1]) for p in phrases):
            people = tree.Description((tree.Phrase(("person",), (*doing, *tests)),))
            either = english.listing([english.article(p.words[0]) for p in phrases], "or")
            missing = f"I cannot tell whether {either} {predicate_words(view, (*doing, *tests), 1)}"
        case (tree.Any(tests=options),) if sum(_is_sex(t) for t in options) == 2 and is_person(last.words):
            # The parser puts the description of the person before the options: "with a bag", "a man" or "a woman".
            people = add_tests(question.subject, tuple(t for t in options if not _is_sex(t)))
            missing = f"I cannot tell whether {definite_as_asked(view, people)} is a man or a woman"
        case _:
            return None
    matches = find(view, people)
    if not matches:
        return known_answer(none_in_view(view, people))
    sexes = [stated_sex(t) for t in matches]
    if None in sexes:
        return unknown_answer(missing)
    counts = Counter(_NOUNS[sex] for sex in sexes if sex)
    if len(matches) == 1:
        return known_answer(f"it is {english.article(next(iter(counts)))}")
    return known_answer(f"there are {english.listing([english.counted(n, noun) for noun, n in counts.items()])}")


def _split_activity(words: tree.Words, tests: tuple[tree.Test, ...]) -> tuple[tuple[tree.Test, ...], tuple[tree.Test, ...]]:
    """Return the test in "a woman pushing the pram", and the other tests.

    The parser reads "woman pushing" as a name and the pram as a state, but the question is whether she has a pram.
    """
    if len(words) == 1 and words[0].endswith("ing") and tests and isinstance(tests[0], tree.Is):
        words, tests = (*words, *tests[0].words), tests[1:]
    if len(words) > 1 and words[0].endswith("ing"):
        return (tree.Has(tree.Description((tree.Phrase(words[1:]),))),), tests
    return ((tree.Is(words),) if words else ()), tests


def _is_sex(test: tree.Test) -> bool:
    return isinstance(test, tree.Is) and is_sexed(test.words)


def _is_a(noun: str, number: int) -> str:
    return f"{is_or_are(number)} {_a(noun, number)}"


def _a(noun: str, number: int) -> str:
    return english.article(noun) if number == 1 else english.plural(noun)
