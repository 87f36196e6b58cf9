"""What the tools of a run said, what a right look would have said, and whether the final answer rests on either."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import combinations

from scope_ptz.bench.coverage import counts_for, inside, reference_directions, shows
from scope_ptz.bench.episode import Call, Episode, Look
from scope_ptz.bench.expected import (
    AnyExpected,
    Choice,
    Description,
    NameSet,
    NoneThere,
    Number,
    Text,
    YesNo,
)
from scope_ptz.bench.reader import agrees, read
from scope_ptz.bench.reader_numbers import find_quantities
from scope_ptz.bench.reader_strings import folded
from scope_ptz.bench.reader_text import script
from scope_ptz.bench.reader_words import names_any
from scope_ptz.bench.reading import Value
from scope_ptz.bench.tasks import EvidenceView, Task

CountTruth = Callable[[Look], int | None]
"""How many of what was asked really show in the very picture of a look; None when the truth cannot say."""

_MOST_COUNTS = 8


def said_by_tools(episode: Episode) -> str:
    """Everything that tools said, as one text."""
    parts = list[str]()
    for call in episode.calls:
        if call.succeeded and call.result is not None:
            parts += [str(call.result[key]) for key in ("message", "answer", "chosen", "count", "presets") if key in call.result]
    return "\n".join(parts)


def numbers_said(episode: Episode) -> set[float]:
    """Numbers that tools gave, and the sums and differences that an answer may draw from counts."""
    counts, other = list[float](), set[float]()
    for call in episode.calls:
        result = call.result or {}
        if not call.succeeded:
            continue
        if "count" in result:
            counts.append(float(result["count"]))
        if "matches" in result:
            other.add(float(result["matches"]))
        if "answer" in result:
            answered = script(str(result["answer"]))
            other |= {q.value for q in find_quantities(answered, ())}
            other |= {0.0} if read(NoneThere(subject=("thing",)), str(result["answer"])) == Value(True) else set()
    sums = {sum(c) for n in range(1, min(len(counts), _MOST_COUNTS) + 1) for c in combinations(counts[:_MOST_COUNTS], n)}
    return other | sums | {abs(a - b) for a, b in combinations(counts, 2)} | {float(sum(c > 0 for c in counts))}


def is_grounded(task: Task, episode: Episode) -> bool:
    """Whether what the answer claims is in, or could be drawn from, what tools said. Denials and comparisons are conclusions."""
    reading = read(task.expected, episode.text)
    if not isinstance(reading, Value):
        return True
    value, said = reading.value, said_by_tools(episode)
    match task.expected:
        case Number():
            return value in numbers_said(episode)
        case Text():
            return folded(str(value), ocr=task.expected.ocr) in folded(said, ocr=task.expected.ocr)
        case Choice():
            return value == "same" or names_any(said, (str(value), *task.expected.options[str(value)]))
        case NameSet():
            return all(names_any(said, (n, *task.expected.options[n])) for n in value) if isinstance(value, frozenset) else True
        case YesNo() | NoneThere():
            claims_presence = value == isinstance(task.expected, YesNo)
            return not claims_presence or _presences(task, episode)
        case Description():
            return _contradictions_said(task.expected, value, said)
        case _:
            return True


def _presences(task: Task, episode: Episode) -> bool:
    """Whether any tool reported something: an answer may call that a yes."""
    for call in episode.calls:
        result = call.result or {}
        if call.succeeded and (result.get("count", 0) or result.get("found") or _answers_yes(task.expected, result.get("answer"))):
            return True
    return False


def _answers_yes(expected: AnyExpected, answer: object) -> bool:
    if not isinstance(answer, str):
        return False
    return read(expected, answer) == Value(isinstance(expected, YesNo))


def _contradictions_said(expected: Description, value: object, said: str) -> bool:
    stated = value[1] if isinstance(value, tuple) else frozenset()
    return all(names_any(said, expected.contradictions[n].any_of) for n in stated if isinstance(n, int))


def wrong_counts(task: Task, episode: Episode, truth: CountTruth | None) -> bool:
    """Whether a count differs from the truth of the very view that was counted: by the truth itself, else by the evidence."""
    for call, look in _looks(episode):
        counted = (call.result or {}).get("count")
        if look.how != "count" or not isinstance(counted, int):
            continue
        really = truth(look) if truth is not None else None
        if really is not None:
            if really != counted:
                return True
            continue
        if any(_miscounts(view.shows, counted) for view in shown_by(task, look)):
            return True
    return any(
        isinstance(view.shows, Number) and _misreads(view.shows, call)
        for call, look in _looks(episode)
        for view in shown_by(task, look)
    )


def _miscounts(right: AnyExpected | None, counted: int) -> bool:
    match right:
        case Number():
            return abs(counted - right.value) > right.tolerance
        case NoneThere():
            return counted > 0
        case YesNo():
            return (counted > 0) != right.value
        case _:
            return False


def wrong_reads(task: Task, episode: Episode) -> bool:
    """Whether perception answered a question about the evidence wrongly, could not tell, or did not find what is there."""
    for call, look in _looks(episode):
        result = call.result or {}
        if look.how in ("locate", "track") and result.get("found") is False and target_in(task, look):
            return True
        if look.how == "query" and any(_misreads(view.shows, call) for view in shown_by(task, look)):
            return True
    return False


def _misreads(right: AnyExpected | None, call: Call) -> bool:
    answer = (call.result or {}).get("answer")
    if right is None or not isinstance(answer, str):
        return False
    return (call.result or {}).get("known") is False or agrees(right, read(right, answer)) is False


def shown_by(task: Task, look: Look) -> Iterator[EvidenceView]:
    """The evidence that a look is of: same place, same scope, asked about it, and the frame holds the items or the whole view."""
    for view in task.evidence:
        if (view.scope == "full") == look.swept and counts_for(view, look):
            seen = inside(look, reference_directions(view)) if view.whole else None
            if seen is None or (seen.mean() > 0.9 and look_is_as_wide(view, look)):
                yield view


def look_is_as_wide(view: EvidenceView, look: Look) -> bool:
    """Whether a frame holds little more than the reference view: a count of more is not the count of that view."""
    return look.swept or look.projection.reach_deg <= 1.1 * _reach_deg(view)


def _reach_deg(view: EvidenceView) -> float:
    half = math.tan(math.radians(view.hfov_deg) / 2)
    return math.degrees(math.atan(half * math.hypot(1.0, 1 / view.aspect)))


def target_in(task: Task, look: Look) -> bool:
    """Whether something that the task is about is in the picture of a look; taken for granted where the evidence names nothing."""
    items = [item for view in task.evidence for item in view.items if view.aim.viewpoint == look.viewpoint]
    return any(shows(item, look) for item in items) if items else not any(view.items for view in task.evidence)


def _looks(episode: Episode) -> Iterator[tuple[Call, Look]]:
    for call in episode.calls:
        for look in call.looks[:1]:
            yield call, look
