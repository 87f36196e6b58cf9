"""Split a turn that is made in steps: "90 degrees in 30 degree steps" is three turns."""

from __future__ import annotations

import math
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Bound,
    Loop,
    Move,
    Repeat,
    Step,
    Turn,
)


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
