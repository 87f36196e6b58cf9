"""Numbers as digits and as words: "20", "-15", "twenty-five", "two and a half", "a hundred and twenty", "a quarter"."""

from __future__ import annotations

import re
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.vocabulary import FRACTION_WORDS, NUMBER_WORDS, ORDINAL_WORDS

_DIGITS = re.compile(r"[-+−]?\d*\.?\d+")


@dataclass(frozen=True, slots=True)
class Number:
    """``used``: how many words were read (0: no number); ``kind``: NUM, FRACTION (half, quarter) or ORDINAL (second)."""

    value: float = 0.0
    used: int = 0
    kind: str = "NUM"

    @property
    def kinds(self) -> frozenset[str]:
        """ "Third" is the third one or a third of something."""
        return frozenset({self.kind, "FRACTION"} if self.kind == "ORDINAL" and self.value > 2 else {self.kind})


def read_number(words: list[str], spans: list[tuple[int, int]] | None = None) -> Number:
    """The number that the words begin with. ``spans`` are their places in the text, to see "1st" and "20 5" apart."""
    if not words:
        return Number()
    if "/" in words[0]:
        above, below = words[0].split("/")
        return Number(int(above) / int(below), 1, "FRACTION") if int(below) else Number()
    if _DIGITS.fullmatch(words[0]):
        return _digits(words, spans)
    sign, start = (-1, 1) if words[0] in {"minus", "negative"} else (1, 0)
    if start and (len(words) == 1 or not (_DIGITS.fullmatch(words[1]) or words[1] in NUMBER_WORDS)):
        return Number()
    if start and _DIGITS.fullmatch(words[1]):
        inner = _digits(words[1:], spans[1:] if spans else None)
        return Number(-inner.value, inner.used + 1)
    value, used = _cardinal(words[start:])
    if used:
        extra, more = _fraction_after(words[start + used :])
        return Number(sign * (value + extra), start + used + more)
    if words[0] in FRACTION_WORDS and words[0] not in ORDINAL_WORDS:
        if words[:3] == ["half", "a", "dozen"]:
            return Number(6, 3)
        return Number(FRACTION_WORDS[words[0]], 1, "FRACTION")
    if words[0] in ORDINAL_WORDS:
        return Number(ORDINAL_WORDS[words[0]], 1, "ORDINAL")
    return Number()


def _digits(words: list[str], spans: list[tuple[int, int]] | None) -> Number:
    value = float(words[0].replace("−", "-"))
    glued = len(words) > 1 and spans is not None and spans[0][1] == spans[1][0]
    if glued and words[1] in {"st", "nd", "rd", "th"}:
        return Number(value, 2, "ORDINAL")
    extra, more = _fraction_after(words[1:])
    return Number(value + (extra if value >= 0 else -extra), 1 + more)


def _cardinal(words: list[str]) -> tuple[float, int]:
    """Value and length of a whole number in words, with "a hundred", "a dozen", "one hundred and twenty", "point five"."""
    total, current, used = 0.0, 0.0, 0
    if words[0] in {"a", "an"}:
        if len(words) < 2 or words[1] not in {"hundred", "thousand", "dozen", "couple"}:
            return 0.0, 0
        if words[1] == "couple" and words[2:3] == ["of"] and words[3:4] in (["times"], ["degrees"]):
            return 0.0, 0
        current, used = 1.0, 1
    spoken = next((i for i, w in enumerate(words) if NUMBER_WORDS.get(w, 10) > 9), len(words))
    if spoken > 1 and not used:  # "three zero" on the radio
        return float("".join(str(int(NUMBER_WORDS[w])) for w in words[:spoken])), spoken
    if not used and _hundreds(words):  # "one eighty", "two seventy"
        current, used = 100 * NUMBER_WORDS[words[0]], 1
    while used < len(words):
        word = words[used]
        if (
            word == "and"
            and used
            and words[used - 1] in {"hundred", "thousand"}
            and NUMBER_WORDS.get(" ".join(words[used + 1 : used + 2]), 100) < 100
        ):
            used += 1
            continue
        if word not in NUMBER_WORDS:
            break
        value = NUMBER_WORDS[word]
        if value in (100, 12, 2) and word in {"hundred", "dozen", "couple"}:
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
    if used and words[used : used + 1] == ["point"] and NUMBER_WORDS.get(" ".join(words[used + 1 : used + 2]), 10) < 10:
        digits = ""
        used += 1
        while used < len(words) and NUMBER_WORDS.get(words[used], 10) < 10:
            digits += str(int(NUMBER_WORDS[words[used]]))
            used += 1
        return total + current + float("0." + digits), used
    return total + current, used


def _hundreds(words: list[str]) -> bool:
    """Whether a digit before a ten counts hundreds, as in "one eighty"."""
    return len(words) > 1 and words[0] in {"one", "two", "three"} and 20 <= NUMBER_WORDS.get(words[1], 0) <= 90


def _continues(current: float, value: float) -> bool:
    """Whether a number word may follow what was read: "twenty five", "hundred twenty", never "twenty thirty"."""
    last_two = current % 100
    return (last_two == 0 and current >= 100 and value < 100) or (last_two >= 20 and last_two % 10 == 0 and 0 < value < 10)


def _fraction_after(words: list[str]) -> tuple[float, int]:
    """The "and a half" after a number: its value and length."""
    if words[:2] in (["and", "a"], ["and", "one"]) and words[2:3] and words[2] in {"half", "quarter", "third"}:
        return FRACTION_WORDS[words[2]], 3
    return 0.0, 0
