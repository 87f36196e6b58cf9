"""Write English phrases for instructions: plurals, articles, lists, and words for object kinds, colours and amounts."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.tasks.expected import Options, Wordings
from scope_ptz.taskgen.facts.kinds import Kind

_IRREGULAR_PLURALS = {
    "person": "people", "man": "men", "woman": "women", "child": "children", "shelf": "shelves", "leaf": "leaves", "mouse": "mice",
    "goose": "geese", "sheep": "sheep", "deer": "deer", "banksman": "banksmen", "aircraft": "aircraft", "knife": "knives",
    "loaf": "loaves",
}  # fmt: skip
UNCOUNTABLE_CATEGORIES = frozenset({
    "tree", "bush", "hedge", "building", "house", "pylon", "guardrail", "bridge", "hill", "road", "pavement", "surface", "fence",
    "fence panel", "wall", "sky", "field", "grass", "plant", "shrub", "kerb", "roof", "platform", "track", "shopfront", "window",
    "railing", "bunting", "cable", "puddle", "produce", "goods", "scaffolding", "gravel pile", "sand pile", "ground", "marker post",
    "warehouse", "church", "station", "flower bed", "box of fruit", "crate", "pipe stack", "terrace", "townhouse", "yew",
    "door", "price card", "drain", "cup", "shop", "tree grate", "plinth", "tram platform", "notice", "poster", "chimney", "gutter",
    "weighbridge", "rail", "line", "marking", "kerbstone", "steps", "stairs", "parapet", "box", "bag", "shelf", "sill", "river",
    "bay number", "hatched zone", "road marking", "dock leveller", "dock shelter", "silo", "dock number", "kerb ramp", "canopy",
    "pedestrian", "door sign", "window notice", "wall sign", "loaf", "ham", "cake", "book", "bottle", "teapot", "table lamp",
    "lane signal", "wheel stop", "wheel guide", "walkway", "cycle shelter", "clock tower", "sign", "gantry", "parking space",
})  # fmt: skip
"""Categories that people count inconsistently, because the objects are not clearly separate or extend into the distance."""

_COLOUR_SYNONYMS: dict[str, Wordings] = {
    "white": ("off-white",), "black": (), "grey": ("gray", "silver", "dark grey", "light grey"),
    "red": ("dark red", "maroon", "crimson"),
    "blue": ("dark blue", "light blue", "navy", "sky blue", "navy blue"), "green": ("dark green", "light green", "lime"),
    "yellow": ("gold",), "orange": ("amber",), "brown": ("dark brown", "light brown"), "purple": ("violet",), "pink": (),
}  # fmt: skip
"""Plain colours, with synonyms for each."""

_PLAIN_COLOURS = {name: plain for plain, others in _COLOUR_SYNONYMS.items() for name in (plain, *others)}


def pluralise(noun: str) -> str:
    """Return the plural of a noun phrase. The inflected word is the last one, or the one before a preposition such as "of"."""
    words = noun.split()
    head = next((i for i, word in enumerate(words) if i and word in {"of", "with", "in", "on", "for", "carrying"}), len(words)) - 1
    words[head] = _pluralise_word(words[head])
    return " ".join(words)


def _pluralise_word(word: str) -> str:
    if word in _IRREGULAR_PLURALS:
        return _IRREGULAR_PLURALS[word]
    if word.endswith("man") and word not in {"human"}:
        return word[:-3] + "men"
    if word.endswith("y") and word[-2:-1] not in "aeiou":
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "ch", "sh")) else "s")


def with_article(noun: str) -> str:
    """Return a noun phrase with "a" or "an" before it."""
    first = noun.lower()
    vowel = first[0] in "aeio" or (first[0] == "u" and not first.startswith(("uni", "use", "uti")))
    return f"{'an' if vowel or noun.startswith(_VOWEL_SOUNDS) else 'a'} {noun}"


_VOWEL_SOUNDS = ("SUV", "8", "11 ", "18 ")
"""Beginnings of noun phrases that take "an" although they are not spelt with a lower-case vowel."""


def with_the(name: str) -> str:
    """Return a name with "the" before it. Names that end in a number ("dock door 5") get no article."""
    return name if re.search(r"\d$", name) else f"the {name.removeprefix('The ')}"


def join_names(names: Sequence[str], conjunction: str = "and") -> str:
    """Join names with commas, and the last two with a conjunction."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {conjunction} {names[-1]}"


