"""Format an estimate as lines of text. Unmeasured quantities are reported as unknown."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.agents.channel import ISOLATION_NOTES, Isolation
from scope_ptz.bench.engine.estimate import Estimate


def estimate_lines(
    estimate: Estimate,
    *,
    planner: str,
    perception: str,
    concurrency: int,
    agent: str | None = None,
    isolation: Isolation | None = None,
    planner_is_free: bool,
) -> Iterator[str]:
    """Yield lines with the estimated runs, calls, duration and cost.

    Args:
        estimate: The estimate.
        planner: Name of the planner.
        perception: Name of the perception backend.
        concurrency: Number of concurrent runs.
        agent: Name of the external agent that replaces the planner, if any.
        isolation: How the external agent is separated from tasks, ground truth and checks.
        planner_is_free: Whether the planner uses no paid server.
    """
    runs, subject = f"{estimate.runs} run{'s' if estimate.runs != 1 else ''}", "this agent" if agent else "this pair"
    yield f"{runs} of {agent or planner} + {perception}, {concurrency} at a time"
    if isolation is not None:
        yield f"agent   {isolation}: {ISOLATION_NOTES[isolation]}"
    perception_calls = f"{estimate.perception_calls} to perception, from the reference programs"
    if agent:
        yield f"calls   about {perception_calls}; the agent's own model calls are unknown"
    else:
        yield f"calls   about {estimate.planner_calls} to the planner and {perception_calls}"
    if estimate.seconds is None:
        yield f"time    unknown: no log of {subject} in this folder; the table shows the remaining time after the first runs"
    else:
        measured = f"{estimate.measured_on} earlier run{'s' if estimate.measured_on != 1 else ''}"
        yield f"time    about {duration_text(estimate.seconds)}, measured on {measured} of {subject}"
    if agent:
        yield "cost    unknown: the agent's own model calls are not measured"
    elif planner_is_free:
        yield "cost    none for the planner, which uses no paid server"
    elif estimate.input_tokens is None or estimate.output_tokens is None:
        yield "cost    unknown: run this pair once with --limit 10 to measure its tokens, and give prices with --price IN,OUT"
    else:
        note = " (guessed from the length of the prompt)" if estimate.guessed else ""
        tokens = f"about {tokens_text(estimate.input_tokens)} input and {tokens_text(estimate.output_tokens)} output tokens"
        price = (
            f", {estimate.cost_usd:.2f} US dollars"
            if estimate.cost_usd is not None
            else "; give prices with --price IN,OUT (dollars per million)"
        )
        yield f"cost    {tokens} for the planner{note}{price}; the cost of perception is unknown"


def tokens_text(tokens: int) -> str:
    """Format a number of tokens, as in "340", "12 thousand" and "3.4 million"."""
    if tokens < 1000:
        return str(tokens)
    return f"{tokens / 1e3:.0f} thousand" if tokens < 999_500 else f"{tokens / 1e6:.1f} million"


def duration_text(seconds: float) -> str:
    """Format a duration, as in "40 s", "12 min" and "3 h 05 min"."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"
