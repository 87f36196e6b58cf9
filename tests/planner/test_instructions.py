"""Instructions of operators, written independently of the grammar. The held-out tenth is reported separately."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.planner.plan import Plan, plan

DATA = Path(__file__).parents[1] / "data" / "instructions.jsonl"
_TOLERANCE = 0.02


def rows(split: str) -> list[dict[str, Any]]:
    loaded = [json.loads(line) for line in DATA.read_text(encoding="utf-8").splitlines() if line.strip()]
    return [row for row in loaded if row["split"] == split]


def _plain(text: str) -> str:
    return " ".join(re.findall(r"[^\W_]+", text.lower()))


def same_value(wanted: Any, got: Any) -> bool:
    """Compare numbers within about 0.01, texts by their words, and ``{"contains": [...]}`` by all of its words."""
    if isinstance(wanted, dict):
        return isinstance(got, str) and all(_plain(part) in _plain(got) for part in wanted["contains"])
    if isinstance(wanted, str):
        return isinstance(got, str) and _plain(wanted) == _plain(got)
    return isinstance(got, int | float) and abs(wanted - got) <= _TOLERANCE


def fits(row: dict[str, Any], made: Plan) -> bool:
    if made.understood != row["understood"] or len(made.calls) != len(row["calls"]):
        return False
    for wanted, got in zip(row["calls"], made.calls, strict=True):
        arguments = wanted["arguments"]
        if wanted["name"] != got.name or arguments.keys() != got.arguments.keys():
            return False
        if not all(same_value(value, got.arguments[key]) for key, value in arguments.items()):
            return False
    return True


def misses(split: Iterable[dict[str, Any]]) -> list[tuple[dict[str, Any], Plan]]:
    made = [(row, plan(row["instruction"], row["presets"])) for row in split]
    return [(row, result) for row, result in made if not fits(row, result)]


@pytest.mark.parametrize(("split", "floor"), [("dev", 0.99), ("held-out", 0.9)])
def test_instructions(split: str, floor: float) -> None:
    chosen = rows(split)
    missed = misses(chosen)
    share = 1 - len(missed) / len(chosen)
    print(f"{split}: {len(chosen) - len(missed)} of {len(chosen)} instructions as expected ({share:.1%})")  # noqa: T201
    examples = [row["instruction"] for row, _ in missed[:10]] if split == "dev" else []
    assert share >= floor, f"{share:.1%} of the {split} split; missed {examples}"
