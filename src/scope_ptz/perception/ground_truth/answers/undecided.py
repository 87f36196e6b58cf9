"""Find the people about whom the scene leaves open whether a description fits them: their sex, and whether they are waiting.

A picture of a person who stands at a kerb does not show whether they wait, and a scene states the sex of few people. A count of
"women" or of "people waiting" would therefore claim more than was seen.
"""

from __future__ import annotations

from dataclasses import replace

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import singular_phrase
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.restating import words_after_noun
from scope_ptz.perception.ground_truth.stated_items import as_worn
from scope_ptz.perception.ground_truth.thing_facts import SEXES, fits_words, is_sexed, stated_sex
from scope_ptz.perception.ground_truth.thing_search import find, find_phrase, holds, is_place, split_after_noun
from scope_ptz.perception.ground_truth.view import Thing, View

WAITING = "waiting"


def undecided_people(view: View, description: tree.Description) -> list[Thing]:
    """Return the people in view who may match the description, although the scene does not state that they do."""
    matches = find(view, description)
    return [t for phrase in description.phrases for t in _candidates(view, phrase) if t not in matches]


def undecided_words(view: View, description: tree.Description) -> str:
    """Return what the scene leaves open about people in view, after "whether anyone is": "a woman"; empty if it is decided."""
    for phrase in description.phrases:
        if _candidates(view, phrase):
            sexed = _sexed_noun(phrase)
            return english.article(singular_phrase(sexed)) if sexed else _open_words(view, phrase) or WAITING
    return ""


def undecided_reason(view: View, description: tree.Description) -> str:
    """Return the statement that the scene leaves open which people match; empty if that is decided."""
    people = undecided_people(view, description)
    if not people:
        return ""
    sexed = next((noun for noun in map(_sexed_noun, description.phrases) if noun), "")
    if len(people) == 1:
        return f"I cannot tell whether one person is {undecided_words(view, description)}"
    return f"I cannot tell which of {len(people)} people are {sexed or undecided_words(view, description)}"


def _candidates(view: View, phrase: tree.Phrase) -> list[Thing]:
    """Return the people who match a phrase apart from the words that the scene leaves open."""
    phrase = _with_activity_as_test(view, phrase)
    sexed = _sexed_noun(phrase)
    if sexed:
        wider = replace(phrase, words=tuple("people" if x == sexed else x for x in phrase.words))
        return [t for t in find_phrase(view, wider) if stated_sex(t) is None]
    open_tests = [t for t in phrase.tests if _may_be_open(t)]
    if open_tests:
        wider = replace(phrase, tests=tuple(t for t in phrase.tests if t not in open_tests))
        return [
            t
            for t in find_phrase(view, wider)
            if "person" in t.concepts and any(holds(view, t, test) is None for test in open_tests)
        ]
    wider = _without_waiting(phrase)
    if wider == phrase or any(is_place(t) for t in phrase.tests):
        return []
    return [t for t in find_phrase(view, wider) if "person" in t.concepts and fits_words(view, t, [WAITING]) is None]


def _with_activity_as_test(view: View, phrase: tree.Phrase) -> tree.Phrase:
    """Return "people" with the test "working" for "people working"."""
    head, after = split_after_noun(view, phrase.words)
    if WAITING in after or not is_person(head) or not any(x.endswith("ing") for x in after):
        return phrase
    return replace(phrase, words=head, tests=(tree.Is(after), *phrase.tests))


def _may_be_open(test: tree.Test) -> bool:
    """Return whether a test is for people's clothes, their sex or what they do, which the scene may leave open."""
    if isinstance(test, tree.Is):
        return is_sexed(test.words) or (WAITING not in test.words and any(x.endswith("ing") for x in test.words))
    return as_worn(test) is not None


def _open_words(view: View, phrase: tree.Phrase) -> str:
    """Return what a phrase says about people's clothes or sex in its tests ("wearing red"); empty if it says nothing about them."""
    tests = _with_activity_as_test(view, phrase).tests
    return next((words_after_noun(view, as_worn(t) or t) for t in tests if _may_be_open(t)), "")


def with_plural_sex(description: tree.Description) -> tree.Description:
    """Return a description in which "woman" is plural, so that it matches only people whose sex the scene states."""
    return tree.Description(
        tuple(replace(p, words=tuple(english.plural(x) if x in SEXES else x for x in p.words)) for p in description.phrases)
    )


def undecided_sex(view: View, description: tree.Description) -> str:
    """Return the statement that several people may be "the woman"; empty if only one may be, or if the scene states who is."""
    sexed = next((x for p in description.phrases for x in p.words if x in SEXES), "")
    people = find(view, description) if sexed else []
    if len(people) < 2 or any(stated_sex(t) is not None for t in people):
        return ""
    return f"I cannot tell which of {len(people)} people is {english.article(sexed)}"


def without_open_sex(view: View, description: tree.Description) -> tree.Description:
    """Return "the person at the stall" for "the lady at the stall" if the scene does not state the sex of whom it matches."""

    def unsexed(phrase: tree.Phrase) -> tree.Phrase:
        people = find(view, tree.Description((phrase,))) if SEXES.keys() & set(phrase.words) else []
        if all(stated_sex(t) is not None for t in people):
            return phrase
        return replace(phrase, words=tuple("person" if x in SEXES else x for x in phrase.words))

    return tree.Description(tuple(map(unsexed, description.phrases)))


def _sexed_noun(phrase: tree.Phrase) -> str:
    """Return the plural noun of a phrase that states the sex of people, such as "women"; empty if it has none."""
    return next((x for x in phrase.words if english.is_plural(x) and singular_phrase(x) in SEXES), "")


def _without_waiting(phrase: tree.Phrase) -> tree.Phrase:
    """Return a phrase without the waiting, and without what is waited for ("people waiting for the bus")."""
    words = phrase.words[: phrase.words.index(WAITING)] if WAITING in phrase.words else phrase.words
    is_waiting = words != phrase.words
    tests: list[tree.Test] = []
    for test in phrase.tests:
        is_waiting |= isinstance(test, tree.Is) and WAITING in test.words
        if not (is_waiting and isinstance(test, tree.Is)):
            tests.append(test)
    return replace(phrase, words=words or (("people",) if is_waiting else ()), tests=tuple(tests))
