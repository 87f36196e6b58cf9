"""Reading answers that compare: orders of several things, and how one stands to another."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.bench.answers.choices import SAME
from scope_ptz.bench.answers.comparisons import bearer_of, reference_of
from scope_ptz.bench.answers.numbers import find_numbers
from scope_ptz.bench.answers.options import option_mentions
from scope_ptz.bench.answers.order_numbers import concluding, contradicts_its_numbers
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.tasks.expected import Ordering, Relation

_FILLERS = frozenset({
    "it", "is", "its", "on", "to", "the", "at", "in", "side", "of", "hand", "a", "bit", "slightly", "much", "them", "lies",
})  # fmt: skip
_NAMING = frozenset({
    "the", "a", "at", "preset", "view", "by", "it", "is", "answer", "i", "would", "say", "that", "definitely", "clearly",
    "one", "to", "versus", "against",
})  # fmt: skip
_TURNED = {"forward": "backward", "backward": "forward"}


def parse_ordering(expected: Ordering, script: AnswerText) -> ParsedAnswer:
    """The options in the order that the answer gives them, turned round where it begins at the other end."""
    everything = [m for m in option_mentions(script, expected.options) if not m.denied or _is_counted(script, m)]
    begins = concluding(script, everything, set(expected.options))
    mentions = [m for m in everything if m.start >= begins]
    order = list(dict.fromkeys(m.name for m in mentions))
    if set(order) != set(expected.options):
        return Unreadable("not all of them are named" if order else "none of them is named")
    ends = [m for m in script.mentions({"first": expected.first, "last": expected.last}) if m.start >= begins]
    told = _told(script, mentions, ends, order, begins)
    if isinstance(told, str):
        return Unreadable(told)
    if contradicts_its_numbers(script, everything, told, expected.first):
        return Unreadable("its own numbers contradict the order")
    return ParsedValue(told)


def _told(
    script: AnswerText, mentions: Sequence[NameMention], ends: Sequence[NameMention], order: list[str], begins: int
) -> tuple[str, ...] | str:
    """The order that is told, or the reason why none is."""
    thans = sum(w.text == "than" for w in script.words[begins:])
    if 0 < thans < len(order) - 1:
        return "only some of them are compared"
    placed = _placed(script, mentions, ends)
    if placed.get("first") is not None and placed.get("last") is not None and placed["first"] != placed["last"]:
        between = [name for name in order if name not in placed.values()]
        if len(between) > 1 and (order[0], order[-1]) not in ((placed["first"], placed["last"]), (placed["last"], placed["first"])):
            return "the order between the two ends is not told"
        if order[0] == placed["last"] and order[-1] == placed["first"]:
            between.reverse()
        return (str(placed["first"]), *between, str(placed["last"]))
    starts_at_last = placed.get("last") == order[0] or _heading_is_turned(mentions, ends)
    if starts_at_last or any("<" in w.gap for w in script.words[begins:]):
        order.reverse()
    elif placed.get("first") not in (None, order[0]) or placed.get("last") not in (None, order[-1]):
        return "the order is told in two ways"
    return tuple(order)


def _is_counted(script: AnswerText, mention: NameMention) -> bool:
    """Whether a number of none stands beside a thing: "cabinets (none)" has a place in an order, and denies nothing."""
    after = script.words[mention.end] if mention.end < len(script.words) else None
    return after is not None and after.text in ("none", "0", "zero") and re.search(r"[(:=]", after.gap) is not None


def _placed(script: AnswerText, mentions: Sequence[NameMention], ends: Sequence[NameMention]) -> dict[str, str | None]:
    """Which option is said to be at which end: in a segment what is named before it, else, where it has one end, after it."""
    placed: dict[str, str | None] = {}
    for group in script.segments():
        here = [m for m in mentions if group[0] <= m.start <= group[-1]]
        end = [m for m in ends if group[0] <= m.start <= group[-1] and not m.denied]
        if any([w.text for w in script.words[one.end : two.start]] == ["to"] for one, two in pairwise(end)):
            continue  # "from most to fewest" places nothing.
        since = group[0]
        for one in end:
            before = [m for m in here if since <= m.start < one.start]
            if before or (len(end) == 1 and here):
                placed.setdefault(one.name, (before[-1] if before else here[0]).name)
            since = one.start
    return placed


def _heading_is_turned(mentions: Sequence[NameMention], ends: Sequence[NameMention]) -> bool:
    """ "From fewest to most: ..."."""
    before = [m.name for m in ends if m.start < mentions[0].start]
    return before[:2] == ["last", "first"] or before == ["last"]


def parse_relation(expected: Relation, script: AnswerText) -> ParsedAnswer:
    """How the subject stands to the object, as every clause of the answer that says so agrees."""
    said = set[str]()
    names = {"subject": expected.subject, "object": expected.object}
    ways = {"forward": expected.forward, "backward": expected.backward}
    things = script.mentions(names)
    comparators = [m for m in script.mentions(ways) if not m.denied]
    for comparator in comparators:
        way = _way(script, comparator, things)
        if way is None:
            return Unreadable("it does not say which of them")
        said.add(way)
    alike = [m for m in script.mentions({"same": (*expected.same, *SAME)}) if not m.denied]
    if alike and not comparators:
        return ParsedValue("same")
    denied = any(m.denied for m in script.mentions({**ways, "same": SAME}))
    if not comparators and not denied and not any(w.text == "or" for w in script.words):
        named = {m.name for m in things if not m.denied}
        if len(named) == 1 and _is_bare(script, things):
            said.add("forward" if named == {"subject"} else "backward")
    if len(said) == 1:
        return ParsedValue(said.pop())
    return Unreadable("it says both" if said else "no comparison")


def _is_bare(script: AnswerText, things: Sequence[NameMention]) -> bool:
    """Whether a text does no more than name a thing ("The gate.", "At the gate, by two")."""
    named = {i for m in things for i in range(m.start, m.end)}
    counted = {i for q in find_numbers(script, ()) for i in range(q.start, q.end)}
    return all(w.text in _NAMING for i, w in enumerate(script.words) if i not in named | counted)


def _way(script: AnswerText, comparator: NameMention, things: Sequence[NameMention]) -> str | None:
    """The relation of subject to object that one comparator states; None when it does not say of which of them."""
    reference = reference_of(script, comparator, things)
    if reference is not None:
        return comparator.name if reference.name == "object" else _TURNED[comparator.name]
    bearer = bearer_of(script, comparator, things)
    if bearer is not None:
        return comparator.name if bearer.name == "subject" else _TURNED[comparator.name]
    clause = script.words[comparator.start].clause
    words = {w.text for i, w in enumerate(script.words) if w.clause == clause and not comparator.start <= i < comparator.end}
    return comparator.name if words <= _FILLERS else None
