"""Detect answers that deny the presence of everything, such as "no", "none" and "there are no cones at all"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.text import AnswerText

_NONE_STATEMENT = re.compile(
    r"^(no|nope|none|nothing|nobody|no one|zero)$|^(none|nothing|nobody|no one)\b(?! (of (?!them|these|those)|but|else))"
    r"(?! (\w+ )?(has |have )?(was |were |is |are |been |be )*(returned|reported|given|received|provided|loaded|answered|done|"
    r"happened|changed|moved|worked|came|executed|required|wrong)\b)"
    r"|\bthere (is|are|were) (none|nothing)\b"
    r"|\b(found|find|see|saw|spotted|detected) (none|nothing)( (here|there|visible|in view))?$"
    r"|\bnot (any|one|a single one)( (here|there|visible|in view))?$"
)
"""Statements that nothing is there, such as "nothing is visible" and "not a single one". "Nothing was returned" does not match."""
_RESTRICTING_WORDS = re.compile(r"\b(others?|else|elsewhere)\b")
"""Words that restrict "none" to other things or places ("no others", "nothing else")."""


def says_none(text: AnswerText) -> bool:
    """Return whether a segment or clause says only "none", as in "No.", "There are none" and "Nothing like that is visible"."""
    parts = [" ".join(text.words[i].text for i in group) for group in (*text.segments(), *text.clauses())]
    return any(map(_is_none, parts))


def _is_none(part: str) -> bool:
    return _NONE_STATEMENT.search(part) is not None and not _RESTRICTING_WORDS.search(part)


def says_yes(text: AnswerText) -> bool:
    """Return whether the answer contains "yes" or a variant of it."""
    return any(word.text in ("yes", "yeah", "yep", "yup") for word in text.words)


def denies_entirely(text: AnswerText, subject: Sequence[str]) -> bool:
    """Return whether a clause denies the subject without restricting it to a place ("at the gate") or a kind ("red ones")."""
    mentions = text.mentions({"subject": subject}) if subject else []
    numbers = find_numbers(text, subject)
    denials = {m.start for m in mentions if m.denied and not m.contrast}
    denials |= {n.start for n in numbers if n.value == 0 and not (n.counts_other or n.bound or n.denied)}
    covered = {i for m in mentions for i in range(m.start, m.end)} | {i for n in numbers for i in range(n.start, n.end)}
    return any(
        (denials.intersection(clause) or _says_none_in(text, clause))
        and all(text.words[i].text in _NEUTRAL_WORDS for i in clause if i not in covered)
        for clause in text.clauses()
    )


def _says_none_in(text: AnswerText, clause: Sequence[int]) -> bool:
    """Return whether a clause, or a segment that begins in it, says only "none"."""
    groups = [*(group for group in text.segments() if group[0] in clause), clause]
    return any(_is_none(" ".join(text.words[i].text for i in group)) for group in groups)


_NEUTRAL_WORDS = frozenset({
    "no", "not", "none", "nothing", "nobody", "zero", "0", "never", "nope", "without", "neither", "nor", "there", "is", "are",
    "was", "were", "be", "been", "i", "we", "you", "it", "they", "them", "that", "this", "these", "those", "see", "sees", "saw",
    "seen", "can", "could", "do", "does", "did", "find", "found", "count", "counted", "visible", "present", "absent", "missing",
    "any", "anywhere", "at", "all", "in", "on", "the", "a", "an", "one", "single", "view", "image", "picture", "scene", "frame",
    "photo", "here", "now", "currently", "so", "of", "to", "whole", "full", "current", "entire", "answer", "total",
    "altogether", "overall", "together", "number", "however", "but", "and", "or", "yet", "still", "simply", "really",
    "actually", "just", "only", "exactly", "final", "finally", "therefore", "thus", "hence", "say", "would", "shows", "show",
    "has", "have", "with", "makes", "sum", "nonetheless", "instead", "also", "then", "by", "for", "as", "my", "its", "sign",
    "such", "like",
})  # fmt: skip
"""Words that do not restrict a denial to a place or a kind."""
