"""Reduce a two-part question to its second part, and replace its pronoun with the noun phrase of the first part."""

from __future__ import annotations

import re

_TWO_PARTS = re.compile(
    r"(?:(?:can|could|do) you (?:see|find|spot)|is there|are there|whether (?:you can (?:see|find)|there is))"
    r" (?P<thing>(?:an?|the|any) [^,?]+?),? and (?P<question>(?:what|which|where|how|who|in which|on which|at which)\b.+)",
    re.IGNORECASE,
)
_PRONOUN = re.compile(r"\b(?:it|they|one|he|she)\b", re.IGNORECASE)
_ARTICLE = re.compile(r"^(?:an?|any|the) ", re.IGNORECASE)


def without_first_part(question: str) -> str:
    """Return "what colour is the bench?" for "can you see a bench, and what colour is it?", and other questions unchanged.

    If there is no bench, the answer to the second part says so.
    """
    match = _TWO_PARTS.fullmatch(question.strip().rstrip("?. "))
    if match is None or not _PRONOUN.search(match["question"]):
        return question
    thing = _ARTICLE.sub("the ", match["thing"])
    return f"{_PRONOUN.sub(lambda _: thing, match['question'], count=1)}?"
