"""Does a word, an outfit or a text fit a thing? Three answers: yes, no, and "the scene does not say" (None)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from scope_ptz.perception.ground_truth.language import words as w
from scope_ptz.perception.ground_truth.language.concepts import COLOURS, lexicon, nouns_in, singular_phrase
from scope_ptz.perception.ground_truth.view import Thing, View, head_of
from scope_ptz.simulator.models import Attribute

_STATES = [
    "",
    "open: opened ajar",
    "closed: shut locked",
    "lit: illuminated glowing flashing alight",
    "unlit: dark",
    "moving: driving travelling traveling",
    "stationary: parked stopped waiting still standstill idle",
    "empty: unloaded unoccupied vacant",
    "full: loaded occupied laden",
    "raised: up lifted",
    "lowered: down",
    "walking: strolling",
    "sitting: seated",
    "upright: standing",
    "fallen: toppled overturned lying knocked",
    "working: operating operational active running",
    "",
]
_CANONICAL = {word: line.partition(":")[0] for line in _STATES if line for word in line.replace(":", "").split()} | {
    "gray": "grey", "amber": "orange", "violet": "purple", "golden": "gold", "metallic": "metal", "steel": "metal",
    "standing": "upright", "stand": "upright", "wood": "wooden", "timber": "wooden", "male": "man", "female": "woman",
}  # fmt: skip
_OPPOSITES = [
    ("open", "closed"), ("lit", "unlit"), ("lit", "off"), ("on", "off"), ("moving", "stationary"), ("empty", "full"),
    ("raised", "lowered"),
    ("sitting", "upright"), ("upright", "fallen"), ("walking", "upright"), ("walking", "stationary"), ("walking", "sitting"),
    ("working", "off"),
]  # fmt: skip
SOFT = frozenset(
    [
        "big",
        "large",
        "small",
        "little",
        "huge",
        "tiny",
        "tall",
        "short",
        "long",
        "wide",
        "narrow",
        "whole",
        "entire",
        "main",
        "other",
        "visible",
        "nearby",
        "actual",
        "particular",
        "present",
        "current",
        "certain",
        "same",
        "real",
        "single",
        "lone",
        "only",
        "different",
        "various",
        "individual",
        "standing",
        "sitting",
        "waiting",
        "hanging",
        "lying",
        "placed",
        "full-size",
        "mounted",
        "shown",
        "displayed",
        "there",
        "located",
        "parked",
        "stationary",
        "moving",
    ]
)
"""Words that restrict nothing when the scene has no fact about them."""
FILLERS = frozenset(
    [
        "the",
        "a",
        "an",
        "is",
        "are",
        "it",
        "its",
        "of",
        "in",
        "on",
        "at",
        "and",
        "be",
        "being",
        "with",
        "very",
        "quite",
        "really",
        "currently",
        "colour",
        "color",
        "coloured",
        "colored",
        "one",
        "ones",
        "parts",
    ]
)
TEXT_KEYS = frozenset(["reads", "text", "plate", "lettering", "number", "signal", "sign", "label", "readable_by", "inscription"])
"""Attributes that repeat what is written on a thing. They are never used: only legible texts are read."""
COLOUR_KEYS = ("colour", "color")
NOTHING = frozenset({"", "none", "no", "false", "nothing", "without"})


def canonical(word: str) -> str:
    return _CANONICAL.get(word, word)


def opposite(a: str, b: str) -> bool:
    return (a, b) in _OPPOSITES or (b, a) in _OPPOSITES


def key_words(key: str) -> list[str]:
    """ "helmet_colour" as words."""
    return w.letters(key.replace("_", " ").replace("-", " ")).split()


def value_words(value: object) -> list[str]:
    return [canonical(x) for x in w.letters(str(value)).split()]


def fact_words(thing: Thing) -> set[str]:
    """Every word that says something of a thing: names, values, true flags, what it is doing. Clothes of people excluded."""
    found = {canonical(x) for x in w.letters(f"{thing.name} {thing.category}").split()}
    for key, value in facts(thing):
        words = key_words(key)
        if value is True:
            found |= {canonical(x) for x in words}
            found |= {"on"} if "lit" in words else set()
        elif value is False:
            found |= {b for pair in _OPPOSITES for a, b in (pair, pair[::-1]) if a in {canonical(x) for x in words}}
        elif not (is_colour(value) and words[-1] not in COLOUR_KEYS and any(k in thing.attributes for k in COLOUR_KEYS)) and not (
            is_worn(key) and "person" in thing.concepts
        ):
            found |= set(value_words(value))
        if words[-1] in {"load", "cargo"} and str(value).lower() not in NOTHING:
            found.add("full")
    if "lit" in found:
        found.add("on")
    if "unlit" in found:
        found.add("off")
    if thing.motion and not found & {"moving", "stationary"}:
        found.add(thing.motion)
    return found


def facts(thing: Thing) -> list[tuple[str, Attribute]]:
    """The attributes that may be told: all but what is written on the thing."""
    return [(k, v) for k, v in thing.attributes.items() if k not in TEXT_KEYS]


def is_colour(value: object) -> bool:
    words = w.letters(str(value)).split()
    return bool(words) and words[-1] in COLOURS


def is_worn(key: str) -> bool:
    """Whether an attribute is about clothes, so that its colour is not the person's."""
    return any(
        lexicon().concept(x) in {"hard hat", "hi-vis vest", "jacket", "trouser", "boot", "glove", "hat"} for x in key_words(key)
    )


