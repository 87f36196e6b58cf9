"""Rewrite wordings in which only the name of a preset shows what is meant."""

from __future__ import annotations

import re
from functools import lru_cache

from scope_ptz.english import is_plural

_STATES = (
    "open|shut|closed|locked|unlocked|clear|empty|full|free|busy|quiet|blocked|wet|dry|lit|occupied|flooded|icy|manned|staffed|"
    "on|off|up|down|raised|lowered"
)
_COUNTS = r"(?:how many|number of|count(?: the)?|total(?: of)?)"


@lru_cache(maxsize=64)
def _names(presets: tuple[str, ...]) -> str:
    """Return a pattern for the names of the presets, with spaces or hyphens between their words."""
    each = (r"[-_ ]".join(re.escape(word) for word in re.findall(r"[^\W_]+", preset)) for preset in presets)
    return "|".join(sorted((name for name in each if name), key=len, reverse=True))


def with_places_named(text: str, presets: tuple[str, ...]) -> str:
    """Return "count the vans at the yard" for "vans count, yard", "is the yard clear?" for "yard clear?", and so on."""
    if not (names := _names(presets)):
        return text
    text = _without_apostrophes(text, presets)
    for pattern, plain in (
        (rf"^right,? (?=(?:the )?(?:{names}) first\b)", ""),
        (rf"^(?:the )?({names}) first, (?:then )?", r"go to the \1, then "),
        (
            rf"^(?:does|do|has|have) (?:the )?({names}) or (?:the )?({names}) (?:have|got|has|hold) more ([\w ]+?)(?: "
            rf"in it| there| on it)?\?*$",
            r"which has more \3, \1 or \2?",
        ),
        (rf"\bgo 2 (?=(?:the )?(?:{names})\b)", "go to "),
        (rf"^({_COUNTS} [\w ]+?)[,:] (?:the )?({names})\W*$", r"\1 at the \2"),
        (
            rf"^(\w+) count[,:]? (?:at )?(?:the )?({names}) (?:vs\.?|versus|v) (?:the )?({names})\W*$",
            lambda match: f"count the {_plural(match[1])} at the {match[2]} and at the {match[3]}",
        ),
        (
            rf"^where(?:'s| is| are) (?:there )?more ([\w ]+?),? (?:(?:at|in|on|near|by) )?(?:the )?({names}) "
            rf"or (?:(?:at|in|on|near|by) )?(?:the )?({names})\W*$",
            r"which has more \1, \2 or \3?",
        ),
        (
            rf"^(?:(?:two|three|four|\d) )(?:stills|photos|pictures|pics|shots|snaps): (?:the )?({names})(?:,| and|, then| then) "
            rf"(?:the )?({names})\W*$",
            r"take a picture at the \1 and at the \2",
        ),
        (
            rf"^(?:is )?(?:the )?((?:{names})(?: \w+)?) ((?:{_STATES})(?: or (?:{_STATES}))?(?: yet| still| now| again)?)\?",
            lambda match: f"{'are' if is_plural(match[1].split(' ')[-1]) else 'is'} the {match[1]} {match[2]}?",
        ),
        (rf"\bsee (?:the )?({names}) (?:car ?park|parking|area|place|side|bit)\b", r"see the \1"),
    ):
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text


def _without_apostrophes(text: str, presets: tuple[str, ...]) -> str:
    """Return a text with "kids pool" for "kids' pool" and "kid's pool", if a preset has that name."""
    for preset in presets:
        words = re.findall(r"[^\W_]+", preset)
        if len(words) > 1 and words[0].lower().endswith("s"):
            stem = re.escape(words[0][:-1])
            text = re.sub(rf"\b({stem})(?:s['’]|['’]s)(?= {re.escape(' '.join(words[1:]))}\b)", r"\1s", text, flags=re.IGNORECASE)
    return text


def _plural(noun: str) -> str:
    return noun if is_plural(noun) else f"{noun}s"
