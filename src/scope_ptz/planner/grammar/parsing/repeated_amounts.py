"""Resolve amounts that refer to the previous turn: "another 10", "half of that back", "by the same amount"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Amount,
    Ask,
    Count,
    Further,
    Move,
    Snap,
    Step,
    Turn,
    Unclear,
)


def add_further(out: list[Step], step: Further) -> None:
    """Repeat the last turn with a new amount."""
    last = out[-1] if out else None
    turn = next((p for p in reversed(last.parts) if isinstance(p, Turn)), None) if isinstance(last, Move) else None
    out.append(Move((replace(turn, amount=step.amount),)) if turn else Unclear("Which way shall I turn, and how far?"))


def add_back_by(out: list[Step], amount: Amount) -> None:
    """Turn back by an amount ("then go back 20 degrees"). This is unambiguous only after a turn about one axis."""
    last = out[-1] if out else None
    turns = [p for p in last.parts if isinstance(p, Turn)] if isinstance(last, Move) else []
    turned = _multiple_of(turns[0], amount) if len(turns) == 1 else None
    if turned is not None:
        out.append(Move((Turn(turned.axis, -turned.sign, turned.amount),)))
    else:
        out.append(Unclear("Which way shall I turn back, and how far?"))


def add_back_towards(out: list[Step], turn: Turn) -> None:
    """Turn towards one side again ("tilt up 20, is it open?, come back down"), as far as the last move turned away from it."""
    last = next((s for s in reversed(out) if not isinstance(s, Snap | Count | Ask)), None)
    turns = [p for p in last.parts if isinstance(p, Turn) and p.axis == turn.axis] if isinstance(last, Move) else []
    away = turns[0] if len(turns) == 1 and turns[0].sign == -turn.sign and not turns[0].step else None
    has_amount = away is not None and away.amount is not None and away.amount.kind != "limit"
    out.append(Move((replace(turn, amount=away.amount) if away is not None and has_amount else turn,)))


def _multiple_of(turn: Turn, amount: Amount) -> Turn | None:
    """Return a turn with a new amount, which may be a multiple of its own; None if its own cannot be multiplied."""
    if amount.kind != "same":
        return replace(turn, amount=amount)
    own = turn.amount or Amount()
    if amount.factor != 1 and (own.kind == "limit" or turn.step):
        return None
    return replace(turn, amount=replace(own, factor=own.factor * amount.factor))


def with_same_amounts(move: Move, before: Sequence[Step]) -> Step:
    """Resolve "by the same amount" and "half as much" to the amount of the last turn."""
    same = next((p.amount for p in move.parts if isinstance(p, Turn) and p.amount and p.amount.kind == "same"), None)
    if same is None:
        return move
    last = next((s for s in reversed(before) if not isinstance(s, Snap | Count | Ask)), None)
    moves = [s for s in before if isinstance(s, Move)] if same.factor == 1 else [last] if isinstance(last, Move) else []
    turns = [p for s in moves for p in s.parts if isinstance(p, Turn)]
    turned = _multiple_of(turns[-1], same) if turns and (same.factor == 1 or len(turns) == 1) else None
    if turned is None:
        return Unclear("The same as what? How far shall I turn?")
    return replace(
        move, parts=tuple(replace(p, amount=turned.amount) if isinstance(p, Turn) and p.amount else p for p in move.parts)
    )
