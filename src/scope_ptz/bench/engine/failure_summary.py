"""Summarize the infrastructure failures, agent failures and failed perception calls of an evaluation, with remedies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.agents.faults import fault_in
from scope_ptz.bench.scoring.trials import ModelCard, RunCard, Trial
from scope_ptz.endpoints.failures import FailureKind, ServerFailure


def failure_summary(trials: Sequence[Trial], card: RunCard) -> list[str]:
    """Return one line per cause of infrastructure failures, and lines about agent and perception failures in scored runs."""
    broken = [trial for trial in trials if trial.headline == "infrastructure"]
    lines = []
    for reason in dict.fromkeys(_remove_kind(trial.reason) for trial in broken):
        group = [trial for trial in broken if _remove_kind(trial.reason) == reason]
        counts = Counter(kind.value for trial in group if (kind := _kind_at_end(trial.reason)) is not None)
        model = card.planner if any(trial.outcome == "planner_error" for trial in group) else card.perception
        kinds = f" ({counts_text(counts)})" if counts else ""
        advice = _advice(model, _most_frequent(counts or server_events(group)))
        lines.append(f"{len(group)} of {_runs(len(trials))} broken: {reason}{kinds}.{advice}")
    faults = Counter(fault for trial in trials if (fault := fault_in(trial.reason)) is not None)
    if faults:
        lines.append(f"The agent failed in {faults.total()} of {_runs(len(trials))}, which were scored: {counts_text(faults)}.")
    affected = [trial for trial in trials if trial.headline != "infrastructure" and trial.perception_failures]
    if affected:
        failures, events = sum(trial.perception_failures for trial in affected), server_events(affected)
        calls = "1 perception call" if failures == 1 else f"{failures} perception calls"
        kinds = f" ({counts_text(events)})" if events else ""
        scored = "which was scored nevertheless" if len(affected) == 1 else "which were scored nevertheless"
        line = f"{calls} failed in {len(affected)} of {_runs(len(trials))}, {scored}{kinds}."
        lines.append(f"{line}{_advice(card.perception, _most_frequent(events))}")
    return lines


def server_events(trials: Sequence[Trial]) -> Counter[str]:
    """Count model server failures by kind, including those after which a retry succeeded."""
    events = Counter[str]()
    for trial in trials:
        events.update(trial.server_events)
    return events


def counts_text(events: Counter[str]) -> str:
    """Format the counts of failures by kind, the most frequent first."""
    return ", ".join(f"{kind} {number}" for kind, number in events.most_common())


def _most_frequent(events: Counter[str]) -> FailureKind | None:
    """Return the most frequent kind of failure.

    An open circuit breaker is a consequence of other failures, so it is returned only if there is no other kind.
    """
    kinds = [kind for name, _ in events.most_common() if (kind := _kind(name)) is not None]
    return next((kind for kind in kinds if kind is not FailureKind.CIRCUIT_OPEN), kinds[0] if kinds else None)


def _remove_kind(reason: str) -> str:
    """Remove the kind of failure from the end of a reason."""
    return reason.rpartition(": ")[0] if _kind_at_end(reason) is not None else reason


def _kind_at_end(reason: str) -> FailureKind | None:
    return _kind(reason.rpartition(": ")[2])


def _kind(name: str) -> FailureKind | None:
    try:
        return FailureKind(name)
    except ValueError:
        return None


def _advice(model: ModelCard, kind: FailureKind | None) -> str:
    """Return a sentence about the server failure and its remedy, or an empty string if the server or the kind is unknown."""
    address = model.provider if "://" in model.provider else ""
    return f" {ServerFailure(kind, where=address)}" if kind is not None and address else ""


def _runs(number: int) -> str:
    return f"{number} run{'' if number == 1 else 's'}"
