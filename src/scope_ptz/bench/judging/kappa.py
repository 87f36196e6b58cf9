"""Measure agreement between raters beyond chance: Cohen's kappa (1960) for two raters, Fleiss' kappa (1971) for more.

Point estimates are computed by statsmodels. Intervals are percentile intervals from a cluster bootstrap (Efron and Tibshirani 1993,
section 13.3), which resamples whole tasks, because ratings of runs of the same task are not independent.
kappa = (p_o - p_e) / (1 - p_e) is undefined if all ratings are the same (p_e = 1).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

CONFIDENCE_LEVEL = 0.95
"""Confidence level of the intervals."""
DRAWS = 2000
"""Number of bootstrap draws."""
_MIN_DEFINED_FRACTION = 0.5
"""Minimum fraction of draws in which kappa must be defined. Otherwise, no interval is reported."""

Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class KappaResult:
    """The measured agreement between raters.

    Attributes:
        runs: Number of rated runs.
        raters: Number of raters.
        raw: Fraction of runs on which two raters agree. For more raters, mean fraction of rater pairs that agree on a run.
        kappa: Kappa; None if undefined.
        low: Lower limit of the 95% confidence interval for kappa; None if unknown.
        high: Upper limit of the 95% confidence interval for kappa; None if unknown.
        confusion: For two raters, the number of runs with each combination of labels.
    """

    runs: int
    raters: int
    raw: float | None
    kappa: float | None
    low: float | None = None
    high: float | None = None
    confusion: tuple[tuple[str, str, int], ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON data."""
        confusion = [{"first": first, "second": second, "runs": number} for first, second, number in self.confusion]
        figures = {name: getattr(self, name) for name in ("runs", "raters", "raw", "kappa", "low", "high")}
        return {**figures, **({"confusion": confusion} if confusion else {})}


def cohen_agreement(first: Sequence[str], second: Sequence[str], clusters: Sequence[Hashable], seed: int = 1) -> KappaResult:
    """Measure the agreement between two raters with Cohen's kappa.

    Args:
        first: The first rater's label of each run.
        second: The second rater's label of each run.
        clusters: The cluster of each run.
        seed: Seed of the bootstrap.
    """
    if not first:
        return KappaResult(0, 2, None, None)
    labels = sorted({*first, *second})
    index = {label: number for number, label in enumerate(labels)}
    tables = _counts_by_cluster(
        clusters, [index[a] * len(labels) + index[b] for a, b in zip(first, second, strict=True)], len(labels) ** 2
    )
    table = tables.sum(axis=0).reshape(len(labels), len(labels))
    confusion = Counter(zip(first, second, strict=True))
    return KappaResult(
        runs=len(first),
        raters=2,
        raw=float(np.trace(table) / table.sum()),
        kappa=_statsmodels_cohen(table) if len(labels) > 1 else None,
        **_interval(tables, lambda sums: cohen_values(sums.reshape(-1, len(labels), len(labels))), seed),
        confusion=tuple((a, b, number) for (a, b), number in sorted(confusion.items())),
    )


def fleiss_agreement(ratings: Sequence[Sequence[str]], clusters: Sequence[Hashable], seed: int = 1) -> KappaResult:
    """Measure the agreement between several raters with Fleiss' kappa.

    Args:
        ratings: The labels of each run. Every run must have the same number of labels.
        clusters: The cluster of each run.
        seed: Seed of the bootstrap.

    Raises:
        ValueError: The runs have different numbers of labels, or fewer than two labels each.
    """
    if not ratings:
        return KappaResult(0, 0, None, None)
    raters = len(ratings[0])
    labels = sorted({label for row in ratings for label in row})
    counts = np.array([[row.count(label) for label in labels] for row in map(list, ratings)], dtype=float)
    if raters < 2 or not (counts.sum(axis=1) == raters).all():
        raise ValueError("every run must have the same number of labels, and at least two")
    pairs = (counts * (counts - 1)).sum(axis=1) / (raters * (raters - 1))
    rows = np.column_stack([counts, pairs, np.ones(len(ratings))])
    names = list(dict.fromkeys(clusters))
    sums = np.zeros((len(names), rows.shape[1]))
    np.add.at(sums, [names.index(cluster) for cluster in clusters], rows)
    return KappaResult(
        runs=len(ratings),
        raters=raters,
        raw=float(pairs.mean()),
        kappa=_statsmodels_fleiss(counts) if len(labels) > 1 else None,
        **_interval(sums, fleiss_values, seed),
    )


def cohen_values(tables: Numbers) -> Numbers:
    """Return Cohen's kappa for each contingency table in an array of shape ``(n, k, k)``; NaN if undefined."""
    total = tables.sum(axis=(1, 2))
    with np.errstate(invalid="ignore", divide="ignore"):
        observed = np.trace(tables, axis1=1, axis2=2) / total
        by_chance = (tables.sum(axis=2) * tables.sum(axis=1)).sum(axis=1) / total**2
        return _kappa(observed, by_chance)


def fleiss_values(sums: Numbers) -> Numbers:
    """Return Fleiss' kappa for each row of sums.

    Args:
        sums: Array of shape ``(n, k + 2)``. Its columns are the counts of the k labels, the fraction of agreeing pairs, and the
            number of runs, each summed over runs.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = sums[:, :-2] / sums[:, :-2].sum(axis=1, keepdims=True)
        return _kappa(sums[:, -2] / sums[:, -1], (shares**2).sum(axis=1))


def _kappa(observed: Numbers, by_chance: Numbers) -> Numbers:
    above_chance = 1 - by_chance
    return np.where(above_chance > 1e-12, (observed - by_chance) / np.where(above_chance > 1e-12, above_chance, 1.0), np.nan)


def _counts_by_cluster(clusters: Sequence[Hashable], cells: Sequence[int], size: int) -> Numbers:
    """Count how often each cell occurs in each cluster, as an array of shape ``(clusters, size)``."""
    indices: dict[Hashable, int] = {}
    rows = [indices.setdefault(cluster, len(indices)) for cluster in clusters]
    counts = np.zeros((len(indices), size))
    np.add.at(counts, (rows, list(cells)), 1.0)
    return counts


def _interval(sums_by_cluster: Numbers, statistic: Callable[[Numbers], Numbers], seed: int) -> dict[str, Any]:
    """Return the percentile interval of a statistic from a cluster bootstrap. Its limits are None if it cannot be computed.

    Args:
        sums_by_cluster: The sums of each cluster, of shape ``(clusters, k)``.
        statistic: Function that computes the statistic for each row of sums over clusters.
        seed: Seed for the draws.
    """
    clusters = len(sums_by_cluster)
    if clusters < 2:
        return {"low": None, "high": None}
    draws = np.random.default_rng(seed).multinomial(clusters, np.full(clusters, 1 / clusters), size=DRAWS)
    values = statistic(draws @ sums_by_cluster)
    values = values[~np.isnan(values)]
    if len(values) < DRAWS * _MIN_DEFINED_FRACTION:
        return {"low": None, "high": None}
    tail = (1 - CONFIDENCE_LEVEL) / 2
    low, high = np.quantile(values, (tail, 1 - tail))
    return {"low": float(low), "high": float(high)}


def _statsmodels_cohen(table: Numbers) -> float:
    from statsmodels.stats.inter_rater import cohens_kappa  # type: ignore[import-untyped]

    return float(cohens_kappa(table, return_results=False))


def _statsmodels_fleiss(counts: Numbers) -> float:
    from statsmodels.stats.inter_rater import fleiss_kappa

    return float(fleiss_kappa(counts))
