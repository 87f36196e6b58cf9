"""Replace remarks, limits, corrections and joined questions in a text by plainer words, before it is split into words."""

from __future__ import annotations

import re

_DIRECTIONS = "left|right|up|down"
_AS_FAR = (
    r"as (?:possible|(?:it|you|she|he|the camera)(?:['’]ll| will| can| could)?(?: ever| possibly)?"
    r"(?: go(?:es)?| tilts?| pans?| turns?| moves?)?)\b"
)
_FORBIDDEN = r"(?:not|n['’]t) (?:allowed|permitted|supposed to be|meant to be)(?: in| on| there| here| it)*"
_NOTHING_ELSE = r"don['’]?t bother|leave it(?: be| alone)?|never mind|forget (?:about )?it|no worries|that['’]s fine|fine"
_CHILDREN = "girl|boy|one|lad|son|daughter|brother|sister"
_INVERTED = r"(?:is|are|does|do|has|have) (?:the|there|any|anyone|anybody|someone|somebody|all|an?)\b"
_SCREEN = r"\bwhat(?:ever)?(?:['’]s| is) (?:up |down |over |out )?there\b"

_OPPOSITES = {"left": "right", "right": "left", "up": "down", "down": "up"}
_TURNED_BACK = re.compile(
    rf"\b({_DIRECTIONS}) (?:by )?(\d+(?:\.\d+)?|[a-z]+(?:[- ][a-z]+)?)(?: ?deg(?:ree)?s?|°)?(?=[ ,;.])[^\d]*"
    rf"\b(?:(?:come|go|move|head|turn|swing|tilt|pan) )?back ({_DIRECTIONS})(?P<again> again)?(?P<end>[.!]?)$",
    re.IGNORECASE,
)
_JOINED = re.compile(
    rf"(?P<topic>(?:[\w' -]+: )?)(?P<first>(?:{_INVERTED}|how many )[^?,.;:]+?),? "
    rf"and (?P<second>(?:{_INVERTED}|how many )[^?,.;:]+)\?*",
    re.IGNORECASE,
)
_NOT_JOINED = re.compile(r"\b(?:if|or|than|more|fewer|same|both|between|each|total|together|altogether)\b", re.IGNORECASE)
_PRONOUNS = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|that|those|these|this|ones?)\b", re.IGNORECASE)

