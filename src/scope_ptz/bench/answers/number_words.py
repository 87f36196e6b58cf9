"""Parse numbers in words and in digits: "a dozen", "one hundred and two", "1,031"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.tokenizer import Word

_UNITS = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10,
    "eleven": 11, "twelve": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16, "seventeen": 17, "eighteen": 18,
    "nineteen": 19,
}  # fmt: skip
_TENS = {"twenty": 20, "thirty": 30, "forty": 40, "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90}
_BIG = {"hundred": 100, "thousand": 1000}
_BEFORE_ONE = frozenset({
    "is", "are", "was", "were", "be", "see", "sees", "seeing", "count", "counted", "counts", "find", "found", "shows",
    "show", "only", "just", "exactly", "about", "of", "total", "make", "makes", "has", "have", "there", "contains",
    "equals", "answer", "with", "precisely", "and", "least", "most", "than", "by",
})  # fmt: skip


def number_at(words: Sequence[Word], at: int) -> tuple[float | None, int]:
    """Return the number that begins at a word, or None, and the position after it."""
    if at >= len(words):
        return None, at
    text, after = words[at].text, [w.text for w in words[at + 1 : at + 3]]
    if text[0].isdigit():
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
    start, total, part = at, 0, 0
    while at < len(words):
        text = words[at].text
        if at > start and re.search(r"[^\s-]", words[at].gap):
            break
        if text in _UNITS and (part % 10 == 0 and (part >= 20 or part == 0 or part % 100 == 0)):
            part += _UNITS[text]
        elif text in _TENS and part % 100 == 0:
            part += _TENS[text]
        elif text in _BIG:
            part = (part or 1) * _BIG[text]
            total, part = (total + part, 0) if text == "thousand" else (total, part)
        elif text == "dozen":
            part = (part or 1) * 12
        elif not (text == "and" and part >= 100 and at + 1 < len(words) and words[at + 1].text in _UNITS | _TENS):
            break
        at += 1
    return (None, start) if at == start else (float(total + part), at)
