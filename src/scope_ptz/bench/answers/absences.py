"""Detect joint denials ("the bin and the drum are not visible") and list items marked as absent ("drum: missing")."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.tokenizer import Word

REMARK_SEPARATOR = re.compile(r"[(:=|→]|\s[-–—]\s|—")
"""Separates a list item from a remark about it."""

_ABSENT_REMARK = re.compile(
    r"not (currently |clearly |actually )?(visible|present|seen|found|there|detected|in (view|sight))\b|"
    r"(absent|missing|none|invisible)\b"
)
"""Remarks that mark a list item as absent."""
_OTHER_THINGS = (
    r"(?P<others>(?:\w+ ){0,8}?(?:"
    r"(?:and|or|nor) (?:\w+ ){1,5}?(?=(?:are|were|can|could|do)\b)|"
    r"(?:or|nor) (?:\w+ ){1,5}?(?=(?:is|was)\b)))"
)
"""The other things in a joint denial, such as "and the drum" in "the bin and the drum are not visible"."""
_DENYING_PREDICATE = (
    r"\w+ (?:(?:all |both |completely )?(?:absent|missing|nowhere)\b|"
    r"not(?: (?:currently|actually|now|yet|even|be|been|\w+ly))?"
    r"(?: (?:visible|present|there|seen|found|shown|here|in (?:view|sight))|$))"
)
"""The predicate of a joint denial, such as "are not visible"."""
_JOINT_DENIAL = re.compile(_OTHER_THINGS + _DENYING_PREDICATE)
_STATING_WORDS = frozenset({
    "i", "we", "you", "it", "see", "sees", "saw", "seen", "find", "found", "is", "are", "was", "were", "has", "have", "shows",
    "show", "shown", "there", "but", "yes", "no", "not", "which", "that", "be", "with", "contains", "spotted", "detected", "none",
    "stands", "stood", "sits", "sat", "waits", "drives", "passes", "appears", "appear", "lies", "leans", "moves", "holds",
    "carries", "hangs", "faces", "rests", "remains",
})  # fmt: skip
"""Words that already make a statement about a thing. A denial after them concerns other things."""

_CROSS = re.compile(r"[\s:|–—-]*[❌✗✘✖]\ufe0f?")
"""A cross that marks a list item as absent, with the separator before it."""


def is_denied_jointly(words: Sequence[Word], start: int, end: int) -> bool:
    """Return whether a thing is denied together with later things, like the bin in "the bin and the drum are not visible"."""
    before = {w.text for w in words[:start] if w.segment == words[start].segment}
    if (_STATING_WORDS - {"but"}).intersection(before):
        return False
    denial = _JOINT_DENIAL.match(" ".join(w.text for w in words[end : end + 20] if w.clause == words[start].clause))
    return denial is not None and not _STATING_WORDS.intersection(denial["others"].split())


def is_listed_as_absent(words: Sequence[Word], end: int) -> bool:
    """Return whether a list marks the thing as absent, as in "Drum: not visible" and "drum - absent"."""
    if end >= len(words) or not REMARK_SEPARATOR.search(words[end].gap):
        return False
    return _ABSENT_REMARK.match(" ".join(w.text for w in words[end : end + 4] if w.clause == words[end].clause)) is not None


def replace_crosses(text: str) -> str:
    """Replace crosses such as ❌ with the word "absent". In lines that contain a denial, remove crosses instead."""
    return "\n".join(map(_replace_cross, text.split("\n")))


def _replace_cross(line: str) -> str:
    if re.search(r"\b(no|not|none|never)\b|n't", line, re.IGNORECASE):
        return _CROSS.sub(" ", line)
    if leading := _CROSS.match(line):
        return f"{line[leading.end() :].strip()}: absent"
    return _CROSS.sub(": absent", line)
