"""The lots of instructions: the share that is planned as expected, and no move that nobody asked for.

The fast tier plans every row that is held out, and one in 24 of the rows that the grammar is developed on.
"""

from __future__ import annotations

from collections import Counter
from functools import cache

import pytest

from tests.planner.lots import FILES, Verdict, planned, rows, verdict

_TRAPS = "traps"  # instructions on which a careless planner moves wrongly; asking back is no failure there
_TRAPS_FLOOR = 0.6
_DEV_FLOOR = 0.9  # share of right plans in the part that the grammar is developed on
_HELD_OUT_FLOOR = 0.6  # in the held-out part of one lot, which is small
_ALL_HELD_OUT_FLOOR = 0.9  # in the held-out parts of all lots together
_MAX_SHARE_OF_WRONG_LOOKS = {"dev": 0.08, "held-out": 0.15}
_MIN_ROWS = 20  # the floors apply to parts of at least this many rows


@cache
def verdicts(lot: str, split: str, step: int = 1) -> Counter[Verdict]:
    """Return how often each verdict occurs among every ``step``-th row."""
    return Counter(verdict(row, planned(row)) for row in list(rows(lot, split))[::step])


def check(found: Counter[Verdict], split: str, floor: float) -> None:
    assert found["wrong move"] == 0, found
    if found.total() >= _MIN_ROWS:
        assert found["right"] >= floor * found.total(), found
        assert found["wrong look"] <= _MAX_SHARE_OF_WRONG_LOOKS[split] * found.total(), found


@pytest.mark.full
@pytest.mark.parametrize("lot", FILES)
def test_lot(lot: str) -> None:
    assert verdicts(lot, "dev"), f"{lot} has no rows to develop on"
    check(verdicts(lot, "dev"), "dev", _TRAPS_FLOOR if lot == _TRAPS else _DEV_FLOOR)


@pytest.mark.parametrize("lot", FILES)
def test_held_out_part_of_a_lot(lot: str) -> None:
    check(verdicts(lot, "held-out"), "held-out", _HELD_OUT_FLOOR)


def test_held_out_parts_of_all_lots() -> None:
    found = sum((verdicts(lot, "held-out") for lot in FILES), Counter[Verdict]())
    check(found, "held-out", _ALL_HELD_OUT_FLOOR)


def test_one_in_24_rows_of_all_lots() -> None:
    check(sum((verdicts(lot, "dev", 24) for lot in FILES), Counter[Verdict]()), "dev", _DEV_FLOOR)
