"""Check that the trials of a submission are internally consistent and match their tasks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from scope_ptz.agent.records import OUTCOMES
from scope_ptz.bench.answers import ParsedValue, agrees, parse_answer
from scope_ptz.bench.scoring.trials import RunCard
from scope_ptz.bench.scoring.verdict import MOVING_TOOLS
from scope_ptz.bench.submissions.submission import TOOLS, TRUNCATION_MARK, UNKNOWN_TOOL, Header, TrialLine
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import Task
from scope_ptz.tools.registry import TOOLS as REGISTRY

SLACK_S = 0.5
"""Seconds by which a stage may take longer than the whole trial, because the clock is read several times."""
BROKEN_OUTCOMES = ("camera_error", "cancelled", "planner_error")
"""Outcomes that infrastructure failures can cause. A planner error can also be caused by the model itself."""
PERCEPTION_TOOLS = REGISTRY.perceiving
"""Names of the tools that call perception."""
MOVING_NEEDS = frozenset({"move", "zoom", "preset"})
"""Task needs that require a change of viewpoint or pose."""


def trial_faults(line: TrialLine, header: Header, task: Task | None) -> Iterator[str]:
    """Yield the faults in a trial. ``task`` is None if the task is not in the split."""
    if line.epoch > header.card.epochs:
        yield f"this is repeat {line.epoch}, but the header states {header.card.epochs} repeats"
    if line.error_mode is not None and line.headline != "incorrect":
        yield f"the trial has the error mode {line.error_mode} although it is {line.headline}"
    if line.error_mode is None and line.headline == "incorrect" and line.scored_by == "checks":
        yield "the trial has no error mode although it is incorrect"
    yield from _verdict_faults(line)
    if line.outcome is not None and line.outcome not in OUTCOMES:
        yield f"the outcome must be one of {', '.join(OUTCOMES)}; it is {line.outcome}"
    if unknown := sorted(set(line.tool_calls) - TOOLS - {UNKNOWN_TOOL}):
        yield f"unknown tools: {', '.join(unknown)[:200]}"
    if line.steps > header.card.max_steps:
        yield f"the trial has {line.steps} steps, but the limit is {header.card.max_steps}"
    times = line.times
    longest = max(times.planner_s, times.perception_s, times.camera_s, times.render_s)
    if longest > times.total_s + SLACK_S:
        yield f"a stage took {longest:g} s, but the whole trial took {times.total_s:g} s"
    if task is not None:
        if line.category != task.category:
            yield f"the trial's category is {line.category}, but the task's category is {task.category}"
        yield from _check_faults(line, task)
        yield from _infrastructure_faults(line, task)
        yield from _answer_faults(line, task)
        yield from _call_faults(line, header, task)


def _verdict_faults(line: TrialLine) -> Iterator[str]:
    """Yield a fault if the headline contradicts the checks or the judgements."""
    if line.scored_by == "judge":
        if line.headline in ("correct", "incorrect") and line.headline not in {judgement.verdict for judgement in line.judged}:
            yield f"the trial was scored {line.headline} by a judge, but no judgement has this verdict"
        return
    passed = list(line.checks.values())
    if line.headline in ("correct", "incorrect", "unscored") and not passed:
        yield "the trial has no checks"
    elif line.headline == "correct" and not all(p is True for p in passed):
        yield "the trial is correct although not every check passed"
    elif line.headline == "incorrect" and False not in passed:
        yield "the trial is incorrect although no check failed"
    elif line.headline == "unscored" and (False in passed or None not in passed):
        yield "the trial is unscored although a check failed or every check is decided"


def _answer_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Yield a fault if parsing the answer again gives a different result for the answer check."""
    if isinstance(task.expected, ActionOnly) or line.scored_by == "judge" or line.answer.endswith(TRUNCATION_MARK):
        return
    if "answer" not in line.checks:
        if line.headline != "infrastructure":
            yield "the task expects an answer, but the trial has no answer check"
        return
    has_answer = line.outcome in ("answered", "clarification", "refused")
    passed = agrees(task.expected, parse_answer(task.expected, line.answer)) if has_answer else False
    if passed != line.checks["answer"]:
        yield f"the answer is {_result_text(passed)}, but the result of its check is {_result_text(line.checks['answer'])}"


def _result_text(passed: bool | None) -> str:
    return {True: "right", False: "wrong", None: "unreadable"}[passed]


