"""Answers about colours, states, clothes and other facts about things."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import singular_phrase
from scope_ptz.perception.ground_truth.answers.legible_text import fact_on_signs
from scope_ptz.perception.ground_truth.answers.restating import as_asked, definite, none_of, noun, plural, unmodelled_background
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, is_or_are, place, reply, unknown
from scope_ptz.perception.ground_truth.language import question_tree as tree
from scope_ptz.perception.ground_truth.thing_facts import (
    ABSENT_VALUES,
    COLOUR_KEYS,
    canonical,
    colour_of,
    fact_words,
    facts,
    is_worn,
    key_words,
    names_of,
    opposite,
    value_words,
)
from scope_ptz.perception.ground_truth.thing_search import find
from scope_ptz.perception.ground_truth.view import Thing, View

UNSEEN = frozenset(
    "it time day weather date temperature mood today season month year hour brand owner price name age".split()  # noqa: SIM905
)
"""Subjects about which a picture gives no information."""
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


def ask(view: View, question: tree.Ask) -> TruthAnswer:
    """Answer with the value of an attribute of one or more things."""
    if question.what is None:
        return fact_in_view(view, question.attribute)
    matches = find(view, question.what)
    if not matches:
        return _answer_about_part(view, question) or absent(view, question.what)
    values = [(t, value_of(t, question.attribute)) for t in matches]
    stated = [(t, v) for t, v in values if v is not None]
    if not stated:
        attribute, who = " ".join(question.attribute), as_asked(view, question.what)
        missing = f"what {who} is {attribute}" if attribute.endswith("ing") else f"the {attribute} of {who}"
        return unknown(f"I cannot tell: the scene does not state {missing}")
    verb = next((v for words, v in _VERBS.items() if set(words.split()) & set(question.attribute)), "")
    if verb == "facing " and all("direction" in t.attributes for t, _ in stated):
        verb = "pointing "
    distinct = Counter(v for _, v in stated)
    if len(distinct) == 1:
        who = definite(view, question.what, many=len(stated) > 1)
        return reply(f"{who} {is_or_are(len(stated))} {verb}{stated[0][1]}")
    if not plural(question.what) and len(stated) <= 4:
        things = [f"{t.category} {place(t)}" for t, _ in stated]
        which = "the" if len(set(things)) == len(things) else "one"
        return reply(english.listing([f"{which} {thing} is {verb}{v}" for thing, (_, v) in zip(things, stated, strict=True)]))
    return reply(
        f"{len(stated)} {noun(view, question.what, many=True)}: "
        + english.listing([f"{n} {verb}{v}" for v, n in distinct.most_common()])
    )


def value_of(thing: Thing, attribute: Sequence[str]) -> str | None:
    """Return the value of an attribute in words; None if the scene does not state it."""
    if attribute[-1] in COLOUR_KEYS:
        colour = colour_of(thing)
        return colour if colour or "person" not in thing.concepts else _clothes(thing)
    if _is_clothes(attribute):
        return _clothes(thing)
    requested = {canonical(english.singular(x)) for x in attribute}
    synonyms = {x for group in _KEY_SYNONYMS.values() if group & set(attribute) for x in group}
    for key, value in facts(thing):
        keys = {canonical(english.singular(x)) for x in key_words(key)}
        if requested <= keys or keys & synonyms or keys <= requested:
            return _value(key, value)
    if set(attribute) & _ACTIVITY_WORDS and (pose := pose_of(thing)) is not None:
        return pose
    if set(attribute) & _ACTIVITY_WORDS:
        states = fact_words(thing) & {"moving", "stationary", "walking", "working", "upright", "sitting"}
        return min(states, default=None)
    if set(attribute) & _KEY_SYNONYMS["state"]:
        polar = [f for f in sorted(fact_words(thing)) if any(opposite(f, x) for x in _POLAR)]
        return polar[0] if polar else None
    return None


_VERBS = {
    "wearing clothes clothing outfit": "wearing ", "carrying load cargo holding": "carrying ", "made material": "made of ",
    "direction pointing facing heading way": "facing ", "lane": "in ", "carriageway": "on the ",
}  # fmt: skip
"""The words between "is" and the value of an attribute, by the words that ask for the attribute."""
# Activities as scenes state them, with the words for answers.
_GERUNDS = {
    "stand": "standing", "walk": "walking", "kneel": "kneeling", "shovel": "shovelling", "carry": "carrying something",
    "point": "pointing", "phone": "talking on the phone", "clipboard": "holding a clipboard", "sit": "sitting", "run": "running",
    "work": "working", "wave": "waving", "dig": "digging", "drive": "driving",
}  # fmt: skip


def pose_of(thing: Thing) -> str | None:
    """Return the activity of a person or machine that the scene states; None if it states none."""
    for key in ("activity", "action", "doing", "task", "pose", "state"):
        if isinstance(value := thing.attributes.get(key), str):
            return _GERUNDS.get(value, value)
    return None


_POLAR = ("open", "closed", "lit", "unlit", "raised", "lowered", "empty", "full", "moving", "stationary")
"""States with an opposite, which answer a question about the state of a thing."""


def _value(key: str, value: object) -> str:
    if key == "lane":
        return f"lane {value}" if isinstance(value, int) else f"the {value}"
    if isinstance(value, bool):
        return " ".join(key_words(key)) if value else f"not {' '.join(key_words(key))}"
    return str(value)


def _is_clothes(attribute: Sequence[str]) -> bool:
    return attribute[-1] in {"wearing", "clothes", "clothing", "outfit"}


def _clothes(thing: Thing) -> str | None:
    """Describe the clothing of a person: "an orange vest and a white helmet"."""
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
    """Answer about a part that the scene states as a fact about its owner ("the worker's helmet colour")."""
    if question.what is None:
        return None
    matches = part_values(view, question.what)
    if not matches:
        return None
    part = english.singular(question.what.phrases[0].words[-1])
    if len({v for _, v in matches}) == 1:
        return reply(f"the {part} is {matches[0][1]}" if len(matches) == 1 else f"all {len(matches)} are {matches[0][1]}")
    return reply(english.listing([f"the {part} of the {t.category} {place(t)} is {v}" for t, v in matches]))


def part_values(view: View, what: tree.Description) -> list[tuple[Thing, str]]:
    """Return owners and values of a part that is stated as a fact about its owner: "helmet of the worker", "cabin door"."""
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
        if part in requested and isinstance(value, str) and value.lower() not in ABSENT_VALUES:
            return value
    return None


def fact_in_view(view: View, attribute: Sequence[str]) -> TruthAnswer:
    """Answer with a fact about a thing in view ("which lane is closed?"), or the text on a sign ("what is the speed limit?")."""
    if tuple(attribute) == ("thing",) or set(attribute) & UNSEEN:
        return unknown("I cannot tell that from the picture")
    stated = [(t, v) for t in view.things for v in [value_of(t, attribute)] if v is not None and _states(t, attribute)]
    if stated:
        values = list(dict.fromkeys(v for _, v in stated))
        return reply(f"the {' '.join(attribute)} is {english.listing(values)}")
    signs = find(view, tree.Description((tree.Phrase(tuple(attribute)),)))
    if "limit" in attribute:
        signs = [t for t in (signs or view.for_reading().things) if any(x.strip().isdigit() for x in t.texts)] or signs
    return fact_on_signs(view, signs, " ".join(attribute)) or unknown(
        f"I cannot tell: nothing in view says the {' '.join(attribute)}"
    )


def _states(thing: Thing, attribute: Sequence[str]) -> bool:
    """Return whether one fact of the thing contains every word of the attribute."""
    requested = {canonical(english.singular(x)) for x in attribute}
    return any(requested <= {canonical(english.singular(x)) for x in (*key_words(k), *value_words(v))} for k, v in facts(thing))


def absent(view: View, subject: tree.Description) -> TruthAnswer:
    """Answer a question about something that is not in view."""
    if any(p.words and p.words[-1] in UNSEEN for p in subject.phrases):
        return unknown("I cannot tell that from the picture")
    if background := unmodelled_background(view, subject):
        return unknown(f"I cannot tell: the scene says nothing about the {background}")
    return reply(none_of(view, subject))
