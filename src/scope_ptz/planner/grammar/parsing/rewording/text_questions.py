"""Patterns for questions, counts and conditions in the text of an instruction, with plainer words that mean the same."""

from __future__ import annotations

import re

_TAGS = "right|correct|yeah|is there|are they|is that right"
_INVERTED = r"(?:is|are|does|do|has|have) (?:the|there|any|anyone|anybody|someone|somebody|all|an?)\b"
_JOINED = re.compile(
    rf"(?P<topic>(?:[\w' -]+: )?)(?P<first>(?:{_INVERTED}|how many )[^?,.;:]+?),? "
    rf"and (?P<second>(?:{_INVERTED}|how many )[^?,.;:]+)\?*",
    re.IGNORECASE,
)
_NOT_JOINED = re.compile(r"\b(?:if|or|than|more|fewer|same|both|between|each|total|together|altogether)\b", re.IGNORECASE)
_PRONOUNS = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|that|those|these|this|ones?)\b", re.IGNORECASE)

QUESTIONS = (
    (r"\bppl\b", "people"),
    (r"\bhows\b", "how's"),
    (r"\bwhoever(?:['’]s| is)\b", "the person"),
    (r"\b(he|she|it)['’]s left (?=the|his|her|its|my|our)", r"\1 has left "),
    (rf"^(?:so\s+)?(?:nobody|no[ -]?one)(?:['’]s| is| are) (.+?),? (?:{_TAGS})\?$", r"is anyone \1?"),
    (r"^there (is|are)(?:n['’]t| not) (.+), \1 (?:there|they)\?$", r"\1 there \2?"),
    (r"^you can see (.+), can(?:['’]t| not) you\?$", r"can you see \1?"),
    (r"^((?:what|which|where|who)\b[^.!?]*?) again(?=\?)", r"\1"),
    (r"^(where|what|who)(?: the (?:hell|heck|devil|blazes)| on earth| in the world) (?=is|are)", r"\1 "),
    (
        r"^where(?:['’]s| is| are) ((?:the|that|my|our|his|her) [^?.!,;]+)\?\s*"
        r"show (?:it to me|me the thing|me|us|it|them)\s*[.!]*$",
        r"show me \1",
    ),
    (r"\bwhat(?:['’]s| is) the weather doing\b", "what is the weather like"),
    (r"\bcheck once\b", "check"),
    (r"^look (?=whether|if\b)", "check "),
    (r"\brevert with\b", "tell me"),
    # Counts
    (r"\bseparately (?=on|at|in\b)", ""),
    (r"\bcount (the [^,.;]+?) and (?:then|afterwards|after that) the ", r"count \1 and then count the "),
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
    (r"^how many ([\w ]+?) and how many ([\w ]+?) (?=(?:are )?(?:at|on|in) the )", r"how many \1 and \2 "),
    # Corrections: "how many impala, I mean kudu, are there?", "bikes at the racks? Bike racks I mean"
    (
        r"^((?:how many|number of|count)(?: the)?) [\w ]{2,30}?(?:,|\.{2,3}|…| -+)? "
        r"i mean,? ([\w ]+?),?( (?:are|on|at|in|do|can)\b.*|\W*)$",
        r"\1 \2\3",
    ),
    (r"\bthe (\w+)([?.!])\s*(?:the )?([\w-]+ \1),? i mean\.?$", r"the \3\2"),
    # Conditions
    (
        r"\band if (it|they|he|she) (is|are|isn['’]t|aren['’]t) (?=go |zoom |take |pan |tilt |return |follow |track )",
        r"and if \1 \2, ",
    ),
    (r"^if ([^,]+?),? (?:i|we) can [^,]+, so (?:please )?check(?: it| that)? and if so,? ", r"if \1, "),
)
"""Patterns with the words that replace them."""


def with_separate_questions(text: str) -> str:
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
