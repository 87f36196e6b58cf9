"""Find numbers and names in text other than answers, such as tool results."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.text import answer_text


def numbers_in(text: str) -> set[float]:
    """Return every number in ``text`` that could be a count.

    Measurements ("15 degrees"), ordinals and labels ("preset 3") are excluded.
    """
    return {number.value for number in find_numbers(answer_text(text), ())}


def is_stated(text: str, wordings: Sequence[str]) -> bool:
    """Return whether ``text`` mentions a thing in one of its wordings without denying it."""
    return any(not mention.denied for mention in answer_text(text).mentions({"thing": wordings}))
