"""Find statements that take back, forbid or change what the rest of an instruction asks for."""

from __future__ import annotations

import re

_NUMBER = r"(?:\d+|ten|twelve|fifteen|twenty|thirty|forty|fifty|sixty|ninety)"
_STATEMENTS = (
    re.compile(
        r"\b(?:nobody|no one|we|i|you|he|they)\b[^.;?!]{0,20} (?:are|is|am|was|were)(?: not|n['’]t)? allowed to\b"
        r"|\bnot to be (?:moved|touched|used|turned|disturbed|operated)\b"
        r"|\bmust(?:n['’]t| not| never) (?:do (?:this|that|it|so)|move|touch (?:it|the camera)|use (?:it|the camera))\b"
        r"|\b(?:i|we) (?:take|took) (?:that|it|this) back\b"
        r"|\byou should(?: not|n['’]t)? have (?:asked|waited|done)\b"
        r"|\b(?:check|clear it|talk) with (?:me|him|her|us|them) first\b|\bask (?:me|him|her|us|them) first\b"
        r"|\bwithout asking\b.{0,20}\b(?:not|never)\b"
        r"|\b(?:i|we)(?: would|['’]d) rather (?:have|see|not|do|go)\b(?! a closer)"
        r"|\b(?:only|just) (?:want|need|meant) half\b|\b(?:need|want)s? it (?:twice|half)\b",
        re.IGNORECASE,
    ),
    re.compile(
        rf"[,.;] (?:my \w+ |he |she |i |we |they )?(?:says? |said |think |thinks |reckons? )?{_NUMBER}(?: degrees)? (?:is|will be) "
        rf"(?:enough|plenty|too much|fine|right|better)\b",
        re.IGNORECASE,
    ),
)


def withdrawing_statement(instruction: str) -> str | None:
    """Return the words that take back, forbid or change a command; None if there are none.

    Args:
        instruction: The user's text.
    """
    found = (pattern.search(instruction) for pattern in _STATEMENTS)
    return next((match[0].strip(" ,.;") for match in found if match), None)
