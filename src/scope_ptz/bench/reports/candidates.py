"""Compare model pairs as candidates for deployment by accuracy, latency and memory, and find the Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from scope_ptz.bench.reports.report_runs import ReportRun, timing_run
from scope_ptz.bench.reports.stage_times import median, stage_seconds
from scope_ptz.bench.statistics.pareto import undominated


@dataclass(frozen=True, slots=True)
class Candidate:
    """A model pair with its accuracy, latency and memory.

    Attributes:
        run: The run of the pair.
        accuracy: Macro accuracy; None if not measured.
        latency_s: Median seconds of a trial without the camera; None if not measured.
        memory_gb: Computed memory in GB; None if a model is not in the registry.
        contended: Whether the latency was measured under contention.
        on_front: Whether the pair is on the Pareto front of accuracy, latency and memory.
    """

    run: ReportRun
    accuracy: float | None
    latency_s: float | None
    memory_gb: float | None
    contended: bool
    on_front: bool = False

    @property
    def complete(self) -> bool:
        """Whether accuracy, latency and memory are all known."""
        return None not in (self.accuracy, self.latency_s, self.memory_gb)


def candidates(ranked: Sequence[ReportRun], all_runs: Sequence[ReportRun]) -> list[Candidate]:
    """Return the ranked runs as candidates, and mark those on the Pareto front.

    Args:
        ranked: The runs of model pairs over the same tasks.
        all_runs: All runs of the report. Latencies are taken from a run without contention if there is one.
    """
    measured = []
    for run in ranked:
        source = timing_run(run, all_runs)
        seconds = median(stage_seconds(source, "own_s"))
        accuracy = run.macro.value if run.macro else None
        measured.append(Candidate(run, accuracy, seconds, run.memory_gb, source.evaluation.card.contended))
    complete = [c for c in measured if c.complete]
    # Accuracies are rounded, so that rounding errors do not decide between pairs of equal accuracy.
    points = [(-round(c.accuracy or 0.0, 9), c.latency_s or 0.0, c.memory_gb or 0.0) for c in complete]
    front = {id(c) for c, is_on_front in zip(complete, undominated(points), strict=True) if is_on_front}
    return [replace(c, on_front=id(c) in front) for c in measured]
