"""Words: splitting text, singular and plural, numbers, articles, lists. Nothing here knows about pictures."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

_IRREGULAR = {
    "people": "person", "persons": "person", "men": "man", "women": "woman", "children": "child", "feet": "foot", "mice": "mouse",
    "geese": "goose", "teeth": "tooth", "lorries": "lorry", "buses": "bus", "busses": "bus", "leaves": "leaf", "shelves": "shelf",
    "knives": "knife", "policemen": "policeman", "policewomen": "policewoman", "workmen": "workman", "firemen": "fireman",
    "foremen": "foreman", "passers-by": "passer-by", "passersby": "passerby", "axes": "axe", "taxis": "taxi", "oxen": "ox",
    "wolves": "wolf", "loaves": "loaf", "halves": "half", "roofs": "roof", "banksmen": "banksman", "ponies": "pony",
}  # fmt: skip
_INVARIANT = {
    "bus", "grass", "gas", "glass", "press", "sheep", "deer", "series", "traffic", "vms", "this", "is", "its", "was", "has", "does",
    "chassis", "cctv", "fencing", "scaffolding", "yes", "lens", "cross", "bass", "pass", "less", "across", "cattle", "machinery",
    "equipment", "luggage", "furniture", "compass", "canvas", "campus", "bypass", "aircraft", "various", "as", "us",
}  # fmt: skip
_UNITS = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10,
    "eleven": 11, "twelve": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16, "seventeen": 17, "eighteen": 18,
    "nineteen": 19, "twenty": 20, "thirty": 30, "forty": 40, "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90,
}  # fmt: skip
_ORDINALS = {
    "first": 1, "second": 2, "third": 3, "fourth": 4, "fifth": 5, "sixth": 6, "seventh": 7, "eighth": 8, "ninth": 9, "tenth": 10,
}  # fmt: skip
_CONTRACTIONS = {
    "what's": "what is", "where's": "where is", "who's": "who is", "there's": "there is", "that's": "that is", "how's": "how is",
    "it's": "it is", "isn't": "is not", "aren't": "are not", "doesn't": "does not", "don't": "do not", "can't": "can not",
    "cannot": "can not", "wasn't": "was not", "hasn't": "has not", "haven't": "have not", "i'm": "i am", "they're": "they are",
    "which's": "which is", "what're": "what are", "there're": "there are",
}  # fmt: skip
_SPLIT = re.compile(r'"[^"]*"|(?<![a-z0-9])\'[^\']+\'(?![a-z0-9])|[a-z0-9]+(?:[-.\'/][a-z0-9]+)*|,|;')


def split(text: str) -> list[str]:
    """Lower-case words, numbers, commas and quoted strings (quotes kept); contractions undone, possessives as ``x 's``."""
    plain = unicodedata.normalize("NFKC", text).lower()
    for curly, straight in (("\u2019", "'"), ("\u2018", "'"), ("\u201c", '"'), ("\u201d", '"')):
        plain = plain.replace(curly, straight)
    words: list[str] = []
    for word in _SPLIT.findall(plain):
        if word in _CONTRACTIONS:
            words += _CONTRACTIONS[word].split()
        elif word.endswith("'s") and len(word) > 2:
            words += [word[:-2], "'s"]
        else:
            words.append(word)
    return words


def singular(word: str) -> str:
    """The singular of a noun; words that are no plural come back as they are."""
    if word in _IRREGULAR:
        return _IRREGULAR[word]
    if word in _INVARIANT or len(word) < 3 or not word.endswith("s") or word.endswith(("ss", "us", "is")):
        return word
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "xes", "sses", "zes")):
        return word[:-2]
    return word[:-1]


def plural(phrase: str) -> str:
    """The plural of a noun phrase: its head is inflected."""
    words = phrase.split()
    head = _head(words)
    words[head] = _plural(words[head])
    return " ".join(words)


def _head(words: list[str]) -> int:
    """Where the noun of a phrase is: the last word, or the one before "with", "of" or another preposition."""
    return next((i for i, x in enumerate(words) if x in _PREPOSITIONS and i > 0), len(words)) - 1


_PREPOSITIONS = frozenset(["with", "of", "on", "in", "at", "for", "by", "from", "near", "carrying"])


def _plural(word: str) -> str:
    for many, one in _IRREGULAR.items():
        if one == word and many not in {"persons", "busses"}:
            return many
    if singular(word) != word or (word in _INVARIANT and word not in {"bus", "glass", "cross"}):
        return word
    if word.endswith("y") and word[-2:-1] not in {"a", "e", "i", "o", "u"}:
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "ch", "sh", "z")) else "s")


def is_plural(word: str) -> bool:
    return singular(word) != word


def number(word: str) -> int | None:
    """A cardinal as digits or words ("12", "twelve", "twenty-five")."""
    if word.isdigit():
        return int(word)
    if word in _UNITS:
        return _UNITS[word]
    tens, _, unit = word.partition("-")
    if unit and _UNITS.get(tens, 0) >= 20 and 0 < _UNITS.get(unit, 0) < 10:
        return _UNITS[tens] + _UNITS[unit]
    return None


def ordinal(word: str) -> int | None:
    """An ordinal as digits or words ("2nd", "second"); "last" is -1."""
    if word == "last":
        return -1
    if word in _ORDINALS:
        return _ORDINALS[word]
    found = re.fullmatch(r"(\d+)(st|nd|rd|th)", word)
    return int(found.group(1)) if found else None


def article(phrase: str) -> str:
    """The phrase with "a" or "an"; plural phrases without."""
    words = phrase.split()
    if is_plural(words[_head(words)]):
        return phrase
    vowel = phrase[0].lower() in "aeio" or (phrase[0].lower() == "u" and not phrase.lower().startswith(("uni", "use")))
    return f"{'an' if vowel else 'a'} {phrase}"


def listing(items: Sequence[str], word: str = "and") -> str:
    """ "a, b and c"."""
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} {word} {items[-1]}"


def counted(count: int, noun: str) -> str:
    """ "1 car", "2 cars"."""
    return f"{count} {noun if count == 1 else plural(noun)}"


def sentence(text: str) -> str:
    """First letter raised, one full stop at the end."""
    return text[:1].upper() + text[1:].rstrip(".") + "."


def letters(text: str) -> str:
    """Letters and digits only, in lower case, one space between words: what two readings of a text are compared by."""
    return " ".join(re.findall(r"[a-z0-9]+", unicodedata.normalize("NFKC", text).lower()))
