"""What servers did to the runs of an evaluation: how often what happened, at which address, and what to do about it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.scoring.trials import ModelCard, RunCard, Trial
from scope_ptz.endpoints.failures import FailureKind, ServerFailure


def troubles(trials: Sequence[Trial], card: RunCard) -> list[str]:
    """A sentence for every way in which runs were broken, and for looks that failed in runs that count all the same."""
    broken = [trial for trial in trials if trial.headline == "infrastructure"]
    lines = []
    for what in dict.fromkeys(_what(trial.reason) for trial in broken):
        own = [trial for trial in broken if _what(trial.reason) == what]
        ended = Counter(kind.value for trial in own if (kind := _kind_in(trial.reason)) is not None)
        model = card.planner if any(trial.outcome == "planner_error" for trial in own) else card.perception
        how = f" ({told(ended)})" if ended else ""
        lines.append(f"{len(own)} of {_runs(len(trials))} broken: {what}{how}.{_advice(model, _main(ended or events_of(own)))}")
    blind = [trial for trial in trials if trial.headline != "infrastructure" and trial.perception_failures]
    if blind:
        looks, events = sum(trial.perception_failures for trial in blind), events_of(blind)
        counts = "which counts as it ended" if len(blind) == 1 else "which count as they ended"
        said = f" ({told(events)})" if events else ""
        line = f"the eyes failed {_times(looks)} in {len(blind)} of {_runs(len(trials))}, {counts}{said}."
        lines.append(f"{line}{_advice(card.perception, _main(events))}")
    return lines


def events_of(trials: Sequence[Trial]) -> Counter[str]:
    """How often servers failed, by kind, also where a further attempt made it good."""
    events = Counter[str]()
    for trial in trials:
        events.update(trial.server_events)
    return events


def told(events: Counter[str]) -> str:
    """Kinds of failures with their numbers, the most frequent first."""
    return ", ".join(f"{kind} {number}" for kind, number in events.most_common())


def _main(events: Counter[str]) -> FailureKind | None:
    """The kind that was most frequent. A circuit that opened only follows from others."""
    kinds = [kind for name, _ in events.most_common() if (kind := _kind(name)) is not None]
    return next((kind for kind in kinds if kind is not FailureKind.CIRCUIT_OPEN), kinds[0] if kinds else None)


def _what(reason: str) -> str:
    """A reason without the kind of failure at its end."""
    return reason.rpartition(": ")[0] if _kind_in(reason) is not None else reason


def _kind_in(reason: str) -> FailureKind | None:
    return _kind(reason.rpartition(": ")[2])


def _kind(name: str) -> FailureKind | None:
    try:
        return FailureKind(name)
    except ValueError:
        return None


def _advice(model: ModelCard, kind: FailureKind | None) -> str:
    """What is wrong with a model's server, and what to do; empty where there is none, or nothing is known."""
    address = model.provider if "://" in model.provider else ""
    return f" {ServerFailure(kind, where=address)}" if kind is not None and address else ""


def _runs(number: int) -> str:
    return f"{number} run{'' if number == 1 else 's'}"


def _times(number: int) -> str:
    return "once" if number == 1 else f"{number} times"
