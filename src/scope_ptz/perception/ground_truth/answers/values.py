"""Answer questions about colours, states, clothes and other facts about things."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import singular_phrase
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.legible_text import answer_from_signs
from scope_ptz.perception.ground_truth.answers.restating import (
    cannot_make_out,
    definite_as_asked,
    definite_phrase,
    is_plural,
    none_in_view,
    noun_phrase,
    unmodelled_background,
)
from scope_ptz.perception.ground_truth.answers.thing_names import (
    TruthAnswer,
    is_or_are,
    known_answer,
    position_words,
    unknown_answer,
)
from scope_ptz.perception.ground_truth.thing_facts import (
    ABSENT_VALUES,
    COLOUR_KEYS,
    are_opposites,
    canonical_form,
    colour_of,
    fact_words,
    facts,
    is_worn,
    key_words,
    names_of,
    value_words,
)
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View

UNANSWERABLE_SUBJECTS = frozenset(
    "it time day weather date temperature mood today season month year hour brand owner price name age".split()  # noqa: SIM905
)
"""Subjects about which a picture contains no information."""
_ACTIVITY_WORDS = frozenset(["doing", "activity", "action", "up"])
# Groups of words that ask for the same fact.
_KEY_SYNONYMS = {
    "state": {"state", "status", "condition", "position"},
    "kind": {"kind", "type", "make", "model", "sort"},
    "activity": {"activity", "action", "doing", "task", "up"},
    "material": {"material", "made"},
    "direction": {"direction", "pointing", "facing", "heading", "way"},
    "carrying": {"carrying", "load", "cargo", "holding", "hold", "carry"},
}


def answer_attribute(view: View, question: tree.Ask) -> TruthAnswer:
    """Answer with the value of an attribute for one or more things."""
    if question.what is None:
        return answer_fact_in_view(view, question.attribute)
    matches = find(view, question.what)
    if not matches:
        return _answer_about_part(view, question) or answer_absent(view, question.what)
    values = [(t, value_of(t, question.attribute)) for t in matches]
    stated = [(t, v) for t, v in values if v is not None]
    if not stated:
        attribute, subject = " ".join(question.attribute), definite_as_asked(view, question.what)
        if attribute.endswith("ing"):
            return unknown_answer(f"I cannot tell from the picture what {subject} is {attribute}")
        return unknown_answer(f"I cannot tell the {attribute} of {subject} from the picture")
    prefix = next((v for words, v in _VALUE_PREFIXES.items() if set(words.split()) & set(question.attribute)), "")
    if prefix == "facing " and all("direction" in t.attributes for t, _ in stated):
        prefix = "pointing "
    if question.attribute[-1] in COLOUR_KEYS and is_person(question.what.phrases[0].words):
        prefix = "wearing "  # the scene states the colours of people's clothes
    distinct = Counter(v for _, v in stated)
    if len(distinct) == 1:
        subject = definite_phrase(view, question.what, plural=len(stated) > 1)
        return known_answer(f"{subject} {is_or_are(len(stated))} {prefix}{stated[0][1]}")
    if not is_plural(question.what) and len(stated) <= 4:
        things = [f"{t.category} {position_words(t)}" for t, _ in stated]
        determiner = "the" if len(set(things)) == len(things) else "one"
        return known_answer(
            english.listing([f"{determiner} {thing} is {prefix}{v}" for thing, (_, v) in zip(things, stated, strict=True)])
        )
    return known_answer(
        f"{len(stated)} {noun_phrase(view, question.what, plural=True)}: "
        + english.listing([f"{n} {prefix}{v}" for v, n in distinct.most_common()])
    )


def value_of(thing: Thing, attribute: Sequence[str]) -> str | None:
    """Return an attribute's value in words; None if the scene does not state it."""
    if attribute[-1] in COLOUR_KEYS:
        colour = colour_of(thing)
        return colour if colour or "person" not in thing.concepts else _describe_clothes(thing)
    if _is_clothes(attribute):
        return _describe_clothes(thing)
    requested = {canonical_form(english.singular(x)) for x in attribute}
    synonyms = {x for group in _KEY_SYNONYMS.values() if group & set(attribute) for x in group}
    for key, value in facts(thing):
        keys = {canonical_form(english.singular(x)) for x in key_words(key)}
        if requested <= keys or keys & synonyms or keys <= requested:
            return _value_words(key, value)
    if set(attribute) & _ACTIVITY_WORDS and (activity := activity_of(thing)) is not None:
        return activity
    if set(attribute) & _ACTIVITY_WORDS:
        states = fact_words(thing) & {"moving", "stationary", "walking", "working", "upright", "sitting"}
        return min(states, default=None)
    if set(attribute) & _KEY_SYNONYMS["state"]:
        opposable = [f for f in sorted(fact_words(thing)) if any(are_opposites(f, x) for x in _STATES_WITH_OPPOSITE)]
        return opposable[0] if opposable else None
    return None


_VALUE_PREFIXES = {
    "wearing clothes clothing outfit": "wearing ", "carrying load cargo holding": "carrying ", "made material": "made of ",
    "direction pointing facing heading way": "facing ", "lane": "in ", "carriageway": "on the ",
}  # fmt: skip
"""The words between "is" and the value of an attribute, by the words that ask for the attribute."""
# Activities in scene files, and the words for them in answers.
_ACTIVITY_PHRASES = {
    "stand": "standing", "walk": "walking", "kneel": "kneeling", "shovel": "shovelling", "carry": "carrying something",
    "point": "pointing", "phone": "talking on the phone", "clipboard": "holding a clipboard", "sit": "sitting", "run": "running",
    "work": "working", "wave": "waving", "dig": "digging", "drive": "driving",
}  # fmt: skip


