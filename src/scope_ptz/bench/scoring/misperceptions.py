"""Find perception errors in a run: wrong counts, wrong answers about the evidence, and targets that were not found."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from scope_ptz.bench.answers import ParsedValue, agrees, all_wordings, names_any, parse_answer
from scope_ptz.bench.scoring.coverage import are_inside, is_clearly_shown, is_within, matches_view, reference_directions
from scope_ptz.bench.scoring.episode import Episode, EpisodeCall, Observation
from scope_ptz.bench.tasks.expected import AnyExpected, Choice, NameSet, NoneThere, Number, Ordering, YesNo
from scope_ptz.bench.tasks.task import EvidenceView, Item, Task

CountTruth = Callable[[Observation], int | None]
"""Function that returns the true count of the requested things in an observation, or None if the ground truth is undefined."""


def has_wrong_count(task: Task, episode: Episode, truth: CountTruth | None) -> bool:
    """Return whether perception reported a wrong count in a run.

    Args:
        task: The task.
        episode: The run.
        truth: Function that returns the true count for an observation. Without a true count, the task's evidence is used.
    """
    for call, observation in _observations(episode):
        counted = (call.result or {}).get("count")
        if observation.kind != "count" or not isinstance(counted, int):
            continue
        true_count = truth(observation) if truth is not None else None
        if true_count is not None:
            if true_count != counted:
                return True
            continue
        views = (view for view in views_shown_by(task, observation) if _asks_about(view.shows, observation.request))
        if any(_is_wrong_count(view.shows, counted) for view in views):
            return True
    return any(
        isinstance(view.shows, Number) and _asks_about(view.shows, observation.request) and _is_wrong_reply(view.shows, call)
        for call, observation in _observations(episode)
        for view in views_shown_by(task, observation)
    )


def _is_wrong_count(expected: AnyExpected | None, counted: int) -> bool:
    match expected:
        case Number():
            return abs(counted - expected.value) > expected.tolerance
        case NoneThere():
            return counted > 0
        case YesNo():
            return (counted > 0) != expected.value
        case _:
            return False


def has_wrong_reply(task: Task, episode: Episode) -> bool:
    """Return whether perception gave a wrong answer or no answer about the evidence, or did not find a visible target."""
    for call, observation in _observations(episode):
        result = call.result or {}
        if observation.kind in ("locate", "track") and result.get("found") is False and is_target_inside(task, observation):
            return True
        if observation.kind == "query" and any(
            _answers_wrongly(view, observation, call) for view in views_shown_by(task, observation)
        ):
            return True
    return False


def _answers_wrongly(view: EvidenceView, observation: Observation, call: EpisodeCall) -> bool:
    """Return whether a reply about an evidence view is wrong.

    If the question names one of several things, only the statement about this thing is checked.
    """
    if not _asks_about(view.shows, observation.request):
        return False
    thing = _thing_asked_about(view, observation.request)
    if thing is None:
        return _is_wrong_reply(view.shows, call)
    options, reply = view.shows.options, str((call.result or {}).get("answer", ""))  # type: ignore[union-attr]
    wordings = all_wordings(thing, options[thing])
    is_present = thing in view.shows.value if isinstance(view.shows, NameSet) else True
    if (call.result or {}).get("known") is False or parse_answer(NoneThere(subject=wordings), reply) == ParsedValue(is_present):
        return True
    if not is_present and parse_answer(YesNo(value=True, affirms=wordings), reply) == ParsedValue(True):
        return True
    is_not_named = isinstance(view.shows, Ordering) or not names_any(reply, wordings)
    return is_not_named and not isinstance(view.shows, NameSet) and _is_wrong_reply(view.shows, call)


def _asks_about(expected: AnyExpected | None, asked: str) -> bool:
    """Return whether a question or description names the subject of the evidence; True if the evidence has no named subject.

    A reply about another subject may be correct although it differs from the evidence.
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
    """Return the only compared or listed thing that a question names; None if the question names no thing or several."""
    if not isinstance(view.shows, Choice | Ordering | NameSet) or (not isinstance(view.shows, NameSet) and len(view.items) < 2):
        return None
    named = [name for name, other_wordings in view.shows.options.items() if names_any(asked, all_wordings(name, other_wordings))]
    return named[0] if len(named) == 1 else None


def _is_wrong_reply(expected: AnyExpected | None, call: EpisodeCall) -> bool:
    answer = (call.result or {}).get("answer")
    if expected is None or not isinstance(answer, str):
        return False
    return (call.result or {}).get("known") is False or agrees(expected, parse_answer(expected, answer)) is False


def views_shown_by(task: Task, observation: Observation) -> Iterator[EvidenceView]:
    """Yield the evidence views that an observation shows.

    The viewpoint, scope and subject must match, and the image must contain the items or the whole view.
    """
    for view in task.evidence:
        if (view.scope == "full") == observation.is_panorama and matches_view(view, observation):
            if not all(is_within(item, observation) for item in view.items):
                continue
            if not view.whole or (
                are_inside(observation, reference_directions(view)).mean() > 0.9 and _is_as_narrow(view, observation)
            ):
                yield view


def _is_as_narrow(view: EvidenceView, observation: Observation) -> bool:
    """Return whether an image shows little more than the reference view. A wider image may contain more countable things."""
    return observation.is_panorama or observation.projection.max_off_axis_deg <= 1.1 * _half_diagonal_deg(view)


def _half_diagonal_deg(view: EvidenceView) -> float:
    """Return the angle between the centre of a view's reference frame and its corners."""
    half = math.tan(math.radians(view.hfov_deg) / 2)
    return math.degrees(math.atan(half * math.hypot(1.0, 1 / view.aspect)))


def is_target_inside(task: Task, observation: Observation) -> bool:
    """Return whether a target of the task is inside the image, at any size. If the evidence has no items, return True."""
    return _has_target(task, observation, is_within)


def is_target_clearly_shown(task: Task, observation: Observation) -> bool:
    """Return whether a target of the task is inside the image and large enough to be recognised or read."""
    return _has_target(task, observation, is_clearly_shown)


def _has_target(task: Task, observation: Observation, is_shown: Callable[[Item, Observation], bool]) -> bool:
    items = [item for view in task.evidence for item in view.items if view.aim.viewpoint == observation.viewpoint]
    return any(is_shown(item, observation) for item in items) if items else not any(view.items for view in task.evidence)


def _observations(episode: Episode) -> Iterator[tuple[EpisodeCall, Observation]]:
    for call in episode.calls:
        for observation in call.observations[:1]:
            yield call, observation
