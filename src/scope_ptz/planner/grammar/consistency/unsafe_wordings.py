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
        r"\bplease (?:don['’]?t|do not|no)\W*$|\b(?:nah|oh no)\W*$",
        r"\d (?:uh,? )?sorry (?:zoom|tilt|pan|go|take)\b",
        # Conditions that would be lost, or read as others
        r"\bbut not (?:if|when)\b|\band only then\b",
        r"\b(?:make sure|check that|ensure)\b[^.;]*\b(?:before (?:you )?(?:zoom|pan|tilt|go|turn|mov)|then (?:go|zoom"
        r"|pan|tilt|turn))\w*\b",
        r"\bif (?:all|both|every|either|any of) (?:of )?(?:the )?\w+ (?:is|are)\b",
        r"\bif the (?:temperature|speed|number|price|pressure|reading) is (?:above|over|below|under|more|less|at least)\b",
        r"\bif the [\w ]+? says? (?:go|turn|stop)\b",
        r"\bif (?:someone|somebody|anyone|anybody) (?:isn['’]?t|is not|doesn['’]?t|does not)\b",
        r"\bif (?:the \w+|someone|somebody) (?:has )?left (?:an?|the|his|her|their)\b",
        # Remarks, reports and questions about others with words for commands
        r"\b(?:thanks|thank you|sorry|well done)(?: for)? (?:zooming|panning|going|tilting|turning|moving|the picture)\b",
        r"\b(?:zoom|pan|tilt|go|turn|picture)\w*\b[^.;,]*\b(?:doesn['’]?t|didn['’]?t|does not|did not) (?:work|help)\b",
        r"\b(?:told|asked) me to\b.*\b(?:and i did|but i (?:refused|won['’]?t|will not|did not|didn['’]?t))\b",
        r"^(?:the \w+|they|he|she|my \w+) (?:wants?|needs?) to go\b",
        r"^(?:could|will|can|may|should|would|must) (?:the|an?|my|our) (?!camera|view|picture|lens|image)\w+ (?:go"
        r"|take|zoom|pan|tilt|turn)\b",
        r"^(?:good|nice|great|lovely|beautiful) (?:picture|photo|shot)\W*$",
        r"\bshow (?:me|us) the (?:last|previous|earlier) (?:picture|photo|image)\b|\bfollow the (?:rules|instructions"
        r"|procedure)\b|\bwatch your\b",
        # Orders, ways and amounts
        r"\b(?:last|second),? (?:and )?the [\w ]+? first\W*$|, but the [\w ]+ first\W*$|\blastly\b.*\bfirstly\b",
        r"\bzoom \w+(?: in)? (?:this|any) way\b|\bsome of the way\b|\btimes \d+x\b",
        r"\b(?:left|right|up|down) \d+ [udlr]\W*$",
        r"\bzoom in (?:on (?:each|every)\b|only on (?:week|mon|tues|wednes|thurs|fri|satur|sun)|on my (?:signal|mark|command))",
        # Tours with unusual choices
        r"\bevery (?:other|second|third) (?:preset|view|position)\b|\ball (?:the )?other (?:presets|views|positions)\b",
        # Habits and later times
        r"\bfrom now on\b|\btell me before you\b|\bevery (?:now and then|day|morning|night)\b|\beach (?:morning"
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
