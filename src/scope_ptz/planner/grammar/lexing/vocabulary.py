"""Read the vocabulary for camera instructions: the phrases of each terminal of ``language.lark``, and misspellings."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

_BRACKETS = re.compile(r"([()\[\]|])")
_NOT_DOUBLED = frozenset({"open", "visit", "orient", "monitor", "widen", "tighten", "broaden", "enter"})
"""Verbs that do not double their last consonant before "-ing", unlike other verbs with such an ending."""


def _forms(verb_phrase: str) -> list[str]:
    """Return the base, third-person and -ing forms of a phrase that starts with a verb."""
    verb, _, rest = verb_phrase.partition(" ")
    stem = verb[:-1] if verb.endswith("e") and not verb.endswith("ee") else verb
    doubles_consonant = re.fullmatch(r"[a-z]*[bcdfghjklmnprstvz][aeiou][bdgmnpt]", verb) and verb not in _NOT_DOUBLED
    gerund = (verb + verb[-1] if doubles_consonant else stem) + "ing"
    third = verb + ("es" if verb.endswith(("s", "x", "ch", "sh", "o")) else "s")
    return [f"{form} {rest}".strip() for form in (verb, third, gerund)]


def expand(pattern: str) -> list[tuple[str, ...]]:
    """Return every word sequence that a phrase pattern stands for.

    ``(a|b)`` is a choice, ``[a|b]`` an optional choice, and ``~`` before a verb stands for its forms.
    """
    sequences: list[tuple[str, ...]] = []
    for variant in _variants(pattern):
        text = " ".join(variant.split())
        if text.startswith("~"):
            sequences.extend(tuple(form.split()) for form in _forms(text[1:].strip()))
        elif text:
            sequences.append(tuple(text.split()))
    return sequences


def _variants(pattern: str) -> list[str]:
    """Return the texts that a pattern stands for, one for each combination of its choices."""
    open_groups: list[tuple[str, list[str], list[str]]] = []  # bracket, texts before the group, choices so far
    texts = [""]
    for part in _BRACKETS.split(pattern):
        if part in ("(", "["):
            open_groups.append((part, texts, []))
            texts = [""]
        elif part == "|" and open_groups:
            open_groups[-1][2].extend(texts)
            texts = [""]
        elif part in (")", "]"):
            bracket, before, choices = open_groups.pop()
            choices = [*choices, *texts, *([""] if bracket == "[" else [])]
            texts = [text + choice for choice in choices for text in before]
        elif part:
            texts = [text + part for text in texts]
    return texts


def _sections(file: str) -> dict[str, list[str]]:
    """Return the comma-separated lists of a data file by heading. The key "@" contains the lines of the form "@name pattern"."""
    sections: dict[str, list[str]] = {"@": []}
    current: list[str] = []
    for line in Path(__file__).with_name(file).read_text(encoding="utf-8").splitlines():
        if line.startswith("@"):
            sections["@"].append(line[1:])
        elif line.endswith(":") and not line.startswith(("#", " ")):
            current = sections.setdefault(line[:-1], [])
        elif line.startswith(" "):
            current.extend(phrase for part in line.split(",") if (phrase := part.strip()))
    return sections


@cache
def word_list(name: str) -> frozenset[str]:
    """Return the word list of ``words.txt`` under a heading."""
    return frozenset(_sections("words.txt")[name])


@cache
def spelling() -> dict[str, str]:
    """Return common misspellings with their corrections."""
    pairs = (entry.partition("=") for entry in word_list("spelling"))
    return {wrong: right for wrong, _, right in pairs}


@cache
def vocabulary() -> dict[str, tuple[str, ...]]:
    """Return the phrase patterns of each terminal in ``vocabulary.txt``."""
    patterns = _sections("vocabulary.txt")
    macros = {f"${name}": pattern for name, _, pattern in (line.partition(" ") for line in patterns.pop("@"))}
    replace = re.compile("|".join(re.escape(name) + r"\b" for name in macros))
    return {
        terminal: tuple(replace.sub(lambda match: macros[match[0]], p) for p in entries) for terminal, entries in patterns.items()
    }
