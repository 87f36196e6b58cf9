"""Find comparatives ("more", "closer"), the thing that each one describes, and the thing with which it is compared."""

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

_COUNTING = frozenset({"more", "most", "fewer", "fewest", "less", "least"})
"""Comparatives that may precede the noun that they count ("fewer skips")."""
_REFERENCE_WORDS = frozenset({"than", "versus", "vs", "against"})
"""Words that introduce the reference of a comparative."""
_PREPOSITIONS = frozenset({"of", "from", "to"})
"""Words that introduce the reference shortly after a comparative, as in "left of B" and "closest to B"."""


def directions(picks: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return the comparatives that mean the same as the given words ("forward") and those that mean the opposite ("backward")."""
    forward, backward = set(picks), set[str]()
    for ones, others in _OPPOSITES:
        for same, against in ((ones, others), (others, ones)):
            if same & set(picks):
                forward |= same
                backward |= against
    return {"forward": tuple(sorted(forward)), "backward": tuple(sorted(backward - forward))}


def comparatives(text: AnswerText, wordings: dict[str, tuple[str, ...]]) -> list[NameMention]:
    """Return the comparatives in an answer. "At least", "at most" and "more or less" are left out."""
    matches = list[NameMention]()
    for mention in text.mentions(wordings):
        before = text.words[mention.start - 1].text if mention.start else ""
        after = " ".join(w.text for w in text.words[mention.end : mention.end + 2])
        if before not in ("at", "or") and not re.match(r"or less\b", after):
            matches.append(mention)
    return matches


def described_thing(text: AnswerText, comparative: NameMention, things: Sequence[NameMention]) -> NameMention | None:
    """Return the thing that a comparative describes.

    This is the noun that the comparative counts ("fewer skips"). If there is none, it is the last thing named before the
    comparative, otherwise the first thing after it.
    """
    words, reference = text.words, reference_of(text, comparative, things)
    clause = [m for m in things if words[m.start].clause == words[comparative.start].clause and m != reference]
    if words[comparative.end - 1].text in _COUNTING:
        counted = [m for m in clause if m.start == comparative.end and not words[m.start].gap.strip()]
        if counted:
            return counted[0]
    near = [m for m in clause if words[m.start].segment == words[comparative.start].segment] or clause
    before = [m for m in near if m.start < comparative.start]
    return before[-1] if before else near[0] if near else None


def reference_of(text: AnswerText, comparative: NameMention, things: Sequence[NameMention]) -> NameMention | None:
    """Return the reference of a comparative, the thing compared with: B in "more than B", "left of B" and "compared with B"."""
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
