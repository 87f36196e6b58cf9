"""Replace wordings in the text of an instruction by plainer ones, before it is split into words."""

from __future__ import annotations

import re

_VOCATIVES = (
    "driver|sunshine|sweetie|sweetheart|honey|hon|love|darling|pet|duck|lad|lads|guys|folks|gentlemen|ladies|captain|skipper|friend"
    "|my friend|son|bro|bruv|dude|jeeves|james|fella|fellas|champ|big man|mind|mind you|my love|petal|treacle"
)
_GREETINGS = "hey|hi|hello|ok|okay|morning|evening|thanks|cheers|listen|look"
_PICTURES = "photo|picture|pic|snap|shot|still"
_GLANCES = "look|nosy|nosey|gander|peek|butcher['’]s|squiz|shufti|squint|glance"
_TAGS = "right|correct|yeah|is there|are they|is that right"
_ENDS = {"lower": "down", "upper": "up", "left": "left", "right": "right"}
_TURNED = {
    "rotated": "rotate", "panned": "pan", "turned": "turn", "tilted": "tilt", "moved": "move", "zoomed": "zoom", "pointed": "point",
}  # fmt: skip
_REPLACEMENTS = tuple(
    (re.compile(pattern, re.IGNORECASE), plain)
    for pattern, plain in (
        (rf"^([^,]*),\s*(?:{_VOCATIVES})(?=\s*[,.!?;]|\s*$)", r"\1"),
        (rf"^({_GREETINGS})\s+(?:{_VOCATIVES})(?=\s*[,.!])", r"\1"),
        (r"\bwhoever(?:['’]s| is)\b", "the person"),
        (rf"^(?:so\s+)?(?:nobody|no[ -]?one)(?:['’]s| is| are) (.+?),? (?:{_TAGS})\?$", r"is anyone \1?"),
        (r"^there (is|are)(?:n['’]t| not) (.+), \1 (?:there|they)\?$", r"\1 there \2?"),
        (r"^you can see (.+), can(?:['’]t| not) you\?$", r"can you see \1?"),
        (r"^((?:what|which|where|who)\b[^.!?]*?) again(?=\?)", r"\1"),
        (r"^(?:well |right |so )?wait,? (?=what|which|where|who|how)", ""),
        (r"\bhows\b", "how's"),
        (r"\b(?:in|by) (ten|five|twentie|fifteen|thirtie)s (?=until|till|til)", lambda match: _steps(match[1])),
        (rf"\b(?:do|get|give) (?:us|me) (?=(?:a|an|another|one|some) (?:(?!close)\w+ ){{0,2}}(?:{_PICTURES})\b)", "take "),
        (rf"\blet['’]?s have a (?:good |quick |little )?(?:{_GLANCES})\b", "have a look"),
        (r"\b(?:let['’]?s )?do (?:the|my|our|a|a quick|one) rounds?:", ""),
        (
            rf"\bthe camera (?:shall|should|must|needs to|has to) be ({'|'.join(_TURNED)})\b",
            lambda match: _TURNED[match[1].lower()],
        ),
        (r"\bcount (the [^,.;]+?) and (?:then|afterwards|after that) the ", r"count \1 and then count the "),
        (r"\bcheck once\b", "check"),
        (
            r"\b(?:(?:all the way|right|round|around|over) )*"
            r"to (?:the|its) (lower|upper|left|right)(?:most|[- ]hand)? (?:mechanical |physical |end |hard )*(?:limit|stop)\b",
            lambda match: f"all the way {_ENDS[match[1].lower()]}",
        ),
        (r"\bseparately (?=on|at|in\b)", ""),
        (r"\b(?:go|come|move|pull) right (in|out)(?=[.,!;]|$| then\b| and\b)", r"zoom all the way \1"),
        (r"\b(?:please |kindly )?do the needful(?: and|,)?", ""),
        (r"\brevert with\b", "tell me"),
        (r"^(?:one|just one) (?:small|little|more|last|quick) (?:request|thing|favou?r)[,:]\s*", ""),
        (r"^(?:ah |oh |ach |sure )?go on,\s*", ""),
        (r"^heads up[,!:.]\s*", ""),
        (r"^(?:jaysus|jesus|christ|lord|good god|good lord|good grief),\s*", ""),
        (r",\s*(?:grand|lovely|perfect|ta|cheers)\s*[.!]?$", ""),
    )
)
"""Patterns with their replacements."""

_TENS = {"ten": 10, "five": 5, "twentie": 20, "fifteen": 15, "thirtie": 30}


def plainer(text: str) -> str:
    """Return a text with "the person" for "whoever is", without "mate" at the end, and so on."""
    for pattern, plain in _REPLACEMENTS:
        text = pattern.sub(plain, text)
    return text


def _steps(word: str) -> str:
    return f"{_TENS[word.lower()]} degrees at a time "
