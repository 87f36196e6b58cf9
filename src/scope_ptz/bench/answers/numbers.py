"""Find the numbers in a text that could be counts, and determine what each number counts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.bench.answers.number_words import number_at
from scope_ptz.bench.answers.text import AnswerText
from scope_ptz.bench.answers.tokenizer import Word, plain_words, same_word

_MEASUREMENT_UNITS = ("degree", "percent", "x", "second", "minute", "metre", "kilometre", "px", "pixel", "time")
"""Units of measurement. A number before one of them is not a count."""
_LABELS = frozenset({
    "zoom", "pan", "tilt", "preset", "lane", "bay", "platform", "exit", "step", "junction", "number", "no", "reading",
    "marked", "labelled", "saying", "view", "picture", "image", "frame",
})  # fmt: skip
"""Words before digits which show that the digits are a label, as in "preset 3"."""
_NOT_COUNTED_NOUNS = frozenset({
    "are", "is", "were", "was", "in", "on", "at", "of", "and", "or", "here", "there", "visible", "altogether", "overall",
    "by", "near", "to", "from", "out", "all", "now", "currently", "seen", "mentions", "present", "so", "then", "as", "but",
    "around", "within", "along", "across", "each", "per", "that", "which", "when", "after", "before", "total", "with",
    "right", "behind", "under", "i", "we", "together", "more", "fewer", "others", "ones", "plus", "minus", "less", "for",
})  # fmt: skip
"""Words after a number that are not the noun that it counts."""
_BOUNDS = re.compile(
    r"\b(at least|at most|more than|fewer than|less than|greater than|over|under|above|below|up to|a minimum of|a maximum of|"
    r"geq|leq|gt|lt|(half|twice|double|triple|thrice|times|x)( of)?( the)?|(half|third|quarter|root|square|multiple|fraction) of)$"
)
"""Phrases that turn the number after them into a bound or an operand ("at least", "half of")."""
_INEXACT_SUFFIX = re.compile(r"(\w+ ){0,4}or (more|fewer|less|so)\b|(ish|plus)\b")
"""Phrases that make the number before them inexact ("or more", "-ish")."""
_VALUE_SUFFIX = re.compile(r"(and )?a (half|third|quarter)\b|(halves|thirds|quarters|fifths|tenths|squared|cubed|factorial)\b")
"""Phrases that change the value of the number before them ("and a half", "squared")."""
_SIGN_BEFORE = re.compile(r"(<|(?<![-=])>|[≤≥≦≧≪≫≲≳⩽⩾±≠])[=\s]*$")
"""A comparison sign before a number, as in "<3"."""
_SIGN_AFTER = re.compile(r"\s*(<|>|[≤≥≦≧≪≫≲≳⩽⩾±])")
"""A comparison sign after a number, as in "3>"."""
_WORDS_BETWEEN_NOT_AND_NUMBER = frozenset({
    "a", "an", "the", "total", "of", "exactly", "quite", "really", "just", "even", "there", "is", "are", "be", "was", "were", "to",
    "see", "seen", "count", "counted", "find", "mentions", "any", "answer", "number", "it", "that", "true", "correct", "right",
    "about", "precisely", "as", "many",
})  # fmt: skip
"""Words that may occur between "not" and the number that it denies."""

_TOTALS = re.compile(
    r"\b(total|altogether|together|overall|in all|combined|sum|makes|making|therefore|thus|hence|so|final|finally)\b"
)
"""Words which show that the numbers in the same segment are totals or results."""

_TOTAL_INTRODUCTION = re.compile(
    r"\b(total( [^\W\d]\w*){0,2}|difference( (is|equals|makes|being|therefore|thus))*|(final )?answer( is)?|sum( is)?)$"
)
"""Words which show that the number directly after them is a total or a result."""
_GENERAL_NOUNS = frozenset({"object", "objects", "item", "items", "thing", "things"})
"""General words for countable things. A total of "items" is treated as a total of the things that the question asks about."""


@dataclass(frozen=True, slots=True)
class NumberMention:
    """A number in a text.

    Attributes:
        value: The number.
        start: Position of its first word.
        end: Position after its last word.
        counts_unit: Whether it counts the things that the question asks about.
        counts_other: Whether it counts other things.
        bound: Whether it is not an exact count ("at least 3", "<3", "3 and a half").
        denied: Whether it is denied ("not 3").
        total: Whether the text states it as a total or a result.
    """

    value: float
    start: int
    end: int
    counts_unit: bool = False
    counts_other: bool = False
    bound: bool = False
    denied: bool = False
    total: bool = False


def find_numbers(text: AnswerText, unit: Sequence[str]) -> list[NumberMention]:
    """Return every number that could be a count, in order.

    Ordinals, labels and numbers joined to letters ("0x3", "A4") are excluded. Measurements ("15 degrees", "2x") are excluded unless
    the question asks for them.

    Args:
        text: The text.
        unit: Wordings of the things that the question asks about.
    """
    words, mentions, at = text.words, list[NumberMention](), 0
    while at < len(words):
        value, end = number_at(words, at)
        if value is None:
            at += 1
            continue
        is_joined = at > 0 and words[at].gap == ""
        if not is_joined and (
            (_is_followed_by_unit(words, end, unit) and not _is_length_of(words, end)) or not _is_measure_or_label(words, at, end)
        ):
            mentions.append(_number_mention(text, value, at, end, unit))
        at = end
    return mentions


def _number_mention(text: AnswerText, value: float, start: int, end: int, unit: Sequence[str]) -> NumberMention:
    words = text.words
    counts_unit = _is_followed_by_unit(words, end, unit) or _is_preceded_by_unit(words, start, unit)
    after = words[end].text if end < len(words) and words[end].segment == words[end - 1].segment else ""
    ones = re.match(r"(\w+ ){0,2}(ones|others)\b", " ".join(w.text for w in words[end : end + 3]))
    has_no_noun = (
        not after
        or ones is not None
        or after in _NOT_COUNTED_NOUNS
        or number_at(words, end)[0] is not None
        or ")" in words[end].gap
    )
    before = " ".join(w.text for w in words[max(0, start - 4) : start])
    segment = " ".join(w.text for w in words if w.segment == words[start].segment)
    announced_total = _TOTAL_INTRODUCTION.search(before) is not None
    has_no_noun = has_no_noun or (announced_total and after in _GENERAL_NOUNS)
    return NumberMention(
        value=value,
        start=start,
        end=end,
        counts_unit=counts_unit,
        counts_other=not counts_unit and not has_no_noun,
        bound=_is_bound(words, start, end),
        denied=_is_denied(words, start),
        total="=" in words[start].gap or announced_total or (bool(_TOTALS.search(segment)) and (counts_unit or has_no_noun)),
    )


def _is_length_of(words: Sequence[Word], end: int) -> bool:
    """Return whether a number measures a row or group of things, as in "5 metres of cones"."""
    after = [word.text for word in words[end : end + 2]]
    return after[1:] == ["of"] and any(
        same_word(after[0], measure) for measure in _MEASUREMENT_UNITS if measure not in ("x", "time")
    )


def _is_measure_or_label(words: Sequence[Word], start: int, end: int) -> bool:
    after = words[end] if end < len(words) else None
    if after is not None and after.segment == words[end - 1].segment:
        if any(same_word(after.text, measure) for measure in _MEASUREMENT_UNITS):
            return True
        if after.gap == "" and after.text[0].isalpha() and after.text != "ish":
            return True
    return (words[start].text[0].isdigit() and _is_label(words, start)) or words[start].gap.endswith("#")


def _is_label(words: Sequence[Word], at: int) -> bool:
    """Return whether digits are a label, as in "preset 3" and "presets 1, 2 and 3"."""
    while at > 0 and words[at].clause == words[at - 1].clause:
        at -= 1
        if words[at].segment == words[at + 1].segment and any(same_word(words[at].text, label) for label in _LABELS):
            return True
        if not words[at].text[0].isdigit() and words[at].text not in ("and", "or", "to", "of"):
            return False
    return False


def _is_bound(words: Sequence[Word], start: int, end: int) -> bool:
    segment = words[start].segment
    before = " ".join(w.text for w in words[max(0, start - 4) : start] if w.segment == segment)
    rest = " ".join(w.text for w in words[end : end + 6] if w.segment == segment)
    signs = _SIGN_BEFORE.search(words[start].gap) or (end < len(words) and _SIGN_AFTER.match(words[end].gap))
    return bool(_BOUNDS.search(before) or _INEXACT_SUFFIX.match(rest) or _VALUE_SUFFIX.match(rest) or signs)


def _is_denied(words: Sequence[Word], start: int) -> bool:
    """Return whether a number is denied, as in "not 3", "it is not the case that there are 3" and "neither 3 nor 5"."""
    at = start - 1
    while at >= 0 and words[at].segment == words[start].segment:
        if words[at].text in ("not", "never", "neither", "nor"):
            return True
        if words[at].text not in _WORDS_BETWEEN_NOT_AND_NUMBER and words[at].text != "case":
            return False
        at -= 1
    return False


def _is_followed_by_unit(words: Sequence[Word], end: int, unit: Sequence[str]) -> bool:
    """Return whether the counted thing follows the number, with at most four adjectives between them."""
    phrases = [plain_words(u) for u in unit]
    for at in range(end, min(end + 5, len(words))):
        if words[at].segment != words[end - 1].segment:
            return False
        for phrase in phrases:
            if all(at + i < len(words) and same_word(words[at + i].text, p) for i, p in enumerate(phrase)):
                return True
        may_be_adjective = words[at].text not in _NOT_COUNTED_NOUNS or (words[at].text in ("and", "of") and at > end)
        if not may_be_adjective or number_at(words, at)[0] is not None:
            return False
    return False


def _is_preceded_by_unit(words: Sequence[Word], start: int, unit: Sequence[str]) -> bool:
    """Return whether the counted thing precedes the number, as in "Cones: 5"."""
    if start == 0 or not re.fullmatch(r"\s*[:=]\s*|\s+-\s+", words[start].gap):
        return False
    for phrase in (plain_words(u) for u in unit):
        begin = start - len(phrase)
        is_named = begin >= 0 and all(same_word(words[begin + i].text, p) for i, p in enumerate(phrase))
        if is_named and (begin == 0 or number_at(words, begin - 1)[0] is None):
            return True
    return False
