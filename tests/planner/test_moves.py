"""Instructions and the moves that they ask for. The planner makes exactly these moves or asks back; it never moves otherwise."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.planner.plan import plan

PRESETS = ("gate", "yard", "loading dock", "car park", "fence east", "fence west", "reception", "overview")
ROWS = [json.loads(line) for line in Path(__file__).with_name("moves.jsonl").read_text(encoding="utf-8").splitlines()]
"""``moves`` is null if the instruction asks for no move that the camera can make."""
MOVES = frozenset({"adjust_ptz", "go_to_preset", "go_home", "zoom_to_object", "track_object"})
MIN_SHARE_PLANNED = 0.7

Move = tuple[str, str, object]


def moves_of(calls: list[dict[str, Any]]) -> list[list[Move]]:
    """Return the moves of calls. For a pan and a tilt in a row, neither their order matters nor whether they are one call."""
    moves: list[Move] = []
    for call in calls:
        arguments = {name: value for name, value in call["arguments"].items() if value not in (None, 0)}
        if "zoom_factor" in arguments:
            arguments["zoom_percent"] = round(100 * (arguments.pop("zoom_factor") - 1), 6)
        moves += [(call["name"], name, value) for name, value in arguments.items()] or [(call["name"], "", None)]
    turns = groupby(moves, key=lambda move: move[1] in ("pan_deg", "tilt_deg"))
    return [sorted(group, key=lambda move: move[1]) if turning else list(group) for turning, group in turns]


def planned_moves(instruction: str) -> list[list[Move]] | None:
    """Return the moves of a plan; None if the planner asks back."""
    made = plan(instruction, PRESETS)
    calls = [{"name": call.name, "arguments": call.arguments} for call in made.calls if call.name in MOVES]
    return moves_of(calls) if made.understood else None


@pytest.mark.parametrize("row", ROWS, ids=[row["instruction"] for row in ROWS])
def test_the_planner_moves_as_asked_or_asks_back(row: dict[str, Any]) -> None:
    moves = planned_moves(row["instruction"])
    assert not moves or moves == moves_of(row["moves"] or [])


def test_most_instructions_are_planned() -> None:
    planned = [planned_moves(row["instruction"]) is not None for row in ROWS if row["moves"] is not None]
    assert sum(planned) >= MIN_SHARE_PLANNED * len(planned)