def everyday_name(category: str) -> str:
    """Return the everyday name of a category, usually the category itself."""
    return _EVERYDAY_NAMES.get(category, category)


_EVERYDAY_NAMES = {
    "cross": "pharmacy cross", "roller": "road roller", "suv": "SUV", "tv": "TV", "cctv camera": "CCTV camera",
    "a-board": "A-board", "belisha beacon": "Belisha beacon", "tyre stack": "stack of tyres", "pipe stack": "stack of pipes",
    "pallet stack": "stack of pallets", "gravel pile": "pile of gravel", "sand pile": "pile of sand",
}  # fmt: skip


def singular_noun(kind: Kind) -> str:
    """Return the noun phrase for one object of a kind, with its attributes in their usual order."""
    noun = everyday_name(kind.category)
    if kind.attribute is not None:
        key, value = kind.attribute
        key = "posture" if kind.category == "person" and key == "state" else key
        return _ATTRIBUTE_PHRASES.get(key, ("{value} {noun}", ""))[0].format(value=value, noun=noun, a=with_article(value))
    return f"{kind.colour} {noun}" if kind.colour else noun


def plural_noun(kind: Kind) -> str:
    """Return the noun phrase for several objects of a kind."""
    key = kind.attribute[0] if kind.attribute is not None else ""
    key = "posture" if kind.category == "person" and key == "state" else key
    if kind.attribute is not None and key in _ATTRIBUTE_PHRASES:
        return _ATTRIBUTE_PHRASES[key][1].format(value=kind.attribute[1], many=pluralise(everyday_name(kind.category)))
    return pluralise(singular_noun(kind))


_ATTRIBUTE_PHRASES = {
    "vest": ("{noun} in {a} vest", "{many} in {value} vests"),
    "helmet": ("{noun} in {a} helmet", "{many} in {value} helmets"),
    "posture": ("{noun} who is {value}", "{many} who are {value}"),
    "light": ("{noun} with its roof sign {value}", "{many} with their roof signs {value}"),
}


def answer_words(kind: Kind) -> Wordings:
    """Return the words that an answer may use for the counted objects: the whole name, the category, and its last word."""
    return tuple(dict.fromkeys((singular_noun(kind), everyday_name(kind.category), kind.category, kind.category.split()[-1])))


def object_words(*kinds: Kind) -> Wordings:
    """Return words for objects of these kinds. A perception call about such objects mentions at least one of the words."""
    words = (
        word for kind in kinds for word in (kind.category, kind.category.split()[-1], *_CATEGORY_SYNONYMS.get(kind.category, ()))
    )
    return tuple(dict.fromkeys(words))


_CATEGORY_SYNONYMS = {"person": ("anyone", "people"), "lorry": ("truck",)}


def plain_colour(colour: object) -> str | None:
    """Return the plain colour for a colour attribute; None if people would disagree about it."""
    return _PLAIN_COLOURS.get(str(colour))


def all_wordings(options: Options) -> Wordings:
    """Return all wordings of all options."""
    return tuple(word for name, others in options.items() for word in (name, *others))


def colour_options() -> Options:
    """Return the plain colours as answer options."""
    return dict(_COLOUR_SYNONYMS)


def angle_words(number: float) -> str:
    """Return an angle in words."""
    return f"{number:g} degrees" if number != 1 else "1 degree"


def factor_words(factor: float) -> str:
    """Return a magnification in words: "twice", "three times", "1.5 times"."""
    return {2.0: "twice", 3.0: "three times", 4.0: "four times"}.get(factor, f"{factor:g} times")


def capitalise(text: str) -> str:
    """Return the text with its first letter capitalised."""
    return text[:1].upper() + text[1:]
