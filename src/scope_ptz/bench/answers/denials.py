"""Saying that there is none, with or without saying of where."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.text import AnswerText

_NONE = re.compile(
    r"^(no|nope|none|nothing|nobody|no one|zero)$|^(none|nothing|nobody|no one)\b(?! (of (?!them|these|those)|but|else))"
    r"(?! (\w+ )?(has |have )?(was |were |is |are |been |be )*(returned|reported|given|received|provided|loaded|answered|done|"
    r"happened|changed|moved|worked|came|executed|required|wrong)\b)"
    r"|\bthere (is|are|were) (none|nothing)\b"
    r"|\b(found|find|see|saw|spotted|detected) (none|nothing)( (here|there|visible|in view))?$"
    r"|\bnot (any|one|a single one)( (here|there|visible|in view))?$"
)
_OF_OTHERS = re.compile(r"\b(others?|else|elsewhere)\b")


def says_none(script: AnswerText) -> bool:
    """Whether a sentence of the text is nothing but "none" ("No.", "There are none", "Nothing like that is visible")."""
    parts = [" ".join(script.words[i].text for i in group) for group in (*script.segments(), *script.clauses())]
    return any(_NONE.search(part) and not _OF_OTHERS.search(part) for part in parts)


def says_yes(script: AnswerText) -> bool:
    return any(word.text in ("yes", "yeah", "yep", "yup") for word in script.words)


def denies_flatly(script: AnswerText, subject: Sequence[str]) -> bool:
    """Whether a clause says that there is none and neither where ("at the gate") nor of which ("red ones")."""
    denied = [m for m in script.mentions({"subject": subject}) if m.denied and not m.aside] if subject else []
    zeros = [q for q in find_numbers(script, subject) if q.value == 0 and not (q.other or q.bound or q.denied)]
    named = {i for m in script.mentions({"subject": subject}) for i in range(m.start, m.end)} if subject else set[int]()
    numbers = {i for q in find_numbers(script, subject) for i in range(q.start, q.end)}
    segments = script.segments()
    for clause in script.clauses():
        parts = [" ".join(script.words[i].text for i in group) for group in segments if group[0] in clause]
        said = any(
            _NONE.search(part) and not _OF_OTHERS.search(part) for part in (*parts, " ".join(script.words[i].text for i in clause))
        )
        said = said or bool({m.start for m in denied}.union(q.start for q in zeros).intersection(clause))
        if said and all(script.words[i].text in _FLAT for i in clause if i not in named | numbers):
            return True
    return False


_FLAT = frozenset({
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
"""Words that say neither where there is none nor of which."""
