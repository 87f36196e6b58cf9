"""Parse comparisons: an order of several things, or the relation between two things."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.choices import EQUALITY_PHRASES
from scope_ptz.bench.answers.comparisons import described_thing, reference_of
from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.options import option_mentions
from scope_ptz.bench.answers.order_numbers import final_order_start, numbers_contradict
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.tasks.expected import Ordering, Relation

_FILLERS = frozenset({
    "it", "is", "its", "on", "to", "the", "at", "in", "side", "of", "hand", "a", "bit", "slightly", "much", "them", "lies",
})  # fmt: skip
"""Words that do not name a thing. A comparative with only these words around it describes the subject ("it is slightly closer")."""

_NAMING_WORDS = frozenset({
    "the", "a", "at", "preset", "view", "by", "it", "is", "answer", "i", "would", "say", "that", "definitely", "clearly",
    "one", "to", "versus", "against",
})  # fmt: skip
"""Words that may occur besides the name in an answer that only names a thing ("the gate preset")."""

_OPPOSITE = {"forward": "backward", "backward": "forward"}


def parse_ordering(expected: Ordering, text: AnswerText) -> ParsedAnswer:
    """Parse the order that an answer gives. If the answer lists the things from last to first, the order is reversed."""
    all_mentions = [m for m in option_mentions(text, expected.options) if not m.denied or _is_counted_as_zero(text, m)]
    start = final_order_start(text, all_mentions, set(expected.options))
    mentions = [m for m in all_mentions if m.start >= start]
    order = list(dict.fromkeys(m.name for m in mentions))
    if _are_two_orders([m.name for m in mentions], len(expected.options)):
        return Unreadable("it states several orders")
    if set(order) != set(expected.options):
        return Unreadable("not all of them are named" if order else "none of them is named")
    ends = [m for m in text.mentions({"first": expected.first, "last": expected.last}) if m.start >= start]
    stated = _stated_order(text, mentions, ends, order, start)
    if isinstance(stated, str):
        return Unreadable(stated)
    if numbers_contradict(text, all_mentions, stated, expected.first):
        return Unreadable("its own numbers contradict the order")
    return ParsedValue(stated)


def _are_two_orders(names: Sequence[str], number: int) -> bool:
    """Return whether names form two complete lists in different orders."""
    first, second = names[:number], names[number:]
    return len(names) == 2 * number and len(set(first)) == len(set(second)) == number and list(first) != list(second)


def _stated_order(
    text: AnswerText, mentions: Sequence[NameMention], ends: Sequence[NameMention], order: list[str], start: int
) -> tuple[str, ...] | str:
    """Return the stated order, or the reason why no order is stated.

    Args:
        text: The answer.
        mentions: The mentions of options in the final order.
        ends: The mentions of words for the two ends of the order, with the names "first" and "last".
        order: The options in the order in which the answer names them. It may be reversed in place.
        start: Position of the word at which the final order begins.
    """
    than_count = sum(w.text == "than" for w in text.words[start:])
    if 0 < than_count < len(order) - 1:
        return "only some of them are compared"
    placed = _options_at_ends(text, mentions, ends)
    if placed.get("first") is not None and placed.get("last") is not None and placed["first"] != placed["last"]:
        between = [name for name in order if name not in placed.values()]
        if len(between) > 1 and (order[0], order[-1]) not in ((placed["first"], placed["last"]), (placed["last"], placed["first"])):
            return "the order between the two ends is missing"
        if order[0] == placed["last"] and order[-1] == placed["first"]:
            between.reverse()
        return (str(placed["first"]), *between, str(placed["last"]))
    starts_at_last = placed.get("last") == order[0] or _announces_opposite_order(mentions, ends)
    if starts_at_last or any("<" in w.gap for w in text.words[start:]):
        order.reverse()
    elif placed.get("first") not in (None, order[0]) or placed.get("last") not in (None, order[-1]):
        return "the order is ambiguous"
    return tuple(order)


def _is_counted_as_zero(text: AnswerText, mention: NameMention) -> bool:
    """Return whether a thing is counted as zero. "Cabinets (none)" is an item in an order rather than a denial."""
    after = text.words[mention.end] if mention.end < len(text.words) else None
    return after is not None and after.text in ("none", "0", "zero") and re.search(r"[(:=]", after.gap) is not None


def _options_at_ends(text: AnswerText, mentions: Sequence[NameMention], ends: Sequence[NameMention]) -> dict[str, str | None]:
    """Return the option that the answer places at each end of the order ("first" and "last").

    In each segment, this is the option before the word for the end ("most", "fewest"). If the segment names only one end, the
    option may also follow that word.
    """
    placed: dict[str, str | None] = {}
    for group in text.segments():
        here = [m for m in mentions if group[0] <= m.start <= group[-1]]
        ends_here = [m for m in ends if group[0] <= m.start <= group[-1] and not m.denied]
        if any([w.text for w in text.words[first.end : second.start]] == ["to"] for first, second in pairwise(ends_here)):
            continue  # "from most to fewest" states the direction of the order and places no option.
        since = group[0]
        for end in ends_here:
            before = [m for m in here if since <= m.start < end.start]
            if before or (len(ends_here) == 1 and here):
                placed.setdefault(end.name, (before[-1] if before else here[0]).name)
            since = end.start
    return placed


def _announces_opposite_order(mentions: Sequence[NameMention], ends: Sequence[NameMention]) -> bool:
    """Return whether the answer announces the opposite order, as in "From fewest to most: ..."."""
    before = [m.name for m in ends if m.start < mentions[0].start]
    return before[:2] == ["last", "first"] or before == ["last"]


def parse_relation(expected: Relation, text: AnswerText) -> ParsedAnswer:
    """Parse the relation between subject and object. All comparisons in the answer must agree."""
    relations = set[str]()
    names = {"subject": expected.subject, "object": expected.object}
    directions = {"forward": expected.forward, "backward": expected.backward}
    things = text.mentions(names)
    comparatives = [m for m in text.mentions(directions) if not m.denied]
    for comparative in comparatives:
        direction = _direction(text, comparative, things)
        if direction is None:
            return Unreadable("it does not say which of them")
        relations.add(direction)
    equalities = [m for m in text.mentions({"same": (*expected.same, *EQUALITY_PHRASES)}) if not m.denied]
    if equalities and not comparatives:
        return ParsedValue("same")
    denied = any(m.denied for m in text.mentions({**directions, "same": EQUALITY_PHRASES}))
    if not comparatives and not denied and not any(w.text == "or" for w in text.words):
        named = {m.name for m in things if not m.denied}
        if len(named) == 1 and _only_names_thing(text, things):
            relations.add("forward" if named == {"subject"} else "backward")
    if len(relations) == 1:
        return ParsedValue(relations.pop())
    return Unreadable("it says both" if relations else "no comparison")


def _only_names_thing(text: AnswerText, things: Sequence[NameMention]) -> bool:
    """Return whether an answer only names a thing ("The gate.", "At the gate, by two")."""
    named = {i for m in things for i in range(m.start, m.end)}
    counted = {i for q in find_numbers(text, ()) for i in range(q.start, q.end)}
    return all(w.text in _NAMING_WORDS for i, w in enumerate(text.words) if i not in named | counted)


def _direction(text: AnswerText, comparative: NameMention, things: Sequence[NameMention]) -> str | None:
    """Return the relation that a comparative states, or None if it is unclear which thing the comparative describes."""
    reference = reference_of(text, comparative, things)
    if reference is not None:
        return comparative.name if reference.name == "object" else _OPPOSITE[comparative.name]
    described = described_thing(text, comparative, things)
    if described is not None:
        return comparative.name if described.name == "subject" else _OPPOSITE[comparative.name]
    clause = text.words[comparative.start].clause
    words = {w.text for i, w in enumerate(text.words) if w.clause == clause and not comparative.start <= i < comparative.end}
    return comparative.name if words <= _FILLERS else None
