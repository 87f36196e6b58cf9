"""Find commands that were mistakenly parsed as part of a description or question.

A description must be a noun phrase. Neither a description nor a question may contain angles, conditions or commands.
"""

from __future__ import annotations

import re

_DIRECTION = r"(?:left|right|up|down|in|out|home|back|closer|wider|clockwise|anticlockwise)"
_VERB = r"(?:pan|tilt|zoom|swivel|nudge|slew|yaw)"
_ANY_VERB = rf"(?:{_VERB}|turn|rotate|swing|move|go|look|point|aim|angle|tip|pitch|return|switch)"
_NO_NOUN_PHRASE = re.compile(
    r"\bin \d+ (?:minutes?|hours?|seconds?)\b.*|\b(?:tomorrow|tonight|later)$|\bgo home\b.*|\bstay$|\bpeople left\b.*"
    r"|\bby (?:noon|midnight)$|\b(?:twice|former|latter)$|\bfor \d+\w*$|\b\d+ more$|"
    r"^(?:current|present|whole|full) (?:view|picture|scene|frame|image)\b.*|^(?:all )?directions$|"
    r"^(?:how many|how much|whether|if|then|until|while|what|which|who|where|from|at|into|looked|counted|checked|seen)\b.*"
    r"|\b(?:as )?compared (?:to|with)\b.*"
    r"|^(?:the )?(?:left|right|up|down) (?:at|by|near|of|off|over|past|to|towards?|until|beside|behind|under)\b.*"
    r"|\b(?:are|is|were|was) there (?:at|by|from)\b.*|\bin the (?:whole|entire|full) (?:scene|area|site|view)\b.*",
    re.IGNORECASE,
)
_JOINED = r"(?:\b(?:and|then|but|to)\b|[,;.])\W*(?:then |please |also )*"
"""The words that can begin another clause."""

_PICTURE = r"(?:photo|picture|snapshot|screenshot|image|shot)s?\b"
_COMPOUND = r"(?!.*\d)\w+(?:$| (?:at|by|in|near|on|with)\b)"
"""What follows a verb that is part of a noun: "tilt truck by the wall"."""

_SWALLOWED = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        rf"(?:^|\bor |{_JOINED}){_ANY_VERB} (?:the camera |it |back )*{_DIRECTION}\b.*",
        rf"(?:^{_VERB}\b(?! {_COMPOUND})|{_JOINED}{_VERB}\b).*",
        rf"{_JOINED}(?:take|snap|grab|save|capture) (?:a|an|the|one|two|another|\d+)? ?(?:\w+ )?{_PICTURE}.*",
        rf"{_JOINED}(?:go|return|move|come|switch) (?:back )?(?:to )?(?:the )?(?:home|preset)\b.*",
        r"(?:\b(?:and|then|but)\b|[,;.])\W*(?:then |please |also )*(?:count|photograph|track|follow) .*",
        r"-?\d+(?:\.\d+)? ?(?:°|degrees?\b|deg\b).*",
        rf"{_JOINED}(?:stop|stay|remain) (?:at|on|when|once|where)\b.*",
        r"^(?:the )?(?:sum|total) of\b.*",
        r"^see (?:the|my|our)\b.*",
        r"\b(?:left|right|up|down) (?:by )?\d+$",
        r"\b(?:otherwise|unless|if so|if not|if any)\b.*",
        r"\bif (?:you|we|i|the camera) (?:were to )?(?:pan|tilt|zoom|turn|mov|swung)\w*\b.*",
        r"\bcamera (?:panned|tilted|zoomed|turned)\b.*",
        r"\b(?:forget|never mind) (?:it|that)\b.*",
        r"\bso (?:can|could) you\b.*",
        r"^(?:list|name) (?:the|all|your|my) (?:presets|positions|views)\b.+",
        r"^What (?:is|are) .*\bto (?:open|close|move|stop|come|get|go|leave|wait|clear|pick|put|bring|shut|step|hurry)\b.*",
        r", (?:I|we|he|she|they) (?:sent|have|had|want|need|think|reckon|said|told|saw|left)\b.*",
        r"\bI (?:say|said|tell|told|shout|signal)\b.*",
    )
)
"""Patterns of commands, angles and conditions, each up to the end of the text."""


def swallowed_command(text: str, *, is_thing: bool) -> str | None:
    """Return the part of a description or question that is a command; None if there is none.

    Args:
        text: The description or question.
        is_thing: Whether it is a description, which must not be a question either.
    """
    for pattern in (_NO_NOUN_PHRASE, *_SWALLOWED) if is_thing else _SWALLOWED:
        if match := pattern.search(text):
            return match[0].strip(" ,;.?!")
    return None
