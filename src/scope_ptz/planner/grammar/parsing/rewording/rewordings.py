"""Patterns with what replaces them, each compiled only when a text contains the words that every match needs."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

Replacement = str | Callable[[re.Match[str]], str]
"""Words, or a function of the match that returns them."""

_CLOSING = {"[": "]", "(": ")", "{": "}"}


class Rewording(NamedTuple):
    """A pattern with what replaces it.

    Attributes:
        pattern: The regular expression; case is ignored.
        plain: What replaces a match.
        required: Lower-case text that every match contains; empty if there is none.
    """

    pattern: str
    plain: Replacement
    required: str


def rewordings(patterns: Sequence[tuple[str, Replacement]]) -> tuple[Rewording, ...]:
    """Return the rewordings for pairs of a pattern and what replaces it."""
    return tuple(Rewording(pattern, plain, required_text(pattern)) for pattern, plain in patterns)


def reworded_text(text: str, changes: Sequence[Rewording]) -> str:
    """Return a text after all rewordings, in their order."""
    lower = text.lower()
    for pattern, plain, required in changes:
        if required in lower and (changed := _compiled(pattern).sub(plain, text)) != text:
            text, lower = changed, changed.lower()
    return text


def required_text(pattern: str) -> str:
    """Return the longest lower-case text that every match of a pattern contains; empty if there is none.

    Only the characters outside of groups and sets count, so that the text may be shorter than it could be.
    """
    runs, run, i = [], "", 0
    while i < len(pattern):
        char = pattern[i]
        if char == "|":
            return ""  # alternatives without a group
        if char in "?*{":
            run = run[:-1]  # the character before it is optional
        if char.isalnum() or char in " ,'-":
            run += char
        else:
            runs.append(run)
            run = ""
        i = _end_of_item(pattern, i)
    return max((*runs, run), key=len).lower()


def _end_of_item(pattern: str, start: int) -> int:
    """Return the index after the character, escape, group, set or repetition that begins at ``start``."""
    if pattern[start] == "\\":
        return start + 2
    closing = _CLOSING.get(pattern[start])
    if closing is None:
        return start + 1
    i = start + 1
    while i < len(pattern) and pattern[i] != closing:
        i = i + 1 if closing != ")" and pattern[i] != "\\" else _end_of_item(pattern, i)
    return i + 1


@cache
def _compiled(pattern: str) -> re.Pattern[str]:
    return re.compile(pattern, re.IGNORECASE)