def colour_of(thing: Thing) -> str | None:
    """The colour as the scene states it."""
    for key in COLOUR_KEYS:
        if key in thing.attributes:
            return str(thing.attributes[key])
    if "person" in thing.concepts:
        return None
    for key, value in thing.attributes.items():
        if is_colour(value) and not is_worn(key):
            return str(value)
    named = [x for x in w.letters(thing.name).split() if x in COLOURS]
    return named[0] if named else None


def fits_noun(view: View, thing: Thing, noun: str) -> bool:
    """Whether a noun (singular or plural) names the thing.

    A word that the scene itself uses for something means that ("pylon" for an electricity pylon), whatever else it may mean.
    """
    one = w.letters(singular_phrase(noun))
    name, category = w.letters(head_of(thing.name)), w.letters(thing.category)
    if one in (category, name) or name.endswith(f" {one}"):
        return True
    concept = lexicon().concept(noun)
    return concept is not None and concept in thing.concepts and (concept == one or one not in view.nouns)


def fits_words(view: View, thing: Thing, words: Sequence[str]) -> bool | None:
    """Whether loose words ("parked", "dark blue", "a van") hold for a thing."""
    rest = [x for x in words if x not in FILLERS] or [x for x in words if x in {"on", "in"}]
    if not rest:
        return True
    spans = nouns_in(rest, view.nouns)
    if spans and spans[0][1] == len(rest):
        answers = [_all([fits_noun(view, thing, " ".join(rest[i:])), *(_fits(view, thing, x) for x in rest[:i])]) for i, _ in spans]
        if any(answers):
            return True
    return _all([_fits(view, thing, x) for x in rest])


def _all(answers: Iterable[bool | None]) -> bool | None:
    found = list(answers)
    return False if False in found else None if None in found else True


def _fits(view: View, thing: Thing, word: str) -> bool | None:
    """Whether one word holds for a thing."""
    if word.startswith("non-"):
        answer = _fits(view, thing, word.removeprefix("non-"))
        return None if answer is None else not answer
    known = fact_words(thing)
    meant = canonical(word)
    if _forms(word) & {f for x in known for f in _forms(x)} or fits_noun(view, thing, word):
        return True
    if lexicon().concept(word) is not None and "person" in thing.concepts and wears(view, thing, [word]):
        return True
    if _in_context(view, thing, word) or any(w.letters(word) in w.letters(text).split() for text in thing.texts):
        return True
    if any(opposite(meant, other) for other in known):
        return False
    if meant in COLOURS and colour_of(thing) is not None:
        return False
    if any(_forms(word) & domain and key in thing.attributes for key, domain in view.values.items() if key not in TEXT_KEYS):
        return False
    return False if lexicon().concept(word) else None


