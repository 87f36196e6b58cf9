"""Detect questions that a camera cannot answer, and instructions that it must refuse."""

from __future__ import annotations

import re

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
    return not (any(re.search(rf"\b{re.escape(phrase)}\b", text) for phrase in off_topic_phrases()) or _ARITHMETIC.search(text))


def is_harmful(instruction: str) -> bool:
    """Return whether an instruction asks to harm or spy on people."""
    return bool(_HARMFUL.search(instruction))
