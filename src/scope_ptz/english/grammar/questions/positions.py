"""Remove the words for a place in the frame from a description or a question.

"The yellow sign at the bottom" is at the bottom of one view only. After the camera has turned to the sign, it is in the middle.
"""

from __future__ import annotations

import re
from functools import cache

from scope_ptz.english.grammar.closed_class import question_phrases

_FRAME = r"(?:picture|image|view|frame|screen)"


def without_position(text: str) -> str:
    """Return a text without the words that say where in the frame, or how far from the camera, a thing is."""
    region, superlative = _patterns()
    shorter = superlative.sub(" ", region.sub("", text))
    return re.sub(r" +(?=[ ,?.!])", "", shorter).strip()


@cache
def _patterns() -> tuple[re.Pattern[str], re.Pattern[str]]:
    """Return the patterns of regions ("at the bottom", "in the distance") and of superlatives ("leftmost", "nearest")."""

    def either(*kinds: str) -> str:
        found = {" ".join(words) for words, (kind, value) in question_phrases().items() if (kind, value) in wanted or kind in kinds}
        return "|".join(re.escape(words) for words in sorted(found, key=len, reverse=True))

    wanted: set[tuple[str, str]] = set()
    side = either("SIDE")
    part = either("PART")
    zone = either("ZONE")
    wanted = {("SUP", key) for key in ("left", "right", "top", "bottom", "nearest", "furthest")}
    superlative = either()
    # "On the left of the van" is a place beside the van, which stays true.
    region = (
        rf"\s+(?:(?:on|at|in|to|from|towards) (?:the )?(?:very |far )?(?:{side})(?:[ -](?:{side}))?(?: (?:side|{part}))*|{zone})"
    )
    ending = rf"(?: of the {_FRAME})?\b(?! of\b)(?= *(?:$|[,?.!]|(?:say|read|show|open|closed|wear|have|has|is|are|do|does)))"
    return re.compile(region + ending, re.IGNORECASE), re.compile(rf"\s(?:{superlative})(?:\s|$)", re.IGNORECASE)