def _forms(word: str) -> frozenset[str]:
    """A word with its other forms, so that "kneeling" fits "kneel"."""
    stems = {word, w.singular(word)}
    for ending in ("ing", "ed"):
        if word.endswith(ending) and len(word) > len(ending) + 2:
            base = word.removesuffix(ending)
            stems |= {base, f"{base}e"} | ({base[:-1]} if base[-1] == base[-2] else set())
    return frozenset(canonical(x) for x in stems) | {word}


def _in_context(view: View, thing: Thing, word: str) -> bool:
    """Whether the word names what the thing hangs on ("the gantry sign", "the cabin door")."""
    holder = thing.parent
    while holder is not None:
        words = w.letters(view.instances[holder].name).split()
        carrier = view.by_id.get(holder)
        if w.singular(word) in words or (carrier is not None and fits_noun(view, carrier, word)):
            return True
        holder = view.parents.get(holder)
    return False


def wears(view: View, thing: Thing, words: Sequence[str], amount: int | None = None) -> bool:
    """Whether a thing has what the words name: an attribute, a part, or a text. What the scene does not say is not there."""
    rest = [x for x in words if x not in FILLERS]
    spans = nouns_in(rest, view.nouns)
    start, end = spans[0] if spans else (len(rest) - 1, len(rest))
    noun, others = " ".join(rest[start:end]), [canonical(x) for x in (*rest[:start], *rest[end:])]
    if lexicon().concept(noun) == "thing":  # "carrying something"
        held = [v for k, v in facts(thing) if set(key_words(k)) & {"carrying", "load", "holding"}]
        return any(str(v).lower() not in NOTHING for v in held)
    names = names_of(noun)
    for key, value in facts(thing):
        if _key_is(key, names):
            said = value_words(value)
            if str(value).lower() not in NOTHING and value is not False and all(x in said for x in others):
                return amount is None or not isinstance(value, int) or isinstance(value, bool) or value == amount
        for chunk in _chunks(value):
            if any(name in chunk for name in names) and all(x in value_words(chunk) for x in others) and "no" not in chunk.split():
                return True
    parts = [t for t in view.things if t.id != thing.id and view.belongs(t.id, thing.id)]
    if any(fits_noun(view, part, noun) and all(_fits(view, part, x) for x in others) for part in parts):
        return True
    wanted = w.letters(" ".join(rest))
    return any(wanted in w.letters(text) for text in thing.texts)


def _key_is(key: str, names: frozenset[str]) -> bool:
    words = [x for x in key_words(key) if x not in COLOUR_KEYS]
    return " ".join(words) in names or (bool(words) and singular_phrase(" ".join(words)) in names)


def names_of(noun: str) -> frozenset[str]:
    """All names, singular, of what a noun means."""
    table = lexicon()
    concept = table.concept(noun)
    return frozenset({singular_phrase(noun)}) | (table.all_names(concept) if concept else frozenset())


def _chunks(value: object) -> list[str]:
    """ "orange vest and white helmet" as its parts, so that the vest is not white."""
    if not isinstance(value, str):
        return []
    text = value.lower().replace(" and ", ",").replace(" with ", ",").replace(";", ",")
    return [w.letters(" ".join([*(c.split()[:-1]), w.singular(c.split()[-1])])) for c in text.split(",") if c.strip()]


def bears(thing: Thing, words: Sequence[str]) -> bool:
    """Whether legible text on a thing contains these words in this order (any legible text when there are none)."""
    wanted = f" {' '.join(words)} "
    return any(wanted in f" {w.letters(text)} " or not words for text in thing.texts) or _plate_is(thing, words)


def _plate_is(thing: Thing, words: Sequence[str]) -> bool:
    """Plates are compared without spaces, and after "number plate"."""
    plain = "".join(x for x in words if x not in {"number", "plate", "registration", "licence", "license"})
    return len(plain) >= 4 and any(plain == w.letters(text).replace(" ", "") for text in thing.texts)
