"""Saying of several things at once, or in a list with marks, that they are not there."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.tokenizer import Word

MARK = re.compile(r"[(:=|→]|\s[-–—]\s|—")
"""Between a thing and what is noted of it in a list."""

_LISTED = re.compile(
    r"not (currently |clearly |actually )?(visible|present|seen|found|there|detected|in (view|sight))\b|"
    r"(absent|missing|none|invisible)\b"
)
_SEVERAL = (
    r"(?P<others>(?:\w+ ){0,8}?(?:"
    r"(?:and|or|nor) (?:\w+ ){1,5}?(?=(?:are|were|can|could|do)\b)|"
    r"(?:or|nor) (?:\w+ ){1,5}?(?=(?:is|was)\b)))"
)
_ARE_NOT = (
    r"\w+ (?:(?:all |both |completely )?(?:absent|missing|nowhere)\b|"
    r"not(?: (?:currently|actually|now|yet|even|be|been|\w+ly))?"
    r"(?: (?:visible|present|there|seen|found|shown|here|in (?:view|sight))|$))"
)
_JOINTLY = re.compile(_SEVERAL + _ARE_NOT)
_TELLS = frozenset({
    "i", "we", "you", "it", "see", "sees", "saw", "seen", "find", "found", "is", "are", "was", "were", "has", "have", "shows",
    "show", "shown", "there", "but", "yes", "no", "not", "which", "that", "be", "with", "contains", "spotted", "detected", "none",
    "stands", "stood", "sits", "sat", "waits", "drives", "passes", "appears", "appear", "lies", "leans", "moves", "holds",
    "carries", "hangs", "faces", "rests", "remains",
})  # fmt: skip
"""Words that say something of a thing, so that what follows is said of others only."""

_CROSS = re.compile(r"[\s:|–—-]*[❌✗✘✖]\ufe0f?")


def is_denied_jointly(words: Sequence[Word], start: int, end: int) -> bool:
    """ "The bin and the drum are not visible": of the first as of the last, where nothing else is said of the first."""
    before = {w.text for w in words[:start] if w.segment == words[start].segment}
    if (_TELLS - {"but"}).intersection(before):
        return False
    joined = _JOINTLY.match(" ".join(w.text for w in words[end : end + 20] if w.clause == words[start].clause))
    return joined is not None and not _TELLS.intersection(joined["others"].split())


def is_listed_as_absent(words: Sequence[Word], end: int) -> bool:
    """ "Drum: not visible", "drum - absent"."""
    if end >= len(words) or not MARK.search(words[end].gap):
        return False
    return _LISTED.match(" ".join(w.text for w in words[end : end + 4] if w.clause == words[end].clause)) is not None


def uncrossed(text: str) -> str:
    """A thing with a cross beside it as what the cross says: that it is absent. Beside a denial a cross adds nothing."""
    return "\n".join(map(_uncrossed, text.split("\n")))


def _uncrossed(line: str) -> str:
    if re.search(r"\b(no|not|none|never)\b|n't", line, re.IGNORECASE):
        return _CROSS.sub(" ", line)
    if leading := _CROSS.match(line):
        return f"{line[leading.end() :].strip()}: absent"
    return _CROSS.sub(": absent", line)