def checks_of(task: Task) -> set[str]:
    """Return the names of the checks that apply to runs of a task."""
    behaviour = task.behaviour
    applies = {
        "outcome": True,
        "answer": not isinstance(task.expected, ActionOnly),
        "coverage": any(view.must_look for view in task.evidence),
        "pose": behaviour.final is not None,
        "calls": bool(behaviour.calls),
        "forbidden": bool(behaviour.forbidden.tools or behaviour.forbidden.changes),
        "pictures": behaviour.pictures is not None,
        "framing": behaviour.framing is not None,
    }
    return {name for name, is_required in applies.items() if is_required}


def _check_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Yield faults in the checks: missing or unexpected checks, or an outcome check that contradicts the outcome."""
    if line.scored_by == "judge":
        yield "the trial was scored by a judge although the task has checks"
    if line.headline == "infrastructure" and line.outcome is None and not line.checks:
        return  # The run never began.
    required = checks_of(task)
    if missing := sorted(required - set(line.checks)):
        yield f"checks of the task are missing: {', '.join(missing)}"
    if superfluous := sorted(set(line.checks) - required):
        yield f"the task does not have these checks: {', '.join(superfluous)[:200]}"
    if "outcome" in line.checks and line.checks["outcome"] is not (line.outcome in task.behaviour.outcomes):
        yield f"the outcome {line.outcome} contradicts the check 'outcome'"


def _infrastructure_faults(line: TrialLine, task: Task) -> Iterator[str]:
    """Yield a fault if a trial has the headline "infrastructure" without an infrastructure failure.

    A server failure, a camera failure or an interruption breaks a run. A run that ended in another way is broken only if every
    perception call failed and the answer states no value.
    """
    if line.headline != "infrastructure" or line.outcome in (None, *BROKEN_OUTCOMES):
        return
    has_full_answer = (
        line.outcome == "answered" and not isinstance(task.expected, ActionOnly) and not line.answer.endswith(TRUNCATION_MARK)
    )
    if (
        not line.perception_failures
        or line.checks.get("coverage") is not False
        or (has_full_answer and isinstance(parse_answer(task.expected, line.answer), ParsedValue))
    ):
        yield (f"the headline is infrastructure, but the trial ended {line.outcome} and was not broken by failures of perception")


def _call_faults(line: TrialLine, header: Header, task: Task) -> Iterator[str]:
    """Yield faults in the calls, such as a check that passed without the required calls."""
    total, calls = sum(line.tool_calls.values()), Counter(line.tool_calls)
    if line.outcome is not None and line.outcome not in BROKEN_OUTCOMES and not line.steps:
        yield f"the trial ended {line.outcome} without a step"
    if total and not line.steps:
        yield f"the trial has {total} calls, but no step"
    if line.bad_calls + line.perception_failures > total:
        yield f"the trial has {line.bad_calls + line.perception_failures} failed calls, but only {total} calls"
    if line.checks.get("coverage") and not _may_see_frames(header.card) and not any(calls[tool] for tool in PERCEPTION_TOOLS):
        yield "the check 'coverage' passed without a perception call"
    if line.checks.get("calls"):
        required = Counter[str]()
        for call in task.behaviour.calls:
            required[call.tool] += call.times
        for tool, number in (required - calls).items():
            yield f"the check 'calls' passed, but only {calls[tool]} of {calls[tool] + number} required calls of {tool} were made"
    if line.checks.get("pictures") and calls["take_image"] < (task.behaviour.pictures or 0):
        yield f"the check 'pictures' passed, but take_image was called {calls['take_image']} of {task.behaviour.pictures} times"
    passed = [name for name in ("pose", "framing") if line.checks.get(name)]
    if passed and set(task.needs) & MOVING_NEEDS and not any(calls[tool] for tool in MOVING_TOOLS):
        yield f"the check '{passed[0]}' passed, but no call moved the camera"


def _may_see_frames(card: RunCard) -> bool:
    """Return whether the planner may have been shown frames.

    It may if it is also the perception model, if it is a person or an external agent, or if its settings state so.
    """
    settings = card.sampling.get("planner")
    sees = settings.get("sees") if isinstance(settings, dict) else None
    return card.agent != "scope" or card.planner.name == card.perception.name or str(sees).lower() == "true"
