"""Model pairs as candidates for deployment: their accuracy, latency and memory, and the Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
        memory_gb: Computed memory; None if a model is not in the registry.
        contended: Whether the latency was measured under contention.
        on_front: Whether no other pair is better in all three.
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


def candidates(ranked: Sequence[ReportRun], every: Sequence[ReportRun]) -> list[Candidate]:
    """Return the ranked runs as candidates.

    Args:
        ranked: The runs of model pairs over the same tasks.
        every: All runs, from which latencies without contention are taken.
    """
    found = []
    for run in ranked:
        source = timing_run(run, every)
        seconds = median(stage_seconds(source, "own_s"))
        accuracy = run.macro.value if run.macro else None
        found.append(Candidate(run, accuracy, seconds, run.memory_gb, source.evaluation.card.contended))
    complete = [c for c in found if c.complete]
    # Rounded, so that rounding errors do not decide between pairs of equal accuracy.
    points = [(-round(c.accuracy or 0.0, 9), c.latency_s or 0.0, c.memory_gb or 0.0) for c in complete]
    front = {id(c) for c, on in zip(complete, undominated(points), strict=True) if on}
    return [Candidate(c.run, c.accuracy, c.latency_s, c.memory_gb, c.contended, id(c) in front) for c in found]
