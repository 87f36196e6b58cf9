"""Agents that give the same answer to every task, and what they win by the real checks.

Their runs are synthetic. Calls come from the reference program: every move, and the first call that looks, which asks with the
words of the whole instruction. Its observation is the first view of the task's evidence, because that is where the moves of the
instruction lead. Moves after the look, which may depend on what is there, are those of the reference program. The scores are
therefore an upper bound of what such an agent can win.
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
from scope_ptz.bench.statistics.chance import ChanceLevel, ConstantAgentScore, whole_pairs
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
"""Frames of the synthetic runs, as in the runs that validate the tasks."""
MAX_ANSWERS = 64
"""Number of constant answers that are tried: those that are correct for the most tasks."""
MAX_CACHED = 32
"""Number of task sets whose chance level is kept in memory."""
_LOOKS = {"count_objects": "description", "query_answer": "question"}
"""The tools that only look, with the argument that says what is asked."""
_GENERIC = ("None.", "Yes.", "No.", "0")
"""Answers that are tried on every task, whatever it asks."""
BY_CATEGORY = "the best answer of each category"


@dataclass(frozen=True, slots=True)
class ConstantReply:
    """How an agent ends every run.

    Attributes:
        text: The final text.
        outcome: The outcome of the run.
        kinds: The kinds of expected answers on which it is tried; empty for all.
    """

    text: str
    outcome: RunOutcome = "answered"
    kinds: frozenset[str] = frozenset()


def constant_text(expected: AnyExpected) -> str:
    """Return an expected answer as text without words from the question, so that it can also be an answer to other questions."""
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
    """Return whether a task expects an answer, a clarifying question or a refusal, and not only actions."""
    return not isinstance(task.expected, ActionOnly) or task.behaviour.outcomes != ("answered",)


def constant_replies(tasks: Sequence[Task]) -> tuple[ConstantReply, ...]:
    """Return the constant replies to try: generic ones, and the most frequent correct answers of at least two tasks.

    An answer that is correct for a single task is no guess that its frequency suggests.
    """
    counts, kinds = Counter[str](), dict[str, set[str]]()
    for task in tasks:
        if not isinstance(task.expected, ActionOnly):
            text = constant_text(task.expected)
            counts[text] += 1
            kinds.setdefault(text, set()).add(task.expected.kind)
    frequent = sorted(
        (text for text, n in counts.items() if n > 1 and text not in _GENERIC), key=lambda text: (-counts[text], text)
    )[:MAX_ANSWERS]
    return (
        *(ConstantReply(text) for text in _GENERIC),
        *(ConstantReply(text, kinds=frozenset(kinds[text])) for text in frequent),
        ConstantReply("Which one do you mean?", "clarification"),
        ConstantReply("I cannot do that.", "refused"),
    )


def looking_episode(task: Task) -> Episode:
    """Return the run of an agent that moves as asked and looks once. It has no answer yet."""
    view = next((view for view in task.evidence if view.must_look), None)
    position = _final_position(task, view)
    calls, looked = list[EpisodeCall](), False
    for step in task.reference:
        if step.tool in _LOOKS and looked:
            continue
        arguments: dict[str, object] = dict(step.arguments)
        if step.tool in _LOOKS:
            looked, arguments[_LOOKS[step.tool]] = True, task.instruction
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
    if tool in _LOOKS and view is not None:
        aim = view.aim
        projection = FRAME.sweep() if view.scope == "full" else FRAME.view(Pose(aim.pan_deg, aim.tilt_deg, aim.zoom))
        time_s = task.time_s if view.window_s is None else max(task.time_s, view.window_s[0])
        how = "count" if tool == "count_objects" else "query"
        observations = (Observation(aim.viewpoint, projection, time_s, how, task.instruction),)  # type: ignore[arg-type]
    return EpisodeCall(tool, arguments, at, at, {"found": True}, observations=observations)


def idle_episode(task: Task) -> Episode:
    """Return the run of an agent that makes no call. It has no answer yet."""
    return replace(looking_episode(task), calls=(), pictures=())


def passes_without_answer(task: Task, episode: Episode) -> bool:
    """Return whether a run passes every check except those of the answer and of the outcome."""
    return all(result.passed is True for result in run_checks(task, episode) if result.name not in ("answer", "outcome"))


def accepts_reply(task: Task, reply: ConstantReply) -> bool:
    """Return whether the checks of the answer and of the outcome accept a reply."""
    if reply.outcome not in task.behaviour.outcomes or (reply.kinds and task.expected.kind not in reply.kinds):
        return False
    result = check_answer(task, replace(_EMPTY, answer=reply.text, outcome=reply.outcome))
    return result is None or result.passed is True


_EMPTY = Episode("", CameraPosition(None, Pose()), (), CameraPosition(None, Pose()), "", "answered")
"""A run without calls, for the check of an answer, which considers only the text."""

Won = dict[ConstantReply, frozenset[str]]
"""The ids of the tasks that each reply wins."""


def tasks_accepting(tasks: Sequence[Task], replies: Sequence[ConstantReply]) -> Won:
    """Return the tasks whose checks of the answer and of the outcome accept each reply."""
    asked = [task for task in tasks if expects_reply(task)]
    return {reply: frozenset(task.id for task in asked if accepts_reply(task, reply)) for reply in replies}


def tasks_won(tasks: Sequence[Task], accepted: Won, *, looks: bool) -> Won:
    """Return the tasks that each reply wins by all checks.

    Args:
        tasks: The tasks.
        accepted: The tasks that accept each reply.
        looks: Whether the agent moves as asked and looks once; otherwise it makes no call.
    """
    candidates = frozenset[str]().union(*accepted.values())
    rows = [task for task in tasks if task.id in candidates]
    passing = {t.id for t in rows if passes_without_answer(t, looking_episode(t) if looks else idle_episode(t))}
    return {reply: ids & passing for reply, ids in accepted.items()}


_cache: dict[str, ChanceLevel] = {}


def chance_level(tasks: Sequence[Task]) -> ChanceLevel:
    """Return what constant answers win on tasks. The result is kept in memory for each digest of tasks."""
    key = digest_of(tasks)
    if key not in _cache:
        while len(_cache) >= MAX_CACHED:
            del _cache[next(iter(_cache))]
        _cache[key] = _chance_level(tasks)
    return _cache[key]


def _chance_level(tasks: Sequence[Task]) -> ChanceLevel:
    asked = [task for task in tasks if expects_reply(task)]
    accepted = tasks_accepting(tasks, constant_replies(tasks))
    looking = tasks_won(tasks, accepted, looks=True)
    by_category = {category: [t for t in tasks if t.category == category] for category in dict.fromkeys(t.category for t in tasks)}
    adaptive_correct = sum(max(len(_within(ids, rows)) for ids in looking.values()) for rows in by_category.values())
    consistent = {name: max(_whole(ids, rows) for ids in looking.values()) for name, rows in by_category.items()}
    return ChanceLevel(
        tasks=len(tasks),
        without_calls=_best(tasks_won(tasks, accepted, looks=False), asked),
        accepted=_best(accepted, asked),
        looking=_best(looking, asked),
        adaptive=ConstantAgentScore(BY_CATEGORY, adaptive_correct, sum(consistent.values()), len(asked)),
        by_category={name: consistent[name] / len(rows) for name, rows in by_category.items()},
    )


def _within(ids: frozenset[str], tasks: Sequence[Task]) -> list[Task]:
    return [task for task in tasks if task.id in ids]


def _whole(ids: frozenset[str], tasks: Sequence[Task]) -> int:
    """Return how many tasks are won if a task of a pair counts only if both tasks of the pair are won."""
    return sum(whole_pairs([t.id in ids for t in tasks], [t.id for t in tasks], [t.pair for t in tasks]))


def _best(won: Won, tasks: Sequence[Task]) -> ConstantAgentScore:
    """Return the reply that wins the most tasks. Ties go to the first."""
    scores = list(_scores(won, tasks))
    return max(scores, key=lambda score: score.correct) if scores else ConstantAgentScore("", 0, 0, len(tasks))


def _scores(won: Won, tasks: Sequence[Task]) -> Iterator[ConstantAgentScore]:
    for reply, ids in won.items():
        yield ConstantAgentScore(reply.text, len(_within(ids, tasks)), _whole(ids, tasks), len(tasks))
