"""Statistics compared with other implementations, enumeration and hand computations."""

from __future__ import annotations

from itertools import combinations, product
from math import isclose, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.bench.statistics.clustered import (
    Scores,
    cluster_variance,
    detectable_difference,
    difference,
    independent_variance,
    macro_weights,
    pool_strata,
    proportion,
    strata_with_one_cluster,
    t_quantile,
    two_sided_p,
    weighted_mean,
    wilson,
)
from scope_ptz.bench.statistics.paired import cluster_bootstrap, holm, mcnemar_exact
from scope_ptz.bench.statistics.pareto import pareto_front
from scope_ptz.bench.statistics.repeats import mean_pass_all, pass_all

SMALL = Scores(np.array([1.0, 0, 1, 1, 0, 1]), ("a", "a", "a", "a", "b", "b"), ("x", "x", "y", "y", "x", "y"))


def random_scores(seed: int, number: int = 120, clusters: int = 9) -> Scores:
    rng = np.random.default_rng(seed)
    values = (rng.random(number) < 0.6).astype(float)
    return Scores(values, tuple(rng.integers(0, 5, number).tolist()), tuple(rng.integers(0, clusters, number).tolist()))


def test_a_worked_example() -> None:
    # Means: a 3/4, b 1/2; macro 5/8. By cluster, residuals times 1/(2 n_k): x: (1/4 - 3/4)/8 - 1/8 = -3/16, y: +3/16.
    weights = macro_weights(SMALL)
    assert weighted_mean(SMALL, weights) == pytest.approx(0.625)
    assert cluster_variance(SMALL, weights) == pytest.approx(2 / 1 * 2 * (3 / 16) ** 2)
    assert weighted_mean(pool_strata(SMALL), {"all": 1.0}) == pytest.approx(4 / 6)
    assert weighted_mean(SMALL, {"a": 1.0, "b": -1.0}) == pytest.approx(0.25)


def test_the_interval_without_clusters_matches_a_hand_computation() -> None:
    # Residuals times 1/(2 n_k), with every outcome independent. a: 1/4, -3/4, 1/4, 1/4 over 8; b: -1/2, 1/2 over 4.
    squares = (3 * (1 / 32) ** 2 + (3 / 32) ** 2) + 2 * (1 / 8) ** 2
    assert squares == pytest.approx(11 / 256)
    assert independent_variance(SMALL, macro_weights(SMALL)) == pytest.approx(6 / 5 * 11 / 256)
    # One stratum: s^2/n with s^2 = sum (x - mean)^2 / (n - 1), for 4 of 6: (4 (1/3)^2 + 2 (2/3)^2) / 5 / 6.
    assert independent_variance(pool_strata(SMALL), {"all": 1.0}) == pytest.approx((4 / 9 + 8 / 9) / 5 / 6)
    assert independent_variance(Scores(np.array([1.0]), ("a",), ("x",)), {"a": 1.0}) is None


def test_clusters_that_agree_by_chance_do_not_lower_the_standard_error() -> None:
    # Both clusters have half correct: the variance between them is 0, so the floor from four independent outcomes applies.
    scores = Scores(np.array([1.0, 0, 1, 0]), ("a",) * 4, ("x", "x", "y", "y"))
    assert cluster_variance(scores, {"a": 1.0}) == 0
    estimate = proportion(scores)
    assert estimate is not None and estimate.se == pytest.approx(sqrt(4 * 0.25 / 3 / 4))


def test_strata_of_one_cluster_are_named_and_have_no_interval() -> None:
    # c has one outcome, and b has two from one viewpoint: neither shows any variation between viewpoints.
    values, strata = np.array([1.0, 0, 1, 1, 0, 1, 1]), ("a", "a", "a", "a", "b", "b", "c")
    scores = Scores(values, strata, ("x", "x", "y", "y", "x", "x", "y"))
    assert strata_with_one_cluster(scores, macro_weights(scores)) == ("b", "c")
    assert strata_with_one_cluster(scores, {"a": 1.0}) == ()
    for estimate in (proportion(scores, macro_weights(scores)), difference(scores, macro_weights(scores))):
        assert estimate is not None and estimate.single_cluster_strata == ("b", "c") and estimate.low is not None
    alone = Scores(values[:2], ("b", "c"), ("x", "y"))
    for estimate in (proportion(alone, macro_weights(alone)), difference(alone, macro_weights(alone))):
        assert estimate is not None and (estimate.value, estimate.low, estimate.high, estimate.se) == (0.5, None, None, None)
        assert two_sided_p(estimate) is None
    whole = proportion(SMALL, macro_weights(SMALL))
    assert whole is not None and whole.single_cluster_strata == ()


