"""Collect what a plan will do: its numbers, directions, presets, actions and texts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from scope_ptz.planner.grammar import instruction_tree as ast

_DIRECTIONS = {("pan", -1): "left", ("pan", 1): "right", ("tilt", 1): "up", ("tilt", -1): "down"}
_MOVES = (ast.Move, ast.Home, ast.GoToPreset, ast.GoThere, ast.ZoomTo, ast.Track, ast.Back, ast.WhichPreset, ast.FirstWith)
_TEXTS = {ast.Thing: ("text",), ast.Ask: ("question",), ast.Statement: ("predicate", "question")}


@dataclass
class Evidence:
    """What the steps of a plan do.

    Attributes:
        numbers: Every number, without its sign.
        directions: "left", "right", "up" and "down" for turns; both directions of an axis for absolute targets.
        zero_turns: The directions of turns by zero degrees.
        zooms: "in" and "out" for relative changes of the magnification.
        presets: The names of the presets.
        steps: The types of all steps and conditions.
        axes: The axes that move: "pan", "tilt" and "zoom".
        texts: Descriptions and questions; the value is True for a description.
        forbids_moving: Whether the instruction says not to move.
        looks_all_around: Whether a step looks at the whole scene.
    """

    numbers: list[float] = field(default_factory=list)
    directions: set[str] = field(default_factory=set)
    zero_turns: set[str] = field(default_factory=set)
    zooms: set[str] = field(default_factory=set)
    presets: set[str] = field(default_factory=set)
    steps: set[type[Any]] = field(default_factory=set)
    axes: set[str] = field(default_factory=set)
    texts: dict[str, bool] = field(default_factory=dict)
    forbids_moving: bool = False
    looks_all_around: bool = False

    def has(self, *kinds: type[Any]) -> bool:
        """Return whether the plan has a step of one of the types."""
        return bool(self.steps & set(kinds))

    @property
    def moves(self) -> bool:
        """Whether a step of the plan moves the camera."""
        return self.has(*_MOVES)


def evidence_of(steps: Sequence[ast.Step]) -> Evidence:
    """Return the evidence of all steps, including those in loops and branches."""
    found = Evidence()
    for node in _nodes(steps):
        found.steps.add(type(node))
        found.looks_all_around |= isinstance(node, ast.Sweep) or getattr(node, "view", None) == "full"
        for name in _TEXTS.get(type(node), ()):
            if text := getattr(node, name):
                found.texts[text] = isinstance(node, ast.Thing)
        _add_node(found, node)
    return found


def _nodes(value: Any) -> Iterator[Any]:
    """Yield every dataclass instance in a tree of steps."""
    if isinstance(value, tuple | list):
        for item in value:
            yield from _nodes(item)
    elif is_dataclass(value):
        yield value
        for each in fields(value):
            yield from _nodes(getattr(value, each.name))


def _add_node(found: Evidence, node: Any) -> None:
    match node:
        case ast.Turn(axis=axis, sign=sign, amount=amount):
            backwards = amount is not None and amount.degrees < 0
            found.axes.add(axis)
            is_turn = amount is None or amount.kind != "degrees" or amount.degrees
            (found.directions if is_turn else found.zero_turns).add(_DIRECTIONS[axis, -sign if backwards else sign])
            if node.steps:
                found.numbers.append(node.steps)
        case ast.Amount(kind=kind, degrees=degrees, factor=factor):
            found.numbers += [abs(degrees)] if kind == "degrees" else []
            found.numbers += [factor] if factor != 1 else []
        case ast.Aim(axis=axis, value=value):
            found.axes.add(axis)
            found.numbers.append(abs(value))
            found.directions |= {word for (turned, _), word in _DIRECTIONS.items() if turned == axis}
        case ast.Zoom():
            _add_zoom(found, node)
        case ast.Forbid(any_move=True):
            found.forbids_moving = True
        case ast.PresetRef(name=name):
            found.presets.add(name)
        case ast.Snap(times=times) | ast.Repeat(times=times):
            found.numbers.append(times)
        case ast.Track(seconds=seconds):
            found.numbers.append(seconds)
        case ast.Quantity(number=number):
            found.numbers.append(number)
        case ast.Bound(moves=moves, degrees=degrees):
            found.numbers += [value for value in (moves, degrees) if value is not None]
        case ast.AtIntervals(degrees=degrees):
            found.numbers.append(degrees)
        case _:
            pass


def _add_zoom(found: Evidence, zoom: ast.Zoom) -> None:
    found.axes.add("zoom")
    if zoom.kind in {"in", "out"}:
        found.zooms.add(zoom.kind)
        return
    enlarges = zoom.value > 0 if zoom.kind == "percent" else zoom.value > 1
    found.zooms.add("in" if enlarges else "out")
    found.numbers.append(abs(zoom.value))
