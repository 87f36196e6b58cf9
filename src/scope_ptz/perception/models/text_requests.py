"""Heuristics for requests about text: questions that ask to read it, and descriptions that quote it."""

from __future__ import annotations

import re
from difflib import SequenceMatcher

_WRITING = r"(?:text|writing|lettering|words?|letters?|digits?|numbers?|inscription|message|caption|title|name)"
_PLATE = r"(?:licen[cs]e|number|registration)[ -]plates?"

_READING = re.compile(
    rf"\bread\b(?! the (?:room|scene|situation))|\btranscribe\b|\bspell(?:ed|t)?\b|\bocr\b"
    r"|\bwhat (?:does|do|did) .{1,80}\b(?:say|state)\b"
    r"|\b(?:written|printed|painted|stencilled|lettered) (?:on|across|above|below|under)\b|\bwhat (?:is|'s) written\b"
    rf"|\b(?:what|which)(?: is|'s| are)?(?: the)?(?: \w+)? {_WRITING}\b.{{0,40}}\b(?:on|of|is|are|shown|visible|displayed)\b"
    rf"|\bwhat(?: is|'s)(?: the)? .{{0,40}}\b{_PLATE}\b|\b{_PLATE} (?:number|of)\b",
    re.IGNORECASE,
)
_NOT_READING = re.compile(
    r"\b(?:how many|count|is there|are there|is (?:any|some)(?:one|body)|is the \w+ reading)\b", re.IGNORECASE
)


def is_reading_request(question: str) -> bool:
    """Return whether a question asks to read text in view. This heuristic decides which backend is called first."""
    return bool(_READING.search(question)) and not _NOT_READING.search(question)


_ARTICLES = r"(?:(?:the|a|an|this|that|those|these|its|all|any|out|aloud|me|what|is)\s+)*"
_TARGETS = (
    re.compile(rf"\bwhat (?:does|do|did)\s+{_ARTICLES}(?P<x>.+?)\s+(?:say|read|state)\b", re.IGNORECASE),
    re.compile(
        rf"\b(?:written|printed|painted|shown|displayed|{_WRITING})\s+(?:is |are )?(?:on|of|across)\s+{_ARTICLES}(?P<x>[^?.!,;]+)",
        re.IGNORECASE,
    ),
    re.compile(rf"\bread\s+{_ARTICLES}(?P<x>[^?.!,;]+)", re.IGNORECASE),
)


def reading_target(question: str) -> str | None:
    """Return the object whose text a question asks for ("the gantry sign"); None if it asks for all text in view."""
    for pattern in _TARGETS:
        if match := pattern.search(question):
            target = re.split(r"\s+(?:and|then|for|to|please|in view|right now)\b", match["x"].strip())[0].strip()
            if target and not re.fullmatch(
                rf"{_WRITING}|it|there|here|view|(?:current )?(?:image|picture|frame|scene)", target, re.IGNORECASE
            ):
                return target
            return None
    return None


_QUOTED = re.compile(r"[\"“”«»„]([^\"“”«»„]+)[\"“”«»„]|(?<!\w)'([^']+)'(?!\w)")
_TEXT_CLAUSE = re.compile(
    r"\b(?:saying|that (?:says|reads|say|read)|reading|with the (?:text|words?|number)|marked|labelled|labeled)\s+(.+)$",
    re.IGNORECASE,
)
_ANY_TEXT = re.compile(
    rf"^\W*(?:(?:the|a|any|all|every|some|visible|readable|printed|written|piece of|line of|pieces of|lines of)\s+)*{_WRITING}\W*$",
    re.IGNORECASE,
)


def requested_texts(description: str) -> tuple[str, ...] | None:
    """Return the texts that a description contains, in quotes or after "that says".

    Returns:
        An empty tuple if the description means any text; None if the description is not about text.
    """
    if quoted := [a or b for a, b in _QUOTED.findall(description)]:
        return tuple(quoted)
    if text_clause := _TEXT_CLAUSE.search(description):
        return (text_clause[1].strip(" .'\""),)
    return () if _ANY_TEXT.match(description) else None


SAME_TEXT = 0.8
"""Minimum similarity at which two texts count as the same. It tolerates about one misread character in five."""


def normalised_text(text: str) -> str:
    """Return only the letters and digits of a text, in lower case."""
    return "".join(c for c in text.casefold() if c.isalnum())


def similarity(a: str, b: str) -> float:
    """Return the similarity between two texts, from 0 to 1. Only letters and digits count."""
    a, b = normalised_text(a), normalised_text(b)
    return SequenceMatcher(None, a, b, autojunk=False).ratio() if a and b else 0.0


def text_matches(requested: str, line: str) -> bool:
    """Return whether a line contains the requested text or, allowing for OCR errors, is similar to it."""
    a, b = normalised_text(requested), normalised_text(line)
    return bool(a) and bool(b) and (a in b or similarity(a, b) >= SAME_TEXT)
