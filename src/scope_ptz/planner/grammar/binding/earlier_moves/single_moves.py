"""Moves about one axis in plain words, so that an earlier turn's move can be repeated, reversed or given another amount."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from scope_ptz.planner.grammar import instruction_tree as ast

_WAYS = {("pan", 1): "right", ("pan", -1): "left", ("tilt", 1): "up", ("tilt", -1): "down"}
_AXES: dict[str, Literal["pan", "tilt", "zoom"]] = {
    "left": "pan", "right": "pan", "up": "tilt", "down": "tilt", "in": "zoom", "out": "zoom",
}  # fmt: skip
_OPPOSITE = {"left": "right", "right": "left", "up": "down", "down": "up", "in": "out", "out": "in"}
_ALL_THE_WAY = "all the way"
_SIZES = {"little": "a bit", "lot": "a lot", "limit": _ALL_THE_WAY, "unspecified": ""}


@dataclass(frozen=True, slots=True)
class SingleMove:
    """A relative move about one axis.

    Attributes:
        axis: The axis, which is also the verb.
        way: The direction: "left", "right", "up", "down", "in" or "out".
        size: The amount in words, such as "20 degrees", "3 times" or "a bit"; empty if the instruction gives none.
    """

    axis: Literal["pan", "tilt", "zoom"]
    way: str
    size: str = ""

    @property
    def text(self) -> str:
        """The move as an instruction: "pan right 20 degrees"."""
        if self.size == _ALL_THE_WAY:
            return f"{self.axis} {self.size} {self.way}"
        return f"{self.axis} {self.way} {self.size}".strip()

    def reversed(self) -> SingleMove:
        """Return the move by the same amount in the opposite direction."""
        return replace(self, way=_OPPOSITE[self.way])

    def sized(self, number: float, unit: str = "") -> SingleMove | None:
        """Return the move with another amount in "degrees", "times" or "percent"; None if that unit does not suit the axis."""
        if self.axis != "zoom":
            return replace(self, size=f"{number:g} degrees") if unit in {"", "degrees"} else None
        if unit == "percent":
            return replace(self, size=f"by {number:g} percent")
        return replace(self, size=f"{number:g} times") if unit in {"", "times"} else None


def axis_of_way(way: str) -> Literal["pan", "tilt", "zoom"]:
    """Return the axis of a direction: "pan" for "left"."""
    return _AXES[way]


def towards(way: str) -> SingleMove:
    """Return the move in a direction, without an amount."""
    return SingleMove(axis_of_way(way), way)


def single_move(steps: Sequence[ast.Step]) -> SingleMove | None:
    """Return the only step of an instruction as a move about one axis; None if it is anything else."""
    if len(steps) != 1 or not isinstance(steps[0], ast.Move) or len(steps[0].parts) != 1:
        return None
    part = steps[0].parts[0]
    if isinstance(part, ast.Turn):
        return _turn(part)
    return _zoom(part) if isinstance(part, ast.Zoom) else None


def _turn(turn: ast.Turn) -> SingleMove | None:
    amount = turn.amount or ast.Amount()
    if turn.step is not None or turn.steps is not None:
        return None
    if amount.kind == "degrees":
        angle = amount.degrees * amount.factor
        return SingleMove(turn.axis, _WAYS[turn.axis, turn.sign if angle >= 0 else -turn.sign], f"{abs(angle):g} degrees")
    if amount.factor != 1 or amount.kind not in _SIZES:
        return None
    return SingleMove(turn.axis, _WAYS[turn.axis, turn.sign], _SIZES[amount.kind])


def _zoom(zoom: ast.Zoom) -> SingleMove | None:
    if zoom.kind in {"in", "out"}:
        return SingleMove("zoom", zoom.kind, _ALL_THE_WAY)
    if zoom.kind == "percent":
        return SingleMove("zoom", "in" if zoom.value > 0 else "out", f"by {abs(zoom.value):g} percent")
    factor = zoom.value if zoom.value >= 1 else 1 / zoom.value
    return SingleMove("zoom", "in" if zoom.value >= 1 else "out", f"{factor:g} times")
