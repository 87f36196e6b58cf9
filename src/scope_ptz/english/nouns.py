"""Singular and plural forms of nouns, and their articles."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

SINGULARS: Mapping[str, str] = MappingProxyType({
    "people": "person", "persons": "person", "men": "man", "women": "woman", "children": "child", "feet": "foot", "mice": "mouse",
    "geese": "goose", "teeth": "tooth", "lorries": "lorry", "buses": "bus", "busses": "bus", "leaves": "leaf", "shelves": "shelf",
    "knives": "knife", "policemen": "policeman", "policewomen": "policewoman", "workmen": "workman", "firemen": "fireman",
    "foremen": "foreman", "passers-by": "passer-by", "passersby": "passerby", "axes": "axe", "taxis": "taxi", "oxen": "ox",
    "wolves": "wolf", "loaves": "loaf", "halves": "half", "roofs": "roof", "banksmen": "banksman", "ponies": "pony",
})  # fmt: skip
"""The singular forms of irregular plurals."""

_NEVER_GENERATED = frozenset({"persons", "busses"})  # plurals that are recognised but never generated

PLURALS: Mapping[str, str] = MappingProxyType({one: many for many, one in SINGULARS.items() if many not in _NEVER_GENERATED})
"""The plural forms of nouns with an irregular plural."""

UNCOUNTABLE = frozenset({
    "smoke", "steam", "water", "litter", "rubbish", "trash", "garbage", "graffiti", "snow", "ice", "debris", "traffic",
    "damage", "dust", "fog", "mist", "mud", "oil", "foam", "sand", "gravel", "hay", "straw", "grass", "luggage", "equipment",
    "machinery", "furniture", "scaffolding", "fencing", "movement", "activity", "vandalism", "flooding", "cargo", "freight",
    "timber", "livestock", "wildlife",
})  # fmt: skip
"""Nouns for what is not counted: "some smoke", not "1 smoke"."""

_INVARIANT = frozenset({
    "bus", "grass", "gas", "glass", "press", "sheep", "deer", "series", "traffic", "vms", "this", "is", "its", "was", "has", "does",
    "chassis", "cctv", "fencing", "scaffolding", "yes", "lens", "cross", "bass", "pass", "less", "across", "cattle", "machinery",
    "equipment", "luggage", "furniture", "compass", "canvas", "campus", "bypass", "aircraft", "various", "as", "us", "hi-vis",
    "ppe",
})  # fmt: skip
"""Singular words that end in "s", and words without a plural form."""

_REGULAR_PLURAL = frozenset({"bus", "glass", "cross"})  # words of _INVARIANT whose plural is formed regularly
_PREPOSITIONS = frozenset({"with", "of", "on", "in", "at", "for", "by", "from", "near", "carrying"})


def singular(word: str) -> str:
    """Return the singular of a noun; a word that is not a plural is returned unchanged."""
    if word in SINGULARS:
        return SINGULARS[word]
    if word in _INVARIANT or len(word) < 3 or not word.endswith("s") or word.endswith(("ss", "us", "is")):
        return word
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "xes", "sses", "zes")):
        return word[:-2]
    return word[:-1]


def is_plural(word: str) -> bool:
    """Return whether a noun is a plural."""
    return singular(word) != word


def plural(phrase: str) -> str:
    """Return the plural of a noun phrase, in which only the head noun is inflected."""
    words = phrase.split()
    head = _head_index(words)
    words[head] = plural_noun(words[head])
    return " ".join(words)


def _head_index(words: list[str]) -> int:
    """Return the index of the head noun: the word before the first preposition, otherwise the last word."""
    return next((i for i, word in enumerate(words) if word in _PREPOSITIONS and i > 0), len(words)) - 1


def plural_noun(word: str) -> str:
    """Return the plural of a single noun; a plural is returned unchanged."""
    if word in PLURALS:
        return PLURALS[word]
    if singular(word) != word or (word in _INVARIANT and word not in _REGULAR_PLURAL):
        return word
    if word.endswith("y") and word[-2:-1] not in {"a", "e", "i", "o", "u"}:
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "ch", "sh", "z")) else "s")


def article(phrase: str) -> str:
    """Return the phrase with "a" or "an" before it. A plural phrase, and one with a number at its end, is returned unchanged."""
    words = phrase.split()
    if (len(words) > 1 and words[-1].isdigit()) or is_plural(words[_head_index(words)]):
        return phrase
    vowel = phrase[0].lower() in "aeio" or (phrase[0].lower() == "u" and not phrase.lower().startswith(("uni", "use")))
    return f"{'an' if vowel else 'a'} {phrase}"


def counted(count: int, noun: str) -> str:
    """Return a count with the noun in the singular or plural: "1 car", "2 cars"."""
    return f"{count} {noun if count == 1 else plural(noun)}"
