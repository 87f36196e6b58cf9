"""Summarize the runs of an evaluation that failures of model servers broke or affected, with a remedy for each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.scoring.trials import ModelCard, RunCard, Trial
from scope_ptz.endpoints.failures import FailureKind, ServerFailure


def failure_summary(trials: Sequence[Trial], card: RunCard) -> list[str]:
    """Return a sentence for each reason for which runs broke, and one for failed perception calls in runs that still count."""
    broken = [trial for trial in trials if trial.headline == "infrastructure"]
    lines = []
    for reason in dict.fromkeys(_without_kind(trial.reason) for trial in broken):
        own = [trial for trial in broken if _without_kind(trial.reason) == reason]
        ended = Counter(kind.value for trial in own if (kind := _kind_at_end(trial.reason)) is not None)
        model = card.planner if any(trial.outcome == "planner_error" for trial in own) else card.perception
        kinds = f" ({counts_text(ended)})" if ended else ""
        advice = _advice(model, _most_frequent(ended or server_events(own)))
        lines.append(f"{len(own)} of {_runs(len(trials))} broken: {reason}{kinds}.{advice}")
    affected = [trial for trial in trials if trial.headline != "infrastructure" and trial.perception_failures]
    if affected:
        failures, events = sum(trial.perception_failures for trial in affected), server_events(affected)
        times = "1 perception call" if failures == 1 else f"{failures} perception calls"
        kinds = f" ({counts_text(events)})" if events else ""
        still = "which still counts" if len(affected) == 1 else "which still count"
        line = f"{times} failed in {len(affected)} of {_runs(len(trials))}, {still}{kinds}."
        lines.append(f"{line}{_advice(card.perception, _most_frequent(events))}")
    return lines


def server_events(trials: Sequence[Trial]) -> Counter[str]:
    """Count the failures of model servers by kind, including those that a retry recovered from."""
    events = Counter[str]()
    for trial in trials:
        events.update(trial.server_events)
    return events


def counts_text(events: Counter[str]) -> str:
    """Return kinds of failures with their counts, the most frequent first."""
    return ", ".join(f"{kind} {number}" for kind, number in events.most_common())


def _most_frequent(events: Counter[str]) -> FailureKind | None:
    """Return the most frequent kind. An open circuit counts only if there is no other, because it follows from other failures."""
    kinds = [kind for name, _ in events.most_common() if (kind := _kind(name)) is not None]
    return next((kind for kind in kinds if kind is not FailureKind.CIRCUIT_OPEN), kinds[0] if kinds else None)


def _without_kind(reason: str) -> str:
    """Return a reason without the kind of failure at its end."""
    return reason.rpartition(": ")[0] if _kind_at_end(reason) is not None else reason


def _kind_at_end(reason: str) -> FailureKind | None:
    return _kind(reason.rpartition(": ")[2])


def _kind(name: str) -> FailureKind | None:
    try:
        return FailureKind(name)
    except ValueError:
        return None


def _advice(model: ModelCard, kind: FailureKind | None) -> str:
    """Return a sentence about the fault of a model's server and the remedy; empty if it has no server or the kind is unknown."""
    address = model.provider if "://" in model.provider else ""
    return f" {ServerFailure(kind, where=address)}" if kind is not None and address else ""


def _runs(number: int) -> str:
    return f"{number} run{'' if number == 1 else 's'}"
