"""Find the quotes in an answer, and select those that report the text on a sign."""

from __future__ import annotations

import re
from dataclasses import dataclass

_QUOTATION = re.compile(r'"([^"]+)"|(?<!\w)\'([^\']+(?:\'\w[^\']*)*)\'(?!\w)')
"""Text in quotation marks. This is the fallback if the characters around the marks do not show which marks form a pair."""
_READING_VERB = r"(?:reads?|says?|states?|displays?|shows?|spells?)"
_READING_WORDS = re.compile(rf"\b{_READING_VERB}\b|\btext\b|\bwritten\b", re.IGNORECASE)
"""Words which show that a sentence reports text."""
_DENIED_BEFORE = re.compile(
    r"(?:\bnot|n't|\bnever|\brather than|\binstead of)(?:\s+(?:actually|really|clearly|in fact|read|say|state|display|show|"
    r"spell|contain|bear|have|carry|the|an?|words?|text|lettering|letters|be|simply|quite|exactly|sign|anything|like))*\s*:?\s*$"
    r"|\b(?:whether|if)\b[^.,;:]{0,40}$|\b(?:should|would|ought to)\s+(?:read|say|be)\s*$",
    re.IGNORECASE,
)
"""Words before a quote that deny it or leave it undecided ("does not read", "whether it says")."""
_PLACE_AFTER = re.compile(r"\s*(?:camera )?(?:preset|view|viewpoint|position)\b", re.IGNORECASE)
"""Words after a quote which show that it is the name of a preset or viewpoint."""
_PLACE_BEFORE = re.compile(
    r"\b(?:presets?|views?|viewpoint|position)(?: called| named)?\s*:?\s*$|"
    r"\b(?:moved|went|switched|turned|navigated|gone) (?:over )?to (?:the )?$",
    re.IGNORECASE,
)
"""Words before a quote which show that it is the name of a preset or viewpoint."""
_READING_INTRODUCTION = re.compile(rf"\b(?:{_READING_VERB}|is|are|text|words?|and)\b\s*:?\s*$|[:,]\s*$", re.IGNORECASE)
"""Words before a quote that introduce a reading."""
_SIGN_NAME_AFTER = re.compile(rf"\s*(?:(?!(?:and|then|but|also|it|which|that)\b)\w+ ){{0,2}}?{_READING_VERB}\b", re.IGNORECASE)
"""Words after a quote which show that it is the name of a sign, as in "the 'Exit' sign reads"."""


@dataclass(frozen=True, slots=True)
class Quote:
    """A quote. ``text`` excludes the quotation marks; the range from ``start`` to ``end`` (exclusive) includes them."""

    text: str
    start: int
    end: int


def find_quotes(text: str) -> list[Quote]:
    """Return the quotes in a cleaned text in order.

    If a quoted sentence reports text in quotes ("The sign reads 'STOP'"), the inner quotes are returned instead.
    """
    opened, quotes = list[tuple[str, int]](), list[Quote]()
    for at, mark in enumerate(text):
        if mark not in "\"'":
            continue
        before, after = text[at - 1 : at] or " ", text[at + 1 : at + 2] or " "
        if not before.isspace() and not after.isalnum() and any(kind == mark for kind, _ in opened):
            while opened[-1][0] != mark:
                opened.pop()
            _close_quote(text, opened.pop()[1], at + 1, quotes)
        elif not before.isalnum() and before not in ".,!?" and not after.isspace():
            opened.append((mark, at))
    if quotes:
        return sorted(quotes, key=lambda quote: quote.start)
    return [Quote(m[1] or m[2], m.start(), m.end()) for m in _QUOTATION.finditer(text)]


def _close_quote(text: str, start: int, end: int, quotes: list[Quote]) -> None:
    """Add a quote and remove the quotes inside it. If it is a sentence that reports text, keep the inner quotes instead."""
    within = [quote for quote in quotes if quote.start > start]
    rest = text[start + 1 : end - 1]
    for quote in within:
        rest = rest.replace(text[quote.start : quote.end], " ")
    if within and _READING_WORDS.search(rest):
        return
    quotes[:] = [quote for quote in quotes if quote not in within]
    if text[start + 1 : end - 1].strip():
        quotes.append(Quote(text[start + 1 : end - 1], start, end))


def reported_quotes(quotes: list[Quote], text: str) -> list[Quote]:
    """Return the quotes that report the text on a sign, without denied readings, preset names and sign names.

    The last quote is never treated as a name, so it is returned unless it is denied.
    """
    readings = list[Quote]()
    for number, quote in enumerate(quotes):
        before = text[quotes[number - 1].end if number else 0 : quote.start]
        after = text[quote.end : quotes[number + 1].start if number + 1 < len(quotes) else len(text)]
        if _DENIED_BEFORE.search(before):
            continue
        is_last = number + 1 == len(quotes)
        is_place = _PLACE_AFTER.match(after) or _PLACE_BEFORE.search(before)
        is_name = _SIGN_NAME_AFTER.match(after) and not _READING_INTRODUCTION.search(before)
        if is_last or not (is_place or is_name):
            readings.append(quote)
    return readings
