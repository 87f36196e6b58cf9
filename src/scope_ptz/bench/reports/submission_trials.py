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
"""Seconds by which a stage may exceed the whole trial, because the clock is read several times."""
BREAKING = ("camera_error", "cancelled", "planner_error")
"""Outcomes of runs that infrastructure may have broken. A planner error may also be the model's own."""
PERCEPTION_TOOLS = REGISTRY.perceiving
MOVING = frozenset({"move", "zoom", "preset"})
"""Needs of a task that require a change of the camera's viewpoint or pose."""


def trial_faults(line: TrialLine, header: Header, task: Task | None) -> Iterator[str]:
    """Yield the faults of a trial. ``task`` is None if it is not a task of the split."""
    if line.epoch > header.card.epochs:
        yield f"this is repeat {line.epoch}, but the header states {header.card.epochs} repeats"
    if line.error_mode is not None and line.headline != "incorrect":
        yield f"error mode {line.error_mode} although the trial is {line.headline}"
    if line.error_mode is None and line.headline == "incorrect" and line.scored_by == "checks":
        yield "an incorrect trial has no error mode"
    yield from _verdict_faults(line)
    if line.outcome is not None and line.outcome not in OUTCOMES:
        yield f"outcome {line.outcome} is not one of {', '.join(OUTCOMES)}"
    if strange := sorted(set(line.tool_calls) - TOOLS - {UNKNOWN_TOOL}):
        yield f"unknown tools: {', '.join(strange)[:200]}"
    if line.steps > header.card.max_steps:
        yield f"{line.steps} steps, but the limit is {header.card.max_steps}"
    times = line.times
    longest = max(times.planner_s, times.perception_s, times.camera_s, times.render_s)
    if longest > times.total_s + SLACK_S:
        yield f"a stage took {longest:g} s, but the whole trial took {times.total_s:g} s"
    if task is not None:
        if line.category != task.category:
            yield f"the category is {line.category}, but that of the task is {task.category}"
        yield from _check_faults(line, task)
        yield from _broken_faults(line, task)
        yield from _answer_faults(line, task)
        yield from _call_faults(line, header, task)


def _verdict_faults(line: TrialLine) -> Iterator[str]:
    """Yield faults of the headline, which must follow from the checks."""
    if line.scored_by == "judge":
        if line.headline in ("correct", "incorrect") and line.headline not in {judgement.verdict for judgement in line.judged}:
            yield f"{line.headline} by the judge, but no judgement has this verdict"
        return
    passed = list(line.checks.values())
    if line.headline in ("correct", "incorrect", "unscored") and not passed:
        yield "the trial has no checks"
    elif line.headline == "correct" and not all(p is True for p in passed):
        yield "correct although not every check passed"
    elif line.headline == "incorrect" and False not in passed:
        yield "incorrect although no check failed"
    elif line.headline == "unscored" and (False in passed or None not in passed):
        yield "unscored although the checks decide"


def _answer_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Yield a fault if the answer, parsed again, does not give the result of the answer check."""
    if isinstance(task.expected, ActionOnly) or line.scored_by == "judge" or line.answer.endswith(CUT):
        return
    if "answer" not in line.checks:
        if line.headline != "infrastructure":
            yield "the task expects an answer, but the trial has no answer check"
        return
    ended = line.outcome in ("answered", "clarification", "refused")
    found = agrees(task.expected, parse_answer(task.expected, line.answer)) if ended else False
    if found != line.checks["answer"]:
        yield f"the answer is {_words(found)}, but its check says {_words(line.checks['answer'])}"


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
    """Yield faults of the checks: missing or unknown checks, or a check that contradicts the outcome."""
    if line.scored_by == "judge":
        yield "scored by a judge, although the task has checks"
    if line.headline == "infrastructure" and line.outcome is None and not line.checks:
        return  # The run never began.
    required = checks_of(task)
    if lacking := sorted(required - set(line.checks)):
        yield f"checks of the task are missing: {', '.join(lacking)}"
    if further := sorted(set(line.checks) - required):
        yield f"the task does not have these checks: {', '.join(further)[:200]}"
    if "outcome" in line.checks and line.checks["outcome"] is not (line.outcome in task.behaviour.outcomes):
        yield f"the outcome {line.outcome} contradicts its check"


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
        yield f"broken by infrastructure although it ended {line.outcome} and perception failures do not explain it"


def _call_faults(line: TrialLine, header: Header, task: Task) -> Iterator[str]:
    """Yield faults of the calls, such as a check that passed without the calls that it requires."""
    made, calls = sum(line.tool_calls.values()), Counter(line.tool_calls)
    if line.outcome is not None and line.outcome not in BREAKING and not line.steps:
        yield f"the trial ended {line.outcome} without a step"
    if made and not line.steps:
        yield f"{made} calls, but no step"
    if line.bad_calls + line.perception_failures > made:
        yield f"{line.bad_calls + line.perception_failures} failed calls, but only {made} calls"
    if line.checks.get("coverage") and not _may_see(header.card) and not any(calls[tool] for tool in PERCEPTION_TOOLS):
        yield "the check 'coverage' passed without a perception call"
    if line.checks.get("calls"):
        needed = Counter[str]()
        for call in task.behaviour.calls:
            needed[call.tool] += call.times
        for tool, number in (needed - calls).items():
            yield f"the check 'calls' passed, but only {calls[tool]} of {calls[tool] + number} required calls of {tool} were made"
    if line.checks.get("pictures") and calls["take_image"] < (task.behaviour.pictures or 0):
        yield f"the check 'pictures' passed, but take_image was called {calls['take_image']} of {task.behaviour.pictures} times"
    moved = [name for name in ("pose", "framing") if line.checks.get(name)]
    if moved and set(task.needs) & MOVING and not any(calls[tool] for tool in MOVERS):
        yield f"the check '{moved[0]}' passed, but no call moved the camera"


def _may_see(card: RunCard) -> bool:
    """Return whether the planner itself may be shown frames: it is also the perception model, a person, or an external agent."""
    settings = card.sampling.get("planner")
    sees = settings.get("sees") if isinstance(settings, dict) else None
    return card.agent != "scope" or card.planner.name == card.perception.name or str(sees).lower() == "true"
