"""Estimate the calls, duration and cost of an evaluation from its tasks and earlier runs of the same models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.tools.registry import TOOLS

_PERCEPTION_TOOLS = frozenset(TOOLS.perceiving)
TYPICAL_CALLS = 2.0
"""Assumed number of tool calls for a task without a reference program."""
CHARS_PER_TOKEN = 4.0
"""Assumed number of prompt characters per token, if there are no measurements."""
STEP_TOKENS = 100
"""Assumed number of tokens for a call and its result in the history, if there are no measurements."""
REPLY_TOKENS = 40
"""Assumed number of tokens in a planner's reply, if there are no measurements."""


@dataclass(frozen=True, slots=True)
class Price:
    """The price of the planner's tokens, in US dollars per million input tokens and per million output tokens."""

    input_usd: float
    output_usd: float

    def cost_usd(self, input_tokens: float, output_tokens: float) -> float:
        """Return the cost of input and output tokens in US dollars."""
        return (input_tokens * self.input_usd + output_tokens * self.output_usd) / 1e6


@dataclass(frozen=True, slots=True)
class Estimate:
    """An estimate of calls, duration and cost. Unknown quantities are None.

    Attributes:
        runs: Number of runs.
        planner_calls: Number of planner calls, derived from the reference programs.
        perception_calls: Number of perception calls, derived from the reference programs.
        seconds: Duration at the requested concurrency, in seconds.
        input_tokens: Input tokens of the planner.
        output_tokens: Output tokens of the planner.
        cost_usd: Cost of these tokens in US dollars.
        measured_on: Number of earlier runs on which the estimate is based; 0 for none.
        guessed: Whether the token counts are guessed from the prompt length because there are no earlier runs.
    """

    runs: int
    planner_calls: int
    perception_calls: int
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
    prompt_chars: int | None = None,
) -> Estimate:
    """Estimate the calls, duration, tokens and cost of an evaluation.

    Calls are estimated from the reference programs. Duration and tokens are scaled from earlier runs by planner calls.

    Args:
        entries: The entries to run.
        epochs: Number of runs of each entry.
        concurrency: Number of concurrent runs.
        earlier: Earlier evaluations of the same pair.
        price: Price of the planner's tokens.
        prompt_chars: Total length of the system prompt and the tool schemas in characters; None if unknown.
    """
    calls = [_tool_calls(entry) for entry in entries]
    runs, planner_calls = len(entries) * epochs, round(sum(calls) + len(calls)) * epochs
    perception_calls = round(sum(_perception_calls(entry) for entry in entries)) * epochs
    trials = [trial for evaluation in earlier for trial in evaluation.trials if trial.headline != "infrastructure"]
    if not trials:
        if prompt_chars is None:
            return Estimate(runs, planner_calls, perception_calls)
        tokens_in, tokens_out = (round(count * epochs) for count in _guess_tokens(calls, prompt_chars))
        cost_usd = price.cost_usd(tokens_in, tokens_out) if price is not None else None
        return Estimate(runs, planner_calls, perception_calls, None, tokens_in, tokens_out, cost_usd, guessed=True)
    steps = sum(trial.steps for trial in trials) or 1
    scale = planner_calls / steps
    tokens_in, tokens_out = (round(scale * sum(getattr(t, n) for t in trials)) for n in ("input_tokens", "output_tokens"))
    # Concurrent runs slow each other down roughly in proportion to their number, so throughput stays the same.
    measured_concurrency = fmean(evaluation.card.concurrency for evaluation in earlier)
    seconds = scale * sum(t.timings.total_s for t in trials) / min(measured_concurrency, concurrency)
    return Estimate(
        runs, planner_calls, perception_calls, seconds, tokens_in, tokens_out,
        price.cost_usd(tokens_in, tokens_out) if price is not None else None, len(trials),
    )  # fmt: skip


def _guess_tokens(calls: Sequence[float], prompt_chars: int) -> tuple[float, float]:
    """Guess the number of input and output tokens. The input of each step contains the prompt, the tools and all earlier steps."""
    steps = [count + 1 for count in calls]
    input_tokens = sum(s * prompt_chars / CHARS_PER_TOKEN + STEP_TOKENS * s * (s - 1) / 2 for s in steps)
    return input_tokens, REPLY_TOKENS * sum(steps)


def _tool_calls(entry: Entry) -> float:
    return float(len(entry.task.reference)) if entry.task is not None else TYPICAL_CALLS


def _perception_calls(entry: Entry) -> float:
    if entry.task is None:
        return 1.0
    return float(sum(call.tool in _PERCEPTION_TOOLS for call in entry.task.reference))
