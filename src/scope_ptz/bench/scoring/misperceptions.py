"""Errors of perception in a run: wrong counts, wrong answers about the evidence, and targets that were not found."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from scope_ptz.bench.answers import ParsedValue, agrees, all_wordings, names_any, parse_answer
from scope_ptz.bench.scoring.coverage import counts_for, inside, is_within, reference_directions, shows
from scope_ptz.bench.scoring.episode import Episode, EpisodeCall, Observation
from scope_ptz.bench.tasks.expected import AnyExpected, Choice, NameSet, NoneThere, Number, Ordering, YesNo
from scope_ptz.bench.tasks.task import EvidenceView, Item, Task

CountTruth = Callable[[Observation], int | None]
"""Returns the true count of the requested things in the image of an observation; None if the ground truth does not define it."""


def wrong_counts(task: Task, episode: Episode, truth: CountTruth | None) -> bool:
    """Return whether a count differs from the true count of the view that was counted.

    Args:
        task: The task.
        episode: The run.
        truth: Returns the true count for an observation. Without a true count, the task's evidence decides.
    """
    for call, observation in _observations(episode):
        counted = (call.result or {}).get("count")
        if observation.how != "count" or not isinstance(counted, int):
            continue
        true_count = truth(observation) if truth is not None else None
        if true_count is not None:
            if true_count != counted:
                return True
            continue
        views = (view for view in shown_by(task, observation) if _asks_about(view.shows, observation.asked))
        if any(_miscounts(view.shows, counted) for view in views):
            return True
    return any(
        isinstance(view.shows, Number) and _asks_about(view.shows, observation.asked) and _misreads(view.shows, call)
        for call, observation in _observations(episode)
        for view in shown_by(task, observation)
    )


def _miscounts(expected: AnyExpected | None, counted: int) -> bool:
    match expected:
        case Number():
            return abs(counted - expected.value) > expected.tolerance
        case NoneThere():
            return counted > 0
        case YesNo():
            return (counted > 0) != expected.value
        case _:
            return False


def wrong_reads(task: Task, episode: Episode) -> bool:
    """Return whether perception answered a question about the evidence wrongly, declined, or did not find a present target."""
    for call, observation in _observations(episode):
        result = call.result or {}
        if observation.how in ("locate", "track") and result.get("found") is False and target_in(task, observation):
            return True
        if observation.how == "query" and any(_answers_wrongly(view, observation, call) for view in shown_by(task, observation)):
            return True
    return False


def _answers_wrongly(view: EvidenceView, observation: Observation, call: EpisodeCall) -> bool:
    """Return whether a reply is wrong about an evidence view. If its question names one of several things, only that is checked."""
    if not _asks_about(view.shows, observation.asked):
        return False
    thing = _thing_asked_about(view, observation.asked)
    if thing is None:
        return _misreads(view.shows, call)
    options, reply = view.shows.options, str((call.result or {}).get("answer", ""))  # type: ignore[union-attr]
    wordings = all_wordings(thing, options[thing])
    is_present = thing in view.shows.value if isinstance(view.shows, NameSet) else True
    if (call.result or {}).get("known") is False or parse_answer(NoneThere(subject=wordings), reply) == ParsedValue(is_present):
        return True
    if not is_present and parse_answer(YesNo(value=True, affirms=wordings), reply) == ParsedValue(True):
        return True
    is_not_named = isinstance(view.shows, Ordering) or not names_any(reply, wordings)
    return is_not_named and not isinstance(view.shows, NameSet) and _misreads(view.shows, call)


def _asks_about(expected: AnyExpected | None, asked: str) -> bool:
    """Return whether a question or description names what the evidence counts or finds; True if the evidence names nothing.

    A reply about something else may be right of the frame although it differs from the evidence.
    """
    match expected:
        case Number():
            wordings = expected.unit
        case NoneThere():
            wordings = expected.subject
        case YesNo():
            wordings = (*expected.affirms, *expected.denies)
        case _:
            return True
    return not wordings or names_any(asked, wordings)


def _thing_asked_about(view: EvidenceView, asked: str) -> str | None:
    """Return the compared or listed thing that a question names; None if it names none or several."""
    if not isinstance(view.shows, Choice | Ordering | NameSet) or (not isinstance(view.shows, NameSet) and len(view.items) < 2):
        return None
    named = [name for name, other_wordings in view.shows.options.items() if names_any(asked, all_wordings(name, other_wordings))]
    return named[0] if len(named) == 1 else None


def _misreads(expected: AnyExpected | None, call: EpisodeCall) -> bool:
    answer = (call.result or {}).get("answer")
    if expected is None or not isinstance(answer, str):
        return False
    return (call.result or {}).get("known") is False or agrees(expected, parse_answer(expected, answer)) is False


def shown_by(task: Task, observation: Observation) -> Iterator[EvidenceView]:
    """Yield the evidence views that an observation shows.

    The viewpoint, the scope and the subject must match, and the image must contain the items or the whole view.
    """
    for view in task.evidence:
        if (view.scope == "full") == observation.swept and counts_for(view, observation):
            if not all(is_within(item, observation) for item in view.items):
                continue
            if not view.whole or (
                inside(observation, reference_directions(view)).mean() > 0.9 and _is_as_narrow(view, observation)
            ):
                yield view


def _is_as_narrow(view: EvidenceView, observation: Observation) -> bool:
    """Return whether an image shows little more than the reference view. A wider image may contain more things to count."""
    return observation.swept or observation.projection.max_off_axis_deg <= 1.1 * _reach_deg(view)


def _reach_deg(view: EvidenceView) -> float:
    """Return the angle between the centre of a view's reference frame and its corners."""
    half = math.tan(math.radians(view.hfov_deg) / 2)
    return math.degrees(math.atan(half * math.hypot(1.0, 1 / view.aspect)))


def target_in(task: Task, observation: Observation) -> bool:
    """Return whether a target of the task is in the image at any size, so that a search can find it.

    If the evidence has no items, return True.
    """
    return _has_target(task, observation, is_within)


def target_shown(task: Task, observation: Observation) -> bool:
    """Return whether a target of the task is in the image and large enough to recognise or read."""
    return _has_target(task, observation, shows)


def _has_target(task: Task, observation: Observation, is_shown: Callable[[Item, Observation], bool]) -> bool:
    items = [item for view in task.evidence for item in view.items if view.aim.viewpoint == observation.viewpoint]
    return any(is_shown(item, observation) for item in items) if items else not any(view.items for view in task.evidence)


def _observations(episode: Episode) -> Iterator[tuple[EpisodeCall, Observation]]:
    for call in episode.calls:
        for observation in call.observations[:1]:
            yield call, observation
