"""Test whether words, clothes and texts match a thing. A test returns None if the scene does not state the answer."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import lru_cache

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in, singular_phrase
from scope_ptz.perception.ground_truth.view import Thing, View, head_of, trades_of
from scope_ptz.perception.ground_truth.vocabulary import FILLER_WORDS, are_opposites, canonical_form, opposites_of
from scope_ptz.simulator.models import Attribute

TEXT_KEYS = frozenset(["reads", "text", "plate", "lettering", "number", "signal", "sign", "label", "readable_by", "inscription"])
"""Attributes that repeat the text on a thing. They are not used, because only legible text may be reported."""
_LETTERING_KEYS = TEXT_KEYS - {"number", "signal", "sign", "readable_by"}
"""Those that say that something is written on the thing itself. A number or a signal may be on a part, such as a plate."""
_ROLE_KEYS = frozenset({"role", "stall", "area", "facing"})
"""Attributes that say who somebody is or where, and not what they have."""
CLOTHING_KEYS = frozenset({"wearing", "clothing", "clothes", "outfit", "ppe"})
"""Attributes that say what somebody wears."""
COLOUR_KEYS = ("colour", "color")
ABSENT_VALUES = frozenset({"", "none", "no", "false", "nothing", "without"})
"""Lower-case attribute values of things that lack the attribute."""


def key_words(key: str) -> list[str]:
    """Return the words of an attribute key such as "helmet_colour"."""
    return english.letters(key.replace("_", " ").replace("-", " ")).split()


def value_words(value: object) -> list[str]:
    """Return the canonical words of an attribute value."""
    return [canonical_form(x) for x in english.letters(str(value)).split()]


_BOOM_STATES = {"raised": "open", "lowered": "closed"}
"""What the position of a barrier arm means for those who want to pass."""


def fact_words(thing: Thing) -> set[str]:
    """Return the words that describe a thing: its name, attribute values, true flags and motion, but not people's clothes."""
    result = {canonical_form(x) for x in english.letters(f"{thing.name} {thing.category}").split()}
    for key, value in facts(thing):
        words = key_words(key)
        if value is True:
            result |= {canonical_form(x) for x in words}
            result |= {"on"} if "lit" in words else set()
        elif value is False:
            result |= opposites_of({canonical_form(x) for x in words})
        elif not (is_colour(value) and words[-1] not in COLOUR_KEYS and any(k in thing.attributes for k in COLOUR_KEYS)) and not (
            is_worn(key) and "person" in thing.concepts
        ):
            result |= set(value_words(value))
        if words[-1] in {"load", "cargo"} and str(value).lower() not in ABSENT_VALUES:
            result.add("full")
    if "boom gate" in thing.concepts:
        result |= {_BOOM_STATES[x] for x in result & _BOOM_STATES.keys()}
    if "lit" in result:
        result.add("on")
    if "unlit" in result:
        result.add("off")
    if thing.motion and not result & {"moving", "stationary"}:
        result.add(thing.motion)
    return result


def facts(thing: Thing) -> list[tuple[str, Attribute]]:
    """Return the attributes that may be reported: all but the texts on the thing."""
    return [(k, v) for k, v in thing.attributes.items() if k not in TEXT_KEYS]


def bears_text(thing: Thing) -> bool:
    """Return whether the scene states that something is written on a thing, wherever on it and whether or not it can be read."""
    keys = _LETTERING_KEYS | {"number"} if thing.concepts & {"vehicle", "machine"} else _LETTERING_KEYS
    return any(str(thing.attributes.get(key, "")).lower() not in ABSENT_VALUES for key in keys)


def is_colour(value: object) -> bool:
    """Return whether an attribute value is a colour."""
    words = english.letters(str(value)).split()
    return bool(words) and words[-1] in english.COLOURS


def is_worn(key: str) -> bool:
    """Return whether an attribute is about clothes. A colour in it is that of the clothes, not that of the person."""
    return any(map(names_clothes, key_words(key)))


