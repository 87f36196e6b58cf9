"""Estimate the calls, duration and cost of an evaluation from its tasks and from earlier runs of the same models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.tools.registry import TOOLS

_PERCEPTION_TOOLS = frozenset(TOOLS.perceiving)
TYPICAL_CALLS = 2.0
"""Tool calls assumed for a task without a reference program."""
CHARS_PER_TOKEN = 4.0
"""Assumed characters per token of a prompt, if nothing was measured."""
STEP_TOKENS = 100
"""Assumed tokens of a call with its result in the history, if nothing was measured."""
REPLY_TOKENS = 40
"""Assumed tokens of a planner's reply, if nothing was measured."""


@dataclass(frozen=True, slots=True)
class Price:
    """US dollars per million input and output tokens of the planner."""

    input_usd: float
    output_usd: float

    def of(self, input_tokens: float, output_tokens: float) -> float:
        """Return the cost of tokens in US dollars."""
        return (input_tokens * self.input_usd + output_tokens * self.output_usd) / 1e6


@dataclass(frozen=True, slots=True)
class Estimate:
    """An estimate of calls, duration and cost. Unknown quantities are None.

    Attributes:
        runs: Number of runs.
        decisions: Planner calls of the reference programs.
        looks: Perception calls of the reference programs.
        seconds: Duration at the requested concurrency.
        input_tokens: Tokens that the planner reads.
        output_tokens: Tokens that the planner writes.
        cost_usd: Cost of these tokens.
        measured_on: Number of earlier runs on which the estimate is based.
        guessed: Whether tokens are guessed from the length of the prompt.
    """

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
    """Estimate calls from the reference programs, and duration and tokens from earlier runs, scaled by the number of calls.

    Args:
        entries: The entries to run.
        epochs: Number of runs of each entry.
        concurrency: Number of concurrent runs.
        earlier: Earlier evaluations of the same pair.
        price: Price of the planner's tokens.
        opening_chars: Characters of prompt and tool schemas, with which every request begins; None if tokens cannot be guessed.
    """
    calls = [_calls(entry) for entry in entries]
    runs, decisions = len(entries) * epochs, round(sum(calls) + len(calls)) * epochs
    looks = round(sum(_looks(entry) for entry in entries)) * epochs
    trials = [trial for evaluation in earlier for trial in evaluation.trials if trial.headline != "infrastructure"]
    if not trials:
        if opening_chars is None:
            return Estimate(runs, decisions, looks)
        read, written = _guess(calls, opening_chars)
        tokens = round(read * epochs), round(written * epochs)
        return Estimate(runs, decisions, looks, None, *tokens, price.of(*tokens) if price is not None else None, guessed=True)
    steps = sum(trial.steps for trial in trials) or 1
    scale = decisions / steps
    tokens_in, tokens_out = (round(scale * sum(getattr(t, n) for t in trials)) for n in ("input_tokens", "output_tokens"))
    # Concurrent runs slow each other down about in proportion to their number; the number of runs per second stays the same.
    measured_concurrency = fmean(evaluation.card.concurrency for evaluation in earlier)
    seconds = scale * sum(t.timings.total_s for t in trials) / min(measured_concurrency, concurrency)
    return Estimate(
        runs, decisions, looks, seconds, tokens_in, tokens_out,
        price.of(tokens_in, tokens_out) if price is not None else None, len(trials),
    )  # fmt: skip


def _guess(calls: Sequence[float], opening_chars: int) -> tuple[float, float]:
    """Guess input and output tokens of runs. Each step reads the prompt, the tools and all earlier steps."""
    steps = [count + 1 for count in calls]
    read = sum(s * opening_chars / CHARS_PER_TOKEN + STEP_TOKENS * s * (s - 1) / 2 for s in steps)
    return read, REPLY_TOKENS * sum(steps)


def _calls(entry: Entry) -> float:
    return float(len(entry.task.reference)) if entry.task is not None else TYPICAL_CALLS


def _looks(entry: Entry) -> float:
    if entry.task is None:
        return 1.0
    return float(sum(call.tool in _PERCEPTION_TOOLS for call in entry.task.reference))
