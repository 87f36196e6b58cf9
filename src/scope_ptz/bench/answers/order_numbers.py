"""Find the numbers that an answer gives for the things it orders, and where its final order begins."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.number_words import number_at
from scope_ptz.bench.answers.text import AnswerText, NameMention

_CONCLUDING_WORDS = frozenset(
    {"so", "therefore", "thus", "hence", "order", "ordering", "ranking", "ranked", "answer", "sorted", "conclusion", "from"}
)
"""Words that may introduce the final order. "From" counts only if "to" follows, as in "from most to fewest"."""
_ASCENDING = frozenset({"nearest", "closest", "fewest", "smallest", "least", "lowest", "shortest"})
"""Words for the first item in an ascending order."""
_DESCENDING = frozenset({"farthest", "furthest", "most", "largest", "biggest", "highest", "tallest"})
"""Words for the first item in a descending order."""
_NUMBER_SEPARATOR = re.compile(r"\s*([:=(|~≈]|\s[-–—]\s|→)[\s(~≈]*")
"""Separators between a thing and its number, as in "skips: 4" and "skips (4)"."""
_LINKING_WORDS = frozenset(
    {"is", "are", "at", "about", "approximately", "roughly", "with", "stands", "has", "have", "only", "just", "around"}
)
"""Words that may occur between a thing and its number, as in "the skip is about 11 m away"."""


def final_order_start(text: AnswerText, mentions: Sequence[NameMention], names: set[str]) -> int:
    """Return the position of the word at which the final order in an answer begins.

    The final order begins at the last concluding word ("so", "therefore") that is followed by all names. Without such a word, it
    begins at a list without numbers that follows a list with numbers. Without such a list, it begins at position 0.
    """
    last = 0
    for at, word in enumerate(text.words):
        after = [w.text for w in text.words[at + 1 : at + 5]]
        is_conclusion = "to" in after if word.text == "from" else not (word.text == "order" and after[:1] == ["to"])
        if word.text in _CONCLUDING_WORDS and is_conclusion and {m.name for m in mentions if m.start > at} == names:
            last = at
    return last or _unnumbered_list_start(text, mentions, names)


def _unnumbered_list_start(text: AnswerText, mentions: Sequence[NameMention], names: set[str]) -> int:
    numbered = [bool(_numbers_by_name(text, [m])) for m in mentions]
    start = numbered.index(False) if False in numbered else 0
    listed = mentions[start : start + len(names)]
    clauses = {text.words[m.start].clause for m in listed}
    if start < len(names) or any(numbered[start : start + len(names)]) or {m.name for m in listed} != names or len(clauses) > 1:
        return 0
    return next(at for at, word in enumerate(text.words) if word.clause in clauses)


def numbers_contradict(text: AnswerText, mentions: Sequence[NameMention], order: Sequence[str], first: Sequence[str]) -> bool:
    """Return whether the counts or distances in an answer contradict its order.

    Args:
        text: The answer.
        mentions: The mentions of things in the answer.
        order: The stated order.
        first: Words for the first item in the order, such as "most" or "nearest".
    """
    descending, ascending = bool(_DESCENDING.intersection(first)), bool(_ASCENDING.intersection(first))
    if descending == ascending:
        return False
    numbers = _numbers_by_name(text, mentions)
    values = [numbers[name] for name in order if name in numbers]
    return any(max(earlier) < min(later) if descending else min(earlier) > max(later) for earlier, later in pairwise(values))


def _numbers_by_name(text: AnswerText, mentions: Sequence[NameMention]) -> dict[str, set[float]]:
    """Return the numbers that the answer gives for each thing, as in "4 skips", "skips (4)" and "the skip is 11 m away"."""
    numbers = dict[str, set[float]]()
    words = text.words
    for mention in mentions:
        value = _number_after(text, mention)
        if value is None:
            for start in range(max(0, mention.start - 3), mention.start):
                number, end = number_at(words, start)
                between = words[start + 1 : mention.start + 1]
                plain = all(not w.gap.strip() for w in between) and not any(w.text in ("m", "metre", "metres") for w in between)
                if number is not None and 0 <= mention.start - end <= 1 and plain:
                    value = number
                    break
        if value is not None:
            numbers.setdefault(mention.name, set()).add(value)
    return numbers


def _number_after(text: AnswerText, mention: NameMention) -> float | None:
    words, at = text.words, mention.end
    if at >= len(words):
        return None
    marked = _NUMBER_SEPARATOR.fullmatch(words[at].gap) is not None
    while at < len(words) and words[at].text in _LINKING_WORDS and at < mention.end + 3 and (marked or not words[at].gap.strip()):
        marked, at = True, at + 1
    value, end = number_at(words, at)
    is_distance = end < len(words) and words[end].text in ("metre", "metres") and not words[at].gap.strip()
    if not (marked or is_distance):
        return None
    is_ordinal = end < len(words) and words[end].gap == "" and words[end].text in ("st", "nd", "rd", "th")
    return None if is_ordinal else value
