"""What an evaluation will take, before it begins: from the tasks, and from earlier runs of the same models where there are any."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.trials import Evaluation

_LOOKERS = frozenset({"count_objects", "query_answer", "zoom_to_object", "track_object"})
TYPICAL_CALLS = 2.0
"""Of a task that has no reference program."""


@dataclass(frozen=True, slots=True)
class Price:
    """US dollars for a million tokens of the planner, in and out."""

    input_usd: float
    output_usd: float

    def of(self, input_tokens: float, output_tokens: float) -> float:
        return (input_tokens * self.input_usd + output_tokens * self.output_usd) / 1e6


@dataclass(frozen=True, slots=True)
class Estimate:
    """``decisions`` and ``looks``: calls of planner and eyes in all, as the reference programs need them. What nobody has measured
    is None: ``seconds`` (with the concurrency asked for), tokens, ``cost_usd``."""

    runs: int
    decisions: int
    looks: int
    seconds: float | None = None
    input_tokens: int | None = None
    output_tokens: int | None = None
    cost_usd: float | None = None
    measured_on: int = 0


def estimate(
    entries: Sequence[Entry], epochs: int, concurrency: int, earlier: Sequence[Evaluation], price: Price | None = None
) -> Estimate:
    """Calls by the reference programs; time and tokens by runs of the same pair, scaled by how many calls tasks need."""
    calls = [_calls(entry) for entry in entries]
    runs, decisions = len(entries) * epochs, round(sum(calls) + len(calls)) * epochs
    looks = round(sum(_looks(entry) for entry in entries)) * epochs
    trials = [trial for evaluation in earlier for trial in evaluation.trials if trial.headline != "infrastructure"]
    if not trials:
        return Estimate(runs, decisions, looks)
    steps = sum(trial.steps for trial in trials) or 1
    each = decisions / steps
    tokens_in, tokens_out = (round(each * sum(getattr(t, n) for t in trials)) for n in ("input_tokens", "output_tokens"))
    # A run among others takes longer than alone, by about as much as there are others: what counts is how many end in a second.
    busy = fmean(evaluation.card.concurrency for evaluation in earlier)
    seconds = each * sum(t.timings.total_s for t in trials) / (busy if busy < concurrency else concurrency)
    return Estimate(
        runs, decisions, looks, seconds, tokens_in, tokens_out,
        price.of(tokens_in, tokens_out) if price is not None else None, len(trials),
    )  # fmt: skip


def _calls(entry: Entry) -> float:
    return float(len(entry.task.reference)) if entry.task is not None else TYPICAL_CALLS


def _looks(entry: Entry) -> float:
    if entry.task is None:
        return 1.0
    return float(sum(call.tool in _LOOKERS for call in entry.task.reference))