@pytest.mark.full
@pytest.mark.parametrize("seed", range(5))
def test_the_micro_variance_is_that_of_a_clustered_regression(seed: int) -> None:
    from statsmodels.regression.linear_model import OLS  # type: ignore[import-untyped]

    scores = random_scores(seed)
    fitted = OLS(scores.values, np.ones(len(scores.values))).fit(
        cov_type="cluster", cov_kwds={"groups": np.array(scores.clusters)}, use_t=True
    )
    assert cluster_variance(pool_strata(scores), {"all": 1.0}) == pytest.approx(float(fitted.bse[0]) ** 2)
    estimate = difference(scores)
    assert estimate is not None
    if estimate.se == pytest.approx(float(fitted.bse[0])):
        assert (estimate.low, estimate.high) == pytest.approx(tuple(fitted.conf_int()[0]))
        assert two_sided_p(estimate) == pytest.approx(float(fitted.pvalues[0]))


@pytest.mark.full
@pytest.mark.parametrize("seed", range(5))
def test_the_macro_variance_is_that_of_a_clustered_regression_on_strata(seed: int) -> None:
    from statsmodels.regression.linear_model import OLS

    scores = random_scores(seed)
    strata = sorted(set(scores.strata))  # type: ignore[type-var]
    dummies = np.array([[float(own == stratum) for stratum in strata] for own in scores.strata])
    covariance = (
        OLS(scores.values, dummies)
        .fit(cov_type="cluster", cov_kwds={"groups": np.array(scores.clusters), "use_correction": False})
        .cov_params()
    )
    clusters, share_of = len(set(scores.clusters)), np.full(len(strata), 1 / len(strata))
    expected = float(share_of @ covariance @ share_of) * clusters / (clusters - 1)
    assert cluster_variance(scores, macro_weights(scores)) == pytest.approx(expected)


def test_intervals_cover_the_truth_although_viewpoints_differ() -> None:
    rng = np.random.default_rng(3)
    covered = naive = 0
    for _ in range(150):
        level = np.clip(rng.normal(0.65, 0.15, 12), 0.05, 0.95)
        clusters = np.repeat(np.arange(12), 40)
        values = (rng.random(480) < level[clusters]).astype(float)
        estimate = proportion(Scores(values, ("all",) * 480, tuple(clusters.tolist())))
        assert estimate is not None and estimate.low is not None and estimate.high is not None
        covered += estimate.low <= 0.65 <= estimate.high
        low, high = wilson(estimate.value, 480, 1.96)
        naive += low <= 0.65 <= high
    assert 0.90 <= covered / 150 <= 0.99
    assert naive / 150 < 0.80


@given(st.lists(st.tuples(st.booleans(), st.sampled_from("abc"), st.integers(0, 4)), min_size=1, max_size=60))
@settings(max_examples=40, deadline=None)
def test_shares_stay_within_their_intervals_and_these_within_0_and_1(rows: list[tuple[bool, str, int]]) -> None:
    scores = Scores(np.array([float(right) for right, _, _ in rows]), tuple(s for _, s, _ in rows), tuple(c for _, _, c in rows))
    for weights in (None, macro_weights(scores)):
        estimate = proportion(scores, weights)
        assert estimate is not None
        groups = ["all"] * len(rows) if weights is None else [s for _, s, _ in rows]
        viewpoints = [len({c for own, (_, _, c) in zip(groups, rows, strict=True) if own == group}) for group in set(groups)]
        if max(viewpoints) < 2:
            assert estimate.low is None and estimate.high is None and estimate.se is None
        else:
            assert estimate.low is not None and estimate.high is not None and estimate.se is not None
            assert -1e-12 <= estimate.low <= estimate.value + 1e-12 and estimate.value <= estimate.high + 1e-12 <= 1 + 2e-12
            assert estimate.high - estimate.low > 0
            floor = independent_variance(pool_strata(scores) if weights is None else scores, weights or {"all": 1.0})
            assert floor is not None and estimate.se**2 >= floor - 1e-12


def test_without_data_there_is_no_estimate() -> None:
    empty = Scores(np.array([]), (), ())
    assert proportion(empty) is None and difference(empty) is None and cluster_bootstrap(empty) is None
    with pytest.raises(ValueError, match="there is none in c"):
        weighted_mean(SMALL, {"c": 1.0})
    with pytest.raises(ValueError, match="length"):
        Scores(np.array([1.0]), (), ())


@pytest.mark.parametrize(("right", "number"), [(0, 7), (3, 10), (50, 72), (72, 72)])
def test_wilson(right: int, number: int) -> None:
    from statsmodels.stats.proportion import proportion_confint  # type: ignore[import-untyped]

    assert wilson(right / number, number, 1.959963984540054) == pytest.approx(proportion_confint(right, number, method="wilson"))


