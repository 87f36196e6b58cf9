"""Find contradictions inside a trace: records that cannot all come from one run of the agent loop.

These checks need no camera and no scene. ``agent.resimulation`` repeats the calls, and therefore also detects forged traces that
are internally consistent.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from scope_ptz.agent.records import Called, Decided, Ended, RecordedPose, Started
from scope_ptz.agent.timing import usage_of_failures
from scope_ptz.agent.trace import Trace
from scope_ptz.planner.base import CallTools, Finish, Usage

POSE_TOLERANCE = 1e-6
"""Maximum difference between equal poses (degrees, or magnification) and between equal scene times (seconds)."""
CLOCK_TOLERANCE_S = 0.05
"""Seconds by which a sum of measured times may exceed the total time, because the clock is read several times."""
INTERRUPTED_OUTCOMES = frozenset({"budget", "cancelled", "camera_error"})
"""Outcomes of runs that can end in the middle of a step, so that calls in the last step may be missing."""
_FINISHED_OUTCOMES = frozenset({"answered", "clarification", "refused"})


def record_faults(records: Sequence[Started | Decided | Called | Ended]) -> Iterator[str]:
    """Yield a fault for each misplaced record. A trace has one header, which comes first, and at most one end, which comes last."""
    if sum(isinstance(record, Started) for record in records) > 1:
        yield "the trace contains the headers of several runs"
    if any(isinstance(record, Ended) for record in records[:-1]):
        yield "the trace continues after its end"


def trace_faults(trace: Trace) -> Iterator[str]:
    """Yield the contradictions in a trace recorded with a simulated camera, as sentences without a final full stop."""
    yield from _step_faults(trace)
    if trace.ended is not None:
        yield from _end_faults(trace, trace.ended)
        yield from _count_faults(trace, trace.ended)
        yield from _time_faults(trace, trace.ended)


def _step_faults(trace: Trace) -> Iterator[str]:
    """Yield a fault for each call without a decision, and for each decision whose calls were not carried out."""
    steps = [decided.step for decided in trace.decisions]
    if steps != list(range(1, len(steps) + 1)):
        yield "the decisions are not numbered from 1 without gaps"
        return
    if any(isinstance(decided.decision, Finish) for decided in trace.decisions[:-1]):
        yield "the planner made another decision after it finished"
    recorded: dict[int, list[Called]] = {}
    for called in trace.calls:
        recorded.setdefault(called.step, []).append(called)
    if [(c.step, c.index) for c in trace.calls] != sorted((c.step, c.index) for c in trace.calls):
        yield "the calls are not in order"
    for decided in trace.decisions:
        calls = recorded.pop(decided.step, [])
        expected = decided.decision.calls if isinstance(decided.decision, CallTools) else ()
        yield from _call_faults(decided.step, calls, expected, complete=_is_complete(trace, decided.step))
    for step in sorted(recorded):
        yield f"step {step} has calls, but the planner made no decision in it"


def _call_faults(step: int, calls: Sequence[Called], expected: Sequence[object], *, complete: bool) -> Iterator[str]:
    positions = [called.index for called in calls]
    if len(set(positions)) < len(positions) or any(index >= len(expected) for index in positions):
        yield f"step {step} has calls that the planner did not decide on"
        return
    for called in calls:
        if called.outcome.call != expected[called.index]:
            yield f"call {called.index + 1} of step {step} differs from the decision of the planner"
        if (called.outcome.error is None) == (called.outcome.result is None):
            yield f"call {called.index + 1} of step {step} must have either a result or an error"
        elif called.outcome.error is None and called.fault is not None:
            yield f"call {called.index + 1} of step {step} has a result although it failed"
    if complete and len(calls) < len(expected):
        yield f"step {step} lacks {len(expected) - len(calls)} of the calls that the planner decided on"


def _is_complete(trace: Trace, step: int) -> bool:
    """Return whether every call in a step must be recorded."""
    return step < len(trace.decisions) or (trace.ended is not None and trace.ended.outcome not in INTERRUPTED_OUTCOMES)


def _end_faults(trace: Trace, ended: Ended) -> Iterator[str]:
    """Yield a fault if the end contradicts the last decision or the last pose."""
    last = trace.decisions[-1].decision if trace.decisions else None
    if isinstance(last, Finish):
        if (ended.outcome, ended.text) != (last.kind, last.text):
            yield "the outcome or the answer at the end differs from the last decision of the planner"
    elif ended.outcome in _FINISHED_OUTCOMES:
        yield f"the run ended with the outcome {ended.outcome}, but the planner never decided to finish"
    decided_steps = len(trace.decisions)
    if not decided_steps <= ended.steps <= decided_steps + (ended.outcome not in (*_FINISHED_OUTCOMES, "step_limit")):
        yield f"the end states {ended.steps} steps, but the trace contains {decided_steps} decisions"
    if ended.steps > trace.started.budgets.max_steps:
        yield f"the run has {ended.steps} steps, but its limit is {trace.started.budgets.max_steps}"
    if ended.outcome in _FINISHED_OUTCOMES and all(called.outcome.error is None for called in trace.calls):
        last_pose = trace.calls[-1].pose if trace.calls else trace.started.pose
        if not is_same_pose(last_pose, ended.pose):
            yield "the pose at the end differs from the pose after the last call"
    for called in trace.calls:
        stated = (called.outcome.result or {}).get("pose")
        if isinstance(stated, dict) and not _equals_rounded_pose(stated, called.pose):
            yield f"the pose in the result of call {called.index + 1} of step {called.step} differs from the pose of the camera"


def is_same_pose(one: RecordedPose, other: RecordedPose) -> bool:
    """Return whether two poses are equal within ``POSE_TOLERANCE``."""
    return all(abs(getattr(one, name) - getattr(other, name)) <= POSE_TOLERANCE for name in RecordedPose.model_fields)


def _equals_rounded_pose(stated: dict[str, object], pose: RecordedPose) -> bool:
    """Return whether a pose in a result, which is rounded to hundredths, equals the camera's pose."""
    values = [(stated.get(name), getattr(pose, name)) for name in RecordedPose.model_fields]
    return all(isinstance(a, int | float) and _difference(float(a), b) <= 0.011 for a, b in values)


