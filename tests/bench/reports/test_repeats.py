"""Repeats of a task count as one observation: repeating a deterministic model does not add information."""

from __future__ import annotations

from dataclasses import replace
from math import isclose

import numpy as np
import pytest

from scope_ptz.bench.reports.assemble import build_report
from scope_ptz.bench.reports.report_runs import ReportRun, report_runs
from scope_ptz.bench.reports.tables import MarkedCell, cell_value
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.statistics.clustered import (
    IntervalEstimate,
    Scores,
    independent_variance,
    macro_weights,
    newcombe,
    proportion,
    proportion_difference,
)
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, facts, trial
from tests.bench.reports.test_report import table

TASKS = [t for t in facts(5) if t.category in ("single_call", "ocr")]
"""Ten tasks of two categories."""


def repeated_evaluation(
    times: int, correct: frozenset[str], planner: str = "qwen3-4b", perception: str = "moondream3"
) -> Evaluation:
    """Return a deterministic evaluation: each task is repeated ``times`` times with the same outcome."""
    trials = tuple(
        trial(t, "correct" if t.id in correct else "incorrect", epoch=epoch, sample=f"{t.id}/{epoch}")
        for t in TASKS
        for epoch in range(1, times + 1)
    )
    return Evaluation(card=card(planner, perception, epochs=times), trials=trials, wanted=len(trials))


def run(times: int, correct: frozenset[str]) -> ReportRun:
    return report_runs([repeated_evaluation(times, correct)], load_registry())[0]


@pytest.mark.parametrize("number", [0, 1, 4, 9, 10])
def test_repeats_of_a_deterministic_run_do_not_narrow_the_interval(number: int) -> None:
    correct = frozenset(t.id for t in TASKS[:number])
    once, thrice, nine = (run(times, correct) for times in (1, 3, 9))
    for name in ("macro", "micro"):
        first = getattr(once, name)
        assert first.low is not None and first.n == len(TASKS)
        for other in (getattr(thrice, name), getattr(nine, name)):
            assert (other.value, other.low, other.high, other.n) == pytest.approx((first.value, first.low, first.high, first.n))


def test_tasks_with_equal_variation_have_an_interval() -> None:
    # Every task is correct in one of three trials. Equal results of tasks must not be taken for certainty.
    values, units = np.array([1.0, 0.0, 0.0] * 5), tuple(n for n in range(5) for _ in range(3))
    estimate = proportion(Scores(values, ("a",) * 15, tuple(n % 3 for n in units), units))
    assert estimate is not None and estimate.low is not None and estimate.high is not None
    assert estimate.n == 5 and estimate.high - estimate.low > 0.4


def test_the_floor_of_the_variance_is_over_tasks() -> None:
    values, strata, clusters = np.array([1.0, 0, 1, 1, 0, 1]), ("a", "a", "a", "a", "b", "b"), ("x", "x", "y", "y", "x", "y")
    once = Scores(values, strata, clusters)
    repeats = Scores(np.repeat(values, 4), *(tuple(np.repeat(labels, 4).tolist()) for labels in (strata, clusters, range(6))))
    weights = macro_weights(once)
    assert independent_variance(repeats, weights) == pytest.approx(independent_variance(once, weights))
    assert independent_variance(replace(repeats, units=None), weights) < independent_variance(once, weights)  # type: ignore[operator]
    with pytest.raises(ValueError, match="units"):
        Scores(values, strata, clusters, ("1",))


@pytest.mark.parametrize("number", [3, 7, 8, 11])
def test_a_perfect_score_is_one_for_any_number_of_categories(number: int) -> None:
    strata = tuple(n % number for n in range(3 * number))
    scores = Scores(np.ones(3 * number), strata, tuple(n % 4 for n in range(3 * number)))
    estimate = proportion(scores, macro_weights(scores))
    assert estimate is not None and estimate.value == 1.0


