"""Statistics for comparing two runs on the same tasks: an exact test, a bootstrap, and an adjustment for multiple tests."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from math import comb

import numpy as np

from scope_ptz.bench.statistics.clustered import Scores

DRAWS = 10_000
"""Default number of bootstrap draws."""


def mcnemar_exact(first_wins: int, second_wins: int) -> float:
    """Return the two-sided exact p value of McNemar's test (1947).

    The p value is min(1, 2 P(X <= min(b, c))) with X binomial(b + c, 1/2). If tasks were repeated, this is the sign test of the
    tasks' mean differences.

    Args:
        first_wins: Number of tasks on which only the first run is correct.
        second_wins: Number of tasks on which only the second run is correct.
    """
    discordant = first_wins + second_wins
    tail = sum(comb(discordant, k) for k in range(min(first_wins, second_wins) + 1))
    return min(1.0, float(2 * tail / 2**discordant))


def holm(p_values: Sequence[float | None]) -> list[float | None]:
    """Adjust p values with Holm's step-down method (1979). None remains None and does not count as a test."""
    tests = sorted((p, index) for index, p in enumerate(p_values) if p is not None)
    adjusted: list[float | None] = [None] * len(p_values)
    highest = 0.0
    for rank, (p, index) in enumerate(tests):
        highest = max(highest, min(1.0, (len(tests) - rank) * p))
        adjusted[index] = highest
    return adjusted


def cluster_bootstrap(scores: Scores, *, seed: int = 0, draws: int = DRAWS) -> tuple[float, float] | None:
    """Return the 95% percentile interval for the macro mean of paired differences from a cluster bootstrap (Field and Welsh 2007).

    Args:
        scores: One difference per task.
        seed: Seed for the draws.
        draws: Number of draws. Whole clusters are drawn with replacement. A draw's mean excludes strata without outcomes.

    Returns:
        The lower and upper limit, or None with fewer than two clusters.
    """
    clusters, strata = _codes(scores.clusters), _codes(scores.strata)
    size = (max(clusters) + 1, max(strata) + 1) if clusters else (0, 0)
    if size[0] < 2:
        return None
    sums, counts = np.zeros(size), np.zeros(size)
    np.add.at(sums, (clusters, strata), scores.values)
    np.add.at(counts, (clusters, strata), 1.0)
    times = np.random.default_rng(seed).multinomial(size[0], np.full(size[0], 1 / size[0]), size=draws)
    resampled = times @ counts
    means = np.divide(times @ sums, resampled, out=np.full(resampled.shape, np.nan), where=resampled > 0)
    low, high = np.quantile(np.nanmean(means, axis=1), (0.025, 0.975))
    return float(low), float(high)


def _codes(labels: Sequence[Hashable]) -> list[int]:
    indices: dict[Hashable, int] = {}
    return [indices.setdefault(label, len(indices)) for label in labels]
