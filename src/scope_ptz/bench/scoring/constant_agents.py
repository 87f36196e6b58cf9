"""Use the real checks to score constant agents, which give the same answer to every task.

Their runs are synthetic. The calls come from the reference program: every move, and the first perception call, which passes the
whole instruction to perception. It observes the first view in the task's evidence, because the moves in the instruction lead there.
Later moves, which may depend on the observation, are also those of the reference program. The scores are therefore upper bounds for
such agents.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from scope_ptz.bench.scoring.checks import check_answer, run_checks
from scope_ptz.bench.scoring.episode import (
    CameraPosition,
    Episode,
    EpisodeCall,
    FrameGeometry,
    Observation,
    SavedPicture,
)
from scope_ptz.bench.statistics.chance import ChanceLevel, ConstantAgentScore, pair_consistent
from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    Description,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Relation,
    Text,
    YesNo,
)
from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.task import EvidenceView, RunOutcome, Task
from scope_ptz.geometry import Pose

FRAME = FrameGeometry(1280, 720)
"""Frame size in synthetic runs, which is the same as in the runs that validate tasks."""
MAX_ANSWERS = 64
"""Maximum number of constant answers to try, starting with the ones that are correct for the most tasks."""
MAX_CACHED = 32
"""Maximum number of cached chance levels."""
_OBSERVING_TOOLS = {"count_objects": "description", "query_answer": "question"}
"""The tools that only observe, with the name of the argument for the description or question."""
_GENERIC_ANSWERS = ("None.", "Yes.", "No.", "0")
"""Answers that are tried on every task."""
BY_CATEGORY = "the best answer of each category"


@dataclass(frozen=True, slots=True)
class ConstantReply:
    """The reply with which a constant agent ends every run.

    Attributes:
        text: The text of the reply.
        outcome: The outcome of the run.
        kinds: The kinds of expected answers on which to try the reply; empty for all.
    """

    text: str
    outcome: RunOutcome = "answered"
    kinds: frozenset[str] = frozenset()


def constant_text(expected: AnyExpected) -> str:
    """Return an expected answer as text without words from the question, so that the text can also answer other questions."""
    match expected:
        case Number():
            return f"{expected.value:g}"
        case YesNo():
            return "Yes." if expected.value else "No."
        case NoneThere():
            return "None."
        case Choice():
            return expected.value
        case Text():
            return f'"{expected.accepted[0]}"'
        case NameSet():
            return ", ".join(expected.value) or "None."
        case Ordering():
            return ", ".join(expected.value)
        case Relation():
            words = {"forward": expected.forward, "backward": expected.backward, "same": ("the same",)}[expected.value]
            return words[0] if words else expected.value
        case Description():
            return ", ".join(fact.any_of[0] for fact in expected.facts)
        case ActionOnly():
            return ""


def expects_reply(task: Task) -> bool:
    """Return whether a task expects an answer, a clarifying question or a refusal, rather than only actions."""
    return not isinstance(task.expected, ActionOnly) or task.behaviour.outcomes != ("answered",)


def constant_replies(tasks: Sequence[Task]) -> tuple[ConstantReply, ...]:
    """Return the constant replies to try: generic replies, and the most frequent correct answers.

    Answers that are correct for only one task are excluded, because they are no better guesses than others.
    """
    counts, kinds = Counter[str](), dict[str, set[str]]()
    for task in tasks:
        if not isinstance(task.expected, ActionOnly):
            text = constant_text(task.expected)
            counts[text] += 1
            kinds.setdefault(text, set()).add(task.expected.kind)
    frequent = sorted(
        (text for text, n in counts.items() if n > 1 and text not in _GENERIC_ANSWERS), key=lambda text: (-counts[text], text)
    )[:MAX_ANSWERS]
    return (
        *(ConstantReply(text) for text in _GENERIC_ANSWERS),
        *(ConstantReply(text, kinds=frozenset(kinds[text])) for text in frequent),
        ConstantReply("Which one do you mean?", "clarification"),
        ConstantReply("I cannot do that.", "refused"),
    )


def observing_episode(task: Task) -> Episode:
    """Return a run, without an answer, of an agent that moves as instructed and observes once."""
    view = next((view for view in task.evidence if view.must_look), None)
    position = _final_position(task, view)
    calls, has_observed = list[EpisodeCall](), False
    for step in task.reference:
        if step.tool in _OBSERVING_TOOLS and has_observed:
            continue
        arguments: dict[str, object] = dict(step.arguments)
        if step.tool in _OBSERVING_TOOLS:
            has_observed, arguments[_OBSERVING_TOOLS[step.tool]] = True, task.instruction
        calls.append(_call(task, step.tool, arguments, position, view))
    pictures = tuple(SavedPicture(f"{number}.jpg") for number, step in enumerate(task.reference) if step.tool == "take_image")
    return Episode(task.instruction, position, tuple(calls), position, "", "answered", pictures)


def _final_position(task: Task, view: EvidenceView | None) -> CameraPosition:
    if (final := task.behaviour.final) is not None:
        return CameraPosition(final.viewpoint, Pose(final.pan_deg, final.tilt_deg, final.zoom))
    if view is not None:
        return CameraPosition(view.aim.viewpoint, Pose(view.aim.pan_deg, view.aim.tilt_deg, view.aim.zoom))
    return CameraPosition(None, Pose())


def _call(task: Task, tool: str, arguments: Mapping[str, object], at: CameraPosition, view: EvidenceView | None) -> EpisodeCall:
    observations: tuple[Observation, ...] = ()
    if tool in _OBSERVING_TOOLS and view is not None:
        aim = view.aim
        projection = FRAME.sweep() if view.scope == "full" else FRAME.view(Pose(aim.pan_deg, aim.tilt_deg, aim.zoom))
        time_s = task.time_s if view.window_s is None else max(task.time_s, view.window_s[0])
        kind = "count" if tool == "count_objects" else "query"
        observations = (Observation(aim.viewpoint, projection, time_s, kind, task.instruction),)  # type: ignore[arg-type]
    return EpisodeCall(tool, arguments, at, at, {"found": True}, observations=observations)


def idle_episode(task: Task) -> Episode:
    """Return a run, without an answer, of an agent that makes no calls."""
    return replace(observing_episode(task), calls=(), pictures=())


def passes_without_answer(task: Task, episode: Episode) -> bool:
    """Return whether a run passes all checks other than the answer and outcome checks."""
    return all(result.passed is True for result in run_checks(task, episode) if result.name not in ("answer", "outcome"))


def accepts_reply(task: Task, reply: ConstantReply) -> bool:
    """Return whether a reply passes the answer and outcome checks of a task."""
    if reply.outcome not in task.behaviour.outcomes or (reply.kinds and task.expected.kind not in reply.kinds):
        return False
    result = check_answer(task, replace(_EMPTY_EPISODE, answer=reply.text, outcome=reply.outcome))
    return result is None or result.passed is True


_EMPTY_EPISODE = Episode("", CameraPosition(None, Pose()), (), CameraPosition(None, Pose()), "", "answered")
"""A run without calls, for the answer check, which considers only the text."""

TasksByReply = dict[ConstantReply, frozenset[str]]
"""The ids of the tasks that each reply passes."""


def find_accepting_tasks(tasks: Sequence[Task], replies: Sequence[ConstantReply]) -> TasksByReply:
    """Return, for each reply, the tasks whose answer and outcome checks it passes."""
    answerable = [task for task in tasks if expects_reply(task)]
    return {reply: frozenset(task.id for task in answerable if accepts_reply(task, reply)) for reply in replies}


def find_passed_tasks(tasks: Sequence[Task], accepted: TasksByReply, *, observes: bool) -> TasksByReply:
    """Return, for each reply, the tasks for which it passes all checks.

    Args:
        tasks: The tasks.
        accepted: For each reply, the tasks whose answer and outcome checks it passes.
        observes: Whether the agent moves as instructed and observes once. If False, the agent makes no calls.
    """
    candidates = frozenset[str]().union(*accepted.values())
    candidate_tasks = [task for task in tasks if task.id in candidates]
    passing = {t.id for t in candidate_tasks if passes_without_answer(t, observing_episode(t) if observes else idle_episode(t))}
    return {reply: ids & passing for reply, ids in accepted.items()}


_cache: dict[str, ChanceLevel] = {}


def chance_level(tasks: Sequence[Task]) -> ChanceLevel:
    """Return the scores of constant agents on a set of tasks. Results are cached by the digest of the tasks."""
    key = digest_of(tasks)
    if key not in _cache:
        while len(_cache) >= MAX_CACHED:
            del _cache[next(iter(_cache))]
        _cache[key] = _chance_level(tasks)
    return _cache[key]


def _chance_level(tasks: Sequence[Task]) -> ChanceLevel:
    answerable = [task for task in tasks if expects_reply(task)]
    accepted = find_accepting_tasks(tasks, constant_replies(tasks))
    looking = find_passed_tasks(tasks, accepted, observes=True)
    by_category = {category: [t for t in tasks if t.category == category] for category in dict.fromkeys(t.category for t in tasks)}
    adaptive_correct = sum(
        max(len(_tasks_in(ids, candidate_tasks)) for ids in looking.values()) for candidate_tasks in by_category.values()
    )
    consistent = {
        name: max(_consistent_count(ids, candidate_tasks) for ids in looking.values())
        for name, candidate_tasks in by_category.items()
    }
    return ChanceLevel(
        tasks=len(tasks),
        without_calls=_best_score(find_passed_tasks(tasks, accepted, observes=False), answerable),
        accepted=_best_score(accepted, answerable),
        looking=_best_score(looking, answerable),
        adaptive=ConstantAgentScore(BY_CATEGORY, adaptive_correct, sum(consistent.values()), len(answerable)),
        by_category={name: consistent[name] / len(candidate_tasks) for name, candidate_tasks in by_category.items()},
    )


def _tasks_in(ids: frozenset[str], tasks: Sequence[Task]) -> list[Task]:
    return [task for task in tasks if task.id in ids]


def _consistent_count(ids: frozenset[str], tasks: Sequence[Task]) -> int:
    """Return the number of passed tasks, where a task in a pair counts only if both tasks in the pair are passed."""
    return sum(pair_consistent([t.id in ids for t in tasks], [t.id for t in tasks], [t.pair for t in tasks]))


def _best_score(passed: TasksByReply, tasks: Sequence[Task]) -> ConstantAgentScore:
    """Return the score of the reply that passes the most tasks. Ties go to the first reply."""
    scores = list(_scores(passed, tasks))
    return max(scores, key=lambda score: score.correct) if scores else ConstantAgentScore("", 0, 0, len(tasks))


def _scores(passed: TasksByReply, tasks: Sequence[Task]) -> Iterator[ConstantAgentScore]:
    for reply, ids in passed.items():
        yield ConstantAgentScore(reply.text, len(_tasks_in(ids, tasks)), _consistent_count(ids, tasks), len(tasks))