def test_quantiles_of_students_t() -> None:
    assert t_quantile(12) == pytest.approx(2.200985)
    assert t_quantile(2) == pytest.approx(12.706205)
    assert detectable_difference(1.0, 12) == pytest.approx(2.200985 + 0.875530)
    assert detectable_difference(0.5, 1_000_000) == pytest.approx(0.5 * (1.959964 + 0.841621), rel=1e-5)


@pytest.mark.parametrize(("one", "other"), [(0, 0), (1, 0), (5, 5), (12, 3), (40, 61), (0, 9)])
def test_mcnemar(one: int, other: int) -> None:
    from statsmodels.stats.contingency_tables import mcnemar  # type: ignore[import-untyped]

    expected = 1.0 if one == other else float(mcnemar([[7, one], [other, 9]], exact=True).pvalue)
    assert mcnemar_exact(one, other) == pytest.approx(expected)
    assert mcnemar_exact(one, other) == mcnemar_exact(other, one)


@pytest.mark.parametrize("number", [1, 2, 3, 12])
def test_holm(number: int) -> None:
    from statsmodels.stats.multitest import multipletests  # type: ignore[import-untyped]

    p_values = [float(p) for p in np.random.default_rng(number).uniform(0, 2 / number, number).clip(0, 1).round(2)]
    adjusted = holm(p_values)
    assert adjusted == pytest.approx(list(multipletests(p_values, method="holm")[1]))
    assert holm([None, *p_values]) == [None, *adjusted]


def test_differences_stay_in_range_and_have_an_interval() -> None:
    wide = difference(Scores(np.array([1.0, -1.0, 1.0]), ("a",) * 3, ("x", "y", "y")))
    assert wide is not None
    assert (wide.low, wide.high) == (-1.0, 1.0)
    constant = difference(Scores(np.array([0.0, 0.0]), ("a",) * 2, ("x", "y")))
    assert constant is not None
    assert (constant.value, constant.low, constant.high) == (0.0, None, None)


def test_the_bootstrap_of_two_clusters_is_known() -> None:
    # Draws: x twice (1/4), one of each (1/2), y twice (1/4): the 2.5% and 97.5% points are the means of x and of y alone.
    scores = Scores(np.array([-1.0, 0.0, 1.0, 1.0]), ("a",) * 4, ("x", "x", "y", "y"))
    assert cluster_bootstrap(scores) == pytest.approx((-0.5, 1.0))
    assert cluster_bootstrap(scores, seed=4) == cluster_bootstrap(scores, seed=4)
    assert cluster_bootstrap(Scores(np.array([1.0]), ("a",), ("x",))) is None


def test_bootstrap_and_linearised_interval_agree_with_many_clusters() -> None:
    scores = random_scores(8, 2000, 100)
    estimate, bootstrap = difference(scores, macro_weights(scores)), cluster_bootstrap(scores)
    assert estimate is not None and bootstrap is not None
    assert bootstrap == pytest.approx((estimate.low, estimate.high), abs=0.006)


@given(st.lists(st.booleans(), min_size=1, max_size=7), st.integers(1, 7))
@settings(max_examples=40, deadline=None)
def test_pass_all_is_the_share_of_selections_in_which_all_trials_pass(runs: list[bool], k: int) -> None:
    chosen = list(combinations(runs, k))
    expected = sum(all(choice) for choice in chosen) / len(chosen) if chosen else None
    share = pass_all(len(runs), sum(runs), k)
    assert share is None if expected is None else share is not None and isclose(share, expected)


def test_pass_all_over_tasks() -> None:
    value, tasks = mean_pass_all([(4, 2), (2, 2), (1, 1)], 2)
    assert tasks == 2 and value == pytest.approx((1 / 6 + 1) / 2)
    assert mean_pass_all([(1, 1)], 2) == (None, 0)
    with pytest.raises(ValueError, match="between"):
        pass_all(2, 3, 1)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3), st.integers(0, 3)), max_size=9))
@settings(max_examples=40, deadline=None)
def test_the_pareto_front(points: list[tuple[int, int, int]]) -> None:
    front = pareto_front([tuple(map(float, point)) for point in points])
    for (index, point), _ in product(enumerate(points), (0,)):
        dominated = any(other != point and all(a <= b for a, b in zip(other, point, strict=True)) for other in points)
        assert front[index] is not dominated


def test_the_smallest_detectable_difference_has_a_power_of_80_percent() -> None:
    clusters = 20
    true = detectable_difference(sqrt(1 / clusters), clusters)
    means = np.random.default_rng(5).normal(true, 1.0, (4000, clusters))
    detected = np.abs(means.mean(axis=1)) / (means.std(axis=1, ddof=1) / sqrt(clusters)) > t_quantile(clusters)
    assert detected.mean() == pytest.approx(0.8, abs=0.03)
