"""Read instructions that continue or take back an undo: "undo" and then "one more time", "redo"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.binding.earlier_moves.commands import Command, Continuation, standing_command
from scope_ptz.planner.grammar.execution.camera_history import position_history
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_EDGE = "(FILLER|AND|THEN|now|no|COMMA|STOP|DASH)*"
_AGAIN = f"{_EDGE} AGAINWORD {_EDGE}"
_BACK_AGAIN = f"{_EDGE} (go_back|take_me_back|(go|come|CARRY|TURN|take) (me|us|it|CAMERA)? BACK) AGAINWORD {_EDGE}"
_REDO = f"{_EDGE} (redo|redo_that|redo_it|redo (DET|last|move|it|that|command)+|UNDO (DET)? UNDO) {_EDGE}"
_RETURN_TRIP = "and back again"
_NOTHING_TO_REDO = "Nothing was taken back just before, so I have nothing to redo. What shall I do?"


def continued_return(
    lexemes: Sequence[Lexeme], said: str, commands: Sequence[Command], conversation: Sequence[PastTurn]
) -> Continuation | None:
    """Return what "again" or "redo" stands for after the camera was put back; None for other instructions.

    "Again" and "go back again" take back one command more, if there is one. "Redo" puts back what was taken back; when nothing was,
    it repeats the last command.

    Args:
        lexemes: The lexemes of the instruction.
        said: The instruction.
        commands: The commands of the latest turns, oldest first.
        conversation: These turns.
    """
    last = next((command for command in reversed(commands) if command.effect != "nothing"), None)
    is_back = last is not None and last.effect == "returned"
    if full_match(_REDO, lexemes):
        if is_back:
            return Continuation(_RETURN_TRIP)
        return Continuation("again") if standing_command(commands) else Continuation(said, question=_NOTHING_TO_REDO)
    if last is None or not is_back:
        return None
    if full_match(_BACK_AGAIN, lexemes):
        return Continuation("go back")
    if not full_match(_AGAIN, lexemes):
        return None
    has_earlier = bool(position_history(conversation, [command.effect for command in commands], None).earlier)
    return Continuation(last.text) if has_earlier else None
