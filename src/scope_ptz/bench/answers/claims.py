"""Determine what an answer claims when it names a thing: that the thing is present, that it is absent, or nothing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from enum import Enum, auto

from scope_ptz.bench.answers.tokenizer import Word


class Claim(Enum):
    """A claim about a thing that an answer names.

    ``STATED``: the sentence makes a statement about the thing; whether the thing is denied is determined separately. ``FOUND`` and
    ``NOT_FOUND``: the result of a search. ``NOTHING``: the sentence only mentions a search for the thing or a question about it.
    """

    STATED = auto()
    FOUND = auto()
    NOT_FOUND = auto()
    NOTHING = auto()


def claim_of(words: Sequence[Word], start: int, end: int) -> Claim:
    """Return the claim about the thing that the words from ``start`` to ``end`` (exclusive) name."""
    clause = words[start].clause
    before = "".join(f"{w.text} " for w in words[max(0, start - 30) : start] if w.clause == clause)
    after = "".join(f"{w.text} " for w in words[end : end + 30] if w.clause == clause)
    after_noun = words[end : end + 1]
    if after_noun and after_noun[0].text in _TOOL_WORDS and not after_noun[0].gap.strip():
        return Claim.NOTHING
    if words[start].text in _DIRECTIONS and _CAMERA_MOVE.search(before):
        return Claim.NOTHING
    if _NO_KNOWLEDGE.search(before) or _ONLY_CHECKED.match(after):
        return Claim.NOTHING
    if not _is_only_searched_for(before, after):
        return Claim.STATED
    following = after + "".join(f"{w.text} " for w in words[end : end + 60] if w.clause == clause + 1)
    if _NOT_FOUND_PHRASE.search(following):
        return Claim.NOT_FOUND
    return Claim.FOUND if _FOUND_PHRASE.search(following) else Claim.NOTHING


def _is_only_searched_for(before: str, after: str) -> bool:
    """Return whether the thing is only searched for or asked about, as in "I looked for cones"."""
    questions = list(_QUESTION_WORDS.finditer(before))
    if questions and not _RESULT_WORDS.intersection(before[questions[-1].end() :].split()):
        return True
    searches = list(_SEARCH_PHRASE.finditer(before))
    if not searches or _VISIBILITY.match(after):
        return False
    since = {*before[searches[-1].start() :].split()} - {"see", "find"} | {*before[searches[-1].end() :].split()}
    return not since & (_RESULT_WORDS | _STATING_VERBS)


_QUESTION_WORDS = re.compile(r"\b(whether|if)\b")
_SEARCH_PHRASE = re.compile(
    r"\b(look|looks|looked|looking|search|searches|searched|searching|scan|scans|scanned|scanning|check|checks|checked|checking|hunt|"
    r"hunted|hunting|watch|watched|swept|sweep|query|queried) (\w+ ){0,6}?for\b|\bin search of\b|"
    r"\b(ask|asks|asked|asking|queried|inquired|enquired) (\w+ ){0,5}?(about|after|for)\b|"
    r"\b(try|tried|trying|attempt|attempted|need|needed|want|wanted|going|order|asked|told|instructed|wish) to "
    r"(find|locate|spot|see|detect|count|look at)\b"
)
"""Phrases that announce a search or a question, such as "I looked for" and "asked about"."""
_RESULT_WORDS = frozenset({
    "found", "saw", "sees", "spotted", "detected", "but", "so", "then", "yes", "no", "however", "shows", "revealed", "identified",
})  # fmt: skip
"""Words that introduce the result of a search."""

_STATING_VERBS = frozenset({"see", "find", "is", "are", "was", "were", "has", "have", "there", "reads", "says"})
"""Verbs after a search phrase which show that the sentence states a result."""
_VISIBILITY = re.compile(r"(\w+ ){0,3}?(is|are|was|were) (not )?(visible|present|found|seen|detected|there)\b")
"""Phrases after a thing that state whether it is visible."""
_FOUND_PHRASE = re.compile(
    r"(?<!not )\b(found|find|see|saw|spotted|detected|located) (it|one|them|some|both|several|two|three|four|five|six|[1-9]\d*)\b"
)
"""Results of a search that found something, such as "found two"."""
_NOT_FOUND_PHRASE = re.compile(
    r"\b(found|find|see|saw|spotted|detected|located) (none|nothing|neither|0|zero)\b"
    r"|\bnot (find|found|see|seen|spot|detect|locate)( (it|one|any|them|either)\b| $)"
    r"|\bwithout (success|finding (it|one|any|them))|\bin vain\b|\bto no avail\b|\bthere (is|are|was|were) none\b"
)
"""Results of a search that found nothing, such as "found none" and "without success"."""
_DIRECTIONS = frozenset({"left", "right", "up", "down"})
"""Directions in which the camera can be moved."""
_CAMERA_MOVE = re.compile(
    r"(?:^|\b(?:i|we|camera|after|by|having|then|and|was|is) )(?:\w+ )?"
    r"(?:turned|turning|panned|panning|rotated|rotating|swung|swinging|moved|moving) (?:(?!(?:and|so|it|is|was)\b)\w+ ){0,6}$"
)
"""The beginning of a statement that the camera moved, such as "I turned 20 degrees to the"."""
_TOOL_WORDS = frozenset({"tool", "tools", "detector", "function", "query", "request", "search"})
"""Nouns that follow the name of a thing in the name of a tool or a request ("the car detector")."""
_NO_KNOWLEDGE = re.compile(
    r"\b(no|without|not (?:have|get|got|receive|received|return|returned|give|given|provide|provided)|without any) (?:\w+ ){0,2}?"
    r"(?:information|info|data|results?|answers?|counts?|records?|knowledge|outputs?|response|reports?|details?|idea|reply|figures?|"
    r"detections?|readings?|measurements?) (?:\w+ ){0,5}?(?:about|of|on|for|regarding|concerning) (?:\w+ ){0,3}$"
)
"""Phrases that deny knowledge rather than presence, such as "no information about"."""
_ONLY_CHECKED = re.compile(r"(has|have) (not )?(yet )?been (counted|checked|searched|queried|measured)\b")
"""Phrases after a thing which say that it was checked, but not with what result."""
