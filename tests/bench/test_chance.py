"""Consistent pairs, and accuracy corrected for chance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.statistics.chance import chance_corrected, pair_consistent
from scope_ptz.bench.statistics.clustered import Scores


def scores(values: dict[str, list[float]]) -> Scores:
    """Return outcomes by category, in two clusters."""
    flat = [(name, number, value) for name, row in values.items() for number, value in enumerate(row)]
    return Scores(
        np.array([value for *_, value in flat]),
        tuple(name for name, *_ in flat),
        tuple(f"place {number % 2}" for _, number, _ in flat),
        tuple(f"{name} {number}" for name, number, _ in flat),
    )


def test_a_task_of_a_pair_counts_only_with_its_twin() -> None:
    units, twins = ["absent", "present", "alone", "half"], ["present", "absent", None, "elsewhere"]
    assert pair_consistent([True, True, True, True], units, twins) == [True, True, True, True]
    assert pair_consistent([True, False, True, True], units, twins) == [False, False, True, True]
    assert pair_consistent([False, True, False, False], units, twins) == [False, False, False, False]


@given(st.lists(st.booleans(), min_size=6, max_size=6))
def test_requiring_both_tasks_of_a_pair_never_adds_correct_tasks(correct: list[bool]) -> None:
    units, twins = list("abcdef"), ["b", "a", "d", "c", None, None]
    whole = pair_consistent(correct, units, twins)
    assert all(not one or two for one, two in zip(whole, correct, strict=True))
    assert whole[0] == whole[1] and whole[2] == whole[3] and whole[4:] == correct[4:]


def test_chance_correction_by_hand() -> None:
    """(0.75 - 0.5) / 0.5 = 0.5 in one category and 0.25 in the other, whose chance level is 0."""
    accuracy = chance_corrected(scores({"a": [1, 1, 1, 0], "b": [1, 0, 0, 0]}), {"a": 0.5, "b": 0.0})
    assert accuracy is not None
    assert accuracy.corrected.value == pytest.approx(0.375)
    assert accuracy.consistent.value == pytest.approx(0.5)
    assert accuracy.chance == pytest.approx(0.25)


@given(st.floats(0, 0.9), st.floats(0, 0.9))
def test_everything_correct_is_one_and_nothing_correct_is_not_above_chance(one: float, two: float) -> None:
    levels = {"a": one, "b": two}
    best = chance_corrected(scores({"a": [1, 1], "b": [1, 1, 1]}), levels)
    worst = chance_corrected(scores({"a": [0, 0], "b": [0, 0, 0]}), levels)
    assert best is not None and worst is not None
    assert best.corrected.value == pytest.approx(1.0)
    assert worst.corrected.value == pytest.approx(-(one / (1 - one) + two / (1 - two)) / 2)


def test_without_chance_the_value_and_its_interval_are_the_macro_average() -> None:
    accuracy = chance_corrected(scores({"a": [1, 0, 1, 1], "b": [1, 0, 0, 1, 1]}), {"a": 0.0, "b": 0.0})
    assert accuracy is not None
    assert (accuracy.corrected.value, accuracy.corrected.low, accuracy.corrected.high) == pytest.approx(
        (accuracy.consistent.value, accuracy.consistent.low, accuracy.consistent.high)
    )
    assert accuracy.corrected.se == pytest.approx(accuracy.consistent.se)


def test_a_higher_chance_level_widens_the_interval() -> None:
    values = scores({"a": [1, 0, 1, 1], "b": [1, 0, 0, 1, 1]})
    plain, with_chance = chance_corrected(values, {"a": 0.0, "b": 0.0}), chance_corrected(values, {"a": 0.5, "b": 0.5})
    assert plain is not None and with_chance is not None
    assert plain.corrected.se is not None and with_chance.corrected.se is not None
    assert with_chance.corrected.se == pytest.approx(2 * plain.corrected.se)


def test_categories_without_a_known_chance_level_are_left_out() -> None:
    values = scores({"a": [1, 0], "b": [1, 1]})
    assert chance_corrected(values, {}) is None
    accuracy = chance_corrected(values, {"a": 0.0})
    assert accuracy is not None and accuracy.corrected.value == pytest.approx(0.5)
