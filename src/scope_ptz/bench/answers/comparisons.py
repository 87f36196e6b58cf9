"""Find comparatives ("more", "closer"), the thing that each one describes, and the reference of the comparison."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from scope_ptz.bench.answers.text import AnswerText, NameMention

_OPPOSITES = (
    ({"more", "most", "greater", "greatest", "higher", "highest", "busier", "busiest"},
     {"fewer", "fewest", "less", "least", "lower", "lowest", "quieter", "quietest"}),
    ({"closer", "closest", "nearer", "nearest"}, {"farther", "farthest", "further", "furthest"}),
    ({"larger", "largest", "bigger", "biggest", "most"}, {"smaller", "smallest", "least"}),
    ({"taller", "tallest"}, {"shorter", "shortest"}),
    ({"leftmost", "left most", "furthest left", "farthest left", "furthest to the left", "farthest to the left"},
     {"rightmost", "right most", "furthest right", "farthest right", "furthest to the right", "farthest to the right"}),
)  # fmt: skip
"""Pairs of sets of comparatives with opposite meanings."""

_COUNTING_COMPARATIVES = frozenset({"more", "most", "fewer", "fewest", "less", "least"})
"""Comparatives that may precede the noun that they count ("fewer skips")."""
_REFERENCE_WORDS = frozenset({"than", "versus", "vs", "against"})
"""Words that introduce the reference of a comparison."""
_PREPOSITIONS = frozenset({"of", "from", "to"})
"""Prepositions that introduce the reference directly after a comparative, as in "left of B" and "closest to B"."""


def comparatives_by_direction(picks: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return comparatives with their synonyms ("forward"), and their antonyms ("backward")."""
    forward, backward = set(picks), set[str]()
    for left, right in _OPPOSITES:
        for same, opposite in ((left, right), (right, left)):
            if same & set(picks):
                forward |= same
                backward |= opposite
    return {"forward": tuple(sorted(forward)), "backward": tuple(sorted(backward - forward))}


def find_comparatives(text: AnswerText, wordings: dict[str, tuple[str, ...]]) -> list[NameMention]:
    """Return the comparatives in an answer, except those in "at least", "at most" and "more or less"."""
    matches = list[NameMention]()
    for mention in text.mentions(wordings):
        before = text.words[mention.start - 1].text if mention.start else ""
        after = " ".join(w.text for w in text.words[mention.end : mention.end + 2])
        if before not in ("at", "or") and not re.match(r"or less\b", after):
            matches.append(mention)
    return matches


def described_thing(text: AnswerText, comparative: NameMention, things: Sequence[NameMention]) -> NameMention | None:
    """Return the thing that a comparative describes.

    If the comparative counts a noun ("fewer skips"), the noun is the thing. Otherwise, it is the last thing named before the
    comparative, or else the first thing named after it.
    """
    words, reference = text.words, reference_of(text, comparative, things)
    clause = [m for m in things if words[m.start].clause == words[comparative.start].clause and m != reference]
    if words[comparative.end - 1].text in _COUNTING_COMPARATIVES:
        counted = [m for m in clause if m.start == comparative.end and not words[m.start].gap.strip()]
        if counted:
            return counted[0]
    near = [m for m in clause if words[m.start].segment == words[comparative.start].segment] or clause
    before = [m for m in near if m.start < comparative.start]
    return before[-1] if before else near[0] if near else None


def reference_of(text: AnswerText, comparative: NameMention, things: Sequence[NameMention]) -> NameMention | None:
    """Return the reference of a comparison, which is B in "more than B", "left of B" and "compared with B"."""
    for mention in (m for m in things if text.words[m.start].clause == text.words[comparative.start].clause):
        between = [w.text for w in text.words[comparative.end : mention.start]] if mention.start > comparative.end - 1 else []
        if set(between) & _REFERENCE_WORDS:
            return mention
        lead = [w.text for w in text.words[max(0, mention.start - 3) : mention.start]]
        if "compared" in lead:
            return mention
        if between and set(between[:2]) & _PREPOSITIONS and len(between) <= 3:
            return mention
    return None
