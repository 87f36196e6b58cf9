"""Compute the current scores of an evaluation in progress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from scope_ptz.bench.engine.run_totals import CATEGORIES
from scope_ptz.bench.judging.judgement_tally import lacks_verdict
from scope_ptz.bench.reports.progress_state import CategoryProgress, Score
from scope_ptz.bench.reports.report_runs import macro, scores_of
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate, proportion


def score_fields(trials: Sequence[Trial]) -> Mapping[str, object]:
    """Return the fields of ``ProgressState`` that depend on the finished runs.

    As in reports, runs with an infrastructure failure and runs without a judge's verdict are excluded from the scores.
    """
    scored = [t for t in trials if t.headline != "infrastructure" and not lacks_verdict(t)]
    scores = scores_of(scored)
    counts = {name: sum(t.headline == name for t in trials) for name in ("correct", "incorrect", "unscored", "infrastructure")}
    return {
        "done": len(trials),
        "correct": counts["correct"],
        "incorrect": counts["incorrect"],
        "unscored": counts["unscored"],
        "broken": counts["infrastructure"],
        "micro": _score(proportion(scores)),
        "macro": _score(macro(scores)),
        "categories": tuple(_category(name, trials, scored) for name in CATEGORIES if any(t.task.category == name for t in trials)),
    }


def _category(name: str, trials: Sequence[Trial], scored: Sequence[Trial]) -> CategoryProgress:
    correct = sum(t.headline == "correct" for t in scored if t.task.category == name)
    number = sum(t.task.category == name for t in scored)
    runs = sum(t.task.category == name for t in trials)
    return CategoryProgress(category=name, runs=runs, correct=correct, accuracy=correct / number if number else None)


def _score(estimate: IntervalEstimate | None) -> Score | None:
    return None if estimate is None else Score(value=estimate.value, low=estimate.low, high=estimate.high)
