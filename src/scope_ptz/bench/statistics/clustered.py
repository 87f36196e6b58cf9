"""Means over strata with intervals that know that tasks of one viewpoint are alike.

An estimate is a weighted sum of stratum means, theta = sum_k w_k mean_k: with w_k = 1/K the macro average, with a single stratum
the micro average, with weights +1 and -1 a contrast. Its variance is that of the linearised estimate, summed by cluster (Liang and
Zeger 1986), times G/(G-1); quantiles are Student's with G-1 degrees of freedom (Cameron and Miller 2015, sections II.A and VI.D).

Repeats of a task are one observation of it, a ``unit``: however often a task is repeated, there are no more tasks.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import fsum, hypot, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtr, stdtrit  # type: ignore[import-untyped]

LEVEL = 0.95
_ROUNDING = 1e-24
Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scores:
    """Outcomes with what they are grouped by, all of length n: ``values`` (n,) float, ``strata`` and ``clusters`` any labels.

    ``units``: what an outcome is one of several repeats of, each within one stratum and one cluster; None: every outcome is a unit
    of its own.
    """

    values: Numbers
    strata: tuple[Hashable, ...]
    clusters: tuple[Hashable, ...]
    units: tuple[Hashable, ...] | None = None

    def __post_init__(self) -> None:
        if not len(self.values) == len(self.strata) == len(self.clusters) == len(self.observed):
            raise ValueError("values, strata, clusters and units differ in length")

    @property
    def observed(self) -> tuple[Hashable, ...]:
        """The unit of each outcome."""
        return tuple(range(len(self.values))) if self.units is None else self.units


@dataclass(frozen=True, slots=True)
class IntervalEstimate:
    """``low`` and ``high``: the 95% interval, None where it is not known. ``se``: standard error; ``n``: units (tasks).

    ``without``: strata of which all outcomes are of one cluster. They are in the value, but nothing is known of how they vary
    between clusters, so that the interval is too narrow by what they would add. Where all strata are such, there is no interval.
    """

    value: float
    low: float | None
    high: float | None
    se: float | None
    n: int
    clusters: int
    without: tuple[str, ...] = ()


def macro_weights(scores: Scores) -> dict[Hashable, float]:
    """Every stratum that occurs counts the same."""
    present = set(scores.strata)
    return {stratum: 1.0 / len(present) for stratum in present}


def pooled(scores: Scores) -> Scores:
    """The same outcomes in one stratum."""
    return Scores(scores.values, ("all",) * len(scores.values), scores.clusters, scores.units)


def weighted_mean(scores: Scores, weights: Mapping[Any, float]) -> float:
    """Sum of weight times stratum mean. Raises ``ValueError`` when a stratum of ``weights`` has no outcome."""
    found: dict[Hashable, list[float]] = {}
    for stratum, value in zip(scores.strata, scores.values.tolist(), strict=True):
        found.setdefault(stratum, []).append(value)
    _hold_all(found, weights)
    # Summed exactly: runs with the same outcomes have the same mean, in whatever order and however often they were repeated.
    return fsum(weight * (fsum(found[stratum]) / len(found[stratum])) for stratum, weight in weights.items())


def cluster_variance(scores: Scores, weights: Mapping[Any, float]) -> float | None:
    """Variance of ``weighted_mean`` over clusters: G/(G-1) sum_g u_g^2, where u_g is the sum over the cluster's outcomes of
    w_k/n_k (x - mean_k). None with fewer than two clusters.

    With one stratum it is the CR1 variance of a regression on a constant.
    """
    labels, index = _factorise(scores.clusters)
    if len(labels) < 2:
        return None
    residuals, share = _residuals(scores, weights)
    sums = np.bincount(index, weights=residuals * share, minlength=len(labels))
    return float(len(labels) / (len(labels) - 1) * np.sum(sums**2))


def independent_variance(scores: Scores, weights: Mapping[Any, float]) -> float | None:
    """``cluster_variance`` with every unit a cluster of its own: as if all were independent. None for fewer than two.

    Repeats are no independent outcomes: of a model that always does the same they tell nothing new.
    """
    return cluster_variance(Scores(scores.values, scores.strata, scores.observed), weights)


def strata_without_spread(scores: Scores, weights: Mapping[Any, float]) -> tuple[Hashable, ...]:
    """Strata of the estimate whose outcomes are all of one cluster: their residuals sum to 0 there, whatever they are."""
    seen: dict[Hashable, set[Hashable]] = {}
    for stratum, cluster in zip(scores.strata, scores.clusters, strict=True):
        seen.setdefault(stratum, set()).add(cluster)
    return tuple(stratum for stratum, clusters in seen.items() if weights.get(stratum) and len(clusters) < 2)


def standard_error(scores: Scores, weights: Mapping[Any, float]) -> float | None:
    """Root of the larger of the two variances: a few clusters that agree by chance must not feign precision.

    None where every stratum is of one cluster: then nothing tells how outcomes vary between clusters. What rounding leaves of a
    variance of 0 is 0.
    """
    clustered, independent = cluster_variance(scores, weights), independent_variance(scores, weights)
    if (
        clustered is None
        or independent is None
        or len(strata_without_spread(scores, weights)) == np.count_nonzero([*weights.values()])
    ):
        return None
    variance = max(clustered, independent)
    return sqrt(variance) if variance > _ROUNDING else 0.0


def share(scores: Scores, weights: Mapping[Any, float] | None = None) -> IntervalEstimate | None:
    """A share in [0, 1] with a Wilson interval at the effective sample size p(1-p)/se^2 (Dean and Pagano 2015); None without data.

    ``weights``: of strata, taken relative to their sum; none means that all outcomes are pooled. Where every unit of a stratum is
    alike, so that the variance is 0, the effective size is the number of units.
    """
    if not len(scores.values):
        return None
    scores, weights = (pooled(scores), {"all": 1.0}) if weights is None else (scores, weights)
    se, clusters, units = standard_error(scores, weights), len(set(scores.clusters)), len(set(scores.observed))
    value = min(1.0, max(0.0, weighted_mean(scores, weights) / fsum(weights.values())))
    low = high = None
    if se is not None:
        size = value * (1 - value) / se**2 if se > 0 else float(units)
        low, high = wilson(value, size, t_quantile(clusters))
    return IntervalEstimate(value, low, high, se, units, clusters, _without(scores, weights))


def difference(scores: Scores, weights: Mapping[Any, float] | None = None) -> IntervalEstimate | None:
    """A mean difference or contrast of shares with the interval value +- t se, cut at -1 and 1; None without data.

    There is no interval where every outcome is alike: a variance of 0 would feign that the difference is known.
    """
    if not len(scores.values):
        return None
    scores, weights = (pooled(scores), {"all": 1.0}) if weights is None else (scores, weights)
    value, se, clusters = weighted_mean(scores, weights), standard_error(scores, weights), len(set(scores.clusters))
    half = se * t_quantile(clusters) if se else None
    low, high = (None, None) if half is None else (max(-1.0, value - half), min(1.0, value + half))
    return IntervalEstimate(value, low, high, se, len(set(scores.observed)), clusters, _without(scores, weights))


def share_difference(first: Scores, second: Scores) -> IntervalEstimate | None:
    """Share of ``first`` minus that of ``second``, which are of different outcomes; None without data of one of them.

    The interval joins those of the two shares as if they were independent (Newcombe 1998, method 10; Zou and Donner 2008): unlike
    value +- t se it has a width on a side whose outcomes are all alike. There is none where one of the shares has none.
    """
    one, other = share(first), share(second)
    if one is None or other is None:
        return None
    both = Scores(
        np.concatenate([first.values, second.values]),
        (1,) * len(first.values) + (2,) * len(second.values),
        (*first.clusters, *second.clusters),
        (*((1, unit) for unit in first.observed), *((2, unit) for unit in second.observed)),
    )
    found = difference(both, {1: 1.0, 2: -1.0})
    if found is None:
        return None
    low, high = newcombe((one.value, one.low, one.high), (other.value, other.low, other.high))
    return replace(found, low=low, high=high, without=())


Bounded = tuple[float, float | None, float | None]
"""A value with its interval."""


def newcombe(one: Bounded, other: Bounded) -> tuple[float, float] | tuple[None, None]:
    """Interval of the difference of two independent shares from their own intervals: the distances of the limits that lie in the
    same direction, squared and added. None where one of them is not known."""
    (p, low, high), (q, least, most) = one, other
    if low is None or high is None or least is None or most is None:
        return None, None
    return p - q - hypot(p - low, most - q), p - q + hypot(high - p, q - least)


def _without(scores: Scores, weights: Mapping[Any, float]) -> tuple[str, ...]:
    return tuple(map(str, strata_without_spread(scores, weights)))


def wilson(value: float, size: float, quantile: float) -> tuple[float, float]:
    """Wilson's interval (1927) of a proportion ``value`` among ``size``, which need not be whole. Within [0, 1]."""
    square = quantile**2 / size
    centre = (value + square / 2) / (1 + square)
    half = quantile / (1 + square) * sqrt(max(0.0, value * (1 - value)) / size + square / (4 * size))
    return max(0.0, centre - half), min(1.0, centre + half)


