"""Recognise replies that only say yes or no."""

from __future__ import annotations

import re
from typing import Literal

_YES = (
    r"(?:yes|yeah|yep|yup|y|sure|ok|okay|confirm(?:ed)?|affirmative|correct|of course|absolutely|go ahead|go on|do it|do that|do so"
    r"|please do|please|by all means|that'?s right|right|roger|fine|all right|alright|carry on|proceed)"
)
_NO = (
    r"(?:no|nope|nah|n|negative|cancel|stop|don'?t|do not|never mind|nevermind|forget it|leave it|better not|not now|thanks"
    r"|thank you|please)"
)
_ALL_YES = re.compile(rf"{_YES}(?: {_YES})*", re.IGNORECASE)
_ALL_NO = re.compile(rf"{_NO}(?: {_NO})*", re.IGNORECASE)
_COURTESIES = frozenset({"please", "thanks", "thank you"})


def yes_or_no(text: str) -> Literal["yes", "no"] | None:
    """Return "yes" or "no" for text that says only that; None for other text, such as "yes, but only 10 degrees"."""
    parts = [part for part in re.split(r"[\s,.!]*[,.!][\s,.!]*", text.strip().replace("’", "'")) if part]
    if not parts or all(part.lower() in _COURTESIES for part in parts):
        return None
    if all(_ALL_YES.fullmatch(part) for part in parts):
        return "yes"
    return "no" if all(_ALL_NO.fullmatch(part) for part in parts) else None