_REPLACEMENTS = tuple(
    (re.compile(pattern, re.IGNORECASE), plain)
    for pattern, plain in (
        # Remarks that ask for nothing
        (r",? shall we\s*[?.!]*$", ""),
        (r"\bhere['’]?s the thing\s*[:,]\s*", ""),
        (r"^oi[,!]?\s+", ""),
        (
            r"(^|[.!] )(?:(?:first|last|next) (?:job|task|stop|thing|order of business)|job one)"
            r"(?: of the (?:day|morning|shift|night)| this morning| today| tonight)?[,:]\s*",
            r"\1",
        ),
        (r",? (?:and|but) make it (?:quick|snappy|fast|sharpish)\b", ""),
        (rf"\b(my|our|the|his|her|their) (?:little|wee|young|small) ({_CHILDREN})\b", r"\1 \2"),
        (r"\b(he|she|it)['’]s left (?=the|his|her|its|my|our)", r"\1 has left "),
        (
            r"(?<=\w), (?!nobody|no[ -]?one|none|neither|who|which|i |we |and |but )((?:the |my |our )?\w+) "
            r"(?:wants?|needs?|asked for|would like) (?:one|a copy)\s*[.!]*$",
            "",
        ),
        (
            rf"^((?:any|is|are|how many|who|do you see|can you see)\b[^?.!;]*\?)\s+"
            r"(?:they|he|she)(?: know(?:s)? (?:that )?(?:they|he|she))?"
            rf"(?:['’]re|['’]s| are| is)? ?(?:{_FORBIDDEN}|mustn['’]t|shouldn['’]t)\s*[.!]*$",
            r"\1",
        ),
        (r"^(how (?:full|busy|deep|high|big|wide|long|tall|crowded)\b[^?]*\?)(?:\s*[\w ]{1,20}\?)+$", r"\1"),
        (r", do (?:i|we) need (?:my|a|an|our) \w+\s*\?", "?"),
        (r"\bwhat(?:['’]s| is) the weather doing\b", "what is the weather like"),
        (r"^(where|what|who)(?: the (?:hell|heck|devil|blazes)| on earth| in the world) (?=is|are)", r"\1 "),
        (rf"\b(if|when|should|in case)\b(.+?)[;,.]\s*(?:if not|otherwise),? (?:{_NOTHING_ELSE})\s*[.!]*$", r"\1\2"),
        # Other words for moves and views
        (rf"\bas (?:far|high|low) (?:to the )?({_DIRECTIONS}) {_AS_FAR}", r"all the way \1"),
        (rf"\b(?:straight |right )?({_DIRECTIONS}),? as (?:far|high|low) {_AS_FAR}", r"all the way \1"),
        (r"\bturn (?:a)?round completely\b", "turn around"),
        (r"\blift the (view|camera|picture|shot)\b", r"raise the \1"),
        (r"\bzoom back (?:out |in )?to (?:how|the way) (?:it|you) (?:was|were)\b", "go back"),
        (r"\breturn to the zoom (?:you|it|we) (?:had|were at|was at)(?: before)?\b", "go back"),
        (r"\b(?:all )?a?round (?:the (?:tower|mast|roof|pole|camera)|you)(?=[.?!,]|$)", "all around"),
        (r"\b(?:anywhere|everywhere) all around\b", "all around"),
        (r"\beverywhere (?:that )?you can see(?: from (?:the \w+|up there|there|here|where you are))?", "everywhere"),
        (rf"\b((?:photo|picture|pic|snap|shot)) of {_SCREEN}", r"\1"),
        (r"\bppl\b", "people"),
        # Counts, questions and corrections
        (r",? each (?:one )?(?:on its own|on their own|separately|individually|by itself)(?=[.!?]|$)", " separately"),
        (r"^((?:\w+ ){1,3}and(?: \w+){1,3}): how many of each\b(?: are there)?([^?]*)\?*$", r"count the \1\2"),
        (
            r"^(\w+) (in|at|on) (the [\w -]+), (\w+) (in|at|on) (the [\w -]+): how many of each\?*$",
            r"count the \1 \2 \3, then count the \4 \5 \6",
        ),
        (
            r"^is it busier at (.+?) or (?:at )?(.+?)\? count the (\w+) at (?:both|each)(?: of them)?\.?$",
            r"count the \3 at \1 and at \2",
        ),
        (
            r"^((?:how many|number of|count)(?: the)?) [\w ]{2,30}?(?:,|\.{2,3}|…| -+)? "
            r"i mean,? ([\w ]+?),?( (?:are|on|at|in|do|can)\b.*|\W*)$",
            r"\1 \2\3",
        ),
        (r"\bthe (\w+)([?.!])\s*(?:the )?([\w-]+ \1),? i mean\.?$", r"the \3\2"),
        (r"^how many ([\w ]+?) and how many ([\w ]+?) (?=(?:are )?(?:at|on|in) the )", r"how many \1 and \2 "),
        (
            r"^where(?:['’]s| is| are) ((?:the|that|my|our|his|her) [^?.!,;]+)\?\s*"
            r"show (?:it to me|me the thing|me|us|it|them)\s*[.!]*$",
            r"show me \1",
        ),
        (r"^keep an eye on (.+?), (?:and )?follow (?:it|him|her|them) for (?=.+$)", r"follow \1 for "),
        (r"^look (?=whether|if\b)", "check "),
        (
            r"\band if (it|they|he|she) (is|are|isn['’]t|aren['’]t) (?=go |zoom |take |pan |tilt |return |follow |track )",
            r"and if \1 \2, ",
        ),
        (r"^if ([^,]+?),? (?:i|we) can [^,]+, so (?:please )?check(?: it| that)? and if so,? ", r"if \1, "),
    )
)
"""Patterns with their replacements."""


def everyday(text: str) -> str:
    """Return a text with "all the way left" for "as far left as you can go", two questions for joined ones, and so on."""
    for pattern, plain in _REPLACEMENTS:
        text = pattern.sub(plain, text)
    return _with_separate_questions(_with_amount_back(text))


def _with_amount_back(text: str) -> str:
    """Return "tilt up 20, then come back down 20 degrees" for "tilt up 20, then come back down"."""
    match = _TURNED_BACK.search(text)
    if match is None or _OPPOSITES[match[1].lower()] != match[3].lower():
        return text
    return f"{text[: match.end(3)]} {match[2]} degrees{match['end']}"


def _with_separate_questions(text: str) -> str:
    """Return "is the bin full? how many cars are there?" for "is the bin full, and how many cars are there?".

    A second question with a pronoun is only separated from a count, whose things the pronoun then refers to.
    """
    match = _JOINED.fullmatch(text.strip())
    if match is None or _NOT_JOINED.search(text):
        return text
    first, second = match["first"], match["second"]
    if _PRONOUNS.search(second) and not first.lower().startswith("how many"):
        return text
    return f"{match['topic']}{first}? {second}?"