def _difference(one: float, other: float) -> float:
    """Return the absolute difference between two pan, tilt or zoom values. A difference of 360 counts as 0, as for pan."""
    return min(abs(one - other), abs(abs(one - other) - 360.0))


def _count_faults(trace: Trace, ended: Ended) -> Iterator[str]:
    faults = Counter(called.fault for called in trace.calls)
    for what, stated, found in (
        ("bad calls", ended.bad_calls, faults["bad_call"]),
        ("perception failures", ended.perception_failures, faults["perception"]),
    ):
        if stated != found:
            yield f"the end states {stated} {what}, but the trace contains {found}"
    used = Usage()
    for decided in trace.decisions:
        used += decided.decision.usage
        if decided.decision.served is not None:
            used += usage_of_failures(decided.decision.served.attempts)
    total = ended.usage
    exceeds_total = used.input_tokens > total.input_tokens or used.output_tokens > total.output_tokens
    if exceeds_total or (
        ended.outcome in _FINISHED_OUTCOMES and (used.input_tokens, used.output_tokens) != (total.input_tokens, total.output_tokens)
    ):
        yield "the tokens at the end differ from those of the decisions"


def _time_faults(trace: Trace, ended: Ended) -> Iterator[str]:
    timings, count = ended.timings, len(trace.decisions) + len(trace.calls)
    tolerance_s = CLOCK_TOLERANCE_S * (1 + count)
    planner_s = sum(decided.planner_s for decided in trace.decisions)
    if planner_s > timings.planner_s + tolerance_s:
        yield "the planner took longer in its steps than in the whole run"
    longest_s = max(timings.planner_s, timings.perception_s, timings.camera_s, timings.render_s)
    calls_s = max((called.timings.total_s for called in trace.calls), default=0.0)
    if max(longest_s, calls_s) > timings.total_s + tolerance_s:
        yield "a part of the run took longer than the whole run"
    if any(b.scene_time_s < a.scene_time_s - POSE_TOLERANCE for a, b in zip(trace.calls, trace.calls[1:], strict=False)):
        yield "scene time runs backwards between calls"
