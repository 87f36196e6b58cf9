"""Find wordings that the grammar reads otherwise than they are meant, so that the planner asks instead of moving the camera."""

from __future__ import annotations

import re

_IF = r"\b(?:if|when|unless|until|till|while|once|in case|as soon as|provided)\b"
_UNSAFE = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        # Negated conditions
        rf"{_IF}[^,.;]*?\b(?:can['’]?t|cannot|can not|isn['’]?t|is not|not)(?: be)? (?:read|legible|readable)\b",
        rf"{_IF} (?:you|we|i) (?:can['’]?t|cannot|can not|don['’]?t|do not|aren['’]?t|are not) "
        r"(?:see|seeing|find|finding|spot|notice|make out)\b",
        r"\b(?:if|when) neither [\w ]+? (?:is|are|has|have)\b",
        r"\bthen (?:don['’]?t|do not) do anything\b",
        rf"{_IF}[^,.;]*\b(?:hasn['’]?t|haven['’]?t|has not|have not|everybody has|everyone has) left\b",
        # Conditions on several presets or things
        r"\b(?:if|when|until|till)\b[^,.;]*\bsee both\b",
        r"\bif\b[^,.;]*\bat any (?:preset|of the presets|position|view)\b",
        r"\bif there(?:['’]s| is| are)\b[^,.;]* and (?:one|another|some) (?:at|in|on) (?:the )?\w+",
        r"\bif\b[^,.;]*\bat both\b|\bif there (?:is|are) no [\w ]+? at (?:the )?\w+(?: \w+)? or (?:the )?\w+",
        # Parts that are taken back or undone
        r"\b(?:picture|photo|snap|shot|still)s?\b.*\b(?:don['’]?t|do not) take (?:one|it|any)\b",
        r"^(?=.*\bpan\b)(?=.*\btilt\b).*\bundo the (?:pan|tilt|zoom)\b",
        # Tours with unusual choices
        r"\bevery (?:other|second|third) (?:preset|view|position)\b|\ball (?:the )?other (?:presets|views|positions)\b",
        # Habits and later times
        r"\bfrom now on\b|\btell me before you\b|\bevery (?:now and then|day|morning|hour|night)\b|\beach (?:morning"
        r"|day|hour|night)\b",
        r"\bor until\b",
        # Questions about abilities, and what others think
        r"^how (?:far|close|much|wide) can you (?:pan|zoom|tilt|turn)\b|^shall i (?:pan|zoom|tilt|turn|go)\b|\bcan i "
        r"(?:pan|zoom|tilt) [\w ]*myself\b",
        r"\byou (?:should|to)\b[^.]*(?:;|,|\bbut\b) ?(?:but )?(?:i|we) (?:disagree|don['’]?t|do not)\W*$",
        r"\b(?:some )?people think\b|\bwants? you to\b[^.]*, which is (?:wrong|silly|a mistake)\b",
    )
)
"""Patterns of such wordings."""


def unsafe_wording(instruction: str) -> str | None:
    """Return the words of an instruction that must not be acted on; None if there are none.

    Args:
        instruction: The user's text, with abbreviations written out.
    """
    found = (pattern.search(instruction) for pattern in _UNSAFE)
    return next((match[0].strip(" ,.;") for match in found if match), None)