_CLOTHES = frozenset({"hard hat", "hi-vis vest", "jacket", "trouser", "boot", "glove", "hat"})


def is_garment(key: str) -> bool:
    """Return whether an attribute is about clothes that give a person their colour: "in yellow" is not about a yellow helmet."""
    return any(lexicon().concept(word) in _GARMENTS for word in key_words(key))


_GARMENTS = _CLOTHES - {"hard hat", "hat", "boot", "glove"}


def names_clothes(word: str) -> bool:
    """Return whether a word names a piece of clothing."""
    return lexicon().concept(word) in _CLOTHES


def colour_of(thing: Thing) -> str | None:
    """Return the stated colour; None if the scene states none."""
    for key in COLOUR_KEYS:
        if key in thing.attributes:
            return str(thing.attributes[key])
    if "person" in thing.concepts:
        return None
    for key, value in thing.attributes.items():
        if is_colour(value) and not is_worn(key):
            return str(value)
    named = [x for x in english.letters(thing.name).split() if x in english.COLOURS]
    return named[0] if named else None


DRIVING = "driving"
"""What the people do whom a scene models in a vehicle, and the key of the fact that says so. For things, the word means moving."""

SEXES = {"man": "male", "gentleman": "male", "guy": "male", "woman": "female", "lady": "female"}
"""The sex that a noun for a person states."""


def stated_sex(thing: Thing) -> str | None:
    """Return "male" or "female" if the name of a person states it; None if it does not."""
    return next((SEXES[word] for word in english.letters(thing.name).split() if word in SEXES), None)


def sex_fits(thing: Thing, noun: str) -> bool | None:
    """Return whether a person has the sex that a noun such as "women" states; None if the scene does not state their sex."""
    sex = stated_sex(thing)
    return None if sex is None else sex == SEXES[singular_phrase(noun)]


def is_sexed(words: Sequence[str]) -> bool:
    """Return whether words are a noun that states a person's sex, and nothing else: "a woman", "men"."""
    nouns = [x for x in words if x not in FILLER_WORDS]
    return len(nouns) == 1 and singular_phrase(nouns[0]) in SEXES


def fits_noun(view: View, thing: Thing, noun: str) -> bool:
    """Return whether a noun (singular or plural) is a name for the thing.

    If the scene itself uses a word, such as "pylon" for an electricity pylon, other meanings of the word do not count.
    """
    singular = english.letters(singular_phrase(noun))
    if singular in SEXES and "person" in thing.concepts:
        sex = stated_sex(thing)
        # One person of unknown sex may be called a man or a woman, but must not be counted among "the men".
        return sex == SEXES[singular] if sex is not None else not english.is_plural(noun)
    name, category = english.letters(head_of(thing.name)), english.letters(thing.category)
    if singular in (category, name) or name.endswith(f" {singular}") or singular in trades_of(thing.sighting.instance):
        return True
    concept = lexicon().concept(noun)
    return concept is not None and concept in thing.concepts and (concept == singular or singular not in view.nouns)


def fits_words(view: View, thing: Thing, words: Sequence[str]) -> bool | None:
    """Return whether words such as "parked", "dark blue" or "a van" hold for a thing; None if the scene does not state that."""
    rest = [x for x in words if x not in FILLER_WORDS] or [x for x in words if x in {"on", "in"}]
    if not rest:
        return True
    spans = nouns_in(rest, view.nouns)
    if spans and spans[0][1] == len(rest):
        answers = [
            all_true([fits_noun(view, thing, " ".join(rest[i:])), *(_word_fits(view, thing, x) for x in rest[:i])])
            for i, _ in spans
        ]
        if any(answers):
            return True
    return all_true([_word_fits(view, thing, x) for x in rest])


