"""Load the function words and fixed expressions from ``closed_class.txt``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from importlib.resources import files
from typing import NamedTuple


class WordClass(NamedTuple):
    """A class of words.

    Attributes:
        kind: "v" for verbs and "n" for nouns, whose inflected forms are computed; "" for words with one form.
        members: The words and expressions.
    """

    kind: str
    members: tuple[str, ...]


@cache
def instruction_classes() -> Mapping[str, WordClass]:
    """Return the word classes used in instructions, and the spelling lists, by name."""
    classes: dict[str, WordClass] = {}
    for head, members in _lines():
        if head[0] not in "@?":
            name, _, kind = head.partition(" ")
            classes[name] = WordClass(kind, members)
    return classes


@cache
def misspellings() -> Mapping[str, str]:
    """Return the intended word for each common misspelling."""
    return dict(pair.split("=") for pair in instruction_classes()["fixed"].members)


@cache
def question_phrases() -> Mapping[tuple[str, ...], tuple[str, str]]:
    """Return the token type and value of each expression used in descriptions and questions, keyed by its words."""
    table: dict[tuple[str, ...], tuple[str, str]] = {}
    for head, members in _lines():
        if head[0] == "?":
            name, _, value = head[1:].partition("=")
            for member in members:
                table.setdefault(tuple(member.split()), (name, value or member))
    return table


def _lines() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the head and the members of each line, with shared classes replaced by their members."""
    shared: dict[str, tuple[str, ...]] = {}
    for line in files(__package__).joinpath("closed_class.txt").read_text("utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            head, _, member_list = line.partition(": ")
            members = tuple(
                member for part in member_list.split(", ") if part.strip() for member in shared.get(part.strip(), (part.strip(),))
            )
            if head[0] == "@":
                shared[head] = members
            yield head, members
