"""Numbers in free text: which one is the answer, if one is. A range, a bound or two rival numbers are no answer."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from scope_ptz.bench.reader_text import Script
from scope_ptz.bench.reader_words import Word, plain_words, same_word

_UNITS = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10,
    "eleven": 11, "twelve": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16, "seventeen": 17, "eighteen": 18,
    "nineteen": 19,
}  # fmt: skip
_TENS = {"twenty": 20, "thirty": 30, "forty": 40, "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90}
_BIG = {"hundred": 100, "thousand": 1000}
_MEASURES = ("degree", "percent", "x", "second", "minute", "metre", "kilometre", "px", "pixel", "time")
_LABELS = frozenset({
    "zoom", "pan", "tilt", "preset", "lane", "bay", "platform", "exit", "step", "junction", "number", "no", "reading",
    "marked", "labelled", "saying",
})  # fmt: skip
_BARE_AFTER = frozenset({
    "are", "is", "were", "was", "in", "on", "at", "of", "and", "or", "here", "there", "visible", "altogether", "overall",
    "by", "near", "to", "from", "out", "all", "now", "currently", "seen", "found", "present", "so", "then", "as", "but",
    "around", "within", "along", "across", "each", "per", "that", "which", "when", "after", "before", "total", "with",
    "right", "behind", "under", "i", "we", "together",
})  # fmt: skip
_BEFORE_ONE = frozenset({
    "is", "are", "was", "were", "be", "see", "sees", "seeing", "count", "counted", "counts", "find", "found", "shows",
    "show", "only", "just", "exactly", "about", "of", "total", "make", "makes", "has", "have", "there", "contains",
    "equals", "answer", "with", "precisely", "and", "least", "most", "than",
})  # fmt: skip
_BOUNDS = re.compile(
    r"(at least|at most|more than|fewer than|less than|over|under|up to|no more than|no fewer than|a minimum of|a maximum of)$"
)
_TOTALS = re.compile(
    r"\b(total|altogether|together|overall|in all|combined|sum|makes|making|therefore|thus|hence|so|final|finally)\b"
)
_NONE = re.compile(
    r"^(no|nope|none|nothing|nobody|no one|zero)$|^(none|nothing|nobody|no one)\b(?! (of (?!them|these|those)|but))"
    r"|\bthere (is|are|were) (none|nothing)\b"
    r"|\bnot (any|one|a single one)( (here|there|visible|in view))?$"
)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number in a text, words ``start`` to ``end`` (exclusive). ``own``: it counts what was asked for; ``other``: not."""

    value: float
    start: int
    end: int
    own: bool = False
    other: bool = False
    bound: bool = False
    denied: bool = False
    total: bool = False


def says_none(script: Script) -> bool:
    """Whether a sentence of the text is nothing but "none" ("No.", "There are none", "Nothing like that is visible")."""
    parts = [" ".join(script.words[i].text for i in group) for group in (*script.segments(), *script.clauses())]
    return any(_NONE.search(part) for part in parts)


def read_number(script: Script, unit: Sequence[str], *, part: bool = False) -> float | str:
    """The number that a text gives as its answer, or the reason why there is none. ``part``: "5 of the 7" means 5."""
    quantities = [q for q in find_quantities(script, unit) if not q.denied]
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
    denied = any(m.denied for m in script.mentions({"own": unit})) if unit else False
    if totals := {q.value for q in definite if q.total}:
        own = {q.value for q in definite if q.total and q.own}
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
        return 0.0
    return 1.0 if _single(script, unit) else "no number"


def find_quantities(script: Script, unit: Sequence[str]) -> list[Quantity]:
    """Every number that could be a count, in order; measures (15 degrees, 2x) not asked for, ordinals and labels are none."""
    words, found, at = script.words, list[Quantity](), 0
    while at < len(words):
        value, end = _number_at(words, at)
        if value is None:
            at += 1
            continue
        if _followed_by(words, end, unit) or not _is_no_count(words, at, end):
            found.append(_quantity(script, value, at, end, unit))
        at = end
    return found


def _quantity(script: Script, value: float, start: int, end: int, unit: Sequence[str]) -> Quantity:
    words = script.words
    owned = _followed_by(words, end, unit) or _announced(words, start, unit)
    after = words[end].text if end < len(words) and words[end].segment == words[end - 1].segment else ""
    bare = not after or after in _BARE_AFTER or _number_at(words, end)[0] is not None or ")" in words[end].gap
    before = " ".join(w.text for w in words[max(0, start - 4) : start])
    beyond = f"{words[end].text} {words[min(end + 1, len(words) - 1)].text}" if end < len(words) else ""
    segment = " ".join(w.text for w in words if w.segment == words[start].segment)
    announced_total = re.search(r"\btotal( \w+){0,2}$", before) is not None
    return Quantity(
        value=value,
        start=start,
        end=end,
        own=owned,
        other=not owned and not bare,
        bound=bool(_BOUNDS.search(before)) or beyond in ("or more", "or fewer", "or less") or beyond.startswith("plus"),
        denied=start > 0 and words[start - 1].text == "not" and words[start].segment == words[start - 1].segment,
        total="=" in words[start].gap or announced_total or (bool(_TOTALS.search(segment)) and (owned or bare)),
    )