def all_true(answers: Iterable[bool | None]) -> bool | None:
    """Return True if all answers are True, False if any is False, and None otherwise."""
    result = list(answers)
    return False if False in result else None if None in result else True


def _word_fits(view: View, thing: Thing, word: str) -> bool | None:
    """Return whether one word holds for a thing; None if the scene does not state that."""
    if word.startswith("non-"):
        answer = _word_fits(view, thing, word.removeprefix("non-"))
        return None if answer is None else not answer
    is_person = "person" in thing.concepts
    if is_person and word == DRIVING:
        return True if DRIVING in thing.attributes else None  # nobody can see into every vehicle
    thing_words = fact_words(thing)
    canonical_word = canonical_form(word)
    if _word_forms(word) & {f for x in thing_words for f in _word_forms(x)} or fits_noun(view, thing, word):
        return True
    if lexicon().concept(word) is not None and is_person and has_item(view, thing, [word]):
        return True
    if _is_context_word(view, thing, word) or any(english.letters(word) in english.letters(text).split() for text in thing.texts):
        return True
    if any(are_opposites(canonical_word, other) for other in thing_words):
        return False
    if canonical_word in english.COLOURS and colour_of(thing) is not None:
        return False
    if canonical_word == "waiting" and is_person:
        return None  # a person who stands or sits may be waiting
    if canonical_word in {"empty", "full"} and "vehicle" in thing.concepts:
        return None  # nobody can see into a vehicle
    if any(_word_forms(word) & domain and key in thing.attributes for key, domain in view.values.items() if key not in TEXT_KEYS):
        return False
    if is_person and word.endswith("ing"):
        return None  # what people do is seldom stated, even if the word also names a thing: "crossing"
    return False if lexicon().concept(word) else None


@lru_cache(maxsize=4096)
def _word_forms(word: str) -> frozenset[str]:
    """Return a word and its other forms, so that "kneeling" matches "kneel"."""
    stems = {word, english.singular(word)}
    for ending in ("ing", "ed"):
        if word.endswith(ending) and len(word) > len(ending) + 2:
            base = word.removesuffix(ending)
            stems |= {base, f"{base}e"} | ({base[:-1]} if base[-1] == base[-2] else set())
    return frozenset(canonical_form(x) for x in stems) | {word}


def has_form_in(word: str, words: Iterable[str]) -> bool:
    """Return whether a word, or another form of it, is one of several words."""
    return any(_word_forms(word) & _word_forms(other) for other in words)


def _is_context_word(view: View, thing: Thing, word: str) -> bool:
    """Return whether the word names something that the thing is part of ("the gantry sign", "the cabin door")."""
    if word in english.COLOURS:
        return False  # a green awning on a red shop is not red
    holder = thing.parent
    while holder is not None:
        words = english.letters(view.instances[holder].name).split()
        owner = view.by_id.get(holder)
        if english.singular(word) in words or (owner is not None and fits_noun(view, owner, word)):
            return True
        holder = view.parents.get(holder)
    return False


def has_item(view: View, thing: Thing, words: Sequence[str], amount: int | None = None) -> bool:
    """Return whether a thing has a matching attribute, part, clothing or text. Anything not stated counts as absent.

    ``amount`` is the required number of items ("with two doors"); it is compared only with a number that the scene states.
    """
    rest = [x for x in words if x not in FILLER_WORDS]
    spans = nouns_in(rest, view.nouns)
    start, end = spans[0] if spans else (len(rest) - 1, len(rest))
    noun, others = " ".join(rest[start:end]), [canonical_form(x) for x in (*rest[:start], *rest[end:])]
    if lexicon().concept(noun) == "thing":  # "carrying something"
        carried = [v for k, v in facts(thing) if set(key_words(k)) & {"carrying", "load", "holding"}]
        return any(str(v).lower() not in ABSENT_VALUES and all(x in value_words(v) for x in others) for v in carried)
    is_only_colour = noun in english.COLOURS  # "in red" is about clothes, and not about an umbrella
    for key, value in facts(thing):
        is_about = (
            is_garment(key) or key in CLOTHING_KEYS if is_only_colour and "person" in thing.concepts else key not in _ROLE_KEYS
        )
        if is_about and attribute_has(key, value, names_of(noun), others, amount):
            return True
    parts = [t for t in view.things if t.id != thing.id and view.belongs(t.id, thing.id)]
    if any(fits_noun(view, part, noun) and all(_word_fits(view, part, x) for x in others) for part in parts):
        return True
    if others and "person" in thing.concepts and _has_beside(view, thing, noun, others):
        return True
    return any(contains_words(text, rest) for text in thing.texts)