def activity_of(thing: Thing) -> str | None:
    """Return the stated activity of a person or machine; None if the scene states none."""
    for key in ("activity", "action", "doing", "task", "pose", "state"):
        if isinstance(value := thing.attributes.get(key), str):
            return _ACTIVITY_PHRASES.get(value, value)
    return None


_STATES_WITH_OPPOSITE = ("open", "closed", "lit", "unlit", "raised", "lowered", "empty", "full", "moving", "stationary")
"""States that have an opposite. They answer questions about a thing's state."""


def _value_words(key: str, value: object) -> str:
    if key == "carrying" and str(value) not in ABSENT_VALUES:
        return english.article(str(value))
    if key == "lane":
        return f"lane {value}" if isinstance(value, int) else f"the {value}"
    if isinstance(value, bool):
        return " ".join(key_words(key)) if value else f"not {' '.join(key_words(key))}"
    return str(value)


def _is_clothes(attribute: Sequence[str]) -> bool:
    return attribute[-1] in {"wearing", "clothes", "clothing", "outfit"}


def _describe_clothes(thing: Thing) -> str | None:
    """Describe a person's clothing: "an orange vest and a white helmet"."""
    worn: list[str] = []
    for key, value in facts(thing):
        if key in {"wearing", "clothing", "clothes", "outfit", "ppe"}:
            worn += [str(value)]
        elif is_worn(key):
            item = " ".join(x for x in key_words(key) if x not in COLOUR_KEYS)
            lacking = value is False or str(value).lower() in {"none", "no"}
            worn.append(f"no {item}" if lacking else english.article(item) if value is True else english.article(f"{value} {item}"))
    return english.listing(worn) if worn else None


def _answer_about_part(view: View, question: tree.Ask) -> TruthAnswer | None:
    """Answer a question about a part that the scene states as a fact about its owner ("the worker's helmet colour")."""
    if question.what is None:
        return None
    matches = part_values(view, question.what)
    if not matches:
        return None
    part = english.singular(question.what.phrases[0].words[-1])
    if len({v for _, v in matches}) == 1:
        return known_answer(f"the {part} is {matches[0][1]}" if len(matches) == 1 else f"all {len(matches)} are {matches[0][1]}")
    return known_answer(english.listing([f"the {part} of the {t.category} {position_words(t)} is {v}" for t, v in matches]))


def part_values(view: View, what: tree.Description) -> list[tuple[Thing, str]]:
    """Return the owners and values for a part that is stated as a fact about its owner: "helmet of the worker", "cabin door"."""
    phrase = what.phrases[0]
    owners = [t.other for t in phrase.tests if isinstance(t, tree.Relation) and t.kind == "on"]
    part = phrase.words
    if not owners and len(phrase.words) > 1:
        owners, part = [tree.Description((tree.Phrase(phrase.words[:-1]),))], phrase.words[-1:]
    if not owners:
        owners = [tree.Description((tree.Phrase(("thing",)),))]
    return [(t, v) for t in find(view, owners[0]) for v in [_part_value(t, part)] if v is not None]


def _part_value(thing: Thing, words: Sequence[str]) -> str | None:
    requested = names_of(" ".join(words))
    for key, value in facts(thing):
        part = singular_phrase(" ".join(x for x in key_words(key) if x not in COLOUR_KEYS) or key)
        if part in requested and isinstance(value, str) and value.lower() not in ABSENT_VALUES and not value.isdigit():
            return value
    return None


def answer_fact_in_view(view: View, attribute: Sequence[str]) -> TruthAnswer:
    """Answer with a fact about a thing in view ("which lane is closed?"), or the text on a sign ("what is the speed limit?")."""
    if tuple(attribute) == ("thing",) or set(attribute) & UNANSWERABLE_SUBJECTS:
        return unknown_answer("I cannot tell that from the picture")
    stated = [(t, v) for t in view.things for v in [value_of(t, attribute)] if v is not None and _fact_contains(t, attribute)]
    if stated:
        values = list(dict.fromkeys(v for _, v in stated))
        return known_answer(f"the {' '.join(attribute)} is {english.listing(values)}")
    signs = find(view, tree.Description((tree.Phrase(tuple(attribute)),)))
    if "limit" in attribute:
        signs = [t for t in (signs or view.with_cut_off_texts().things) if any(x.strip().isdigit() for x in t.texts)] or signs
    names_fact = "NOUN" in parts_of_speech(attribute[-1])
    return answer_from_signs(view, signs, " ".join(attribute)) or unknown_answer(
        f"I cannot tell: nothing in view states the {' '.join(attribute)}" if names_fact else "I cannot tell that from the picture"
    )


def _fact_contains(thing: Thing, attribute: Sequence[str]) -> bool:
    """Return whether one fact of the thing contains every word of the attribute."""
    requested = {canonical_form(english.singular(x)) for x in attribute}
    return any(
        requested <= {canonical_form(english.singular(x)) for x in (*key_words(k), *value_words(v))} for k, v in facts(thing)
    )


def answer_absent(view: View, subject: tree.Description) -> TruthAnswer:
    """Answer a question about something that is not in view."""
    if any(p.words and p.words[-1] in UNANSWERABLE_SUBJECTS for p in subject.phrases):
        return unknown_answer("I cannot tell that from the picture")
    if background := unmodelled_background(view, subject):
        return unknown_answer(cannot_make_out(background))
    return known_answer(none_in_view(view, subject))
