"""Build trial records from the stored data of runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scope_ptz.agent.records import Ended
from scope_ptz.agent.trace import Trace
from scope_ptz.bench.agents.faults import AGENT_FAULTS, fault_reason
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.stored_run import StoredRun, sample_name, trace_of
from scope_ptz.bench.judging.deciding_judge import verdict_by
from scope_ptz.bench.scoring.episode import Episode, Observation
from scope_ptz.bench.scoring.error_modes import error_mode
from scope_ptz.bench.scoring.imported_check import check_imported_calls
from scope_ptz.bench.scoring.trials import CheckRecord, Judgement, ObservationTime, Trial
from scope_ptz.bench.scoring.verdict import AGENT_FAILURES, score_episode
from scope_ptz.builtin_names import EXACT_PERCEPTION

_TIMED_TOOLS = ("count_objects", "query_answer")
"""Tools whose calls are reported, with their times, as perception calls."""


def trial_of(entry: Entry, stored_run: StoredRun, epoch: int, folder: Path, judgements: tuple[Judgement, ...] = ()) -> Trial:
    """Return the trial of a run, scored by the checks of its task. For a task without checks, the first verdict by a judge decides.

    If a log contains verdicts by several judges, ``judging.deciding_judge`` selects the deciding judge later.

    Args:
        entry: The entry that was run.
        stored_run: The stored data of the run.
        epoch: Number of the run of this entry, from 1.
        folder: Folder of the trace, for error messages.
        judgements: The judgements of the run.
    """
    name = sample_name(entry.facts.id, epoch)
    trace = trace_of(stored_run.trace, folder)
    if trace is None:
        reason = "the run did not begin"
        return Trial(
            task=entry.facts, epoch=epoch, sample=name, headline="infrastructure", reason=reason, outcome=None, answer="",
            judgements=judgements,
        )  # fmt: skip
    verdict = _verdict_of_checks(entry, stored_run, trace) if entry.task else _verdict_of_judges(trace, judgements)
    if entry.imported is not None:
        verdict["checks"] = (check_imported_calls(entry.imported, stored_run.episode(trace)),)
    return Trial.model_validate(
        {"task": entry.facts, "epoch": epoch, "sample": name, "judgements": judgements} | verdict | _trace_fields(trace)
    )


def _verdict_of_checks(entry: Entry, stored_run: StoredRun, trace: Trace) -> dict[str, Any]:
    assert entry.task is not None  # noqa: S101 - the caller has checked
    episode = stored_run.episode(trace)
    verdict = score_episode(entry.task, episode)
    truth = _TrueCounts(episode, stored_run.truths)
    return {
        "headline": verdict.headline,
        "scored_by": "checks",
        "reason": _with_fault(trace.ended, verdict.reason),
        "error_mode": error_mode(
            entry.task,
            episode,
            truth if stored_run.truths else None,
            exact_perception=trace.started.perception in EXACT_PERCEPTION,
            verdict=verdict,
        ),
        "checks": tuple(CheckRecord(name=c.name, passed=c.passed, reason=c.reason) for c in verdict.checks),
        "collateral": verdict.moved_needlessly,
    }


def _with_fault(ended: Ended | None, reason: str) -> str:
    """Return the reason for a verdict. If the failure of an external agent ended the run, add the failure before the reason."""
    if ended is None or ended.kind not in AGENT_FAULTS:
        return reason
    return f"{fault_reason(ended.kind, ended.text)} {reason}"


class _TrueCounts:
    """A callable that looks up the stored true count for an observation."""

    def __init__(self, episode: Episode, truths: Mapping[str, int | None]) -> None:
        self._counts = [
            (observation, truths.get(str(number))) for number, call in enumerate(episode.calls) for observation in call.observations
        ]

    def __call__(self, observation: Observation) -> int | None:
        return next((count for counted, count in self._counts if counted == observation), None)


def _verdict_of_judges(trace: Trace, judgements: tuple[Judgement, ...]) -> dict[str, Any]:
    failure = failure_at_end(trace.ended)
    if failure is not None:
        return {"headline": "infrastructure", "scored_by": "judge", "reason": failure, "error_mode": None}
    return {"scored_by": "judge", **verdict_by(judgements)}


def failure_at_end(ended: Ended | None) -> str | None:
    """Return the infrastructure failure that ended a run, given the last record of its trace; None if there was none."""
    if ended is None:
        return "the run was cut off"
    if ended.outcome in ("camera_error", "cancelled"):
        return f"the run ended with the outcome {ended.outcome}"
    if ended.outcome == "planner_error" and ended.kind is not None and ended.kind not in AGENT_FAILURES:
        return f"the planner's server failed: {ended.kind}"
    return None


def _observation_times(trace: Trace) -> tuple[ObservationTime, ...]:
    """Return, for each successful call to a timed tool, the times of perception, the camera and the whole call."""
    calls = [c for c in trace.calls if c.outcome.call.name in _TIMED_TOOLS and c.outcome.error is None]
    return tuple(
        ObservationTime(
            view="full" if called.outcome.call.arguments.get("view") == "full" else "current",
            eyes_s=called.perception_s,
            capture_s=max(called.timings.capture_s, 0.0),
            call_s=max(called.timings.total_s, 0.0),
        )
        for called in calls
    )


def _trace_fields(trace: Trace) -> dict[str, Any]:
    """Return the trial fields that come from the trace."""
    ended = trace.ended
    return {
        "outcome": ended.outcome if ended else None,
        "answer": ended.text if ended else "",
        "steps": ended.steps if ended else len(trace.decisions),
        "planned_by": dict(Counter(d.decision.planned_by for d in trace.decisions if d.decision.planned_by is not None)),
        "tool_calls": dict(Counter(c.outcome.call.name for c in trace.calls if c.fault != "skipped")),
        "bad_calls": sum(c.fault == "bad_call" for c in trace.calls),
        "perception_failures": sum(c.fault == "perception" for c in trace.calls),
        "server_events": ended.server_events if ended else {},
        "input_tokens": ended.usage.input_tokens if ended else 0,
        "output_tokens": ended.usage.output_tokens if ended else 0,
        "timings": ended.timings if ended else {},
        "looks": _observation_times(trace),
    }
