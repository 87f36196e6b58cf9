"""Parse the count that an answer states among other numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.denials import denies_entirely, says_none, says_yes
from scope_ptz.bench.answers.numbers import NumberMention, find_numbers
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import plain_words


def parse_number(text: AnswerText, unit: Sequence[str], *, asks_for_part: bool = False) -> float | str:
    """Parse the number that an answer states.

    Args:
        text: The answer.
        unit: Wordings of the counted thing.
        asks_for_part: Whether the question asks for a part of a whole, so that "5 of the 7" is read as 5.

    Returns:
        The number, or the reason why the answer does not state exactly one.
    """
    number = _stated_number(text, unit, asks_for_part=asks_for_part)
    if isinstance(number, float) and number > 0 and denies_entirely(text, unit):
        return "both that there are some and that there are none"
    return number


def _stated_number(text: AnswerText, unit: Sequence[str], *, asks_for_part: bool) -> float | str:
    numbers = [n for n in find_numbers(text, unit) if not (n.denied or _is_absent(text, unit, n))]
    wholes = _wholes(text, numbers)
    if wholes and not asks_for_part:
        return "a part of a number"
    if asks_for_part and re.search(r"\bnone of (the|those|these)\b", text.plain_text()):
        return 0.0
    numbers = [n for n in numbers if n not in wholes]
    if _is_range(text, numbers):
        return "a range"
    if (adds_up := _breakdown_agrees(text, numbers)) is not None:
        return numbers[0].value if adds_up else "numbers that do not fit together"
    total = _total(text, numbers)
    return total if total is not None else _single_number(text, unit, numbers)


def _exact_numbers(numbers: Sequence[NumberMention]) -> list[NumberMention]:
    """Return the exact numbers, except those that count other things."""
    return [n for n in numbers if not n.bound and not n.counts_other]


def _total(text: AnswerText, numbers: Sequence[NumberMention]) -> float | str | None:
    """Return the stated total, or the reason why it is unclear. Return None if the answer neither calculates nor states a total."""
    operands = _operands(text, numbers)
    results = [n for n in _exact_numbers(numbers) if n.total and n not in operands]
    if not results:
        return "a sum that is not worked out" if operands else None
    totals, unit_totals = {n.value for n in results}, {n.value for n in results if n.counts_unit}
    candidates = unit_totals if len(unit_totals) == 1 else totals
    return candidates.pop() if len(candidates) == 1 else "several totals"


def _single_number(text: AnswerText, unit: Sequence[str], numbers: Sequence[NumberMention]) -> float | str:
    """Return the only number in an answer without a total, or the reason why there is no single number."""
    definite = _exact_numbers(numbers)
    values = {n.value for n in definite}
    if _is_denied(text, unit) and not any(n.counts_unit for n in definite):
        values.add(0.0)
    if len(values) == 1:
        return values.pop()
    if len(values) > 1:
        return "several numbers: " + ", ".join(f"{v:g}" for v in sorted(values))
    if any(n.bound for n in numbers):
        return "a bound, not a number"
    return _number_in_words(text, unit)


def _number_in_words(text: AnswerText, unit: Sequence[str]) -> float | str:
    """Return 0 for "none" and 1 for "a dog", or the reason why the answer states no number."""
    if says_none(text):
        return "both some and none" if _names_exactly_one(text, unit) or says_yes(text) else 0.0
    return 1.0 if _names_exactly_one(text, unit) else "no number"


def _is_denied(text: AnswerText, unit: Sequence[str]) -> bool:
    """Return whether the answer denies the thing itself, and not only a number of things."""
    return bool(unit) and any(m.denied and not is_only_number_denied(text, m, unit) for m in text.mentions({"unit": unit}))


def _wholes(text: AnswerText, numbers: Sequence[NumberMention]) -> list[NumberMention]:
    """Return the numbers that are wholes, such as 7 in "5 of the 7 cones" and in "5 out of 7"."""
    links = (["of", "the"], ["of"], ["out", "of"], ["out", "of", "the"], ["of", "these"], ["of", "those"])
    pairs = pairwise(numbers)
    return [second for first, second in pairs if [w.text for w in text.words[first.end : second.start]] in links]


def _breakdown_agrees(text: AnswerText, numbers: Sequence[NumberMention]) -> bool | None:
    """Return whether the first number is the sum or the difference of the numbers that follow it after a colon or in brackets.

    Examples: "7: 5 bollards, 2 cones", "4 more (7 to 3)", "4 more: 7 cones, 3 bollards", "by 4: 7 cones against 3".

    Returns:
        None if the answer contains no breakdown.
    """
    if len(numbers) < 3 or any(q.bound for q in numbers):
        return None
    whole, *parts = numbers
    gaps = "".join(word.gap for word in text.words[whole.end : parts[0].start + 1])
    if not re.match(r"[^\S\n]*[:(]", gaps):
        return None  # "Skips: 7, bins: 2" is a list, not a breakdown.
    if "(" not in gaps:  # "4: 2 skips (1 blue, 1 yellow) and 2 posts"
        parts = [q for q in parts if not text.in_brackets(q.start)]
        if not parts:
            return None
    lead = [word.text for word in text.words[max(0, whole.start - 3) : whole.start]]
    compares = any(word.text in ("more", "fewer", "less") for word in text.words[whole.end : parts[0].start])
    difference = "(" in gaps or compares or lead[-1:] == ["by"] or "difference" in lead
    gap = abs(parts[0].value - parts[1].value) if len(parts) == 2 and difference else None
    return whole.value in (sum(q.value for q in parts), gap)


def _is_range(text: AnswerText, numbers: Sequence[NumberMention]) -> bool:
    for first, second in pairwise(numbers):
        if first.counts_other or second.counts_other or first.value == second.value:
            continue
        between = [w.text for w in text.words[first.end : second.start]]
        before = text.words[first.start - 1].text if first.start else ""
        dashed = not between and re.fullmatch(r"\s*[-–~/]\s*", text.words[second.start].gap) is not None
        if dashed or between in (["to"], ["or"]) or (between == ["and"] and before == "between"):
            return True
    return False


def _is_absent(text: AnswerText, unit: Sequence[str], number: NumberMention) -> bool:
    """Return whether the answer counts absent things, as in "3 cones are missing"."""
    near = [m for m in text.mentions({"unit": unit}) if 0 <= m.start - number.end <= 4] if unit and number.counts_unit else []
    return any(text.is_denied_after(m.end) for m in near[:1])


def is_only_number_denied(text: AnswerText, mention: NameMention, unit: Sequence[str]) -> bool:
    """Return whether only a number is denied and not the presence of the thing, as in "not 5 cones" and "5 cones are missing"."""
    numbers = [q for q in find_numbers(text, unit) if q.counts_unit and 0 <= mention.start - q.end <= 4 and q.value > 0]
    return any(q.value > 1 or not q.denied for q in numbers)


def _operands(text: AnswerText, numbers: Sequence[NumberMention]) -> list[NumberMention]:
    """Return the operands of calculations, as in "seven minus four", "2 + 1" and "3 on the left and 3 on the right"."""
    operands = list[NumberMention]()
    for first, second in pairwise(numbers):
        if text.words[first.start].clause != text.words[second.start].clause or first.counts_other or second.counts_other:
            continue
        between = [w.text for w in text.words[first.end : second.start]]
        has_sign = not between and _SIGN.fullmatch(text.words[second.start].gap) is not None
        is_repeated = (
            first.value == second.value > 0 and len(between) > 1 and between[-1] in ("and", "another", "plus") and not second.total
        )
        if has_sign or is_repeated or _ARITHMETIC.search(" ".join(between)):
            operands += [first, second]
    return operands


_SIGN = re.compile(r"\s*[-–+*/×·⋅÷^⁄]\s*")
"""An arithmetic sign between two numbers."""
_ARITHMETIC = re.compile(
    r"^((plus|minus|times|over|less|add|subtract|mod|modulo|x)|(multiplied|divided) by|(raised )?to the( power( of)?)?|"
    r"(more|fewer|less) than|short of|subtracted from|added to|plus or minus|give or take)$|\b(plus|minus|times)$"
)
"""Words between two numbers that make them the operands of a calculation."""


def _names_exactly_one(text: AnswerText, unit: Sequence[str]) -> bool:
    """Return whether the answer names exactly one thing ("a dog", "only a bus"), and not a row or a group ("a row of dogs")."""
    for mention in text.mentions({"unit": unit}) if unit else ():
        words = [text.words[i] for i in range(max(0, mention.start - 4), mention.start)]
        texts = [w.text for w in words if w.segment == text.words[mention.start].segment]
        is_singular = any(plain_words(u)[-1] == text.words[mention.end - 1].text for u in unit)
        if is_singular and "of" not in texts and {"a", "an", "single"} & set(texts):
            return True
    return False
