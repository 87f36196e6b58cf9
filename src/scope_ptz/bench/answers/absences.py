"""Denials of several things at once, and absences that are marked in a list."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.tokenizer import Word

MARK = re.compile(r"[(:=|→]|\s[-–—]\s|—")
"""Separator between a thing and the remark about it in a list."""

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
"""Words that already say something about a thing. A denial after them is about other things."""

_CROSS = re.compile(r"[\s:|–—-]*[❌✗✘✖]\ufe0f?")


def is_denied_jointly(words: Sequence[Word], start: int, end: int) -> bool:
    """Return whether a joint denial includes the words, as "the bin and the drum are not visible" includes the bin."""
    before = {w.text for w in words[:start] if w.segment == words[start].segment}
    if (_TELLS - {"but"}).intersection(before):
        return False
    joined = _JOINTLY.match(" ".join(w.text for w in words[end : end + 20] if w.clause == words[start].clause))
    return joined is not None and not _TELLS.intersection(joined["others"].split())


def is_listed_as_absent(words: Sequence[Word], end: int) -> bool:
    """Return whether a list marks the thing as absent: "Drum: not visible", "drum - absent"."""
    if end >= len(words) or not MARK.search(words[end].gap):
        return False
    return _LISTED.match(" ".join(w.text for w in words[end : end + 4] if w.clause == words[end].clause)) is not None


def uncrossed(text: str) -> str:
    """Replace crosses such as ❌ by the word "absent". A cross next to a denial is removed."""
    return "\n".join(map(_uncrossed, text.split("\n")))


def _uncrossed(line: str) -> str:
    if re.search(r"\b(no|not|none|never)\b|n't", line, re.IGNORECASE):
        return _CROSS.sub(" ", line)
    if leading := _CROSS.match(line):
        return f"{line[leading.end() :].strip()}: absent"
    return _CROSS.sub(": absent", line)
