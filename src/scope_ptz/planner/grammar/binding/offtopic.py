"""Detect questions that a camera cannot answer, and instructions that it must refuse."""

from __future__ import annotations

import re

from scope_ptz.english import singular
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.planner.grammar.lexing.lexicon import off_topic_phrases

_ARITHMETIC = re.compile(r"\d\s*[-+*/×]\s*\d|\bwhat(?:'s| is) \d+\b")
_HARMFUL = re.compile(
    r"\b(spy(?:ing)? on|stalk|peep|undress|naked|kill|shoot at|attack|murder|assassinate|rob the|break into|burgle"
    r"|aim (?:the|a) (?:gun|weapon|rifle)|harass|blackmail|bomb the)\b|\b(bedroom|bathroom|changing room) window",
    re.IGNORECASE,
)
_CLOCK = re.compile(r"\b(clocks?|watch|sundial|display|timetable|scoreboard|departure board)\b")
REFUSAL = "I will not help with that: this camera is not for harming or spying on people."


def is_about_the_scene(question: str) -> bool:
    """Return whether a picture could answer a question: False for arithmetic, general knowledge and similar topics."""
    text = " ".join(question.lower().replace("’", "'").split())
    if _CLOCK.search(text):
        return True  # "what is the time on the station clock?"
    return not (any(_is_topic(phrase, text) for phrase in off_topic_phrases()) or _ARITHMETIC.search(text))


def _is_topic(phrase: str, text: str) -> bool:
    """Return whether a text is about a phrase, and does not just contain it in the name of a thing ("news" in "news kiosk")."""
    founds = re.finditer(rf"\b{re.escape(phrase)}\b(?: ([a-z]+))?", text)
    return any(" " in phrase or not found[1] or lexicon().concept(singular(found[1])) is None for found in founds)


def is_harmful(instruction: str) -> bool:
    """Return whether an instruction asks to harm or spy on people."""
    return bool(_HARMFUL.search(instruction))
