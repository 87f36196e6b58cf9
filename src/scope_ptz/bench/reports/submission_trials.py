"""Check that a trial of a submission is consistent with itself and with its task."""

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
"""Seconds by which a part may exceed the whole, because clocks are read one after the other."""
BREAKING = ("camera_error", "cancelled", "planner_error")
"""Outcomes of runs that infrastructure may have broken. A planner error may also be the model's own."""
LOOKERS = REGISTRY.perceiving
MOVING = frozenset({"move", "zoom", "preset"})
"""Needs of a task that change the camera's viewpoint or pose."""


def trial_faults(line: TrialLine, header: Header, task: Task | None) -> Iterator[str]:
    """Yield the faults of a trial. ``task`` is None if it is not a task of the split."""
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
    """Yield faults of the headline, which must follow from the checks."""
    if line.scored_by == "judge":
        if line.headline in ("correct", "incorrect") and line.headline not in {judgement.verdict for judgement in line.judged}:
            yield f"{line.headline} by the judge, but no judgement says so"
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
    """Yield a fault if the answer, parsed again, does not give the result of the answer check."""
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
    """Return the names of the checks that apply to a task."""
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
    return {name for name, required in called_for.items() if required}


def _check_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Yield faults of the checks: missing or unknown ones, or a verdict that is not theirs."""
    if line.scored_by == "judge":
        yield "scored by a judge, and the task has checks"
    if line.headline == "infrastructure" and line.outcome is None and not line.checks:
        return  # The run never began.
    required = checks_of(task)
    if lacking := sorted(required - set(line.checks)):
        yield f"the task's checks {', '.join(lacking)} are missing"
    if further := sorted(set(line.checks) - required):
        yield f"the task has no checks {', '.join(further)[:200]}"
    if "outcome" in line.checks and line.checks["outcome"] is not (line.outcome in task.behaviour.outcomes):
        yield f"the outcome {line.outcome} and its check differ"


def _broken_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Yield a fault if a trial was not broken by infrastructure although its headline says so.

    Only a server, the camera or an interruption breaks a run. A run that ended in another way is broken only if perception always
    failed and the answer claims no value.
    """
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
    """Yield faults of the calls: checks that passed require them."""
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
    """Return whether the planner itself may be shown frames: it is also the perception model, a person, or an external agent."""
    settings = card.sampling.get("planner")
    sees = settings.get("sees") if isinstance(settings, dict) else None
    return card.agent != "scope" or card.planner.name == card.perception.name or str(sees).lower() == "true"
