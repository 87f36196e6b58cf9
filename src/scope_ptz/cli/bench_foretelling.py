"""The estimate before an evaluation, in words. What nobody knows is said to be unknown."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.engine.estimate import Estimate
from scope_ptz.cli.bench_live import clock
from scope_ptz.factory.models import ResolvedPair


def lines(told: Estimate, choice: ResolvedPair, concurrency: int, agent: str | None = None) -> Iterator[str]:
    """Runs, calls, time and cost, one a line. ``agent``: the name of another one, which plans in place of the planner."""
    runs, who = f"{told.runs} run{'s' if told.runs != 1 else ''}", "this agent" if agent else "this pair"
    yield f"{runs} of {agent or choice.planner.name} + {choice.perception.name}, {concurrency} at a time"
    if agent:
        yield f"calls   about {told.looks} of the eyes, as the reference programs need them; the agent plans by means of its own"
    else:
        yield f"calls   about {told.decisions} of the planner and {told.looks} of the eyes, as the reference programs need them"
    if told.seconds is None:
        yield f"time    unknown: {who} has no log here yet; the table tells how long is left after the first runs"
    else:
        measured = f"{told.measured_on} earlier run{'s' if told.measured_on != 1 else ''}"
        yield f"time    about {clock(told.seconds)}, by {measured} of {who}"
    if agent:
        yield "cost    unknown: what the agent asks of models of its own is not known here"
    elif choice.planner.endpoint is None:
        yield "cost    nothing is asked of a paid server for planning"
    elif told.input_tokens is None or told.output_tokens is None:
        yield "cost    unknown: tokens are known after a first run of this pair (--limit 10), prices by --price IN,OUT"
    else:
        how = " (guessed from the length of the prompt)" if told.guessed else ""
        tokens = f"about {amount(told.input_tokens)} tokens in and {amount(told.output_tokens)} out for the planner{how}"
        price = (
            f", {told.cost_usd:.2f} US dollars"
            if told.cost_usd is not None
            else "; give prices by --price IN,OUT (dollars per million)"
        )
        yield f"cost    {tokens}{price}; what the eyes cost is not known"


def amount(tokens: int) -> str:
    """A number of tokens as people say it: 340, 12 thousand, 3.4 million."""
    if tokens < 1000:
        return str(tokens)
    return f"{tokens / 1e3:.0f} thousand" if tokens < 999_500 else f"{tokens / 1e6:.1f} million"
