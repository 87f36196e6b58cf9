"""Answer questions about colours, states, clothes and other facts about things."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import nouns_in, singular_phrase
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.answers.clock_times import answer_clock_time
from scope_ptz.perception.ground_truth.answers.legible_text import answer_from_signs
from scope_ptz.perception.ground_truth.answers.restating import (
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
from scope_ptz.perception.ground_truth.answers.unclear import answer_unclear
from scope_ptz.perception.ground_truth.thing_facts import (
    ABSENT_VALUES,
    COLOUR_KEYS,
    colour_of,
    fact_words,
    facts,
    is_colour,
    is_worn,
    key_words,
    names_of,
    value_words,
)
from scope_ptz.perception.ground_truth.thing_search import find, find_excluding_wearers
from scope_ptz.perception.ground_truth.view import Thing, View
from scope_ptz.perception.ground_truth.vocabulary import are_opposites, canonical_form

UNANSWERABLE_SUBJECTS = frozenset(
    "it time day weather date temperature mood today season month year hour brand owner price name age".split()  # noqa: SIM905
)
"""Subjects about which a picture contains no information."""
WRITTEN_FACTS = frozenset({"limit", "hours"})
"""Facts that are written on signs, and whose names also mean the signs: "the speed limit", "the opening hours"."""
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
    is_clock_time = question.attribute == ("time",) and question.what == tree.Description((tree.Phrase(("it",)),))
    if question.what is None or is_clock_time:
        return answer_fact_in_view(view, question.attribute)
    matches = find(view, question.what)
    if not matches:
        return _answer_about_part(view, question) or _answer_about_unmodelled(view, question) or answer_absent(view, question.what)
    if question.attribute[-1] in COLOUR_KEYS and (answer := _answer_about_worn(view, question.what, matches)) is not None:
        return answer
    values = [(t, value_of(t, question.attribute)) for t in matches]
    stated = [(t, v) for t, v in values if v is not None]
    if not stated:
        attribute, subject = " ".join(question.attribute), definite_as_asked(view, question.what)
        verb = is_or_are(2 if is_plural(question.what) else 1)
        is_predicate = attribute.endswith("ing") or attribute == "for"
        missing = f"what {subject} {verb} {attribute}" if is_predicate else f"the {attribute} of {subject}"
        if question.attribute == ("sells",):
            missing = f"what {subject} {'sell' if is_plural(question.what) else 'sells'}"
        return unknown_answer(f"I cannot tell {missing}")
    prefix = next((v for words, v in _VALUE_PREFIXES.items() if set(words.split()) & set(question.attribute)), "")
    if prefix == "facing " and all("direction" in t.attributes for t, _ in stated):
        prefix = "pointing "
    if question.attribute[-1] in COLOUR_KEYS and is_person(question.what.phrases[0].words):
        prefix = "wearing "  # the scene states the colours of people's clothes
    distinct = Counter(v for _, v in stated)
    if question.attribute == ("sells",):
        return _goods_sentence(view, question.what, distinct)
    if len(distinct) == 1 and len(stated) < len(matches):
        kind = noun_phrase(view, question.what, plural=True)
        return known_answer(f"{len(stated)} of the {len(matches)} {kind} {is_or_are(len(stated))} {prefix}{stated[0][1]}")
    is_named = set(stated[0][1].split()) <= set(question.what.phrases[0].words)
    if len(distinct) == 1 and question.attribute[-1] in COLOUR_KEYS and is_named:
        return _where_named_by_colour(view, question.what, matches)
    if len(distinct) == 1:
        subject = definite_phrase(view, question.what, plural=len(stated) > 1)
        return known_answer(f"{subject} {is_or_are(len(stated))} {prefix}{stated[0][1]}")
    if not is_plural(question.what) and len(stated) <= 4:
        things = [f"{t.category} {position_words(t)}" for t, _ in stated]
        determiner = "the" if len(set(things)) == len(things) else "one"
        return known_answer(
            english.listing([f"{determiner} {thing} is {prefix}{v}" for thing, (_, v) in zip(things, stated, strict=True)])
        )
    total, kind = len(matches), noun_phrase(view, question.what, plural=True)
    shares = english.listing([f"{n} {is_or_are(n)} {prefix}{v}" for v, n in distinct.most_common()])
    others = total - len(stated)
    rest = f"; I cannot tell for the other {'one' if others == 1 else others}" if others else ""
    return known_answer(f"of the {total} {kind}, {shares}{rest}")


def _where_named_by_colour(view: View, what: tree.Description, matches: Sequence[Thing]) -> TruthAnswer:
    """Say how many things there are and where, for "what colour is the red car?", which states its own answer."""
    kind = noun_phrase(view, what, plural=len(matches) > 1)
    places = english.listing(list(dict.fromkeys(position_words(thing) for thing in matches)))
    return known_answer(f"there {is_or_are(len(matches))} {len(matches)} {kind} in view, {places}")


def _goods_sentence(view: View, what: tree.Description, goods: Counter[str]) -> TruthAnswer:
    """State what is sold: "the purple stall sells flowers", "2 stalls sell fruit and 1 sells fish"."""
    if len(goods) == 1:
        plural = goods.total() > 1
        return known_answer(f"{definite_phrase(view, what, plural)} {'sell' if plural else 'sells'} {next(iter(goods))}")
    (first, number), *rest = goods.most_common()
    others = [f"{n} {'sells' if n == 1 else 'sell'} {sold}" for sold, n in rest]
    kind = noun_phrase(view, what, plural=number != 1)
    return known_answer(english.listing([f"{number} {kind} {'sells' if number == 1 else 'sell'} {first}", *others]))


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
    "dock platform": "at ", "bay space": "in ",
}  # fmt: skip
"""The words between "is" and the value of an attribute, by the words that ask for the attribute."""
# Activities in scene files, and the words for them in answers.
_ACTIVITY_PHRASES = {
    "stand": "standing", "walk": "walking", "kneel": "kneeling", "shovel": "shovelling", "carry": "carrying something",
    "point": "pointing", "phone": "talking on the phone", "clipboard": "holding a clipboard", "sit": "sitting", "run": "running",
    "sweep": "sweeping", "work": "working", "wave": "waving", "dig": "digging", "drive": "driving",
}  # fmt: skip


def activity_of(thing: Thing) -> str | None:
    """Return the stated activity of a person or machine; None if the scene states none."""
    for key in ("activity", "action", "doing", "task", "pose", "state"):
        if isinstance(value := thing.attributes.get(key), str):
            return _ACTIVITY_PHRASES.get(value, value)
    return None


_STATES_WITH_OPPOSITE = ("open", "closed", "lit", "unlit", "raised", "lowered", "empty", "full", "moving", "stationary")
"""States that have an opposite. They answer questions about a thing's state."""


