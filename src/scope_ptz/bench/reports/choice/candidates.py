"""Compare model pairs as candidates for deployment by accuracy, latency and memory, and find the Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from scope_ptz.bench.reports.report_runs import ReportRun, timing_run
from scope_ptz.bench.reports.stage_times import median, p95, stage_seconds
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.pareto import pareto_front

REAL_TIME_S = 0.5
"""The paper's real-time criterion in seconds per inference, which corresponds to a control loop of about 2 Hz."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A model pair with its accuracy, latency and memory.

    Attributes:
        run: The run of the pair.
        accuracy: Macro accuracy; None if not measured.
        latency_s: Median seconds per turn (one trial) without the camera; None if not measured.
        p95_s: 95th percentile of the seconds per turn; None if not measured.
        inference_s: Median seconds per inference (planner step or perception call, whichever is slower); None if one of them was
            not measured.
        memory_gb: Computed memory in GB; None if a model is not in the registry.
        contended: Whether the latency was measured under contention.
        on_front: Whether the pair is on the Pareto front of accuracy, latency and memory.
    """

    run: ReportRun
    accuracy: float | None
    latency_s: float | None
    p95_s: float | None
    inference_s: float | None
    memory_gb: float | None
    contended: bool
    on_front: bool = False

    @property
    def is_complete(self) -> bool:
        """Whether accuracy, latency and memory are all known."""
        return None not in (self.accuracy, self.latency_s, self.memory_gb)


def rank_candidates(ranked: Sequence[ReportRun], all_runs: Sequence[ReportRun]) -> list[Candidate]:
    """Return the ranked runs as candidates, and mark the candidates on the Pareto front.

    Args:
        ranked: The runs of model pairs on the same tasks.
        all_runs: All runs in the report. Latencies are taken from a run without contention, if there is one.
    """
    measured = [create_candidate(run, all_runs) for run in ranked]
    complete = [c for c in measured if c.is_complete]
    # Accuracies are rounded, so that numerical errors do not decide between pairs with equal accuracy.
    points = [(-round(c.accuracy or 0.0, 9), c.latency_s or 0.0, c.memory_gb or 0.0) for c in complete]
    front = {id(c) for c, is_on_front in zip(complete, pareto_front(points), strict=True) if is_on_front}
    return [replace(c, on_front=id(c) in front) for c in measured]


def create_candidate(run: ReportRun, all_runs: Sequence[ReportRun]) -> Candidate:
    """Create a candidate from a run. It is not marked as being on the Pareto front."""
    source = timing_run(run, all_runs)
    seconds = stage_seconds(source, "own_s")
    return Candidate(
        run,
        run.macro.value if run.macro else None,
        median(seconds),
        p95(seconds),
        _inference_s(source.scored_trials),
        run.memory_gb,
        source.evaluation.card.contended,
    )


def _inference_s(trials: Sequence[Trial]) -> float | None:
    """Return the slower of the median planner step and the median perception call, in seconds."""
    step_s = median([t.timings.planner_s / t.steps for t in trials if t.steps and t.timings.planner_s > 0])
    call_s = median([call.eyes_s for t in trials for call in t.looks])
    return None if step_s is None or call_s is None else max(step_s, call_s)