def test_equal_best_values_are_all_marked() -> None:
    # The same tasks are correct with one, three and seven repeats. Thirds and sevenths have rounding errors.
    correct = frozenset(t.id for t in TASKS[:-1])
    logs = [
        repeated_evaluation(times, correct, planner) for times, planner in ((1, "qwen3-4b"), (3, "qwen3-30b-a3b"), (7, "qwen3-32b"))
    ]
    equal = table(build_report(logs, load_registry()), "accuracy")
    assert not any(isinstance(cell, MarkedCell) and (cell.best or cell.best_of_all) for values in equal.rows for cell in values)
    worse = repeated_evaluation(1, frozenset(), "qwen3-14b")
    accuracy = table(build_report([*logs, worse], load_registry()), "accuracy")
    for name in ("macro", "micro", "ocr", "single_call"):
        index = [column.name for column in accuracy.columns].index(name)
        cells = [values[index] for values in accuracy.rows if not str(cell_value(values[0])).startswith("qwen3-14b")]
        assert all(isinstance(cell, MarkedCell) and cell.best and cell.best_of_all for cell in cells), name


def test_the_best_value_does_not_depend_on_rounding() -> None:
    from scope_ptz.bench.reports.details.accuracy import _is_best

    values = [0.9999999999999999, 1.0, 1.0000000000000002]
    assert not any(_is_best(value, values) for value in values), "equal values have no best"
    assert all(_is_best(value, [*values, 0.9]) for value in values)
    assert not _is_best(0.9999, [*values, 0.9999]) and not _is_best(1.0, [1.0])


def test_the_difference_of_two_proportions_uses_newcombes_interval() -> None:
    from statsmodels.stats.proportion import confint_proportions_2indep, proportion_confint  # type: ignore[import-untyped]

    # 56 of 70 and 48 of 80: Newcombe's own example (1998, table II, case a), 0.0524 to 0.3339.
    sides = [(k / n, *proportion_confint(k, n, method="wilson")) for k, n in ((56, 70), (48, 80))]
    low, high = newcombe(*sides)
    assert (low, high) == pytest.approx((0.0524, 0.3339), abs=5e-5)
    assert (low, high) == pytest.approx(confint_proportions_2indep(56, 70, 48, 80, method="newcomb"))
    assert newcombe((0.5, None, None), sides[1]) == (None, None)


def test_a_side_without_variance_keeps_its_uncertainty_in_the_difference() -> None:
    first = Scores(np.array([1.0, 0, 1, 1, 0, 1, 0, 1]), ("a",) * 8, (1, 1, 2, 2, 3, 3, 4, 4))
    constant = Scores(np.zeros(2), ("a",) * 2, (1, 2))
    estimate, alone = proportion_difference(first, constant), proportion(constant)
    assert (
        estimate is not None
        and estimate.low is not None
        and estimate.high is not None
        and alone is not None
        and alone.high is not None
    )
    assert estimate.value == pytest.approx(5 / 8)
    assert estimate.value - estimate.low >= alone.high - 1e-12 > 0.9, "two trials of one side allow almost any value"
    assert -1 <= estimate.low <= estimate.value <= estimate.high <= 1
    assert proportion_difference(first, Scores(np.array([]), (), ())) is None
    single = proportion_difference(first, Scores(np.array([0.0, 1.0]), ("a",) * 2, (1, 1)))
    assert single is not None and (single.low, single.high) == (None, None)


def test_the_report_shows_the_difference_between_scopes() -> None:
    tasks = facts(6)
    full = [t for t in tasks if t.scope == "full"][:2]
    current = [t for t in tasks if t.scope == "current"]
    trials = [trial(t, "correct" if n % 3 else "incorrect") for n, t in enumerate(current)] + [trial(t, "incorrect") for t in full]
    report = build_report(
        [Evaluation(card=card("qwen3-4b", "moondream3"), trials=tuple(trials), wanted=len(trials))], load_registry()
    )
    _, _, _, _, side, between = (cell_value(cell) for cell in table(report, "scope").rows[0])
    assert isinstance(side, IntervalEstimate) and isinstance(between, IntervalEstimate)
    assert side.value == 0.0 and side.high is not None and side.high > 0.9
    assert (
        between.low is not None and between.value - between.low >= side.high - 1e-12 and isclose(between.value, 2 / 3, abs_tol=0.02)
    )
