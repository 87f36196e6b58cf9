"""How many a text says that there are: which of its numbers is the answer, if one is."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.denials import denies_flatly, says_none, says_yes
from scope_ptz.bench.answers.numbers import NumberMention, find_numbers
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import plain_words


def parse_number(script: AnswerText, unit: Sequence[str], *, part: bool = False) -> float | str:
    """The number that a text gives as its answer, or the reason why there is none. ``part``: "5 of the 7" means 5."""
    number = _told(script, unit, part=part)
    if isinstance(number, float) and number > 0 and denies_flatly(script, unit):
        return "both that there are some and that there are none"
    return number


def _told(script: AnswerText, unit: Sequence[str], *, part: bool) -> float | str:
    quantities = [q for q in find_numbers(script, unit) if not (q.denied or _is_absent(script, unit, q))]
    wholes = _wholes(script, quantities)
    if wholes and not part:
        return "a part of a number"
    if part and re.search(r"\bnone of (the|those|these)\b", script.text()):
        return 0.0
    quantities = [q for q in quantities if q not in wholes]
    if _is_range(script, quantities):
        return "a range"
    if (parts := _breakdown(script, quantities)) is not None:
        return quantities[0].value if parts else "numbers that do not fit together"
    definite = [q for q in quantities if not q.bound and not q.other]
    denied = any(m.denied and not is_miscounted(script, m, unit) for m in script.mentions({"own": unit})) if unit else False
    operands = _operands(script, quantities)
    results = [q for q in definite if q.total and q not in operands]
    if operands and not results:
        return "a sum that is not worked out"
    if totals := {q.value for q in results}:
        own = {q.value for q in results if q.own}
        sole = own if len(own) == 1 else totals
        return sole.pop() if len(sole) == 1 else "several totals"
    values = {q.value for q in definite} | ({0.0} if denied and not any(q.own and not q.bound for q in definite) else set())
    if len(values) == 1:
        return values.pop()
    if len(values) > 1:
        return "several numbers: " + ", ".join(f"{v:g}" for v in sorted(values))
    if any(q.bound for q in quantities):
        return "a bound, not a number"
    if says_none(script):
        return "both some and none" if _single(script, unit) or says_yes(script) else 0.0
    return 1.0 if _single(script, unit) else "no number"


def _wholes(script: AnswerText, quantities: Sequence[NumberMention]) -> list[NumberMention]:
    """The 7 of "5 of the 7 cones" and "5 out of 7"."""
    links = (["of", "the"], ["of"], ["out", "of"], ["out", "of", "the"], ["of", "these"], ["of", "those"])
    pairs = pairwise(quantities)
    return [two for one, two in pairs if [w.text for w in script.words[one.end : two.start]] in links]


def _breakdown(script: AnswerText, quantities: Sequence[NumberMention]) -> bool | None:
    """Whether what follows the first number after a colon or in brackets makes it up: "7: 5 bollards, 2 cones", "4 more (7 to 3)",
    "4 more: 7 cones, 3 bollards", "by 4: 7 cones against 3".

    None where nothing like that follows.
    """
    if len(quantities) < 3 or any(q.bound for q in quantities):
        return None
    whole, *parts = quantities
    gaps = "".join(word.gap for word in script.words[whole.end : parts[0].start + 1])
    if not re.match(r"[^\S\n]*[:(]", gaps):
        return None  # "Skips: 7, bins: 2" takes nothing apart.
    if "(" not in gaps:  # "4: 2 skips (1 blue, 1 yellow) and 2 posts"
        parts = [q for q in parts if not script.in_brackets(q.start)]
    lead = [word.text for word in script.words[max(0, whole.start - 3) : whole.start]]
    compares = any(word.text in ("more", "fewer", "less") for word in script.words[whole.end : parts[0].start])
    difference = "(" in gaps or compares or lead[-1:] == ["by"] or "difference" in lead
    apart = abs(parts[0].value - parts[1].value) if len(parts) == 2 and difference else None
    return whole.value in (sum(q.value for q in parts), apart)


def _is_range(script: AnswerText, quantities: Sequence[NumberMention]) -> bool:
    for one, two in pairwise(quantities):
        if one.other or two.other or one.value == two.value:
            continue
        between = [w.text for w in script.words[one.end : two.start]]
        before = script.words[one.start - 1].text if one.start else ""
        dashed = not between and re.fullmatch(r"\s*[-–~/]\s*", script.words[two.start].gap) is not None
        if dashed or between in (["to"], ["or"]) or (between == ["and"] and before == "between"):
            return True
    return False


def _is_absent(script: AnswerText, unit: Sequence[str], quantity: NumberMention) -> bool:
    """ "3 cones are missing"."""
    near = [m for m in script.mentions({"own": unit}) if 0 <= m.start - quantity.end <= 4] if unit and quantity.own else []
    return any(script.denied_after(m.end) for m in near[:1])


def is_miscounted(script: AnswerText, mention: NameMention, unit: Sequence[str]) -> bool:
    """Whether only a number of a thing is denied, not that there is one: "not 5 cones", "5 cones are missing"."""
    numbers = [q for q in find_numbers(script, unit) if q.own and 0 <= mention.start - q.end <= 4 and q.value > 0]
    return any(q.value > 1 or not q.denied for q in numbers)


def _operands(script: AnswerText, quantities: Sequence[NumberMention]) -> list[NumberMention]:
    """Numbers to be reckoned with: "seven minus four", "2 + 1", "3 on the left and 3 on the right"."""
    found = list[NumberMention]()
    for one, two in pairwise(quantities):
        if script.words[one.start].clause != script.words[two.start].clause or one.other or two.other:
            continue
        between = [w.text for w in script.words[one.end : two.start]]
        signed = not between and _SIGN.fullmatch(script.words[two.start].gap) is not None
        twice = one.value == two.value > 0 and len(between) > 1 and between[-1] in ("and", "another", "plus") and not two.total
        if signed or twice or _ARITHMETIC.search(" ".join(between)):
            found += [one, two]
    return found


_SIGN = re.compile(r"\s*[-–+*/×·⋅÷^⁄]\s*")
_ARITHMETIC = re.compile(
    r"^((plus|minus|times|over|less|add|subtract|mod|modulo|x)|(multiplied|divided) by|(raised )?to the( power( of)?)?|"
    r"(more|fewer|less) than|short of|subtracted from|added to|plus or minus|give or take)$|\b(plus|minus|times)$"
)


def _single(script: AnswerText, unit: Sequence[str]) -> bool:
    """ "a dog", "only a bus": one, as long as it is not a row, a number or a group of them."""
    for mention in script.mentions({"own": unit}) if unit else ():
        words = [script.words[i] for i in range(max(0, mention.start - 4), mention.start)]
        texts = [w.text for w in words if w.segment == script.words[mention.start].segment]
        is_singular = any(plain_words(u)[-1] == script.words[mention.end - 1].text for u in unit)
        if is_singular and "of" not in texts and {"a", "an", "single"} & set(texts):
            return True
    return False
