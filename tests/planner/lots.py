"""The lots of instructions with expected calls, and how a plan compares with them.

A row of a lot states the instruction, the camera's presets, whether a plan is expected, and the calls of the plan. An expected
text may be ``{"contains": [...]}``, which any text with these words fits. The expected call ``look`` fits a count or a question
whose text fits ``about``. Rows of the split ``held-out`` are never used to develop the grammar, and are reported apart.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from scope_ptz.planner.plan import Plan, PlannedCall, plan

_HERE = Path(__file__).parent
_HIGHWAY_WORKS = (
    "overview", "highway", "works", "gantry", "compound", "gate", "southbound", "bridge-south", "bridge-north",
)  # fmt: skip
FILES: dict[str, Path] = {
    "operators": _HERE.parent / "data" / "instructions.jsonl",
    "highway": _HERE / "more_instructions.jsonl",
    "registers": _HERE / "registers.jsonl",
    "control-room": _HERE / "control_room.jsonl",
    **{path.stem: path for path in sorted((_HERE / "lots").glob("*.jsonl"))},
}
_TOLERANCE = 0.02
_MOVES = frozenset({"adjust_ptz", "go_home", "go_to_preset", "zoom_to_object", "track_object"})
_LOOKS = {"count_objects": "description", "query_answer": "question"}

Verdict = Literal["right", "asked back", "wrong look", "wrong move"]
VERDICTS: tuple[Verdict, ...] = ("right", "asked back", "wrong look", "wrong move")


@dataclass(frozen=True, slots=True)
class Row:
    """An instruction with its expected plan."""

    lot: str
    split: str
    instruction: str
    presets: tuple[str, ...]
    understood: bool
    calls: tuple[dict[str, Any], ...]


def rows(lot: str, split: str | None = None) -> Iterator[Row]:
    """Return the rows of a lot; of one split if it is given."""
    for line in FILES[lot].read_text(encoding="utf-8").splitlines():
        if not line.strip():
            continue
        data = json.loads(line)
        row = Row(
            lot=lot,
            split=data.get("split", "dev"),
            instruction=data["instruction"],
            presets=tuple(data.get("presets", _HIGHWAY_WORKS)),
            understood=data["understood"],
            calls=tuple(data["calls"]),
        )
        if split in (None, row.split):
            yield row


def planned(row: Row) -> Plan:
    """Return the plan for a row's instruction."""
    return plan(row.instruction, row.presets)


def verdict(row: Row, made: Plan) -> Verdict:
    """Judge a plan. A plan that moves the camera is a wrong move unless its moves are all those that are expected, in order."""
    if not made.understood:
        return "asked back" if row.understood else "right"
    if row.understood and len(row.calls) == len(made.calls):
        if all(_fits(expected, call) for expected, call in zip(row.calls, made.calls, strict=True)):
            return "right"
        if all(_moves_alike(expected, call) for expected, call in zip(row.calls, made.calls, strict=True)):
            return "wrong look"
    moves = [call for call in made.calls if call.name in _MOVES]
    expected_moves = [call for call in row.calls if call["name"] in _MOVES]
    alike = not moves or (len(moves) == len(expected_moves) and all(map(_moves_alike, expected_moves, moves)))
    return "wrong look" if alike else "wrong move"


def _fits(expected: dict[str, Any], call: PlannedCall) -> bool:
    if expected["name"] == "look":
        text = call.arguments.get(_LOOKS.get(call.name, ""))
        return text is not None and _same(expected["about"], text) and call.arguments.get("view") == expected["view"]
    return expected["name"] == call.name and _same_arguments(expected["arguments"], call.arguments)


def _moves_alike(expected: dict[str, Any], call: PlannedCall) -> bool:
    """Return whether two calls move the camera alike. A thing is sought by its words, so another wording is a wrong look."""
    if expected["name"] not in _MOVES:
        return call.name not in _MOVES
    if expected["name"] in {"zoom_to_object", "track_object"}:
        return bool(call.name == expected["name"])
    return _fits(expected, call)


def _same_arguments(expected: dict[str, Any], arguments: dict[str, Any]) -> bool:
    expected, arguments = _with_factor(expected), _with_factor(arguments)
    return expected.keys() == arguments.keys() and all(_same(value, arguments[key]) for key, value in expected.items())


def _with_factor(arguments: dict[str, Any]) -> dict[str, Any]:
    """Return arguments with a change of zoom in per cent as a factor, which has the same effect."""
    if not isinstance(percent := arguments.get("zoom_percent"), int | float):
        return arguments
    return {**{name: value for name, value in arguments.items() if name != "zoom_percent"}, "zoom_factor": 1 + percent / 100}


def _same(expected: Any, value: Any) -> bool:
    """Compare numbers within about 0.01, and texts by their words, with the text that was read."""
    if isinstance(expected, dict):
        return isinstance(value, str) and all(_plain(part) in _plain(value) for part in expected["contains"])
    if isinstance(expected, str):
        return isinstance(value, str) and _plain(expected) == _plain(value)
    return isinstance(value, int | float) and abs(expected - value) <= _TOLERANCE


def _plain(text: str) -> str:
    return " ".join(re.findall(r"[^\W_]+", text.lower()))
