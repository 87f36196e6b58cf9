"""Summarise a planner's speed and its rate of valid calls in trials with individual instructions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import median

from pydantic import BaseModel, ConfigDict

from scope_ptz.planner.profile.first_calls import PlannerTrial
from scope_ptz.planner.profile.prompt_sensitivity import Rate


class Spread(BaseModel):
    """The median and the 95th percentile of a list of values."""

    model_config = ConfigDict(frozen=True)

    median: float
    p95: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread | None:
        """Return the spread of values; None if there are no values."""
        if not values:
            return None
        ordered = sorted(values)
        return cls(median=round(median(ordered), 4), p95=round(ordered[min(len(ordered) - 1, int(0.95 * len(ordered)))], 4))


class Speed(BaseModel):
    """A planner's speed, in seconds and tokens per second.

    Attributes:
        valid: Rate of turns with only valid calls, out of the turns with calls.
        right: Rate of turns whose first call was the expected one.
        inverted: Rate of turns with an inverted move, out of the turns whose instruction requests a move.
        failures: Number of failed turns by failure kind. Failed turns are excluded from all rates and times.
        first_failure: The error message from the first failure, which may have occurred in the warm-up.
    """

    model_config = ConfigDict(frozen=True)

    turns: int
    turn_s: Spread | None
    first_token_s: Spread | None
    tokens_per_s: Spread | None
    valid: Rate
    right: Rate
    inverted: Rate
    failures: dict[str, int]
    first_failure: str = ""


def speed_of(trials: Sequence[PlannerTrial], warm_up: PlannerTrial | None = None) -> Speed:
    """Return a planner's speed. ``warm_up`` is an earlier trial, from which only the error message is used."""
    succeeded = [t for t in trials if t.failure is None]
    called = [t for t in succeeded if t.calls or t.invalid]
    return Speed(
        turns=len(trials),
        turn_s=Spread.of([t.seconds for t in succeeded]),
        first_token_s=Spread.of([t.first_token_s for t in succeeded if t.first_token_s is not None]),
        tokens_per_s=Spread.of([rate for t in succeeded if (rate := _tokens_per_s(t)) is not None]),
        valid=Rate.over(not t.invalid for t in called),
        right=Rate.over(t.right for t in succeeded),
        inverted=Rate.over(t.inverted for t in succeeded if any(c.name == "adjust_ptz" for c in t.row.calls)),
        failures=dict(Counter(t.failure for t in trials if t.failure is not None)),
        first_failure=next((t.text for t in (warm_up, *trials) if t is not None and t.failure is not None), ""),
    )


def _tokens_per_s(trial: PlannerTrial) -> float | None:
    """Return the tokens per second after the first token; None for replies that were not streamed or are too short."""
    if trial.first_token_s is None or trial.usage.output_tokens < 2:
        return None
    generation_s = trial.seconds - trial.first_token_s
    return (trial.usage.output_tokens - 1) / generation_s if generation_s > 0 else None
