"""Parse numbers in digits and words: "20", "-15", "twenty-five", "two and a half", "a hundred and twenty", "a quarter"."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import takewhile

from scope_ptz.english.numerals import CARDINALS, FRACTIONS, ORDINALS, SCALES

NUMBER_WORDS: Mapping[str, float] = {**CARDINALS, **SCALES, "fourty": 40, "dozen": 12, "couple": 2}
ORDINAL_WORDS: Mapping[str, int] = {**ORDINALS, "last": -1, "final": -1}

_DIGITS = re.compile(r"[-+−]?\d*\.?\d+")
_FRACTION = re.compile(r"\d{1,9}/\d{1,9}")


@dataclass(frozen=True, slots=True)
class NumberPhrase:
    """A number at the start of a list of words.

    Attributes:
        value: The value of the number.
        used: The number of words that form the number; 0 if the words do not begin with one.
        kind: NUM, FRACTION ("half", "quarter") or ORDINAL ("second").
    """

    value: float = 0.0
    used: int = 0
    kind: str = "NUM"

    @property
    def kinds(self) -> frozenset[str]:
        """The kinds that the number can have: "third" is an ordinal or a fraction."""
        return frozenset({self.kind, "FRACTION"} if self.kind == "ORDINAL" and self.value > 2 else {self.kind})


def read_number(words: list[str], spans: list[tuple[int, int]] | None = None) -> NumberPhrase:
    """Return the number at the start of the words.

    Args:
        words: Words in lower case.
        spans: The start and end of each word in the text, which distinguish "1st" from "1 st".
    """
    if not words:
        return NumberPhrase()
    if _FRACTION.fullmatch(words[0]):
        numerator, denominator = words[0].split("/")
        return NumberPhrase(int(numerator) / int(denominator), 1, "FRACTION") if int(denominator) else NumberPhrase()
    if _DIGITS.fullmatch(words[0]):
        return _number_from_digits(words, spans)
    sign, start = (-1, 1) if words[0] in {"minus", "negative"} else (1, 0)
    if start and (len(words) == 1 or not (_DIGITS.fullmatch(words[1]) or words[1] in NUMBER_WORDS)):
        return NumberPhrase()
    if start and _DIGITS.fullmatch(words[1]):
        inner = _number_from_digits(words[1:], spans[1:] if spans else None)
        return NumberPhrase(-inner.value, inner.used + 1)
    if not start and (part := _counted_fraction(words)):
        return NumberPhrase(part, 2, "FRACTION")
    value, used = _cardinal(words[start:])
    if used:
        extra, more = _fraction_after(words[start + used :])
        return NumberPhrase(sign * (value + extra), start + used + more)
    if words[0] in FRACTIONS and words[0] not in ORDINAL_WORDS:
        if words[:3] == ["half", "a", "dozen"]:
            return NumberPhrase(6, 3)
        return NumberPhrase(FRACTIONS[words[0]], 1, "FRACTION")
    if words[0] in ORDINAL_WORDS:
        return NumberPhrase(ORDINAL_WORDS[words[0]], 1, "ORDINAL")
    return NumberPhrase()


def _number_from_digits(words: list[str], spans: list[tuple[int, int]] | None) -> NumberPhrase:
    """Return the number that starts with digits, including an ordinal suffix or a fraction after it."""
    if part := _counted_fraction(words):
        return NumberPhrase(part, 2, "FRACTION")
    value = float(words[0].replace("−", "-"))
    adjacent = len(words) > 1 and spans is not None and spans[0][1] == spans[1][0]
    if adjacent and words[1] in {"st", "nd", "rd", "th"}:
        return NumberPhrase(value, 2, "ORDINAL")
    extra, more = _fraction_after(words[1:])
    return NumberPhrase(value + (extra if value >= 0 else -extra), 1 + more)


def _cardinal(words: list[str]) -> tuple[float, int]:
    """Return the value and length of a cardinal in words: "a hundred", "a dozen", "one hundred and twenty", "one point five"."""
    total, current, used = 0.0, 0.0, 0
    if words[0] in {"a", "an"}:
        if not _article_means_one(words):
            return 0.0, 0
        current, used = 1.0, 1
    digit_count = next((i for i, w in enumerate(words) if NUMBER_WORDS.get(w, 10) > 9), len(words))
    if digit_count > 1 and not used:  # "three zero", digit by digit
        return float(_spoken_digits(words[:digit_count])), digit_count
    if not used and _starts_with_hundreds(words):  # "one eighty", "two seventy"
        current, used = 100 * NUMBER_WORDS[words[0]], 1
    while used < len(words):
        word = words[used]
        if used and _is_number_and(words, used):
            used += 1
            continue
        if word not in NUMBER_WORDS:
            break
        value = NUMBER_WORDS[word]
        if word in {"hundred", "dozen", "couple"}:
            current = (current or 1) * value
        elif value == 1000:
            total, current = total + (current or 1) * 1000, 0.0
        elif used and not _continues(current, value):
            break
        else:
            current += value
        used += 1
    if used and words[used : used + 1] == ["of"] and words[used - 1] in {"couple", "dozen"}:
        used += 1
    decimals, more = _decimals(words[used:]) if used else (0.0, 0)
    return total + current + decimals, used + more


def _article_means_one(words: list[str]) -> bool:
    """Return whether the article at the start means one, as in "a hundred", but not in "a couple of times"."""
    if len(words) < 2 or words[1] not in {"hundred", "thousand", "dozen", "couple"}:
        return False
    return not (words[1] == "couple" and words[2:3] == ["of"] and words[3:4] in (["times"], ["degrees"]))


def _is_number_and(words: list[str], index: int) -> bool:
    """Return whether the word at a position is the "and" in "one hundred and twenty"."""
    after = NUMBER_WORDS.get(" ".join(words[index + 1 : index + 2]), 100)
    return words[index] == "and" and words[index - 1] in {"hundred", "thousand"} and after < 100


def _decimals(words: list[str]) -> tuple[float, int]:
    """Return the value and length of a decimal part at the start of the words: "point two five"."""
    if words[:1] != ["point"]:
        return 0.0, 0
    digits = list(takewhile(lambda word: NUMBER_WORDS.get(word, 10) < 10, words[1:]))
    return (float("0." + _spoken_digits(digits)), 1 + len(digits)) if digits else (0.0, 0)


def _spoken_digits(words: list[str]) -> str:
    """Return number words below ten as a string of digits."""
    return "".join(str(int(NUMBER_WORDS[word])) for word in words)


def _starts_with_hundreds(words: list[str]) -> bool:
    """Return whether the words begin with a digit that counts hundreds, as in "one eighty"."""
    return len(words) > 1 and words[0] in {"one", "two", "three"} and 20 <= NUMBER_WORDS.get(words[1], 0) <= 90


def _continues(current: float, value: float) -> bool:
    """Return whether a number word may continue a number: "twenty five" and "hundred twenty", but not "twenty thirty"."""
    last_two = current % 100
    return (last_two == 0 and current >= 100 and value < 100) or (last_two >= 20 and last_two % 10 == 0 and 0 < value < 10)


def _counted_fraction(words: list[str]) -> float:
    """Return the value of "one third" or "three quarters" at the start of the words; 0 for other words."""
    count = CARDINALS.get(words[0], int(words[0]) if words[0].isdecimal() else 0)
    unit = words[1] if len(words) > 1 else ""
    is_plural = unit.endswith("s")
    part = FRACTIONS.get(unit.removesuffix("s"), 0.0)
    return count * part if (count > 1) == is_plural and 0 < count * part < 1 else 0.0


def _fraction_after(words: list[str]) -> tuple[float, int]:
    """Return the value and length of "and a half" or a similar fraction at the start of the words."""
    if words[:2] in (["and", "a"], ["and", "one"]) and words[2:3] and words[2] in {"half", "quarter", "third"}:
        return FRACTIONS[words[2]], 3
    return 0.0, 0
