"""Apply steps that say how often or where others are repeated: "each time", "again", "between each", "every 20 degrees"."""

from __future__ import annotations

import math
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Amount,
    AtIntervals,
    AtPlaces,
    DoAgain,
    EachTime,
    GoToPreset,
    Home,
    If,
    Loop,
    Move,
    Repeat,
    Snap,
    Step,
    Turn,
    Unclear,
)
from scope_ptz.planner.grammar.parsing.turns_in_steps import split_into_steps


def add_each_time(out: list[Step], step: EachTime) -> None:
    """Add steps to run after every move of the previous steps."""
    if out and isinstance(out[-1], Snap) and out[-1].times > 1:
        out[-1] = Repeat((replace(out[-1], times=1), *step.body), out[-1].times)  # "five shots, tilting up 2 degrees after each"
        return
    for i in range(len(out) - 1, -1, -1):
        target = out[i]
        if isinstance(target, Repeat | Loop | AtPlaces):
            out[i] = replace(target, body=(*target.body, *step.body))
            return
        if isinstance(target, GoToPreset):
            first = i
            while first and isinstance(out[first - 1], GoToPreset):
                first -= 1
            out[first:] = [s for place in out[first:] for s in (place, *step.body)]
            return
    out.extend(split_into_steps(each) for each in step.body)


def steps_at_last_place(out: list[Step]) -> tuple[Step, ...]:
    """Return the steps that follow the last move to a preset or home."""
    if out and isinstance(out[-1], AtPlaces):
        return out[-1].body
    return tuple(out[max((i + 1 for i, s in enumerate(out) if isinstance(s, GoToPreset | Home)), default=0) :])


def add_again(out: list[Step], step: DoAgain) -> None:
    """Repeat the steps that follow the last move to a preset or home.

    If that move is the last step ("count the cars, go to gate and do that again"), run the steps before it at the new place.
    """
    if isinstance(out[-1], GoToPreset) and len(out) > 1:
        out.extend(steps_at_last_place(out[:-1]))
        return
    if isinstance(out[-1], Repeat) and step.times is None and len(out) == 1:
        out[-1] = replace(out[-1], times=out[-1].times + 1)  # "right 10, again, again"
        return
    first = max((i + 1 for i, s in enumerate(out) if isinstance(s, GoToPreset | Home)), default=0)
    first = first if first < len(out) else 0
    body = tuple(out[first:])
    if any(isinstance(s, If | Unclear) for s in body) and step.times is None:
        body = body[-1:]
    times = (step.times or 1) + (1 if step.more or step.times is None else 0)
    out[first:] = [Repeat(body, times)]


def interleaved(step: Step | None, between: tuple[Step, ...]) -> list[Step]:
    """Return a repeated step with other steps between its repetitions."""
    times = step.times if isinstance(step, Snap | Repeat) else 1
    if step is None or times < 2:
        return [*([step] if step else []), Unclear("How many times shall I do that?")]
    single = step.body if isinstance(step, Repeat) else (replace(step, times=1),) if isinstance(step, Snap) else (step,)
    return [*single, Repeat((*between, *single), times - 1)]


def add_at_intervals(out: list[Step], step: AtIntervals) -> None:
    """Add steps to run at regular angular intervals during a turn."""
    move = step.move
    if move is None and out and isinstance(last := out[-1], Move) and any(isinstance(p, Turn) for p in last.parts):
        move = last
        out.pop()
    turn = next((p for p in move.parts if isinstance(p, Turn)), None) if move else None
    body = step.body[0]
    step_turn = Turn(turn.axis if turn else "pan", turn.sign if turn else 1, Amount("degrees", step.degrees))
    if turn is None or turn.amount is None:
        fixed = isinstance(body, Snap) and body.times > 1
        out.extend(
            interleaved(body, (Move((step_turn,)),)) if fixed else [Unclear("Over how many degrees shall I turn, and which way?")]
        )
        return
    total = turn.amount.degrees if turn.amount.kind == "degrees" else 360.0
    times = math.ceil(round(total / step.degrees, 6)) if step.degrees else 1
    single = replace(body, times=1) if isinstance(body, Snap) else body
    out.append(Repeat((Move((step_turn,)), single, *step.body[1:]), max(1, min(times, 24))))
