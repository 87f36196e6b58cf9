"""Name one of several things by another one: "the other one" of two, and "the next one" in an order."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.english.numerals import ORDINALS
from scope_ptz.planner.grammar.binding.focus import Focus
from scope_ptz.planner.grammar.binding.narrowing import is_region, is_worn
from scope_ptz.planner.grammar.binding.noun_heads import head_noun, is_same_kind
from scope_ptz.planner.grammar.execution.answer_sentences import head_and_rest, noun

_OPPOSITES = {
    "left": "right", "leftmost": "rightmost", "left-hand": "right-hand", "first": "second", "nearest": "farthest",
    "closest": "farthest", "nearer": "farther", "closer": "farther", "front": "back", "top": "bottom", "upper": "lower",
    "bigger": "smaller", "biggest": "smallest", "larger": "smaller", "largest": "smallest", "taller": "shorter",
}  # fmt: skip
"""Words that tell two things apart by their order, with their opposites."""
_OPPOSITE = {**_OPPOSITES, **{second: first for first, second in reversed(_OPPOSITES.items())}, "last": "first"}
_RANKS = (
    ("nearer nearest closer closest", "farther farthest further furthest"), ("bigger biggest larger largest", "smaller smallest"),
    ("taller tallest higher highest", "shorter shortest lower lowest"),
)  # fmt: skip
_RANK = {word: 2 * i + j for i, pair in enumerate(_RANKS) for j, words in enumerate(pair) for word in words.split(" ")}
"""Words that compare two things. The numbers of opposites differ in their last bit only."""

_RANKED_ONE = re.compile(r"(?P<rank>\w+)(?: one| of the two| of them)?", re.IGNORECASE)
_AFTER = re.compile(r"(?:next|following) one|one (?:after|following)(?: (?:it|that))?", re.IGNORECASE)
_BEFORE = re.compile(r"previous one|one before(?: (?:it|that))?", re.IGNORECASE)
_WORN = re.compile(r" (?:with|wearing|carrying|holding) (?=\w)")
_CARRIED = re.compile(r" (?:wearing|carrying|holding) (?=\w)")
_WITHOUT = re.compile(r" (?:without|not wearing|not carrying|not holding) (?=\w)")


def pair_in(foci: Sequence[Focus], kind: str = "") -> int | None:
    """Return the index of the latest things of which there are exactly two; None if there are none.

    Args:
        foci: What the conversation was about, oldest first.
        kind: The noun of the things; empty for the latest ones of any kind.
    """
    for i in reversed(range(len(foci))):
        focus = foci[i]
        is_meant = not kind or is_same_kind(focus.description, kind)
        if is_meant and focus.number == 2 and not focus.is_chosen:
            return i
        if is_meant and focus.number is not None and focus.number > 2:
            return None  # they were counted again, and are no pair
    return None


def members_of(pair: Focus) -> tuple[str, str]:
    """Return the descriptions of two things: as the answer named them, otherwise by their places, the left one first."""
    if len(pair.members) == 2:
        return pair.members[0], pair.members[1]
    one = noun(pair.description, 1)
    return f"left {one}", f"right {one}"


def taken_of(foci: Sequence[Focus], pair: int, current: str = "") -> str:
    """Return the description of the one of two things that was spoken of after them; empty if none was.

    Args:
        foci: What the conversation was about, oldest first.
        pair: The index of the two things.
        current: The thing that the instruction has named itself; empty for none.
    """
    if current:
        return current
    later = (focus for focus in reversed(foci[pair + 1 :]) if not focus.is_several)
    kind = head_noun(foci[pair].description)
    return next(
        (focus.description for focus in later if is_same_kind(focus.description, kind) or _is_member(focus, foci[pair])), ""
    )


def other_of(pair: Focus, taken: str) -> str:
    """Return the description of the other one of two things; empty if what tells them apart is not clear.

    It has the opposite of an adjective before the noun ("left dog") or of a place in the picture ("dog on the left"), or lacks what
    the one wears or carries. A dog "in front of the van" may be beside another one in front of it.

    Args:
        pair: The two things.
        taken: The one of them that was taken: "left dog", or "worker with a white helmet".
    """
    meant = [i for i, member in enumerate(pair.members) if _describes(taken, member)]
    if len(pair.members) == 2 and len(meant) == 1:
        return pair.members[1 - meant[0]]
    head, rest = head_and_rest(taken)
    is_place = is_region(rest.strip()) if rest else False
    words, last = taken.split(" "), len(head.split(" ")) - 1
    places = [i for i, word in enumerate(words) if word.lower() in _OPPOSITE and (i < last or (i > last and is_place))]
    if len(places) == 1:
        words[places[0]] = _OPPOSITE[words[places[0]].lower()]
        return " ".join(words)
    if places or not (is_worn(taken) or _CARRIED.search(taken)):
        return ""
    if _WITHOUT.search(taken):
        return _WITHOUT.sub(" with ", taken, count=1)
    if len(_WORN.findall(taken)) == 1 and not _WORN.search(pair.description):
        return _WORN.sub(" without ", taken)
    return ""


def compared_one(focus: Focus, text: str) -> str | None:
    """Return the thing that "the nearer one" means after "which is nearer, the bus or the car?"; None for other words.

    It is empty if the answer named neither of the two.
    """
    match = _RANKED_ONE.fullmatch(text)
    if match is None or not focus.compared:
        return None
    rank = match["rank"].lower()
    asked = next((word for word in re.findall(r"[a-z]+", focus.question.lower()) if word in _RANK), "")
    if not asked or rank not in _RANK:
        return None
    if focus.number == 2:
        return ""
    if _RANK[rank] == _RANK[asked]:
        return focus.compared[0]
    return focus.compared[1] if _RANK[rank] == _RANK[asked] ^ 1 else None


def neighbour_of(text: str, current: str) -> str:
    """Return the thing before or after another one in an order: for "next one" after "first board", "second board".

    Empty for other texts, and if the other thing has no number in an order.
    """
    step = 1 if _AFTER.fullmatch(text) else -1 if _BEFORE.fullmatch(text) else 0
    words = current.split(" ")
    place = ORDINALS.get(words[0].lower())
    if not step or place is None:
        return ""
    place += step
    neighbour = next((word for word, number in ORDINALS.items() if number == place), "")
    return " ".join([neighbour, *words[1:]]) if neighbour else ""


def names_neighbour(text: str) -> bool:
    """Return whether text is "next one", "previous one", "one before" or the like."""
    return _AFTER.fullmatch(text) is not None or _BEFORE.fullmatch(text) is not None


def _is_member(focus: Focus, pair: Focus) -> bool:
    return any(_describes(focus.description, member) for member in pair.members)


def _describes(taken: str, member: str) -> bool:
    """Return whether a shorter description is contained in that of a thing: "yellow skip" in "yellow skip on the left"."""
    return set(taken.lower().split(" ")) <= set(member.lower().split(" "))
