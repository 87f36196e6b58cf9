"""Instructions for ``highway-works`` (typed, spoken, polite, impossible) and the expected calls."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.planner.plan import plan

PRESETS = ("overview", "highway", "works", "gantry", "compound", "gate", "southbound", "bridge-south", "bridge-north")
ROWS = [json.loads(line) for line in Path(__file__).with_name("more_instructions.jsonl").read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize("row", ROWS, ids=[row["instruction"] for row in ROWS])
def test_more_instructions(row: dict[str, Any]) -> None:
    made = plan(row["instruction"], PRESETS)
    assert made.understood == row["understood"], made.clarification
    assert [{"name": call.name, "arguments": call.arguments} for call in made.calls] == row["calls"]
