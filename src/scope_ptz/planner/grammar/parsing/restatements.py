"""Recognise moves that may only restate the previous move: "pan left 10, ten degrees to the left"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import (
    Amount,
    Move,
    Step,
    Turn,
    Zoom,
)
from scope_ptz.planner.grammar.parsing.parts.clause import AS_FAR_AS, Clause
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

_HALF_TURN_DEG = 180.0


def repeats_previous_move(before: Step | None, steps: Sequence[Step]) -> bool:
    """Return whether a move goes the same way as the previous move: "pan left 10, ten degrees to the left".

    It may just be a rewording of that move, so it must not be carried out as a second one.
    """
    if not (isinstance(before, Move) and len(steps) == 1 and isinstance(steps[0], Move)):
        return False
    return bool(_axis_directions(before) & _axis_directions(steps[0]))


def is_reason_for_zoom(before: Step | None, steps: Sequence[Step], clause: Clause) -> bool:
    """Return whether a clause only says why the previous move zooms: "zoom out a lot, I want the wide view"."""
    if not (clause.lexemes and clause.lexemes[0].has("WRAPPER") and clause.lexemes[0].word.endswith(("want", "need"))):
        return False
    if not (isinstance(before, Move) and len(steps) == 1 and isinstance(steps[0], Move)):
        return False
    limits = [part.kind for part in steps[0].parts if isinstance(part, Zoom)]
    directions = {"in" if inwards else "out" for axis, inwards in _axis_directions(before) if axis == "zoom"}
    return len(limits) == len(steps[0].parts) == 1 and limits[0] in directions


def repeats_previous_size(move: Move, clause: Clause) -> bool:
    """Return whether a clause only repeats how far the previous move goes: "a hair to the right, just slightly"."""
    half_turn = full_match("(FILLER|AMOUNTISH|DET|LIMIT)* (?P<number>NUM) DEG? (FILLER)*", clause.lexemes)
    if half_turn is not None and half_turn["number"][0].value == _HALF_TURN_DEG:
        return move.parts == (Turn("pan", 1, Amount("degrees", _HALF_TURN_DEG)),)  # "turn around, a full 180"
    at_limit = any(isinstance(part, Zoom) and part.kind in {"in", "out"} for part in move.parts)
    at_limit = at_limit or any(isinstance(part, Turn) and part.amount == Amount("limit") for part in move.parts)
    if at_limit and full_match(f"(FILLER)* ({AS_FAR_AS}|LIMIT) (FILLER)*", clause.lexemes):
        return True  # "zoom right in, as far as it goes"
    match = full_match("(FILLER|AMOUNTISH)* ((?P<little>LITTLE)|(?P<lot>LOT)) (in fact|FILLER)*", clause.lexemes)
    if match is None:
        return False
    kind, factors = ("little", (1.25, 0.8)) if match.has("little") else ("lot", (4.0, 0.25))
    return all(
        part.value in factors if isinstance(part, Zoom) else isinstance(part, Turn) and part.amount == Amount(kind)  # type: ignore[arg-type]
        for part in move.parts
    )


def _axis_directions(move: Move) -> set[tuple[str, bool]]:
    """Return the axes that a move changes by an amount, each with its direction."""
    directions: set[tuple[str, bool]] = {(part.axis, part.sign > 0) for part in move.parts if isinstance(part, Turn)}
    for part in move.parts:
        if isinstance(part, Zoom) and part.kind in {"factor", "percent"}:
            directions.add(("zoom", part.value > (1 if part.kind == "factor" else 0)))
    return directions