_NUMBERED_PLACES = frozenset({"dock", "bay", "platform"})


def _value_words(key: str, value: object) -> str:
    if key == "carrying" and str(value) not in ABSENT_VALUES:
        return english.article(str(value))
    if key == "lane":
        return f"lane {value}" if isinstance(value, int) else f"the {value}"
    if key in _NUMBERED_PLACES:
        return f"{key} {value}"
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
    if question.what is None or not (set(question.attribute) & _FACTS_OF_PARTS):
        return None
    matches = part_values(view, question.what)
    if question.attribute[-1] in COLOUR_KEYS:
        matches = [(t, value) for t, value in matches if is_colour(value)]
    return _part_sentence(english.singular(question.what.phrases[0].words[-1]), matches) if matches else None


def _answer_about_unmodelled(view: View, question: tree.Ask) -> TruthAnswer | None:
    """Answer that one fact about a part is unknown, of which others may be stated: "the colour of the load of the forklift"."""
    if question.what is None or not is_unmodelled_part(view, question.what) or _missing_owner(view, question.what) is not None:
        return None
    return unknown_answer(f"I cannot tell the {' '.join(question.attribute)} of {definite_as_asked(view, question.what)}")


_FACTS_OF_PARTS = {*COLOUR_KEYS, *_KEY_SYNONYMS["state"], *_KEY_SYNONYMS["material"]}
"""What the scene states about a part as a fact about its owner: the value of "helmet" is a colour, that of "door" a state."""


