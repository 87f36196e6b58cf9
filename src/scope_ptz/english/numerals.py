"""Number words: cardinals, ordinals and fractions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

SMALL_NUMBERS = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve", "thirteen",
    "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen",
)  # fmt: skip
"""The words for 0 to 19; a word's index is its value."""

_TENS_WORDS = ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")
_ORDINAL_WORDS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")

UNITS: Mapping[str, int] = MappingProxyType({word: value for value, word in enumerate(SMALL_NUMBERS)})
"""Values of the cardinals from 0 to 19."""

TENS: Mapping[str, int] = MappingProxyType({word: 10 * value for value, word in enumerate(_TENS_WORDS, 2)})
"""Values of the multiples of ten from 20 to 90."""

SCALES: Mapping[str, int] = MappingProxyType({"hundred": 100, "thousand": 1000})
"""Words that multiply the number before them."""

CARDINALS: Mapping[str, int] = MappingProxyType({**UNITS, **TENS})
"""Values of the single-word cardinals below one hundred."""

ORDINALS: Mapping[str, int] = MappingProxyType({word: value for value, word in enumerate(_ORDINAL_WORDS, 1)})
"""Values of the ordinals from "first" to "tenth"."""

FRACTIONS: Mapping[str, float] = MappingProxyType({
    "half": 0.5, "third": 1 / 3, "thirds": 1 / 3, "quarter": 0.25, "quarters": 0.25, "fourth": 0.25, "fourths": 0.25, "fifth": 0.2,
    "sixth": 1 / 6, "eighth": 0.125, "eighths": 0.125, "tenth": 0.1, "twelfth": 1 / 12,
})  # fmt: skip
"""Values of fractions by word, such as 0.5 for "half"."""


def cardinal(word: str) -> int | None:
    """Return the value of a cardinal in digits or words ("12", "twelve", "twenty-five"); None for other words."""
    if word.isdigit():
        return int(word)
    if word in CARDINALS:
        return CARDINALS[word]
    tens, _, unit = word.partition("-")
    if unit and CARDINALS.get(tens, 0) >= 20 and 0 < CARDINALS.get(unit, 0) < 10:
        return CARDINALS[tens] + CARDINALS[unit]
    return None


def ordinal(word: str) -> int | None:
    """Return the value of an ordinal in digits or words ("2nd", "second"): -1 for "last", None for other words."""
    if word == "last":
        return -1
    if word in ORDINALS:
        return ORDINALS[word]
    match = re.fullmatch(r"(\d+)(st|nd|rd|th)", word)
    return int(match.group(1)) if match else None


def ordinal_suffix(number: int) -> str:
    """Return the suffix of an ordinal in digits: "st", "nd", "rd" or "th"."""
    return "th" if number % 100 in {11, 12, 13} else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")


def number_word(number: int) -> str:
    """Return a whole number from 0 to 99 in words ("twenty-five").

    Raises:
        ValueError: The number is negative or above 99.
    """
    if not 0 <= number < 100:
        raise ValueError(f"the number must be from 0 to 99; got {number}")
    if number < len(SMALL_NUMBERS):
        return SMALL_NUMBERS[number]
    tens, unit = _TENS_WORDS[number // 10 - 2], number % 10
    return f"{tens}-{SMALL_NUMBERS[unit]}" if unit else tens
