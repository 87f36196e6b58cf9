"""Parse numbers in words and digits, such as "a dozen", "one hundred and two" and "1,031"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.tokenizer import Word
from scope_ptz.english.numerals import CARDINALS, SCALES, TENS, UNITS

_BEFORE_ONE = frozenset({
    "is", "are", "was", "were", "be", "see", "sees", "seeing", "count", "counted", "counts", "find", "found", "shows",
    "show", "only", "just", "exactly", "about", "of", "total", "make", "makes", "has", "have", "there", "contains",
    "equals", "answer", "with", "precisely", "and", "least", "most", "than", "by",
})  # fmt: skip
"""Words after which "one" is a number rather than a pronoun."""


def number_at(words: Sequence[Word], at: int) -> tuple[float | None, int]:
    """Return the number that begins at position ``at`` and the position after it, or (None, ``at``) if no number begins there."""
    if at >= len(words):
        return None, at
    text, after = words[at].text, [w.text for w in words[at + 1 : at + 3]]
    if text[0].isdecimal():
        value = float(text.replace(",", ""))
        return (-value if re.search(r"(^|\s)-$", words[at].gap) else value), at + 1
    if text == "half" and after == ["a", "dozen"]:
        return 6.0, at + 3
    if text in ("a", "one") and after[:1] in (["dozen"], ["hundred"], ["thousand"]):
        return _number_words(words, at + 1)
    if text == "pair" and after[:1] == ["of"]:
        return 2.0, at + 2
    if text == "one" and at > 0 and words[at - 1].segment == words[at].segment and words[at - 1].text not in _BEFORE_ONE | {"not"}:
        return None, at
    if text == "one" and after[:1] == ["of"]:
        return None, at
    return _number_words(words, at)


def _number_words(words: Sequence[Word], at: int) -> tuple[float | None, int]:
    """Return the number that consecutive number words form and the position after it, or (None, ``at``) if there are none."""
    start, total, part = at, 0, 0
    while at < len(words):
        text = words[at].text
        if at > start and re.search(r"[^\s-]", words[at].gap):
            break
        # A word for 0 to 19 can begin a number, or follow a multiple of ten other than ten itself.
        if text in UNITS and (part % 10 == 0 and (part >= 20 or part == 0 or part % 100 == 0)):
            part += UNITS[text]
        elif text in TENS and part % 100 == 0:
            part += TENS[text]
        elif text in SCALES:
            part = (part or 1) * SCALES[text]
            total, part = (total + part, 0) if text == "thousand" else (total, part)
        elif text == "dozen":
            part = (part or 1) * 12
        elif not (text == "and" and part >= 100 and at + 1 < len(words) and words[at + 1].text in CARDINALS):
            break
        at += 1
    return (None, start) if at == start else (float(total + part), at)
