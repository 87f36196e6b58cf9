"""English for instructions: nouns in number, articles, numbers, and how values are called."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.tasks.expected import Options, Wordings
from scope_ptz.taskgen.facts.kinds import Kind

_IRREGULAR = {
    "person": "people", "man": "men", "woman": "women", "child": "children", "shelf": "shelves", "leaf": "leaves", "mouse": "mice",
    "goose": "geese", "sheep": "sheep", "deer": "deer", "banksman": "banksmen", "aircraft": "aircraft", "knife": "knives",
    "loaf": "loaves",
}  # fmt: skip
UNCOUNTED = frozenset({
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
"""What people do not count alike: where one ends and the next begins, or which of many far ones still counts, is anyone's guess."""

_FAMILIES: dict[str, Wordings] = {
    "white": ("off-white",), "black": (), "grey": ("gray", "silver", "dark grey", "light grey"),
    "red": ("dark red", "maroon", "crimson"),
    "blue": ("dark blue", "light blue", "navy", "sky blue", "navy blue"), "green": ("dark green", "light green", "lime"),
    "yellow": ("gold",), "orange": ("amber",), "brown": ("dark brown", "light brown"), "purple": ("violet",), "pink": (),
}  # fmt: skip
"""Plain colours and what else they are called."""

_FAMILY = {name: plain for plain, others in _FAMILIES.items() for name in (plain, *others)}


def plural(noun: str) -> str:
    """The plural of a noun phrase whose last word, or the one before "of", "with" ..., is its noun."""
    words = noun.split()
    head = next((i for i, word in enumerate(words) if i and word in {"of", "with", "in", "on", "for", "carrying"}), len(words)) - 1
    words[head] = _plural(words[head])
    return " ".join(words)


def _plural(word: str) -> str:
    if word in _IRREGULAR:
        return _IRREGULAR[word]
    if word.endswith("man") and word not in {"human"}:
        return word[:-3] + "men"
    if word.endswith("y") and word[-2:-1] not in "aeiou":
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "ch", "sh")) else "s")


def article(noun: str) -> str:
    """The noun with "a" or "an"."""
    first = noun.lower()
    vowel = first[0] in "aeio" or (first[0] == "u" and not first.startswith(("uni", "use", "uti")))
    return f"{'an' if vowel or noun.startswith(_SPELT) else 'a'} {noun}"


_SPELT = ("SUV", "8", "11 ", "18 ")
"""Said with a vowel first."""


def the(name: str) -> str:
    """A name with its article; what is numbered ("dock door 5") has none."""
    return name if re.search(r"\d$", name) else f"the {name.removeprefix('The ')}"


def listing(names: Sequence[str], word: str = "and") -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {word} {names[-1]}"


def called(category: str) -> str:
    """What people say for a category, where they say something else."""
    return _CALLED.get(category, category)


_CALLED = {
    "cross": "pharmacy cross", "roller": "road roller", "suv": "SUV", "tv": "TV", "cctv camera": "CCTV camera",
    "a-board": "A-board", "belisha beacon": "Belisha beacon", "tyre stack": "stack of tyres", "pipe stack": "stack of pipes",
    "pallet stack": "stack of pallets", "gravel pile": "pile of gravel", "sand pile": "pile of sand",
}  # fmt: skip


def noun_of(kind: Kind) -> str:
    """What one thing of a kind is called, attributes in their usual order."""
    noun = called(kind.category)
    if kind.attribute is not None:
        key, value = kind.attribute
        key = "posture" if kind.category == "person" and key == "state" else key
        return _WITH.get(key, ("{value} {noun}", ""))[0].format(value=value, noun=noun, a=article(value))
    return f"{kind.colour} {noun}" if kind.colour else noun


def many_of(kind: Kind) -> str:
    """What several things of a kind are called."""
    key = kind.attribute[0] if kind.attribute is not None else ""
    key = "posture" if kind.category == "person" and key == "state" else key
    if kind.attribute is not None and key in _WITH:
        return _WITH[key][1].format(value=kind.attribute[1], many=plural(called(kind.category)))
    return plural(noun_of(kind))


_WITH = {
    "vest": ("{noun} in {a} vest", "{many} in {value} vests"),
    "helmet": ("{noun} in {a} helmet", "{many} in {value} helmets"),
    "posture": ("{noun} who is {value}", "{many} who are {value}"),
    "light": ("{noun} with its roof sign {value}", "{many} with their roof signs {value}"),
}


def unit_of(kind: Kind) -> Wordings:
    """The words for what is counted: the whole name, the category, its last word."""
    return tuple(dict.fromkeys((noun_of(kind), called(kind.category), kind.category, kind.category.split()[-1])))


def about(*kinds: Kind) -> Wordings:
    """The words that a look at things of these kinds mentions."""
    words = (word for kind in kinds for word in (kind.category, kind.category.split()[-1], *_ALSO.get(kind.category, ())))
    return tuple(dict.fromkeys(words))


_ALSO = {"person": ("anyone", "people"), "lorry": ("truck",)}


def plain_colour(colour: object) -> str | None:
    """The plain colour that a thing has; None where people would not agree."""
    return _FAMILY.get(str(colour))


def wordings(options: Options) -> Wordings:
    """All words in which any of the options may come."""
    return tuple(word for name, others in options.items() for word in (name, *others))


def colour_options() -> Options:
    return dict(_FAMILIES)


def degrees(number: float) -> str:
    return f"{number:g} degrees" if number != 1 else "1 degree"


def times(factor: float) -> str:
    """A magnification in words: "twice", "three times", "1.5 times"."""
    return {2.0: "twice", 3.0: "three times", 4.0: "four times"}.get(factor, f"{factor:g} times")


def capital(text: str) -> str:
    return text[:1].upper() + text[1:]
