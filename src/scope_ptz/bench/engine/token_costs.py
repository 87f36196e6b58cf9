"""Compute the cost of a run's tokens from the prices on the run card."""

from __future__ import annotations

from scope_ptz.bench.scoring.trials import RunCard

PRICE_KEY = "price_usd_per_million_tokens"
"""Key for the prices of the planner's input and output tokens in a card's ``sampling``."""


def cost_usd(card: RunCard, input_tokens: int, output_tokens: int) -> float | None:
    """Return the cost of a run's planner tokens in US dollars; None if the card contains no prices."""
    price = card.sampling.get(PRICE_KEY)
    return (input_tokens * price["input"] + output_tokens * price["output"]) / 1e6 if price else None
