"""Whether a trial of a submission agrees with itself and with its task, as far as the file can tell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from scope_ptz.agent.records import OUTCOMES
from scope_ptz.bench.answers import ParsedValue, agrees, parse_answer
from scope_ptz.bench.reports.submission import CUT, TOOLS, UNKNOWN_TOOL, Header, TrialLine
from scope_ptz.bench.scoring.trials import RunCard
from scope_ptz.bench.scoring.verdict import MOVERS
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import Task
from scope_ptz.tools.registry import TOOLS as REGISTRY

SLACK_S = 0.5
"""By how much the parts of a time may exceed the whole: clocks are read one after the other."""
BREAKING = ("camera_error", "cancelled", "planner_error")
"""Outcomes with which infrastructure ends a run; a planner's error may be its own, too."""
LOOKERS = REGISTRY.perceiving
MOVING = frozenset({"move", "zoom", "preset"})
"""What a task may need that changes where the camera is or looks."""


def trial_faults(line: TrialLine, header: Header, task: Task | None) -> Iterator[str]:
    """What is wrong with a trial. ``task``: None where it is no task of the split."""
    if line.epoch > header.card.epochs:
        yield f"repeat {line.epoch} of {header.card.epochs}"
    if line.error_mode is not None and line.headline != "incorrect":
        yield f"error mode {line.error_mode} although the trial is {line.headline}"
    if line.error_mode is None and line.headline == "incorrect" and line.scored_by == "checks":
        yield "an incorrect trial has no error mode"
    yield from _verdict_faults(line)
    if line.outcome is not None and line.outcome not in OUTCOMES:
        yield f"outcome {line.outcome} is none of {', '.join(OUTCOMES)}"
    if strange := sorted(set(line.tool_calls) - TOOLS - {UNKNOWN_TOOL}):
        yield f"there are no tools {', '.join(strange)[:200]}"
    if line.steps > header.card.max_steps:
        yield f"{line.steps} steps where {header.card.max_steps} are the most"
    times = line.times
    longest = max(times.planner_s, times.perception_s, times.camera_s, times.render_s)
    if longest > times.total_s + SLACK_S:
        yield f"a stage took {longest:g} s of {times.total_s:g} s in all"
    if task is not None:
        if line.category != task.category:
            yield f"category {line.category} where the task's is {task.category}"
        yield from _check_faults(line, task)
        yield from _broken_faults(line, task)
        yield from _answer_faults(line, task)
        yield from _call_faults(line, header, task)


def _verdict_faults(line: TrialLine) -> Iterator[str]:
    """The headline follows from the checks."""
    if line.scored_by == "judge":
        if line.headline in ("correct", "incorrect") and line.headline not in {said.verdict for said in line.judged}:
            yield f"{line.headline} by the judge, which no judgement says"
        return
    passed = list(line.checks.values())
    if line.headline in ("correct", "incorrect", "unscored") and not passed:
        yield "no check at all"
    elif line.headline == "correct" and not all(p is True for p in passed):
        yield "correct although not every check passed"
    elif line.headline == "incorrect" and False not in passed:
        yield "incorrect although no check failed"
    elif line.headline == "unscored" and (False in passed or None not in passed):
        yield "unscored although the checks tell"


def _answer_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """The answer, read again, gives what the answer check says."""
    if isinstance(task.expected, ActionOnly) or line.scored_by == "judge" or line.answer.endswith(CUT):
        return
    if "answer" not in line.checks:
        if line.headline != "infrastructure":
            yield "the task wants an answer and there is no answer check"
        return
    ended = line.outcome in ("answered", "clarification", "refused")
    found = agrees(task.expected, parse_answer(task.expected, line.answer)) if ended else False
    if found != line.checks["answer"]:
        yield f"the answer reads as {_words(found)} and its check says {_words(line.checks['answer'])}"


def _words(passed: bool | None) -> str:
    return {True: "right", False: "wrong", None: "unreadable"}[passed]


def checks_of(task: Task) -> set[str]:
    """The names of the checks that every run of a task has."""
    behaviour = task.behaviour
    called_for = {
        "outcome": True,
        "answer": not isinstance(task.expected, ActionOnly),
        "coverage": any(view.must_look for view in task.evidence),
        "pose": behaviour.final is not None,
        "calls": bool(behaviour.calls),
        "forbidden": bool(behaviour.forbidden.tools or behaviour.forbidden.changes),
        "pictures": behaviour.pictures is not None,
        "framing": behaviour.framing is not None,
    }
    return {name for name, wanted in called_for.items() if wanted}


def _check_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Every check of the task is there, no other, and the checks decide."""
    if line.scored_by == "judge":
        yield "scored by a judge, and the task has checks"
    if line.headline == "infrastructure" and line.outcome is None and not line.checks:
        return  # It never began.
    wanted = checks_of(task)
    if lacking := sorted(wanted - set(line.checks)):
        yield f"the task's checks {', '.join(lacking)} are missing"
    if further := sorted(set(line.checks) - wanted):
        yield f"the task has no checks {', '.join(further)[:200]}"
    if "outcome" in line.checks and line.checks["outcome"] is not (line.outcome in task.behaviour.outcomes):
        yield f"the outcome {line.outcome} and its check differ"


def _broken_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Only a server, the camera or a cut break a run. One that ended in another way may still have been blind: then nothing looked
    with success, and no value was claimed."""
    if line.headline != "infrastructure" or line.outcome in (None, *BREAKING):
        return
    claimed = line.outcome == "answered" and not isinstance(task.expected, ActionOnly) and not line.answer.endswith(CUT)
    if (
        not line.perception_failures
        or line.checks.get("coverage") is not False
        or (claimed and isinstance(parse_answer(task.expected, line.answer), ParsedValue))
    ):
        yield f"broken by infrastructure although it ended {line.outcome} and perception did not fail it"


def _call_faults(line: TrialLine, header: Header, task: Task) -> Iterator[str]:
    """What the checks say was done needs calls."""
    made, calls = sum(line.tool_calls.values()), Counter(line.tool_calls)
    if line.outcome is not None and line.outcome not in BREAKING and not line.steps:
        yield f"it ended {line.outcome} without a step"
    if made and not line.steps:
        yield f"{made} calls in no step"
    if line.bad_calls + line.perception_failures > made:
        yield f"{line.bad_calls + line.perception_failures} calls failed of {made}"
    if line.checks.get("coverage") and not _may_see(header.card) and not any(calls[tool] for tool in LOOKERS):
        yield "coverage passed and nothing looked"
    if line.checks.get("calls"):
        needed = Counter[str]()
        for call in task.behaviour.calls:
            needed[call.tool] += call.times
        for tool, number in (needed - calls).items():
            yield f"calls passed with {calls[tool]} of {calls[tool] + number} calls of {tool}"
    if line.checks.get("pictures") and calls["take_image"] < (task.behaviour.pictures or 0):
        yield f"pictures passed with {calls['take_image']} of {task.behaviour.pictures} calls of take_image"
    moved = [name for name in ("pose", "framing") if line.checks.get(name)]
    if moved and set(task.needs) & MOVING and not any(calls[tool] for tool in MOVERS):
        yield f"{moved[0]} passed and nothing moved the camera"


def _may_see(card: RunCard) -> bool:
    """Whether the planner itself is shown what the camera sees, as one that is eyes at once, a person, or another agent may be."""
    settings = card.sampling.get("planner")
    says = settings.get("sees") if isinstance(settings, dict) else None
    return card.agent != "scope" or card.planner.name == card.perception.name or str(says).lower() == "true"
