"""The words of camera operation: which phrases make which terminal of ``language.lark``; numbers, colours, misspellings."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files

NUMBER_WORDS: dict[str, float] = {
    "zero": 0,
    "one": 1,
    "two": 2,
    "three": 3,
    "four": 4,
    "five": 5,
    "six": 6,
    "seven": 7,
    "eight": 8,
    "nine": 9,
    "ten": 10,
    "eleven": 11,
    "twelve": 12,
    "thirteen": 13,
    "fourteen": 14,
    "fifteen": 15,
    "sixteen": 16,
    "seventeen": 17,
    "eighteen": 18,
    "nineteen": 19,
    "twenty": 20,
    "thirty": 30,
    "forty": 40,
    "fourty": 40,
    "fifty": 50,
    "sixty": 60,
    "seventy": 70,
    "eighty": 80,
    "ninety": 90,
    "hundred": 100,
    "thousand": 1000,
    "dozen": 12,
    "couple": 2,
}
FRACTION_WORDS: dict[str, float] = {
    "half": 0.5,
    "third": 1 / 3,
    "thirds": 1 / 3,
    "quarter": 0.25,
    "quarters": 0.25,
    "fourth": 0.25,
    "fourths": 0.25,
    "fifth": 0.2,
    "sixth": 1 / 6,
    "eighth": 0.125,
    "eighths": 0.125,
    "tenth": 0.1,
    "twelfth": 1 / 12,
}
ORDINAL_WORDS: dict[str, int] = {
    "first": 1,
    "second": 2,
    "third": 3,
    "fourth": 4,
    "fifth": 5,
    "sixth": 6,
    "seventh": 7,
    "eighth": 8,
    "ninth": 9,
    "tenth": 10,
    "last": -1,
    "final": -1,
}


_NOT_DOUBLED = frozenset({"open", "visit", "orient", "monitor", "widen", "tighten", "broaden", "enter"})


def _forms(verb_phrase: str) -> list[str]:
    """The base, third-person and -ing forms of a phrase that starts with a verb."""
    verb, _, rest = verb_phrase.partition(" ")
    stem = verb[:-1] if verb.endswith("e") and not verb.endswith("ee") else verb
    doubled = re.fullmatch(r"[a-z]*[bcdfghjklmnprstvz][aeiou][bdgmnpt]", verb) and verb not in _NOT_DOUBLED
    gerund = (verb + verb[-1] if doubled else stem) + "ing"
    third = verb + ("es" if verb.endswith(("s", "x", "ch", "sh", "o")) else "s")
    return [f"{form} {rest}".strip() for form in (verb, third, gerund)]


def expand(pattern: str) -> list[tuple[str, ...]]:
    """Every word sequence that a phrase pattern stands for."""
    option = re.search(r"[(\[]([^()\[\]]*)[)\]]", pattern)
    if option:
        choices = option.group(1).split("|") + ([""] if option.group(0)[0] == "[" else [])
        return [words for choice in choices for words in expand(pattern[: option.start()] + choice + pattern[option.end() :])]
    text = " ".join(pattern.split())
    if text.startswith("~"):
        return [tuple(form.split()) for form in _forms(text[1:].strip())]
    return [tuple(text.split())] if text else []


def _sections(file: str) -> dict[str, list[str]]:
    """The comma-separated lists of a data file by their headings; "@name pattern" lines under "@"."""
    sections: dict[str, list[str]] = {"@": []}
    current: list[str] = []
    for line in files(__package__).joinpath(file).read_text(encoding="utf-8").splitlines():
        if line.startswith("@"):
            sections["@"].append(line[1:])
        elif line.endswith(":") and not line.startswith(("#", " ")):
            current = sections.setdefault(line[:-1], [])
        elif line.startswith(" "):
            current.extend(phrase for part in line.split(",") if (phrase := part.strip()))
    return sections


@cache
def word_list(name: str) -> frozenset[str]:
    """A list of ``words.txt``."""
    return frozenset(_sections("words.txt")[name])


@cache
def spelling() -> dict[str, str]:
    """Common misspellings and what they stand for."""
    pairs = (entry.partition("=") for entry in word_list("spelling"))
    return {wrong: right for wrong, _, right in pairs}


@cache
def vocabulary() -> dict[str, tuple[str, ...]]:
    """Terminal to phrase patterns, as ``vocabulary.txt`` lists them."""
    patterns = _sections("vocabulary.txt")
    macros = {f"${name}": pattern for name, _, pattern in (line.partition(" ") for line in patterns.pop("@"))}
    replace = re.compile("|".join(re.escape(name) + r"\b" for name in macros))
    return {terminal: tuple(replace.sub(lambda match: macros[match[0]], p) for p in found) for terminal, found in patterns.items()}


@cache
def phrase_table() -> dict[tuple[str, ...], frozenset[str]]:
    """Word sequence to the terminals that it may be; ``FILLER`` for words without meaning."""
    table: dict[tuple[str, ...], set[str]] = {}
    for terminal, patterns in vocabulary().items():
        for pattern in patterns:
            for words in expand(pattern):
                table.setdefault(words, set()).add(terminal)
    return {words: frozenset(kinds) for words, kinds in table.items()}
