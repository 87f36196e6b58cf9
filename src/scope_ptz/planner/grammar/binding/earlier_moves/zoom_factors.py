"""Read a magnification without a verb that refers to the last zoom: "3x", "no, 3x", "make it 3x instead", "to 3x"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_moves.commands import Command, Continuation
from scope_ptz.planner.grammar.binding.earlier_moves.single_moves import SingleMove, single_move
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.looks.closeups import FILLS_THE_VIEW
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.rewording.repairs import EDITING

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_FACTOR = (
    rf"(?P<editing>{EDITING})? (it|by|(?P<to>to)|just|only|FILLER)* (?P<number>NUM) ((?P<factor>X)|PERCENT) "
    "(COMMA|INSTEAD|FILLER|STOP)*"
)


def factor_for_last_zoom(lexemes: Sequence[Lexeme], command: Command, turn: PastTurn) -> Continuation | None:
    """Return the zoom that a bare magnification asks for after a zoom; None for other instructions and after other commands.

    The magnification is relative to that before the last zoom: "3x" after "zoom in 2x" zooms in 3 times in all. After a zoom on a
    thing, the camera keeps aiming at the thing. With "to", it is the magnification itself.

    Args:
        lexemes: The lexemes of the instruction.
        command: The last command.
        turn: The turn of that command.
    """
    if len(command.steps) != 1 or (match := full_match(_FACTOR, lexemes)) is None:
        return None
    number = match["number"][0].value
    said = f"{number:g} times"
    if match.has("to") and match.has("factor") and number > 0 and _is_zoom(command.steps[0]):
        return Continuation(f"zoom to {number:g}x", corrects=match.has("editing") and not isinstance(command.steps[0], ast.ZoomTo))
    if isinstance(command.steps[0], ast.ZoomTo):
        if not match.has("factor") or turn.start is None or number <= 0:
            return Continuation(said, question=FILLS_THE_VIEW) if match.has("editing") else None
        return Continuation(f"zoom to {turn.start.zoom * number:g}x")
    move = single_move(command.steps)
    if match.has("editing") or not match.has("factor") or number <= 0:
        return None  # corrections of other moves are read together with those of turns
    if move is not None and move.axis == "zoom":
        if move.way == "out":
            return Continuation(said, question=f"Shall I zoom in {number:g}x, or zoom out {number:g}x?")
        return Continuation(SingleMove("zoom", "in", said).text, corrects=True)
    return Continuation(f"zoom to {number:g}x") if _is_zoom_to_value(command.steps[0]) else None


def _is_zoom(step: ast.Step) -> bool:
    """Return whether a step only changes the magnification, or zooms in on a thing."""
    move = single_move((step,))
    return isinstance(step, ast.ZoomTo) or (move is not None and move.axis == "zoom") or _is_zoom_to_value(step)


def _is_zoom_to_value(step: ast.Step) -> bool:
    """Return whether a step only zooms to a stated magnification."""
    if not isinstance(step, ast.Move) or len(step.parts) != 1:
        return False
    part = step.parts[0]
    return isinstance(part, ast.Aim) and part.axis == "zoom"
