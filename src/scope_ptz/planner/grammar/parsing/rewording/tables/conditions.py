"""Patterns for conditions and for the order of commands, with plainer wordings in their place."""

from __future__ import annotations

from scope_ptz.english import is_plural

_IFS = "if|when|once|as soon as|in case|provided|unless|until|till|while"
_UNSEEN = (
    r"(?:you|we|i) (?:can['’]?t|cannot|can not|don['’]?t|do not|aren['’]?t|are not) "
    r"(?:see|seeing|find|finding|spot|notice|make out)"
)
_NOUN_END = (
    r"(?=,| (?:go|zoom|pan|tilt|take|turn|move|follow|track|count|return|come|then|otherwise|please|look|swing|tell"
    r"|read|find|show)\b"
    r"|[.;?!]|$)"
)
"""Where the noun phrase of a condition ends."""

_STATE = r"(wide open|open|shut|closed|ajar|empty|idle|unattended|still|unused|vacant|unlocked|unmanned|dark)"

CONDITIONS = (
    (
        r"^(if) (?:the )?((?!the |there|it|you|we|i |any|no |some|that|this|he |she |they )"
        r"(?:(?!\b(?:is|are|was|were|has|have|can|(?:look|seem|stay|stand|sit|lie|remain|hang)s?)\b)[\w ])+?) "
        r"(open|shut|closed|locked|unlocked|empty|full|blocked|clear|lit|occupied|flooded),? "
        r"(?=(?:then )?(?:take|pic|photo|snap|count|zoom|go|tell|report|pan|tilt)\b)",
        lambda match: f"{match[1]} the {match[2]} {'are' if is_plural(match[2].split()[-1]) else 'is'} {match[3]}, ",
    ),
    (rf"\b({_IFS}) {_UNSEEN} (?:anyone|anybody|any people){_NOUN_END}", r"\1 there is nobody"),
    (rf"\b({_IFS}) {_UNSEEN} (?:any|an?) ([\w -]+?){_NOUN_END}", r"\1 there is no \2"),
    (rf"\b({_IFS}) {_UNSEEN} (the [\w -]+?){_NOUN_END}", r"\1 \2 is not in view"),
    (rf"\b({_IFS}) ((?:the |an? )[\w -]+?) has left(?! (?:the|an?|his|her|its|it|my|some)\b)", r"\1 \2 is not in view"),
    (rf"\b({_IFS}) ((?:the )[\w -]+?) have left(?! (?:the|an?|his|her|its|it|my|some)\b)", r"\1 \2 are not in view"),
    (rf"\b({_IFS}|whether) ((?:the|that|my|our|an?) [\w -]+?) (?:stands|sits|lies|remains|stays|hangs) {_STATE}\b", r"\1 \2 is \3"),
    (rf"\b({_IFS}|whether) ((?:the|my|our|those) [\w -]+?) (?:stand|sit|lie|remain|stay|hang) {_STATE}\b", r"\1 \2 are \3"),
    (r",? (?:and )?once it(?:['’]s| is) there,? (?:please )?(?=\w)", ", then "),
    (
        r",? (?:and,? |then,? )?(?:once|when|after) (?:that|the|this) (?:move|movement|turn|pan|tilt|zoom) (?:has|is) "
        r"(?:finished|done|complete|completed|ended|over),? ",
        ", then ",
    ),
    (r",? when you(?:['’]ve| have) (?:done|finished)(?: that| this| so)?,? ", " "),
    (r",? (?:and,? )?once (?:we|you) are there,? ", ", then "),
    (r"\bonce there(?:['’]s| is) ", "when there is "),
    (r"\bonce there are ", "when there are "),
    (r"^(?:is|are) there ([^?,]+)\? then ([^?]+)", r"if there is \1, \2"),
    (r"^(is|are) there ([^?,]+), (follow|zoom in on) (it|them|him|her)\b", r"if there \1 \2, \3 \4"),
)
"""Patterns with the words that replace them."""
