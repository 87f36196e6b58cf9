"""Scores for active search, based on success and the number of frames that the agent received."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SearchOutcome:
    """The outcome of a search: whether the target was found, and how many frames the agent received."""

    success: bool
    looks: int


def search_score(success: bool, looks: int, max_looks: int) -> float:
    """Return the score of one search, from 0 to 1.

    A success on the first frame scores 1, each further frame costs 1 / max_looks, and a failure scores 0. The mean over episodes is
    the area under the curve of success against the number of frames allowed, from 1 to ``max_looks``.
    """
    return (1 - (looks - 1) / max_looks) if success else 0.0


def success_within(outcomes: Iterable[SearchOutcome], budgets: Sequence[int]) -> list[float]:
    """Return, for each budget, the fraction of searches that succeeded with at most that many frames.

    Raises:
        ValueError: There are no outcomes.
    """
    searches = list(outcomes)
    if not searches:
        raise ValueError("no searches: run at least one episode")
    return [sum(s.success and s.looks <= budget for s in searches) / len(searches) for budget in budgets]
