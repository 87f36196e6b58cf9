"""Instructions from a control room, written before the grammar was looked at: none may move the camera wrongly."""

from __future__ import annotations

import pytest

from tests.planner.lots import planned, rows, verdict


@pytest.mark.parametrize(("split", "floor"), [("dev", 0.8), ("held-out", 0.7)])
def test_control_room(split: str, floor: float) -> None:
    verdicts = [(row, verdict(row, planned(row))) for row in rows("control-room", split)]
    right = [row for row, result in verdicts if result == "right"]
    wrong_moves = sum(result == "wrong move" for _, result in verdicts)
    assert wrong_moves == 0, f"{wrong_moves} wrong moves in the {split} split"
    assert len(right) / len(verdicts) >= floor
