"""Read complaints about the last move: "too much", "not that far", "a bit less", "too close", "too far away"."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.geometry import wrap_pan_deg
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_moves.commands import Command, Continuation
from scope_ptz.planner.grammar.binding.earlier_moves.single_moves import SingleMove, axis_of_way, single_move, towards
from scope_ptz.planner.grammar.execution.camera_history import ANGLE_TOLERANCE_DEG, ZOOM_TOLERANCE, pose_after
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_DEGREE = (
    "(much|much_more|(?P<far>far) ((?P<away>away|off)|(?P<out>OUT))?|(?P<in>close|tight|near)|"
    "(?P<out>wide)|(?P<up>high)|(?P<down>low))"
)
_WAY = "(to|DET)* ((?P<left>LEFT)|(?P<right>RIGHT)|(?P<up>UP)|(?P<down>DOWN)|(?P<in>IN)) (SIDE)?"
_LEAD = (
    "(FILLER|no|nope|oops|wait|hmm|AND|BUT|COMMA|DASH|STOP|that|this|it|SELF|BE|HAVEV|went|turned|moved|zoomed|panned|tilted|"
    "gone|been|still|just|now)*"
)
_WENT = frozenset({"went", "turned", "moved", "zoomed", "gone"})
"""Words that say that the camera went too far, and not that a thing is too far away."""

_HOW = "(LITTLE|LOT|way|a)*"
_END = "(for SELF|FILLER|now|COMMA|STOP|DASH)*"
_OVERSHOOT = (
    f"{_LEAD} ({_HOW} too {_DEGREE}|(bit|a_bit) much|not (quite|so|that|as|too) {_DEGREE}|{_HOW} less {_DEGREE}?) ({_WAY})? {_END}"
)
_STILL = "(FILLER|COMMA|that|it|BE)* still (_)*"
_FURTHER_OR_BACK = "Shall I zoom in further, or out again?"
"""The question about "too far" after a zoom: the zoom went too far, or the thing still is too far away."""

_WAYS = ("left", "right", "up", "down", "in", "out")


def move_after_overshoot(
    lexemes: Sequence[Lexeme], said: str, command: Command | None, turn: PastTurn | None
) -> Continuation | None:
    """Return the move that takes back half of the last change, if the instruction says that the change was too large.

    After a zoom, "too far away" zooms in, and "too far" is asked about.

    Half of a magnification is its square root: after zooming in 4x, the camera zooms out 2x. None for other instructions, and if
    the last command did not change a single axis or not in the direction complained about.

    Args:
        lexemes: The lexemes of the instruction.
        said: The instruction.
        command: The last command that stands; None if there is none.
        turn: The turn of that command.
    """
    match = full_match(_OVERSHOOT, lexemes)
    if match is None or command is None or turn is None or (changed := _change(command, turn)) is None:
        return None
    ways = [way for way in _WAYS if match.has(way)]
    is_second = full_match(_OVERSHOOT, lexemes_of(turn.instruction)) is not None
    if match.has("away"):  # the thing is too far away
        if changed[0].axis != "zoom":
            return None
        return Continuation(changed[1].text if changed[0].way == "out" and not is_second else "zoom in")
    may_be_distance = match.has("far") and any(x.word == "too" for x in lexemes) and not any(x.word in _WENT for x in lexemes)
    if changed[0].axis == "zoom" and may_be_distance and not ways and (is_second or changed[0].way == "in"):
        return Continuation(said, question=_FURTHER_OR_BACK)
    if is_second:
        if full_match(_STILL, lexemes) or (ways and all(way == changed[0].reversed().way for way in ways)):
            return Continuation(changed[0].text)
        way, other = changed[0].way, changed[0].reversed().way
        return Continuation(said, question=f"Shall I {changed[0].axis} {way} further, or {other} again?")
    return Continuation(changed[1].text) if all(way == changed[0].way for way in ways) else None


def _change(command: Command, turn: PastTurn) -> tuple[SingleMove, SingleMove] | None:
    """Return the move that a command made about one axis, and half of it back; None if it moved about no axis or several."""
    move = single_move(command.steps)
    if move is None and len(command.steps) == 1 and isinstance(command.steps[0], ast.ZoomTo):
        move = towards("in")
    start, end = turn.start, pose_after(turn)
    if move is None or start is None or end is None:
        return None
    if move.axis == "zoom":
        factor = end.zoom / start.zoom
        if abs(factor - 1) < ZOOM_TOLERANCE:
            return None
        made = SingleMove("zoom", "in" if factor > 1 else "out", f"{max(factor, 1 / factor):.4g} times")
        return made, SingleMove("zoom", made.reversed().way, f"{math.sqrt(max(factor, 1 / factor)):.3g} times")
    angle_deg = wrap_pan_deg(end.pan_deg - start.pan_deg) if move.axis == "pan" else end.tilt_deg - start.tilt_deg
    if abs(angle_deg) < ANGLE_TOLERANCE_DEG:
        return None
    signs = ("right", "left") if move.axis == "pan" else ("up", "down")
    way = signs[0 if angle_deg > 0 else 1]
    made = SingleMove(axis_of_way(way), way, f"{abs(angle_deg):g} degrees")
    return made, SingleMove(made.axis, made.reversed().way, f"{round(abs(angle_deg) / 2, 2):g} degrees")
