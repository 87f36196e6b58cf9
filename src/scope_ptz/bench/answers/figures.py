"""Reading a price or another figure that is written somewhere: the one number that an answer gives."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.numbers import NumberMention, find_numbers
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.text import NEGATORS, AnswerText, answer_text
from scope_ptz.bench.answers.tokenizer import clean
from scope_ptz.bench.tasks.expected import Text

_FIGURE = re.compile(r"[£$€]?\s*\d+(?:\.(\d+))?")
_PENCE = re.compile(r"(?<![\d.,])(\d{1,2})\s?(?:p|pence)\b", re.IGNORECASE)
_MIXED = re.compile(r"[^\W\d_][.,]?\d|\d[.,]?[^\W\d_]")
_MEASURE = re.compile(r"(?<![\w.,])\d+(?:\.\d+)?(?:x|m|km|cm|s|st|nd|rd|th|px)\b", re.IGNORECASE)
"""Digits with letters that stand for themselves: 3x, 1st."""


def is_figure(accepted: Sequence[str]) -> bool:
    return all(_FIGURE.fullmatch(text) for text in accepted)


def parse_figure(expected: Text, answer: str) -> ParsedAnswer | None:
    """The number of the answer, written with as many decimals as the figure has; None where it has no number."""
    found = _FIGURE.fullmatch(expected.accepted[0])
    places = len(found.group(1) or "") if found else 0
    text = clean(answer)
    if places:
        text = _PENCE.sub(lambda m: f"{int(m[1]) / 100:.2f}", text)
        text = re.sub(r"(?<=\d\.\d\d)\s?p\b", "", text)
        text = re.sub(r"(?<![\w.,])\.(?=\d\d\b)", "0.", re.sub(r"(?<![\d.,])(\d+),(?=\d\d(?!\d))", r"\1.", text))
    said = answer_text(text)
    quantities = find_numbers(said, ())
    told = [q for q in quantities if not _is_denied(said, q)]
    if not quantities or _MIXED.search(_MEASURE.sub("", text)):
        return None  # "O.95" is for what knows which letters look alike, and "5.C0" is no 5.
    if any(q.bound for q in told):
        return Unreadable("a bound, not a figure")
    values = {q.value for q in told}
    if len(values) != 1:
        return Unreadable("several numbers: " + ", ".join(f"{v:g}" for v in sorted(values)) if values else "only what is denied")
    value = values.pop()
    return ParsedValue(f"{value:.{places}f}" if abs(round(value, places) - value) < 1e-9 else f"{value:g}")


def _is_denied(said: AnswerText, quantity: NumberMention) -> bool:
    segment = said.words[quantity.start].segment
    return quantity.denied or any(w.text in NEGATORS - {"0", "zero"} for w in said.words[: quantity.start] if w.segment == segment)
