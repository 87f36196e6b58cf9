"""What an evaluation will take, before it begins: from the tasks, and from earlier runs of the same models where there are any."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.tools.registry import TOOLS

_LOOKERS = frozenset(TOOLS.perceiving)
TYPICAL_CALLS = 2.0
"""Of a task that has no reference program."""
CHARS_A_TOKEN, STEP_TOKENS, SAID_TOKENS = 4.0, 100, 40
"""For a guess where nothing was measured: English text and JSON; a call with its result in the history; what a planner says."""


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
    is None: ``seconds`` (with the concurrency asked for), tokens, ``cost_usd``. ``guessed``: tokens are, by the length of the
    prompt."""

    runs: int
    decisions: int
    looks: int
    seconds: float | None = None
    input_tokens: int | None = None
    output_tokens: int | None = None
    cost_usd: float | None = None
    measured_on: int = 0
    guessed: bool = False


def estimate(
    entries: Sequence[Entry],
    epochs: int,
    concurrency: int,
    earlier: Sequence[Evaluation],
    price: Price | None = None,
    opening_chars: int | None = None,
) -> Estimate:
    """Calls by the reference programs; time and tokens by runs of the same pair, scaled by how many calls tasks need.

    ``opening_chars``: what each request to the planner begins with, prompt and tools; None where tokens cannot be guessed from it.
    """
    calls = [_calls(entry) for entry in entries]
    runs, decisions = len(entries) * epochs, round(sum(calls) + len(calls)) * epochs
    looks = round(sum(_looks(entry) for entry in entries)) * epochs
    trials = [trial for evaluation in earlier for trial in evaluation.trials if trial.headline != "infrastructure"]
    if not trials:
        if opening_chars is None:
            return Estimate(runs, decisions, looks)
        read, said = _guess(calls, opening_chars)
        tokens = round(read * epochs), round(said * epochs)
        return Estimate(runs, decisions, looks, None, *tokens, price.of(*tokens) if price is not None else None, guessed=True)
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


def _guess(calls: Sequence[float], opening_chars: int) -> tuple[float, float]:
    """Tokens in and out of runs of so many calls: each step reads the prompt, the tools and all steps before it."""
    steps = [count + 1 for count in calls]
    read = sum(s * opening_chars / CHARS_A_TOKEN + STEP_TOKENS * s * (s - 1) / 2 for s in steps)
    return read, SAID_TOKENS * sum(steps)


def _calls(entry: Entry) -> float:
    return float(len(entry.task.reference)) if entry.task is not None else TYPICAL_CALLS


def _looks(entry: Entry) -> float:
    if entry.task is None:
        return 1.0
    return float(sum(call.tool in _LOOKERS for call in entry.task.reference))
