"""Faults in replies: wrong perception results, and wrong final answers.

Each fault function takes a passing run and returns it with the fault, or None if the fault does not apply to the run. The names
of these functions are stored with gold runs.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from scope_ptz.bench.scoring.episode import Episode, EpisodeCall
from scope_ptz.bench.scoring.evidence import is_supported_by_tools, numbers_from_tools
from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, NoneThere, Number, Relation, YesNo
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers, wrong_answer
from scope_ptz.taskgen.gold.agent_faults import FaultContext, change_calls, change_result, replay, wrong_count

_MAX_TRIES = 24  # maximum number of wrong answers to try when looking for one that the run does not support
_DECLINING_ANSWERS = ("I cannot tell.", "I'm not sure.", "It is not possible to say.")


# Wrong perception results


def miscount(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Make perception return wrong counts that lead to a wrong answer."""
    counts = [n for n, call in enumerate(episode.calls) if call.name == "count_objects"]
    answer = wrong_answer(task.expected, rng)
    if not counts or answer is None:
        return None
    for wrong in _miscounts(task.expected, answer, [episode.calls[n] for n in counts]):
        calls = list(episode.calls)
        for n, number in zip(counts, wrong, strict=True):
            calls[n] = change_count(calls[n], number)
        faulty = replace(replay(episode, calls, context), answer=answer)
        if is_supported_by_tools(task, faulty):
            return faulty
    return None


def _miscounts(expected: AnyExpected, answer: str, counts: list[EpisodeCall]) -> Iterator[list[int]]:
    """Yield lists of counts, one for each counting call, that are consistent with a wrong answer."""
    numbers = [int((call.result or {})["count"]) for call in counts]
    if not isinstance(expected, Number | NoneThere | YesNo):
        exchanged = list(reversed(numbers)) if isinstance(expected, Relation) else [*numbers[1::-1], *numbers[2:]]
        yield exchanged if exchanged != numbers else [numbers[0] + 2, *numbers[1:]]
        return
    last = wrong_count(expected, answer, counts[-1])
    error = last - round(expected.value) if isinstance(expected, Number) else 0
    for number in (last, numbers[-1] + error, numbers[-1] - error):
        if number >= 0 and number != numbers[-1]:
            yield [*numbers[:-1], number]


def change_count(call: EpisodeCall, number: int) -> EpisodeCall:
    """Return a counting call with a different count."""
    return change_result(call, count=number, message=f"{number} of '{call.arguments.get('description')}' in view.")


def misread(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Make perception return a wrong answer."""
    answer = wrong_answer(task.expected, rng)
    if answer is None or not any(call.name == "query_answer" for call in episode.calls):
        return None

    def change(call: EpisodeCall) -> EpisodeCall:
        return change_result(call, answer=answer, message=answer) if call.name == "query_answer" else call

    return replace(change_calls(episode, context, change), answer=answer)


def overlook(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Make perception miss a target that is in view."""
    if not any(call.name == "zoom_to_object" for call in episode.calls) or not isinstance(task.expected, ActionOnly):
        return None

    def change(call: EpisodeCall) -> EpisodeCall:
        if call.name != "zoom_to_object":
            return call
        result = {"message": "Nothing that fits is in view.", "found": False, "matches": 0}
        return replace(call, result=result, after=call.before)

    return replace(change_calls(episode, context, change), answer="It is not in view.")


# Wrong answers


def make_up(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Answer with something that no observation supports."""
    for _ in range(_MAX_TRIES):
        answer = wrong_answer(task.expected, rng)
        if answer is None:
            return None
        if not is_supported_by_tools(task, replace(episode, answer=answer)):
            return replace(episode, answer=answer)
    return None


def conclude_wrongly(task: Task, episode: Episode, context: FaultContext, rng: random.Random) -> Episode | None:
    """Draw a wrong conclusion from correct observations, or decline to answer."""
    expected = task.expected
    if isinstance(expected, ActionOnly):
        return None
    if isinstance(expected, Number):
        others = sorted(n for n in numbers_from_tools(episode) if abs(n - expected.value) > expected.tolerance)
        if others and rng.random() < 0.5:
            return replace(episode, answer=correct_answers(expected.model_copy(update={"value": rng.choice(others)}))[0])
    answer = wrong_answer(expected, rng)
    if answer is not None and rng.random() < 0.5 and is_supported_by_tools(task, replace(episode, answer=answer)):
        return replace(episode, answer=answer)
    return replace(episode, answer=rng.choice(_DECLINING_ANSWERS))
