"""Split a turn that is made in steps, or join one that is not: "90 degrees in 30 degree steps", "4 x 7.5 degrees in one move"."""

from __future__ import annotations

import math
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import Bound, Loop, Move, Repeat, Step, Turn, Unclear
from scope_ptz.planner.grammar.lexing.lexer import Lexeme

_ONE_OR_MORE = Unclear("Shall I do that in one move, or in several?")


def _step_size(step: Step) -> Turn | None:
    """Return the turn of a move if it has a step size; otherwise None."""
    if isinstance(step, Move):
        return next((p for p in step.parts if isinstance(p, Turn) and p.step), None)
    return None


def split_into_steps(step: Step) -> Step:
    """Split a move with a step size: "90 degrees in 30 degree steps" is three moves, "in 30 degree steps" alone is one."""
    turn = _step_size(step)
    if turn is None or turn.step is None or not isinstance(step, Move):
        return step
    single = Move(
        tuple(replace(p, amount=p.step, step=None, steps=None) if isinstance(p, Turn) and p.step else p for p in step.parts),
        step.has_verb,
    )
    total = 0.0
    if turn.amount and turn.amount.kind == "degrees":
        total = abs(turn.amount.degrees)
    elif turn.amount and turn.amount.kind == "limit":
        total = 358.0 if turn.axis == "pan" else 90.0
    times = turn.steps or math.ceil(round(total / turn.step.degrees, 6)) if turn.step.degrees else 0
    return Repeat((single,), min(times, 24)) if times > 1 else single


def split_loop_into_steps(step: Loop | Repeat) -> Step:
    """Split the move with a step size in a loop: each iteration makes one step, and the whole move limits the loop."""
    turn = _step_size(step.body[0])
    if turn is None or not isinstance(step.body[0], Move):
        return step
    inner = split_into_steps(step.body[0])
    single = inner.body[0] if isinstance(inner, Repeat) else inner
    body = (single, *step.body[1:])
    if isinstance(step, Loop) and isinstance(inner, Repeat) and step.bound is None:
        return Loop(body, step.until, Bound(moves=inner.times), step.otherwise)
    return replace(step, body=body) if isinstance(step, Loop) else Repeat(body, step.times)


def is_single_move(lexeme: Lexeme) -> bool:
    """Return whether a lexeme asks for one move, as in "in a single move" and "in one go", unlike "at the same time"."""
    return lexeme.has("ATSAMETIME") and not {"one", "single"}.isdisjoint(lexeme.word.split("_"))


def in_single_move(step: Step) -> Step:
    """Return a repeated turn as one turn by the whole angle: "pan left 4 x 7.5 degrees in a single move" is 30 degrees."""
    if _step_size(step) is not None:
        return _ONE_OR_MORE
    if not (isinstance(step, Repeat) and all(isinstance(inner, Move) for inner in step.body)):
        return step
    move = step.body[0]
    if len(step.body) > 1 or not isinstance(move, Move):
        return _ONE_OR_MORE
    turns = [part for part in move.parts if isinstance(part, Turn)]
    amounts = [turn.amount for turn in turns if turn.amount is not None and turn.amount.kind == "degrees"]
    if len(amounts) < len(move.parts) or any(turn.step for turn in turns):
        return _ONE_OR_MORE
    whole = (
        replace(turn, amount=replace(amount, degrees=amount.degrees * step.times))
        for turn, amount in zip(turns, amounts, strict=True)
    )
    return replace(move, parts=tuple(whole))
