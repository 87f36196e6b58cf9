"""What perception got wrong in a run: counts that differ from the truth, answers about the evidence, targets not found."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from scope_ptz.bench.answers import ParsedValue, agrees, all_wordings, names_any, parse_answer
from scope_ptz.bench.scoring.coverage import counts_for, inside, is_within, reference_directions, shows
from scope_ptz.bench.scoring.episode import Episode, EpisodeCall, Observation
from scope_ptz.bench.tasks.expected import AnyExpected, Choice, NameSet, NoneThere, Number, Ordering, YesNo
from scope_ptz.bench.tasks.task import EvidenceView, Item, Task

CountTruth = Callable[[Observation], int | None]
"""How many of what was asked really show in the very picture of a look; None when the truth cannot say."""


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
        if look.how == "query" and any(_answers_wrongly(view, look, call) for view in shown_by(task, look)):
            return True
    return False


def _answers_wrongly(view: EvidenceView, look: Observation, call: EpisodeCall) -> bool:
    """Whether a reply is wrong about a view; of a question about one of several things, what it says of that thing counts."""
    one = _asked_of(view, look.asked)
    if one is None:
        return _misreads(view.shows, call)
    options, reply = view.shows.options, str((call.result or {}).get("answer", ""))  # type: ignore[union-attr]
    wordings = all_wordings(one, options[one])
    there = one in view.shows.value if isinstance(view.shows, NameSet) else True
    if (call.result or {}).get("known") is False or parse_answer(NoneThere(subject=wordings), reply) == ParsedValue(there):
        return True
    if not there and parse_answer(YesNo(value=True, affirms=wordings), reply) == ParsedValue(True):
        return True
    told_elsewise = isinstance(view.shows, Ordering) or not names_any(reply, wordings)
    return told_elsewise and not isinstance(view.shows, NameSet) and _misreads(view.shows, call)


def _asked_of(view: EvidenceView, asked: str) -> str | None:
    """The only one of several compared or listed things that a question names; None when it names none or more."""
    if not isinstance(view.shows, Choice | Ordering | NameSet) or (not isinstance(view.shows, NameSet) and len(view.items) < 2):
        return None
    named = [name for name, further in view.shows.options.items() if names_any(asked, all_wordings(name, further))]
    return named[0] if len(named) == 1 else None


def _misreads(right: AnyExpected | None, call: EpisodeCall) -> bool:
    answer = (call.result or {}).get("answer")
    if right is None or not isinstance(answer, str):
        return False
    return (call.result or {}).get("known") is False or agrees(right, parse_answer(right, answer)) is False


def shown_by(task: Task, look: Observation) -> Iterator[EvidenceView]:
    """The evidence that a look is of: same place, same scope, asked about it, and the frame holds the items or the whole view."""
    for view in task.evidence:
        if (view.scope == "full") == look.swept and counts_for(view, look):
            if not all(is_within(item, look) for item in view.items):
                continue
            if not view.whole or (inside(look, reference_directions(view)).mean() > 0.9 and look_is_as_wide(view, look)):
                yield view


def look_is_as_wide(view: EvidenceView, look: Observation) -> bool:
    """Whether a frame holds little more than the reference view: a count of more is not the count of that view."""
    return look.swept or look.projection.reach_deg <= 1.1 * _reach_deg(view)


def _reach_deg(view: EvidenceView) -> float:
    half = math.tan(math.radians(view.hfov_deg) / 2)
    return math.degrees(math.atan(half * math.hypot(1.0, 1 / view.aspect)))


def target_in(task: Task, look: Observation) -> bool:
    """Whether something that the task is about is in the picture of a look, however small: that is what a search is for. Taken for
    granted where the evidence names nothing."""
    return _has_target(task, look, is_within)


def target_shown(task: Task, look: Observation) -> bool:
    """Whether it is in the picture and large enough to be told or read."""
    return _has_target(task, look, shows)


def _has_target(task: Task, look: Observation, has: Callable[[Item, Observation], bool]) -> bool:
    items = [item for view in task.evidence for item in view.items if view.aim.viewpoint == look.viewpoint]
    return any(has(item, look) for item in items) if items else not any(view.items for view in task.evidence)


def _looks(episode: Episode) -> Iterator[tuple[EpisodeCall, Observation]]:
    for call in episode.calls:
        for look in call.looks[:1]:
            yield call, look