def t_quantile(clusters: int, level: float = LEVEL) -> float:
    """Two-sided quantile of Student's t with one degree of freedom fewer than there are clusters."""
    return float(stdtrit(clusters - 1, 0.5 + level / 2))


def two_sided_p(estimate: IntervalEstimate) -> float | None:
    """P value of the hypothesis that a difference is 0; None where there is no standard error."""
    if estimate.se is None:
        return None
    if estimate.se == 0:
        return 1.0 if estimate.value == 0 else 0.0
    return float(2 * stdtr(estimate.clusters - 1, -abs(estimate.value) / estimate.se))


def detectable(se: float, clusters: int, power: float = 0.8, level: float = LEVEL) -> float:
    """The smallest true difference that a two-sided test finds with the given power: (t_(1-a/2) + t_power) se (Bloom 1995)."""
    return se * float(stdtrit(clusters - 1, 0.5 + level / 2) + stdtrit(clusters - 1, power))


def _factorise(labels: Sequence[Hashable]) -> tuple[list[Hashable], NDArray[np.intp]]:
    known: dict[Hashable, int] = {}
    codes = np.array([known.setdefault(label, len(known)) for label in labels], dtype=np.intp)
    return list(known), codes


def _coded(scores: Scores, weights: Mapping[Any, float]) -> tuple[NDArray[np.intp], Numbers]:
    """The stratum of each outcome, (n,), and each stratum's weight over its number of outcomes."""
    strata, codes = _factorise(scores.strata)
    _hold_all(strata, weights)
    counts = np.bincount(codes, minlength=len(strata))
    return codes, np.array([weights.get(stratum, 0.0) / n for stratum, n in zip(strata, counts, strict=True)])


def _hold_all(strata: Collection[Hashable], weights: Mapping[Any, float]) -> None:
    if absent := set(weights) - set(strata):
        raise ValueError(f"no outcome in {', '.join(sorted(map(str, absent)))}")


def _residuals(scores: Scores, weights: Mapping[Any, float]) -> tuple[Numbers, Numbers]:
    """Distance of each outcome from its stratum's mean, and its share in the estimate, both (n,)."""
    codes, weight = _coded(scores, weights)
    means = np.bincount(codes, weights=scores.values) / np.bincount(codes)
    return scores.values - means[codes], weight[codes]
