"""Reduce a question of two parts to its second part, in which a pronoun stands for the thing of the first part."""

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

    The answer to the second part says so if there is no such thing.
    """
    match = _TWO_PARTS.fullmatch(question.strip().rstrip("?. "))
    if match is None or not _PRONOUN.search(match["question"]):
        return question
    thing = _ARTICLE.sub("the ", match["thing"])
    return f"{_PRONOUN.sub(lambda _: thing, match['question'], count=1)}?"