def _answer_about_worn(view: View, what: tree.Description, wearers: Sequence[Thing]) -> TruthAnswer | None:
    """Answer what colour clothes are ("the helmets"), which are facts about their wearers; None if the things are no clothes."""
    if find_excluding_wearers(view, what):
        return None
    words = what.phrases[0].words
    matches = [(t, value) for t in wearers for value in [_part_value(t, words[-1:])] if value is not None]
    return _part_sentence(english.singular(words[-1]), matches) if matches else None


def _part_sentence(part: str, matches: Sequence[tuple[Thing, str]]) -> TruthAnswer:
    """State the value of a part for each of its owners: "the helmet is white", "5 helmets: 3 white and 2 blue"."""
    values = Counter(value for _, value in matches)
    if len(matches) == 1:
        return known_answer(f"the {part} is {matches[0][1]}")
    if len(values) == 1:
        return known_answer(f"{'both' if len(matches) == 2 else f'all {len(matches)}'} {english.plural(part)} are {matches[0][1]}")
    if len(matches) > _MAX_OWNERS:
        shares = english.listing([f"{n} {is_or_are(n)} {v}" for v, n in values.most_common()])
        return known_answer(f"of the {len(matches)} {english.plural(part)}, {shares}")
    return known_answer(english.listing(_values_by_owner(part, matches)))


def _values_by_owner(part: str, matches: Sequence[tuple[Thing, str]]) -> list[str]:
    """Return the value of each owner's part. Owners that only their position would tell apart, and does not, share a statement."""
    owners: dict[tuple[str, str], list[str]] = {}
    for thing, value in matches:
        owners.setdefault((thing.category, position_words(thing)), []).append(value)
    statements = []
    for (category, position), stated in owners.items():
        if len(stated) == 1:
            statements.append(f"the {part} of the {category} {position} is {stated[0]}")
        elif len(set(stated)) == 1:
            statements.append(
                f"the {english.plural(part)} of the {len(stated)} {english.plural(category)} {position} are {stated[0]}"
            )
        else:
            parts = f"the {english.plural(part)} of the {len(stated)} {english.plural(category)} {position}"
            statements.append(f"{parts} are {english.listing(stated)}")
    return statements


_MAX_OWNERS = 4
"""Maximum number of parts to describe individually."""


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
        if part in requested and isinstance(value, str) and value.lower() not in {*ABSENT_VALUES, "yes"} and not value.isdigit():
            return value
    return None


def answer_fact_in_view(view: View, attribute: Sequence[str]) -> TruthAnswer:
    """Answer with a fact about a thing in view ("which lane is closed?"), or the text on a sign ("what is the speed limit?")."""
    if tuple(attribute) == ("time",) and (clocks := [t for t in view.things if "clock" in t.concepts]):
        return answer_clock_time(clocks)
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
        return unknown_answer(f"I cannot tell anything about the {background}")
    if (owner := _missing_owner(view, subject)) is not None:
        return known_answer(none_in_view(view, owner))
    if is_unmodelled_part(view, subject):
        return unknown_answer(f"I cannot tell anything about {definite_as_asked(view, subject)}")
    if (unclear := answer_unclear(view, subject)) is not None:
        return unclear
    return known_answer(none_in_view(view, subject))


_OCCUPANTS = frozenset({("driver",), ("passenger",)})
"""The owners of doors and seats of vehicles: "the driver's door"."""


def _missing_owner(view: View, subject: tree.Description) -> tree.Description | None:
    """Return the description of the owner in "the forklift driver's helmet" if the owner is not in view; otherwise None."""
    owners = [t.other for t in subject.phrases[0].tests if isinstance(t, tree.Relation) and t.kind == "on" and not t.preposition]
    return next((o for o in owners if not find(view, o) and o.phrases[0].words not in _OCCUPANTS), None)


def is_unmodelled_part(view: View, subject: tree.Description) -> bool:
    """Return whether a description names a part that no fact states, of a thing in view: "the cabin door", "the driver's door"."""
    phrase = subject.phrases[0]
    owners = [t.other for t in phrase.tests if isinstance(t, tree.Relation) and t.kind == "on" and t.preposition in {"", "of"}]
    if owners:
        return bool(find(view, owners[0])) or owners[0].phrases[0].words in _OCCUPANTS
    head = phrase.words[:-1]
    return bool(head) and bool(nouns_in(head, view.nouns)) and bool(find(view, tree.Description((tree.Phrase(head),))))