def _number_at(words: Sequence[Word], at: int) -> tuple[float | None, int]:
    """The number that begins at a word and the position after it; None when none does."""
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


def _is_no_count(words: Sequence[Word], start: int, end: int) -> bool:
    after = words[end] if end < len(words) else None
    if after is not None and after.segment == words[end - 1].segment:
        if any(same_word(after.text, measure) for measure in _MEASURES):
            return True
        if after.gap == "" and after.text in ("st", "nd", "rd", "th"):
            return True
    before = words[start - 1].text if start > 0 and words[start - 1].segment == words[start].segment else ""
    labelled = before in _LABELS and words[start].text[0].isdigit()
    return labelled or (words[start].gap.endswith("#"))


def _followed_by(words: Sequence[Word], end: int, unit: Sequence[str]) -> bool:
    """Whether the thing counted comes after the number, with at most four adjectives between."""
    phrases = [plain_words(u) for u in unit]
    for at in range(end, min(end + 5, len(words))):
        if words[at].segment != words[end - 1].segment:
            return False
        for phrase in phrases:
            if all(at + i < len(words) and same_word(words[at + i].text, p) for i, p in enumerate(phrase)):
                return True
        is_adjectives = words[at].text not in _BARE_AFTER or (words[at].text in ("and", "of") and at > end)
        if not is_adjectives or _number_at(words, at)[0] is not None:
            return False
    return False


def _announced(words: Sequence[Word], start: int, unit: Sequence[str]) -> bool:
    """ "Cones: 5"."""
    if start == 0 or not re.fullmatch(r"\s*[:=]\s*|\s+-\s+", words[start].gap):
        return False
    for phrase in (plain_words(u) for u in unit):
        begin = start - len(phrase)
        is_named = begin >= 0 and all(same_word(words[begin + i].text, p) for i, p in enumerate(phrase))
        if is_named and (begin == 0 or _number_at(words, begin - 1)[0] is None):
            return True
    return False


def _wholes(script: Script, quantities: Sequence[Quantity]) -> list[Quantity]:
    """The 7 of "5 of the 7 cones" and "5 out of 7"."""
    links = (["of", "the"], ["of"], ["out", "of"], ["out", "of", "the"], ["of", "these"], ["of", "those"])
    pairs = pairwise(quantities)
    return [two for one, two in pairs if [w.text for w in script.words[one.end : two.start]] in links]


def _breakdown(script: Script, quantities: Sequence[Quantity]) -> bool | None:
    """Whether what follows the first number after a colon or in brackets makes it up: "7: 5 bollards, 2 cones", "4 more (7 to 3)",
    "by 4: 7 cones against 3".

    None where nothing like that follows.
    """
    if len(quantities) < 3 or any(q.bound for q in quantities):
        return None
    whole, *parts = quantities
    gaps = "".join(word.gap for word in script.words[whole.end : parts[0].start + 1])
    if not re.search(r"[:(]", gaps):
        return None
    difference = "(" in gaps or (whole.start > 0 and script.words[whole.start - 1].text == "by")
    apart = abs(parts[0].value - parts[1].value) if len(parts) == 2 and difference else None
    return whole.value in (sum(q.value for q in parts), apart)


def _is_range(script: Script, quantities: Sequence[Quantity]) -> bool:
    for one, two in pairwise(quantities):
        if one.other or two.other or one.value == two.value:
            continue
        between = [w.text for w in script.words[one.end : two.start]]
        before = script.words[one.start - 1].text if one.start else ""
        dashed = not between and re.fullmatch(r"\s*[-–~/]\s*", script.words[two.start].gap) is not None
        if dashed or between in (["to"], ["or"]) or (between == ["and"] and before == "between"):
            return True
    return False


def _single(script: Script, unit: Sequence[str]) -> bool:
    """ "a dog", "only a bus": one, as long as it is not a row, a number or a group of them."""
    for mention in script.mentions({"own": unit}) if unit else ():
        words = [script.words[i] for i in range(max(0, mention.start - 4), mention.start)]
        texts = [w.text for w in words if w.segment == script.words[mention.start].segment]
        is_singular = any(plain_words(u)[-1] == script.words[mention.end - 1].text for u in unit)
        if is_singular and "of" not in texts and {"a", "an", "single"} & set(texts):
            return True
    return False
