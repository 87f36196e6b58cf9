"""Kappa agrees with values computed by hand, published values, and statsmodels."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.bench.judging.kappa import cohen_agreement, cohen_values, fleiss_agreement, fleiss_values

FLEISS_1971 = [
    [0, 0, 0, 0, 14], [0, 2, 6, 4, 2], [0, 0, 3, 5, 6], [0, 3, 9, 2, 0], [2, 2, 8, 1, 1],
    [7, 7, 0, 0, 0], [3, 2, 6, 3, 0], [2, 5, 3, 2, 2], [6, 5, 2, 1, 0], [0, 2, 2, 3, 7],
]  # fmt: skip
"""The example of Fleiss (1971): ten subjects, fourteen raters, five categories, kappa 0.210."""


def ratings_from(table: list[list[int]]) -> tuple[list[str], list[str]]:
    """Return the ratings of two raters from a table of counts."""
    cells = [(str(a), str(b)) for a, row in enumerate(table) for b, number in enumerate(row) for _ in range(number)]
    return [a for a, _ in cells], [b for _, b in cells]


def test_cohen_by_hand() -> None:
    """50 grant proposals: 20 both yes, 5 only one, 10 only the other, 15 both no: p_o = 0.7, p_e = 0.5, kappa = 0.4."""
    one, two = ratings_from([[20, 5], [10, 15]])
    agreement = cohen_agreement(one, two, list(range(50)))
    assert (agreement.runs, agreement.raters) == (50, 2)
    assert agreement.raw == pytest.approx(0.7)
    assert agreement.kappa == pytest.approx(0.4)
    assert agreement.confusion == (("0", "0", 20), ("0", "1", 5), ("1", "0", 10), ("1", "1", 15))
    assert agreement.low is not None
    assert agreement.high is not None
    # Near the analytic interval, 0.4 +- 1.96 * 0.127.
    assert agreement.low == pytest.approx(0.151, abs=0.05)
    assert agreement.high == pytest.approx(0.649, abs=0.05)


def test_fleiss_published() -> None:
    ratings = [[str(label) for label, number in enumerate(row) for _ in range(number)] for row in FLEISS_1971]
    agreement = fleiss_agreement(ratings, list(range(10)))
    assert (agreement.runs, agreement.raters) == (10, 14)
    assert agreement.kappa == pytest.approx(0.210, abs=0.0005)
    assert agreement.raw == pytest.approx(0.378, abs=0.0005)


@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from("abc")), min_size=1, max_size=40))
@settings(deadline=None, max_examples=60)
def test_bootstrap_estimates_use_the_same_formula(ratings: list[tuple[str, str]]) -> None:
    """On the original data, the bootstrap formula gives statsmodels' estimate; for two raters, it is Cohen's kappa."""
    one, two = [a for a, _ in ratings], [b for _, b in ratings]
    agreement = cohen_agreement(one, two, range(len(ratings)))
    labels = sorted({*one, *two})
    table = np.zeros((1, len(labels), len(labels)))
    for a, b in ratings:
        table[0, labels.index(a), labels.index(b)] += 1
    (bootstrap_value,) = cohen_values(table)
    if agreement.kappa is None:
        assert len(labels) == 1
        assert np.isnan(bootstrap_value)
    else:
        assert bootstrap_value == pytest.approx(agreement.kappa)
        assert -1 <= agreement.kappa <= 1
    assert cohen_agreement(two, one, range(len(ratings))).kappa == agreement.kappa
    fleiss = fleiss_agreement([list(pair) for pair in ratings], range(len(ratings)))
    assert fleiss.raw == pytest.approx(agreement.raw)
    if fleiss.kappa is not None and agreement.kappa is not None:
        assert fleiss.kappa <= agreement.kappa + 1e-9


def test_the_fleiss_formula_gives_the_published_value() -> None:
    counts = np.array(FLEISS_1971, dtype=float)
    pairs = (counts * (counts - 1)).sum(axis=1) / (14 * 13)
    row = np.concatenate([counts.sum(axis=0), [pairs.sum(), 10]])
    assert fleiss_values(row[None])[0] == pytest.approx(0.210, abs=0.0005)


def test_raters_who_always_agree() -> None:
    agreement = cohen_agreement(["correct"] * 5, ["correct"] * 5, range(5))
    assert (agreement.raw, agreement.kappa, agreement.low) == (1.0, None, None)
    assert fleiss_agreement([["correct"] * 3] * 4, range(4)).kappa is None


def test_no_ratings() -> None:
    assert cohen_agreement([], [], []).as_dict() == {"runs": 0, "raters": 2, "raw": None, "kappa": None, "low": None, "high": None}
    assert fleiss_agreement([], []).kappa is None


def test_one_cluster_has_no_interval_and_equal_clusters_have_a_wide_one() -> None:
    one, two = ratings_from([[20, 5], [10, 15]])
    assert cohen_agreement(one, two, ["same"] * 50).low is None
    independent = cohen_agreement(one, two, range(50))
    # Ten tasks with five runs each; the runs of a task agree.
    clustered = cohen_agreement(one, two, [n // 5 for n in range(50)])
    assert independent.low is not None
    assert independent.high is not None
    assert clustered.low is not None
    assert clustered.high is not None
    assert clustered.high - clustered.low > 1.5 * (independent.high - independent.low)


def test_unequal_numbers_of_ratings_are_refused() -> None:
    with pytest.raises(ValueError, match="same number"):
        fleiss_agreement([["a", "b"], ["a"]], [1, 2])


def test_the_same_seed_gives_the_same_interval() -> None:
    one, two = ratings_from([[8, 3], [2, 7]])
    assert cohen_agreement(one, two, range(20), seed=3) == cohen_agreement(one, two, range(20), seed=3)
    assert cohen_agreement(one, two, range(20), seed=3) != cohen_agreement(one, two, range(20), seed=4)
