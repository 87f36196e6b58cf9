"""Find the quotes in an answer, and select those that report text from a sign. Names and denied readings are left out."""

from __future__ import annotations

import re
from dataclasses import dataclass

_PLAIN = re.compile(r'"([^"]+)"|(?<!\w)\'([^\']+(?:\'\w[^\']*)*)\'(?!\w)')
"""A text in double or single quotation marks. Used if no quotation marks can be paired by the characters next to them."""
_READ = r"(?:reads?|says?|states?|displays?|shows?|spells?)"
_READING_WORDS = re.compile(rf"\b{_READ}\b|\btext\b|\bwritten\b", re.IGNORECASE)
"""Words that show that a sentence reports a text."""
_DENIED_BEFORE = re.compile(
    r"(?:\bnot|n't|\bnever|\brather than|\binstead of)(?:\s+(?:actually|really|clearly|in fact|read|say|state|display|show|"
    r"spell|contain|bear|have|carry|the|an?|words?|text|lettering|letters|be|simply|quite|exactly|sign|anything|like))*\s*:?\s*$"
    r"|\b(?:whether|if)\b[^.,;:]{0,40}$|\b(?:should|would|ought to)\s+(?:read|say|be)\s*$",
    re.IGNORECASE,
)
"""Words before a quote that deny it or leave it open ("does not read", "whether it says")."""
_PLACE_AFTER = re.compile(r"\s*(?:camera )?(?:preset|view|viewpoint|position)\b", re.IGNORECASE)
"""Words after a quote that show that it is the name of a preset or viewpoint."""
_PLACE_BEFORE = re.compile(
    r"\b(?:presets?|views?|viewpoint|position)(?: called| named)?\s*:?\s*$|"
    r"\b(?:moved|went|switched|turned|navigated|gone) (?:over )?to (?:the )?$",
    re.IGNORECASE,
)
"""Words before a quote that show that it is the name of a preset or viewpoint."""
_INTRODUCED = re.compile(rf"\b(?:{_READ}|is|are|text|words?|and)\b\s*:?\s*$|[:,]\s*$", re.IGNORECASE)
"""Words before a quote that introduce a reading."""
_NAMED_AFTER = re.compile(rf"\s*(?:(?!(?:and|then|but|also|it|which|that)\b)\w+ ){{0,2}}?{_READ}\b", re.IGNORECASE)
"""Words after a quote that show that it names a sign, as in "the 'Exit' sign reads"."""


@dataclass(frozen=True, slots=True)
class Quote:
    """A quote. ``start`` and ``end`` (exclusive) include the quotation marks, ``text`` does not."""

    text: str
    start: int
    end: int


def quotes_of(text: str) -> list[Quote]:
    """Return the quotes of a cleaned text in order.

    If a quoted sentence itself contains a quote ("The sign reads 'STOP'"), the inner quotes are returned instead.
    """
    opened, quotes = list[tuple[str, int]](), list[Quote]()
    for at, mark in enumerate(text):
        if mark not in "\"'":
            continue
        before, after = text[at - 1 : at] or " ", text[at + 1 : at + 2] or " "
        if not before.isspace() and not after.isalnum() and any(kind == mark for kind, _ in opened):
            while opened[-1][0] != mark:
                opened.pop()
            _close(text, opened.pop()[1], at + 1, quotes)
        elif not before.isalnum() and before not in ".,!?" and not after.isspace():
            opened.append((mark, at))
    if quotes:
        return sorted(quotes, key=lambda quote: quote.start)
    return [Quote(m[1] or m[2], m.start(), m.end()) for m in _PLAIN.finditer(text)]


def _close(text: str, start: int, end: int, quotes: list[Quote]) -> None:
    """Add a closed quote and drop the quotes inside it. If it is a sentence that itself reports a text, keep these instead."""
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
    """Return the quotes that report text from a sign. Denied readings, preset names and names of signs are left out.

    The last quote is not taken for a name: unless it is denied, it is returned.
    """
    readings = list[Quote]()
    for number, quote in enumerate(quotes):
        before = text[quotes[number - 1].end if number else 0 : quote.start]
        after = text[quote.end : quotes[number + 1].start if number + 1 < len(quotes) else len(text)]
        if _DENIED_BEFORE.search(before):
            continue
        is_last = number + 1 == len(quotes)
        is_place = _PLACE_AFTER.match(after) or _PLACE_BEFORE.search(before)
        is_name = _NAMED_AFTER.match(after) and not _INTRODUCED.search(before)
        if is_last or not (is_place or is_name):
            readings.append(quote)
    return readings
