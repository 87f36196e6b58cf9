"""Parse an answer that should report a written figure, such as a price."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.numbers import NumberMention, find_numbers
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.text import NEGATORS, AnswerText, answer_text
from scope_ptz.bench.answers.tokenizer import clean
from scope_ptz.bench.tasks.expected import Text

_FIGURE = re.compile(r"[£$€]?\s*\d+(?:\.(\d+))?")
"""A figure with or without a currency sign. The group contains the digits after the decimal point."""
_PENCE = re.compile(r"(?<![\d.,])(\d{1,2})\s?(?:p|pence)\b", re.IGNORECASE)
"""An amount in pence, which is converted to pounds."""
_LETTER_JOINED_TO_DIGIT = re.compile(r"[^\W\d_][.,]?\d|\d[.,]?[^\W\d_]")
"""A letter joined to a digit, as in "O.95"."""
_DIGITS_WITH_SUFFIX = re.compile(r"(?<![\w.,])\d+(?:\.\d+)?(?:x|m|km|cm|s|st|nd|rd|th|px)\b", re.IGNORECASE)
"""Digits with a unit or an ordinal suffix, such as "3x" and "1st"."""


def is_figure(accepted: Sequence[str]) -> bool:
    """Return whether every accepted text is a figure, such as a price."""
    return all(_FIGURE.fullmatch(text) for text in accepted)


def parse_figure(expected: Text, answer: str) -> ParsedAnswer | None:
    """Parse the only number in an answer and format it with as many decimal places as the expected figure.

    Returns:
        The figure, ``Unreadable`` if it is unclear, or None if the answer contains no number or joins letters to digits ("O.95").
    """
    figure = _FIGURE.fullmatch(expected.accepted[0])
    places = len(figure.group(1) or "") if figure else 0
    text = clean(answer)
    if places:
        text = _PENCE.sub(lambda m: f"{int(m[1]) / 100:.2f}", text)
        text = re.sub(r"(?<=\d\.\d\d)\s?p\b", "", text)
        text = re.sub(r"(?<![\w.,])\.(?=\d\d\b)", "0.", re.sub(r"(?<![\d.,])(\d+),(?=\d\d(?!\d))", r"\1.", text))
    statement = answer_text(text)
    numbers = find_numbers(statement, ())
    stated = [q for q in numbers if not _is_denied(statement, q)]
    if not numbers or _LETTER_JOINED_TO_DIGIT.search(_DIGITS_WITH_SUFFIX.sub("", text)):
        return None  # "O.95" is compared as text with look-alike characters, and "5.C0" is not 5.
    if any(q.bound for q in stated):
        return Unreadable("a bound, not a figure")
    values = {q.value for q in stated}
    if len(values) != 1:
        return Unreadable("several numbers: " + ", ".join(f"{v:g}" for v in sorted(values)) if values else "every number is denied")
    value = values.pop()
    return ParsedValue(f"{value:.{places}f}" if abs(round(value, places) - value) < 1e-9 else f"{value:g}")


def _is_denied(statement: AnswerText, number: NumberMention) -> bool:
    segment = statement.words[number.start].segment
    return number.denied or any(w.text in NEGATORS - {"0", "zero"} for w in statement.words[: number.start] if w.segment == segment)
