"""Compute the durations and the number of tool calls of trials."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

import numpy as np

from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Trial


def stage_seconds(run: ReportRun, stage: str) -> list[float]:
    """Return the wall-clock seconds of a stage in each timed trial that used the stage. ``stage`` is a field of ``Timings``."""
    seconds = [float(getattr(t.timings, stage)) for t in run.scored_trials if t.timings.total_s > 0]
    return [value for value in seconds if value > 0]


def median(seconds: Sequence[float]) -> float | None:
    """Return the median of durations; None if there are none."""
    return float(np.median(seconds)) if seconds else None


def p95(seconds: Sequence[float]) -> float | None:
    """Return the 95th percentile of durations, linearly interpolated; None if there are none."""
    return float(np.quantile(seconds, 0.95)) if seconds else None


def mean_tool_calls(trials: Sequence[Trial]) -> float | None:
    """Return the mean number of tool calls per trial, including failed calls; None if there are no trials."""
    return fmean(sum(t.tool_calls.values()) for t in trials) if trials else None
