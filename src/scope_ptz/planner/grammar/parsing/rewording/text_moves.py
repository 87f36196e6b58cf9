"""Patterns for moves, limits, views and pictures in the text of an instruction, with plainer words that mean the same."""

from __future__ import annotations

_PICTURES = "photo|picture|pic|snap|shot|still"
_GLANCES = "look|nosy|nosey|gander|peek|butcher['’]s|squiz|shufti|squint|glance"
_ENDS = {"lower": "down", "upper": "up", "left": "left", "right": "right"}
_TURNED = {
    "rotated": "rotate", "panned": "pan", "turned": "turn", "tilted": "tilt", "moved": "move", "zoomed": "zoom", "pointed": "point",
}  # fmt: skip
_TENS = {"ten": 10, "five": 5, "twentie": 20, "fifteen": 15, "thirtie": 30}
_DIRECTIONS = "left|right|up|down"
_END = r"(?=\s*(?:[.,;!?]|$|and\b|then\b|please\b))"
_AS_FAR = (
    r"as (?:possible|(?:it|you|she|he|the camera)(?:['’]ll| will| can| could)?(?: ever| possibly)?"
    rf"(?: go(?:es)?| tilts?| pans?| turns?| moves?)?){_END}"
)
_MAST = "tower|mast|roof|pole|camera"

MOVES = (
    (r"\b(?:in|by) (ten|five|twentie|fifteen|thirtie)s (?=until|till|til)", lambda match: _steps(match[1])),
    (rf"\b(?:do|get|give) (?:us|me) (?=(?:a|an|another|one|some) (?:(?!close)\w+ ){{0,2}}(?:{_PICTURES})\b)", "take "),
    (rf"\blet['’]?s have a (?:good |quick |little )?(?:{_GLANCES})\b", "have a look"),
    (
        rf"\bthe camera (?:shall|should|must|needs to|has to) be ({'|'.join(_TURNED)})\b",
        lambda match: _TURNED[match[1].lower()],
    ),
    (
        r"\b(?:(?:all the way|right|round|around|over) )*"
        r"to (?:the|its) (lower|upper|left|right)(?:most|[- ]hand)? (?:mechanical |physical |end |hard )*(?:limit|stop)\b",
        lambda match: f"all the way {_ENDS[match[1].lower()]}",
    ),
    (r"\b(?:go|come|move|pull) right (in|out)(?=[.,!;]|$| then\b| and\b)", r"zoom all the way \1"),
    (rf"\bas (?:far|high|low) (?:to the )?({_DIRECTIONS}) {_AS_FAR}", r"all the way \1"),
    (rf"\b(?:straight |right )?({_DIRECTIONS}),? as (?:far|high|low) {_AS_FAR}", r"all the way \1"),
    (r"\bturn (?:a)?round completely\b", "turn around"),
    (r"\blift the (view|camera|picture|shot)\b", r"raise the \1"),
    (r"\bzoom back (?:out |in )?to (?:how|the way) (?:it|you) (?:was|were)\b", "go back"),
    (r"\breturn to the zoom (?:you|it|we) (?:had|were at|was at)(?: before)?\b", "go back"),
    (rf"\b(?:all )?a?round (?:the (?:{_MAST})|you)(?=[.?!,]|$)", "all around"),
    (r"\b(?:anywhere|everywhere) all around\b", "all around"),
    (rf"\beverywhere (?:that )?you can see(?: from (?:the (?:{_MAST})|up there|there|where you are))?{_END}", "everywhere"),
    (rf"\b((?:{_PICTURES})) of what(?:ever)?(?:['’]s| is) (?:up |down |over |out )?there\b", r"\1"),
    (r"^keep an eye on (.+?), (?:and )?follow (?:it|him|her|them) for (?=.+$)", r"follow \1 for "),
)
"""Patterns with the words, or the function of the match, that replace them."""


def _steps(word: str) -> str:
    return f"{_TENS[word.lower()]} degrees at a time "
