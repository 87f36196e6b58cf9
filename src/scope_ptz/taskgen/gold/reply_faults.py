"""Known faults of what an agent is told and makes of it, to put into a run that passes: perception and answers that are wrong.

Every way gives the run with the fault, or None where the run offers no place for it.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from scope_ptz.bench.scoring.episode import Episode, EpisodeCall
from scope_ptz.bench.scoring.evidence import is_supported_by_tools, numbers_from_tools
from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, NoneThere, Number, Relation, YesNo
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.phrasing import right_answers, wrong_answer
from scope_ptz.taskgen.gold.agent_faults import Setting, changed, count_of, replayed, retold

_TRIES = 24
_DECLINES = ("I cannot tell.", "I'm not sure.", "It is not possible to say.")


# Perception is wrong


def miscount(task: Task, episode: Episode, setting: Setting, rng: random.Random) -> Episode | None:
    counts = [n for n, call in enumerate(episode.calls) if call.name == "count_objects"]
    told = wrong_answer(task.expected, rng)
    if not counts or told is None:
        return None
    for wrong in _miscounts(task.expected, told, [episode.calls[n] for n in counts]):
        calls = list(episode.calls)
        for n, number in zip(counts, wrong, strict=True):
            calls[n] = recounted(calls[n], number)
        made = replace(replayed(episode, calls, setting), answer=told)
        if is_supported_by_tools(task, made):
            return made
    return None


def _miscounts(expected: AnyExpected, told: str, counts: list[EpisodeCall]) -> Iterator[list[int]]:
    """Wrong counts that could lead to what is told."""
    numbers = [int((call.result or {})["count"]) for call in counts]
    if not isinstance(expected, Number | NoneThere | YesNo):
        exchanged = list(reversed(numbers)) if isinstance(expected, Relation) else [*numbers[1::-1], *numbers[2:]]
        yield exchanged if exchanged != numbers else [numbers[0] + 2, *numbers[1:]]
        return
    last = count_of(expected, told, counts[-1])
    off = last - round(expected.value) if isinstance(expected, Number) else 0
    for number in (last, numbers[-1] + off, numbers[-1] - off):
        if number >= 0 and number != numbers[-1]:
            yield [*numbers[:-1], number]


def recounted(call: EpisodeCall, number: int) -> EpisodeCall:
    return retold(call, count=number, message=f"{number} of '{call.arguments.get('description')}' in view.")


def misread(task: Task, episode: Episode, setting: Setting, rng: random.Random) -> Episode | None:
    told = wrong_answer(task.expected, rng)
    if told is None or not any(call.name == "query_answer" for call in episode.calls):
        return None

    def misread(call: EpisodeCall) -> EpisodeCall:
        return retold(call, answer=told, message=told) if call.name == "query_answer" else call

    return replace(changed(episode, setting, misread), answer=told)


def overlook(task: Task, episode: Episode, setting: Setting, rng: random.Random) -> Episode | None:
    """Perception does not find a target that is in view."""
    if not any(call.name == "zoom_to_object" for call in episode.calls) or not isinstance(task.expected, ActionOnly):
        return None

    def overlook(call: EpisodeCall) -> EpisodeCall:
        if call.name != "zoom_to_object":
            return call
        said = {"message": "Nothing that fits is in view.", "found": False, "matches": 0}
        return replace(call, result=said, after=call.before)

    return replace(changed(episode, setting, overlook), answer="It is not in view.")


# The answer is wrong


def make_up(task: Task, episode: Episode, setting: Setting, rng: random.Random) -> Episode | None:
    for _ in range(_TRIES):
        told = wrong_answer(task.expected, rng)
        if told is None:
            return None
        if not is_supported_by_tools(task, replace(episode, answer=told)):
            return replace(episode, answer=told)
    return None


def conclude_wrongly(task: Task, episode: Episode, setting: Setting, rng: random.Random) -> Episode | None:
    expected = task.expected
    if isinstance(expected, ActionOnly):
        return None
    if isinstance(expected, Number):
        others = sorted(n for n in numbers_from_tools(episode) if abs(n - expected.value) > expected.tolerance)
        if others and rng.random() < 0.5:
            return replace(episode, answer=right_answers(expected.model_copy(update={"value": rng.choice(others)}))[0])
    told = wrong_answer(expected, rng)
    if told is not None and rng.random() < 0.5 and is_supported_by_tools(task, replace(episode, answer=told)):
        return replace(episode, answer=told)
    return replace(episode, answer=rng.choice(_DECLINES))
