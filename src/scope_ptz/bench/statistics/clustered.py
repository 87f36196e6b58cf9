"""Estimate means over strata with cluster-robust intervals, because outcomes of tasks at the same viewpoint are correlated.

An estimate is a weighted sum of stratum means, theta = sum_k w_k mean_k. It is a macro average if every w_k is 1/K, a micro
average if there is a single stratum, and a contrast if the weights are +1 and -1. Its variance is that of the linearised estimate,
summed by cluster (Liang and Zeger 1986), times G/(G-1). The quantiles are those of Student's t distribution with G-1 degrees of
freedom (Cameron and Miller 2015, sections II.A and VI.D).

Repeats of a task count as one observation, called a ``unit``.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import fsum, hypot, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr, stdtrit

CONFIDENCE_LEVEL = 0.95
"""Confidence level for intervals and tests."""
_MAX_ROUNDING_VARIANCE = 1e-24
"""Variances up to this value are treated as rounding errors."""
Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scores:
    """Outcomes with their strata, clusters and units. All fields have length n.

    Attributes:
        values: The outcomes, of shape ``(n,)``.
        strata: The stratum of each outcome.
        clusters: The cluster of each outcome.
        units: The unit of each outcome; None if there are no repeats, so that each outcome is a unit. A unit belongs to one stratum
            and one cluster.
    """

    values: Numbers
    strata: tuple[Hashable, ...]
    clusters: tuple[Hashable, ...]
    units: tuple[Hashable, ...] | None = None

    def __post_init__(self) -> None:
        if not len(self.values) == len(self.strata) == len(self.clusters) == len(self.unit_of_each):
            raise ValueError("values, strata, clusters and units must have the same length")

    @property
    def unit_of_each(self) -> tuple[Hashable, ...]:
        """The unit of each outcome."""
        return tuple(range(len(self.values))) if self.units is None else self.units


@dataclass(frozen=True, slots=True)
class IntervalEstimate:
    """An estimate with its 95% confidence interval.

    Attributes:
        value: The estimate.
        low: Lower limit of the interval; None if unknown.
        high: Upper limit of the interval; None if unknown.
        se: Standard error; None if unknown.
        n: Number of units (tasks).
        clusters: Number of clusters.
        single_cluster_strata: Strata with only one cluster. They contribute to the value, but their variation between clusters is
            unknown, so the interval is too narrow. If every stratum has only one cluster, there is no interval.
    """

    value: float
    low: float | None
    high: float | None
    se: float | None
    n: int
    clusters: int
    single_cluster_strata: tuple[str, ...] = ()


def macro_weights(scores: Scores) -> dict[Hashable, float]:
    """Return equal weights for all strata that have outcomes."""
    present = set(scores.strata)
    return {stratum: 1.0 / len(present) for stratum in present}


def pool_strata(scores: Scores) -> Scores:
    """Combine all outcomes into a single stratum."""
    return Scores(scores.values, ("all",) * len(scores.values), scores.clusters, scores.units)


def weighted_mean(scores: Scores, weights: Mapping[Any, float]) -> float:
    """Return the weighted sum of the stratum means.

    Raises:
        ValueError: A weighted stratum has no outcome.
    """
    values: dict[Hashable, list[float]] = {}
    for stratum, value in zip(scores.strata, scores.values.tolist(), strict=True):
        values.setdefault(stratum, []).append(value)
    _check_strata(values, weights)
    # fsum makes the mean independent of the order of the outcomes.
    return fsum(weight * (fsum(values[stratum]) / len(values[stratum])) for stratum, weight in weights.items())


def cluster_variance(scores: Scores, weights: Mapping[Any, float]) -> float | None:
    """Return the cluster-robust variance of ``weighted_mean``; None with fewer than two clusters.

    The variance is G/(G-1) sum_g u_g^2, where u_g is the sum of w_k/n_k (x - mean_k) over the outcomes of cluster g. With one
    stratum it equals the CR1 variance of a regression on a constant.
    """
    labels, index = _factorise(scores.clusters)
    if len(labels) < 2:
        return None
    residuals, weight = _residuals(scores, weights)
    sums = np.bincount(index, weights=residuals * weight, minlength=len(labels))
    return float(len(labels) / (len(labels) - 1) * np.sum(sums**2))


def independent_variance(scores: Scores, weights: Mapping[Any, float]) -> float | None:
    """Return the variance under the assumption that all units are independent; None with fewer than two units.

    Repeats of a task form one unit, because they are not independent: a deterministic model always gives the same result.
    """
    return cluster_variance(Scores(scores.values, scores.strata, scores.unit_of_each), weights)


def strata_with_one_cluster(scores: Scores, weights: Mapping[Any, float]) -> tuple[Hashable, ...]:
    """Return the strata with only one cluster. They add no variance, because their residuals always sum to 0."""
    clusters_by_stratum: dict[Hashable, set[Hashable]] = {}
    for stratum, cluster in zip(scores.strata, scores.clusters, strict=True):
        clusters_by_stratum.setdefault(stratum, set()).add(cluster)
    return tuple(stratum for stratum, clusters in clusters_by_stratum.items() if weights.get(stratum) and len(clusters) < 2)


def standard_error(scores: Scores, weights: Mapping[Any, float]) -> float | None:
    """Return the standard error: the square root of the clustered or the independent variance, whichever is larger.

    Using the larger variance prevents chance agreement between a few clusters from shrinking the interval.

    Returns:
        The standard error, or None if every stratum has only one cluster, so that the variation between clusters is unknown.
    """
    clustered, independent = cluster_variance(scores, weights), independent_variance(scores, weights)
    if (
        clustered is None
        or independent is None
        or len(strata_with_one_cluster(scores, weights)) == np.count_nonzero([*weights.values()])
    ):
        return None
    variance = max(clustered, independent)
    return sqrt(variance) if variance > _MAX_ROUNDING_VARIANCE else 0.0


def proportion(scores: Scores, weights: Mapping[Any, float] | None = None) -> IntervalEstimate | None:
    """Estimate a proportion in [0, 1] with a Wilson interval at the effective sample size p(1-p)/se^2 (Dean and Pagano 2015).

    If the variance is 0, the effective sample size is the number of units.

    Args:
        scores: The outcomes.
        weights: Weights of the strata, which are normalised to a sum of 1; None to pool all outcomes.

    Returns:
        The estimate, or None if there are no outcomes.
    """
    if not len(scores.values):
        return None
    scores, weights = (pool_strata(scores), {"all": 1.0}) if weights is None else (scores, weights)
    se, clusters, units = standard_error(scores, weights), len(set(scores.clusters)), len(set(scores.unit_of_each))
    value = min(1.0, max(0.0, weighted_mean(scores, weights) / fsum(weights.values())))
    low = high = None
    if se is not None:
        size = value * (1 - value) / se**2 if se > 0 else float(units)
        low, high = wilson(value, size, t_quantile(clusters))
    return IntervalEstimate(value, low, high, se, units, clusters, _single_cluster_strata(scores, weights))


def difference(scores: Scores, weights: Mapping[Any, float] | None = None) -> IntervalEstimate | None:
    """Estimate a mean difference or a contrast of proportions, with the interval value +- t se, limited to [-1, 1].

    If all outcomes are equal, there is no interval, because a variance of 0 does not mean that the difference is exact.

    Args:
        scores: The differences, or the outcomes of a contrast.
        weights: Weights of the strata; None to pool all outcomes.

    Returns:
        The estimate, or None if there are no outcomes.
    """
    if not len(scores.values):
        return None
    scores, weights = (pool_strata(scores), {"all": 1.0}) if weights is None else (scores, weights)
    value, se, clusters = weighted_mean(scores, weights), standard_error(scores, weights), len(set(scores.clusters))
    half = se * t_quantile(clusters) if se else None
    low, high = (None, None) if half is None else (max(-1.0, value - half), min(1.0, value + half))
    return IntervalEstimate(value, low, high, se, len(set(scores.unit_of_each)), clusters, _single_cluster_strata(scores, weights))


def proportion_difference(first: Scores, second: Scores) -> IntervalEstimate | None:
    """Estimate the difference between the proportions of two different sets of outcomes (``first`` minus ``second``).

    The interval combines the intervals of the two proportions as if they were independent (Newcombe 1998, method 10; Zou and
    Donner 2008). Unlike value +- t se, it has a non-zero width even if all outcomes in one set are equal. If either proportion has
    no interval, the difference has none.

    Returns:
        The estimate, or None if one of the sets is empty.
    """
    first_estimate, second_estimate = proportion(first), proportion(second)
    if first_estimate is None or second_estimate is None:
        return None
    both = Scores(
        np.concatenate([first.values, second.values]),
        (1,) * len(first.values) + (2,) * len(second.values),
        (*first.clusters, *second.clusters),
        (*((1, unit) for unit in first.unit_of_each), *((2, unit) for unit in second.unit_of_each)),
    )
    contrast = difference(both, {1: 1.0, 2: -1.0})
    if contrast is None:
        return None
    low, high = newcombe(
        (first_estimate.value, first_estimate.low, first_estimate.high),
        (second_estimate.value, second_estimate.low, second_estimate.high),
    )
    return replace(contrast, low=low, high=high, single_cluster_strata=())


Bounded = tuple[float, float | None, float | None]
"""A value with the lower and upper limit of its interval."""


def newcombe(first: Bounded, second: Bounded) -> tuple[float, float] | tuple[None, None]:
    """Return Newcombe's interval for the difference between two independent proportions, which combines their intervals.

    Returns:
        The lower and upper limit, or (None, None) if either interval is unknown.
    """
    (p, p_low, p_high), (q, q_low, q_high) = first, second
    if p_low is None or p_high is None or q_low is None or q_high is None:
        return None, None
    return p - q - hypot(p - p_low, q_high - q), p - q + hypot(p_high - p, q - q_low)


def _single_cluster_strata(scores: Scores, weights: Mapping[Any, float]) -> tuple[str, ...]:
    return tuple(map(str, strata_with_one_cluster(scores, weights)))


def wilson(value: float, size: float, quantile: float) -> tuple[float, float]:
    """Return the Wilson interval (1927) for a proportion, limited to [0, 1]. The sample size need not be an integer."""
    square = quantile**2 / size
    centre = (value + square / 2) / (1 + square)
    half = quantile / (1 + square) * sqrt(max(0.0, value * (1 - value)) / size + square / (4 * size))
    return max(0.0, centre - half), min(1.0, centre + half)


def t_quantile(clusters: int, level: float = CONFIDENCE_LEVEL) -> float:
    """Return the two-sided quantile of Student's t distribution with ``clusters - 1`` degrees of freedom."""
    return float(stdtrit(clusters - 1, 0.5 + level / 2))