def _has_beside(view: View, person: Thing, noun: str, others: Sequence[str]) -> bool:
    """Return whether a person has the item beside them: "with a purple suitcase", if the scene says "pulling a suitcase"."""
    return any(attribute_has(key, value, names_of(noun), [], None) for key, value in facts(person)) and any(
        fits_noun(view, t, noun) and person.gap_m(t) <= _WITHIN_REACH_M and all(_word_fits(view, t, x) for x in others)
        for t in view.things
    )


_WITHIN_REACH_M = 0.3  # maximum gap between a person and something that they pull or push


def contains_words(text: str, words: Sequence[str]) -> bool:
    """Return whether a text contains these whole words in this order, in upper or lower case and whatever the punctuation."""
    return f" {english.letters(' '.join(words))} " in f" {english.letters(text)} "


def attribute_has(key: str, value: Attribute, names: frozenset[str], others: Sequence[str], amount: int | None) -> bool:
    """Return whether an attribute contains one of the names, in its key or its value, together with all other words."""
    if _key_matches(key, names):
        stated = value_words(value)
        if str(value).lower() not in ABSENT_VALUES and value is not False and all(x in stated for x in others):
            return amount is None or not isinstance(value, int) or isinstance(value, bool) or value == amount
    return any(
        any(contains_words(item, [name]) for name in names)
        and all(x in value_words(item) for x in others)
        and "no" not in item.split()
        for item in _split_items(value)
    )


def _key_matches(key: str, names: frozenset[str]) -> bool:
    words = [x for x in key_words(key) if x not in COLOUR_KEYS]
    return " ".join(words) in names or (bool(words) and singular_phrase(" ".join(words)) in names)


def names_of(noun: str) -> frozenset[str]:
    """Return all nouns, in the singular, that name the same concept as a noun."""
    table = lexicon()
    concept = table.concept(noun)
    return frozenset({singular_phrase(noun)}) | (table.all_names(concept) if concept else frozenset())


_GOAL = re.compile(r"\b(?:for|to|by|at) [^,]*")
"""The goal or place of an activity, which a person does not carry: "waiting for a taxi" is no taxi."""


def _split_items(value: object) -> list[str]:
    """Split "orange vest and white helmet" into items, so that "white" applies only to the helmet. Goals are left out."""
    if not isinstance(value, str):
        return []
    text = value.lower().replace(" and ", ",").replace(" with ", ",").replace(";", ",")
    text = _GOAL.sub("", text)
    return [english.letters(" ".join([*(c.split()[:-1]), english.singular(c.split()[-1])])) for c in text.split(",") if c.strip()]


def has_text(thing: Thing, words: Sequence[str]) -> bool:
    """Return whether legible text on a thing contains these words in this order. Without words, any legible text counts."""
    return any(not words or contains_words(text, words) for text in thing.texts) or _has_plate(thing, words)


def _has_plate(thing: Thing, words: Sequence[str]) -> bool:
    """Return whether a text on the thing is this number plate. Spaces and the words "number plate" are ignored."""
    plain = "".join(x for x in words if x not in {"number", "plate", "registration", "licence", "license"})
    return len(plain) >= 4 and any(plain == english.letters(text).replace(" ", "") for text in thing.texts)
