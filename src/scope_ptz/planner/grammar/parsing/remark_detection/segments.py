"""Split an instruction into segments, each of which may be a remark."""

from __future__ import annotations

import re
from dataclasses import dataclass

_BOUNDARY = re.compile(
    r"(?:[,;.!?]+|:| -+| –| —)\s+"
    r"|\s+(?=(?:and|but|so|because|cos|as|since|for|before|while|if|then|until|unless|when)\b)"
    r"|\s+(?=(?:i|i['’]m|i['’]ve|we|we['’]ve|he['’]s|she['’]s|they|there['’]s|it['’]s|please|can you|could you)\b)",
    re.IGNORECASE,
)
"""Punctuation, and the words with which a clause often begins where punctuation is missing."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of an instruction.

    Attributes:
        text: Its words.
        start: The index of its first character in the instruction.
        end: The index after its last character.
        mark: The punctuation after it; empty if there is none.
    """

    text: str
    start: int
    end: int
    mark: str


def segments_of(text: str) -> tuple[Segment, ...]:
    """Return the segments of a text in order."""
    found: list[Segment] = []
    start = 0
    for boundary in _BOUNDARY.finditer(text):
        if boundary.start() > start:
            found.append(Segment(text[start : boundary.start()], start, boundary.start(), boundary[0].strip()))
            start = boundary.end()
    if start < len(text):
        found.append(Segment(text[start:], start, len(text), ""))
    return tuple(found)