def two_sided_p(estimate: IntervalEstimate) -> float | None:
    """Return the two-sided p value for the hypothesis that a difference is 0; None without a standard error."""
    if estimate.se is None:
        return None
    if estimate.se == 0:
        return 1.0 if estimate.value == 0 else 0.0
    return float(2 * stdtr(estimate.clusters - 1, -abs(estimate.value) / estimate.se))


def detectable_difference(se: float, clusters: int, power: float = 0.8, level: float = CONFIDENCE_LEVEL) -> float:
    """Return the smallest true difference that a two-sided test detects with the given power.

    The difference is (t_(1-a/2) + t_power) se (Bloom 1995).
    """
    return se * float(stdtrit(clusters - 1, 0.5 + level / 2) + stdtrit(clusters - 1, power))


def _factorise(labels: Sequence[Hashable]) -> tuple[list[Hashable], NDArray[np.intp]]:
    """Return the distinct labels, and the index of each given label among them."""
    indices: dict[Hashable, int] = {}
    codes = np.array([indices.setdefault(label, len(indices)) for label in labels], dtype=np.intp)
    return list(indices), codes


def _strata_codes(scores: Scores, weights: Mapping[Any, float]) -> tuple[NDArray[np.intp], Numbers]:
    """Return the stratum index of each outcome, of shape ``(n,)``, and each stratum's weight per outcome."""
    strata, codes = _factorise(scores.strata)
    _check_strata(strata, weights)
    counts = np.bincount(codes, minlength=len(strata))
    return codes, np.array([weights.get(stratum, 0.0) / n for stratum, n in zip(strata, counts, strict=True)])


def _check_strata(strata: Collection[Hashable], weights: Mapping[Any, float]) -> None:
    if absent := set(weights) - set(strata):
        raise ValueError(f"every weighted stratum must have an outcome; there is none in {', '.join(sorted(map(str, absent)))}")


def _residuals(scores: Scores, weights: Mapping[Any, float]) -> tuple[Numbers, Numbers]:
    """Return the residuals of the outcomes and their weights in the estimate, both of shape ``(n,)``."""
    codes, weight = _strata_codes(scores, weights)
    means = np.bincount(codes, weights=scores.values) / np.bincount(codes)
    return scores.values - means[codes], weight[codes]
