"""Put the settings of the camera before the question that they serve.

"How many planters are there? To find out, move to the forecourt." becomes "Move to the forecourt. How many planters are there?".
"""

from __future__ import annotations

import re

_ASKS = re.compile(
    r"(?:please |could you |can you |would you |i'd like you to )*"
    r"(?:let me know|tell me|i (?:need|want|would like) to know|i'd like to know|report|say|note|check|what|what's|which|who|where"
    r"|how|is|are|does|do|can you see|from|out of|count|in which|at which|add up|put)\b",
    re.IGNORECASE,
)
_PURPOSE = (
    r"(?:(?:in order )?to (?:find (?:it |that |this )?out|see(?: that| it)?|check(?: that| it)?|answer(?: that| this| it)?)"
    r"|for (?:that|this))"
)
_PATTERNS = tuple(
    re.compile(pattern, re.IGNORECASE | re.DOTALL)
    for pattern in (
        rf"(?P<asked>.+?)[.?;:!,]\s*{_PURPOSE},?\s+(?P<moves>[^?]+?)[.!\s]*",
        r"(?P<asked>.+):\s*(?P<moves>[^?:]+?),?\s+and (?:then )?(?:have a |take a )?look(?: there)?[.!\s]*",
        rf"(?P<asked>.+?)[.?]\s+(?P<moves>(?:[^?.]|\.(?=\d))+?)\s+{_PURPOSE}[.!\s]*",
        r"(?P<asked>.+?)[.?!]\s*you(?:'ll| will)? (?:have|need) to (?P<moves>[^?]+?)(?: for (?:that|this|it))?[.!\s]*",
    )
)
_IF_ANY = re.compile(
    r"(\b(?:what|which|where|who)\b[^.?!;]*?),? if (?:there (?:is|are)|(?:you|i|we) (?:can )?see) (?:one|any|some)"
    r"(?=\s*(?:[.?!:]|$))",
    re.IGNORECASE,
)
"""The pattern for a question that ends with "if there is one", which says nothing that an answer does not say."""

_LOOKS = re.compile(r"\b(?:how many|what|which|count|tell me|let me know|who|where|if|unless|until)\b", re.IGNORECASE)


_PARK = re.compile(
    r"(^|[,;.]\s*|\b(?:and|then|please|now)\s+)park (?:the camera |it |yourself )?(?:at|on|over|by|in)\b(?= \w)", re.IGNORECASE
)
"""To park the camera is to send it home, but to park it at a preset is to go there."""


_FROM = re.compile(
    r"(?P<asked>[^.?!]+)\?\s*\(?(?:(?:please )?(?:look|check)(?: it)? (?:from|at|in)|from|use) "
    r"(?P<place>[^.?!,;:)]+?)(?:,? please)?\)?[.!]?",
    re.IGNORECASE,
)
"""A question with the place to look from: "Are there any dogs? Check from fence-east."."""


def with_settings_first(text: str) -> str:
    """Return an instruction with the moves before the question, if its words say that the moves serve the question."""
    text = _PARK.sub(r"\1go to", _IF_ANY.sub(r"\1", text))
    plain = text.strip()
    if (match := _FROM.fullmatch(plain)) and _ASKS.match(match["asked"]) and " and " not in match["place"]:
        return f"Go to {match['place']}. {match['asked']}?"
    for pattern in _PATTERNS:
        match = pattern.fullmatch(plain)
        if match and _ASKS.match(match["asked"]) and not _LOOKS.search(match["moves"]):
            moves = match["moves"].strip()
            mark = "?" if plain[match.end("asked") : match.end("asked") + 1] == "?" else "."
            return f"{moves[:1].upper()}{moves[1:]}. {match['asked'].strip()}{mark}"
    return text
