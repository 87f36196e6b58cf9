"""Compute accuracies, and summarize evaluations as JSON data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from scope_ptz.bench.engine.failure_summary import failure_summary, server_events
from scope_ptz.bench.judging.judgement_tally import lacks_verdict, needs_judgement
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.tasks.task import Category

CATEGORIES: tuple[str, ...] = get_args(Category)


def accuracy(trials: Sequence[Trial]) -> float | None:
    """Return the fraction of correct runs; None if no run is scored.

    Runs with an infrastructure failure and runs without a judge's verdict are excluded.
    """
    scored = [t for t in trials if t.headline != "infrastructure" and not lacks_verdict(t)]
    return sum(t.headline == "correct" for t in scored) / len(scored) if scored else None


def macro_accuracy(trials: Sequence[Trial]) -> float | None:
    """Return the unweighted mean of the accuracies in all categories; None if no run is scored."""
    groups = [[t for t in trials if t.task.category == category] for category in CATEGORIES]
    shares = [share for share in (accuracy(group) for group in groups if group) if share is not None]
    return sum(shares) / len(shares) if shares else None


def evaluation_summary(evaluation: Evaluation) -> dict[str, object]:
    """Return the summary of an evaluation that the option ``--json`` prints."""
    trials = evaluation.trials
    groups = {name: [t for t in trials if t.task.category == name] for name in CATEGORIES}
    return {
        "log": evaluation.log,
        "pair": evaluation.card.pair,
        "isolation": evaluation.card.isolation,
        "finished": evaluation.finished,
        "runs": len(trials),
        "wanted": evaluation.wanted,
        "macro": macro_accuracy(trials),
        "micro": accuracy(trials),
        "by_category": {name: accuracy(group) for name, group in groups.items() if group},
        "headlines": {
            name: sum(t.headline == name for t in trials) for name in ("correct", "incorrect", "unscored", "infrastructure")
        },
        "not_judged": sum(needs_judgement(t) for t in trials),
        "server_events": dict(server_events(trials)),
        "failure_summary": failure_summary(trials, evaluation.card),
    }
