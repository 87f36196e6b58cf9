"""The lots of instructions: the share that is planned as expected, and no move that nobody asked for."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.planner.lots import FILES, planned, rows, verdict

_DEV_FLOOR = 0.9  # share of right plans in the part that the grammar is developed on
_HELD_OUT_FLOOR = 0.6  # in the held-out part of one lot, which is small
_ALL_HELD_OUT_FLOOR = 0.9  # in the held-out parts of all lots together
_MAX_SHARE_OF_WRONG_LOOKS = {"dev": 0.08, "held-out": 0.15}
_MIN_ROWS = 20  # the floors apply to parts of at least this many rows


@pytest.mark.parametrize("lot", FILES)
@pytest.mark.parametrize(("split", "floor"), [("dev", _DEV_FLOOR), ("held-out", _HELD_OUT_FLOOR)])
def test_lot(lot: str, split: str, floor: float) -> None:
    verdicts = Counter(verdict(row, planned(row)) for row in rows(lot, split))
    size = sum(verdicts.values())
    assert size or split == "held-out", f"{lot} has no rows to develop on"
    assert verdicts["wrong move"] == 0, f"{verdicts['wrong move']} wrong moves in {lot} ({split})"
    if size < _MIN_ROWS:
        return
    assert verdicts["right"] >= floor * size, f"{verdicts['right']} of {size} right in {lot} ({split})"
    assert verdicts["wrong look"] <= _MAX_SHARE_OF_WRONG_LOOKS[split] * size


def test_held_out_instructions_of_all_lots() -> None:
    verdicts = Counter(verdict(row, planned(row)) for lot in FILES for row in rows(lot, "held-out"))
    assert verdicts["right"] >= _ALL_HELD_OUT_FLOOR * verdicts.total(), verdicts
