"""Find the numbers of an instruction that its plan does not use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

from scope_ptz.english.grammar.numbers import read_number
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.consistency.evidence import Evidence
from scope_ptz.planner.grammar.consistency.words import Word

_TOLERANCE = 0.02
_VAGUE = frozenset({"one", "couple", "zero"})  # "the one on the left", "a couple of degrees", "zero in on"
_UNIT_FACTORS = (1.0, 60.0, 3600.0, 90.0, 360.0, 0.01)
"""Factors of units: minutes and hours in seconds, right angles and full turns in degrees, per cent."""

_NAMED = frozenset({
    "preset", "position", "view", "bookmark", "camera", "cam", "unit", "station", "number", "step", "task", "bay", "door", "gate",
    "lane", "platform", "gallery", "room", "track", "pump", "dock", "berth", "tower", "row", "aisle", "floor",
})  # fmt: skip
"""Words before a number that is part of a name."""


@dataclass(frozen=True, slots=True)
class StatedNumber:
    """A number in an instruction, with its words.

    Attributes:
        is_doubled: Whether "twice" is beside it: "twice 10 degrees", "10 degrees twice".
    """

    value: float
    words: tuple[Word, ...]
    is_fraction: bool = False
    is_doubled: bool = False


_BEFORE_HALF = frozenset({"", ".", ",", "is", "are", "s", "ve", "have", "has", "got"})
_AFTER_HALF = frozenset({"the", "full", "out", "empty", "open", "closed", "hidden", "cut", "missing", "gone"})
"""Words before and after "half" in a remark about what the picture shows."""
_AFTER_AMOUNT = frozenset({
    "degrees", "degree", "deg", "degs", "x", "times", "percent", "per", "seconds", "second", "secs", "sec", "minutes", "minute",
    "mins", "min", "left", "right", "up", "down", "to", "in", "out", "please", "more", "further", "steps", "shots", "pictures",
    "photos",
})  # fmt: skip
"""Words after the number of an amount."""

_LONG_TIMES = frozenset({"minute", "minutes", "min", "mins", "hour", "hours"})


def unused_numbers(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words of the numbers that the plan does not use. Numbers in descriptions and negated clauses count as used."""
    stated_numbers = _stated_numbers(words)
    remaining = list(evidence.numbers)
    unmatched = [stated for stated in stated_numbers if not _take_match(stated, remaining, evidence)]
    unmatched = [stated for stated in unmatched if not _is_product(stated, evidence)]
    for first, second in pairwise(stated_numbers):
        together = (
            first.value * second.value,  # "three quarters of 20 degrees"
            360 * first.value * second.value,  # "three quarters of the way round"
            first.value + second.value,  # "7 1/2 degrees", "20 plus 15"
            60 * first.value + second.value,  # "1 minute 30 seconds"
        )
        is_time = _is_among(together[-1], evidence.numbers)
        is_part_of_turn = second.is_fraction and _is_among(together[1], evidence.numbers)
        if second in unmatched and (
            is_time or is_part_of_turn or (first in unmatched and any(_is_among(value, remaining) for value in together))
        ):
            unmatched = [stated for stated in unmatched if stated not in (first, second)]
    return [word for stated in unmatched for word in stated.words]


def is_amount(words: Sequence[Word], word: Word) -> bool:
    """Return whether a number has a unit or direction, or ends its clause: "20 degrees", unlike "two guards"."""
    i = next(i for i, other in enumerate(words) if other is word)
    after = words[i + 1] if i + 1 < len(words) else None
    return after is None or after.is_break or after.text in _AFTER_AMOUNT


def _stated_numbers(words: Sequence[Word]) -> list[StatedNumber]:
    stated_numbers: list[StatedNumber] = []
    i, listed = 0, 1  # the next number of a numbered list
    while i < len(words):
        read = read_number([word.text for word in words[i : i + 8]])
        used = words[i : i + max(read.used, 1)]
        after = words[i + read.used].text if i + read.used < len(words) else ""
        if read.used == 1 and after in {".", ")"} and read.value == listed and i + 2 < len(words):
            listed += 1
        elif read.used and read.kind != "ORDINAL" and not _is_ignored(words, i, read.used, may_be_vague=read.kind != "FRACTION"):
            is_doubled = any(
                word.text == "twice" for word in (*words[max(i - 1, 0) : i], *words[i + len(used) : i + len(used) + 2])
            )
            stated_numbers.append(StatedNumber(abs(read.value), tuple(used), read.kind == "FRACTION", is_doubled))
        i += len(used)
    return stated_numbers


def _is_ignored(words: Sequence[Word], start: int, used: int, *, may_be_vague: bool) -> bool:
    """Return whether a number states no amount: it is part of a name, a description or a remark, or vague as in "the one"."""
    before = words[start - 1].text if start else ""
    used_words = words[start : start + used]
    after = words[start + used].text if start + used < len(words) else ""
    if before == "in" and after in _LONG_TIMES:
        return True  # "we start loading in five minutes" is only a remark: a plan cannot wait
    if (
        used_words[0].text in {"2", "4"}
        and before in {"go", "back", "zoom", "look"}
        and words[start + used : start + used + 1]
        and (words[start + used].is_described)
    ):
        return True  # "go 2 log deck"
    if before == "your" and after == "o":
        return True  # "your nine o'clock" is a direction
    if used_words[0].text == "half" and before in _BEFORE_HALF and after in _AFTER_HALF:
        return True  # "the net's half out of frame", "half the crowd is cut off"
    return before in {*_NAMED, "the", "these", "those"} or any(
        word.is_described or word.is_negated or (may_be_vague and word.text in _VAGUE) for word in used_words
    )


def _take_match(stated: StatedNumber, remaining: list[float], evidence: Evidence) -> bool:
    """Remove the plan's number that matches a stated number from ``remaining``. Return whether there is one."""
    for value in _plan_values(stated, evidence):
        for number in remaining:
            if abs(number - value) <= _TOLERANCE:
                remaining.remove(number)
                return True
    return False


def _plan_values(stated: StatedNumber, evidence: Evidence) -> list[float]:
    """Return the numbers with which a plan may express a stated number."""
    value = stated.value
    values = [value * unit for unit in _UNIT_FACTORS]
    if stated.is_doubled:
        values.append(2 * value)
    if value:
        values.append(1 / value)
    if stated.is_fraction:
        values += [1 + value, 1 - value, 60 + 60 * value]
    if evidence.has(ast.Repeat):
        values += [value - 1, value + 1]
    if value == len(evidence.presets):
        values.append(0.0)
    return values


def _is_product(stated: StatedNumber, evidence: Evidence) -> bool:
    """Return whether the plan reaches a stated number in steps: 90 degrees as three turns of 30."""
    if stated.value == len(evidence.presets) or (stated.value == 180 and evidence.has(ast.Sweep)):
        return True
    if stated.value == 360 and evidence.looks_all_around:
        return True
    pairs = combinations(evidence.numbers, 2)
    return any(abs(a * b - stated.value) <= _TOLERANCE for a, b in pairs)


def _is_among(value: float, numbers: Sequence[float]) -> bool:
    return any(abs(number - value) <= _TOLERANCE for number in numbers)
