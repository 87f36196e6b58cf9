"""Combine neighbouring steps of a sentence: moves joined by "and", and steps such as "each time" with those that they refer to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Aim,
    Amount,
    Ask,
    AtIntervals,
    AtPlaces,
    Back,
    BeforeAfter,
    Between,
    Bound,
    CompareWithBefore,
    Count,
    DoAgain,
    EachTime,
    FirstWith,
    Further,
    GoToPreset,
    Home,
    If,
    Linked,
    Loop,
    Move,
    Part,
    PresetRef,
    Repeat,
    Rescope,
    SameAt,
    Snap,
    Step,
    Turn,
    Unclear,
    WhichPreset,
    Zoom,
)

_CONTRADICTION = "Those two directions contradict each other. Which way shall I turn?"


def compose(linked: Sequence[Linked], before: Sequence[Step]) -> list[Step]:
    """Return the steps of a sentence combined with the steps before it."""
    out = list(before)
    for item in linked:
        _add(out, item.link, item.step)
    return out


def _add(out: list[Step], link: str, step: Step) -> None:
    """Append a step to the previous steps, or combine it with them."""
    if isinstance(step, Move):
        step = _with_same_amounts(step, out)
        if (
            isinstance(step, Move)
            and out
            and step == out[-1]
            and all(isinstance(part, Zoom) and part.kind in {"in", "out"} for part in step.parts)
        ):
            return  # "out all the way, widest angle"
    if isinstance(step, Move) and out and isinstance(out[-1], Move) and link not in {".", "then"} and _restates(out[-1], step):
        out.append(Unclear("Is that part of the same move, or another one? Please give each move its amount."))
        return
    if _add_modifier(out, link, step):
        return
    last = out[-1] if out else None
    if last is not None and (joined := _joined_to_last(last, link, step)) is not None:
        out[-1:] = joined
    elif isinstance(step, Loop | Repeat):
        out.append(_stepped_loop(step))
    elif isinstance(step, GoToPreset) and step.how == "bare" and link == "and" and isinstance(last, Ask):
        out.append(Unclear("I can look at one place after the other, but not answer that about both. What shall I look for?"))
    else:
        out.append(_stepped(step))


def _add_modifier(out: list[Step], link: str, step: Step) -> bool:
    """Apply a step that modifies or repeats the previous steps. Return False for any other step, without applying it."""
    last = out[-1] if out else None
    match step:
        case EachTime():
            _add_each_time(out, step)
        case Between():
            out[-1:] = _interleaved(last, step.body)
        case AtIntervals():
            _add_at_intervals(out, step)
        case Rescope() if link == "," and isinstance(last, Count | Ask) and last.view in (None, step.view):
            out[-1] = replace(last, view=step.view)  # "how many people are there, everywhere?"
        case Rescope():
            out.append(replace(last, view=step.view) if isinstance(last, Count | Ask) else Unclear("What shall I look for there?"))
        case CompareWithBefore():
            _compare_with_before(out, step)
        case DoAgain() if out:
            _add_again(out, step)
        case Further():
            _add_further(out, step)
        case Back() if step.amount is not None and step.amount.kind in ("degrees", "little", "lot"):
            _add_back_by(out, step.amount)
        case WhichPreset(places=()) if len(visited := _last_visited(out)) > 1:
            out[-len(visited) :] = [replace(step, places=visited)]  # "go to the gate, then the yard, and say which has more cars"
        case FirstWith(places=places) if places and (visited := _last_visited(out)):
            out[-len(visited) :] = [
                replace(step, places=(*visited, *places))
            ]  # "visit gate, then yard, and stop at the first with a van"
        case SameAt():
            out.append(AtPlaces(step.places, _done_at_place(out)))
        case _:
            return False
    return True


def _restates(first: Move, second: Move) -> bool:
    """Return whether a move without a verb and an amount follows one with an amount: "6 degrees of tilt, upwards".

    It may only say the same in other words, so it must not be made as another move.
    """
    if second.has_verb:
        return False
    is_sized = any(isinstance(p, Aim) or (isinstance(p, Turn) and p.amount) or isinstance(p, Zoom) for p in first.parts)
    unsized = [p for p in second.parts if (isinstance(p, Turn) and p.amount is None and p.step is None) or isinstance(p, Zoom)]
    same = {_axis(p) for p in first.parts} & {_axis(p) for p in unsized}
    return is_sized and bool(unsized) and (bool(same) or all(isinstance(p, Turn) for p in unsized))


def _last_visited(steps: Sequence[Step]) -> tuple[PresetRef, ...]:
    """Return the presets that the last steps go to, without anything between them."""
    visited: list[PresetRef] = []
    for step in reversed(steps):
        if not isinstance(step, GoToPreset):
            break
        visited.append(step.ref)
    return tuple(reversed(visited))


def _add_further(out: list[Step], step: Further) -> None:
    """Repeat the last turn by another amount."""
    last = out[-1] if out else None
    turn = next((p for p in reversed(last.parts) if isinstance(p, Turn)), None) if isinstance(last, Move) else None
    out.append(Move((replace(turn, amount=step.amount),)) if turn else Unclear("Which way shall I turn, and how far?"))


def _add_back_by(out: list[Step], amount: Amount) -> None:
    """Turn back by an amount ("then go back 20 degrees"). It is clear only after a turn about one axis."""
    last = out[-1] if out else None
    turns = [p for p in last.parts if isinstance(p, Turn)] if isinstance(last, Move) else []
    if len(turns) == 1:
        out.append(Move((Turn(turns[0].axis, -turns[0].sign, amount),)))
    else:
        out.append(Unclear("Which way shall I turn back?"))


def _joined_to_last(last: Step, link: str, step: Step) -> list[Step] | None:
    """Return the steps that replace the last step if the new step belongs to it; None if the new step is separate."""
    if isinstance(step, Repeat) and link in {"and", ","} and _covers_before(step, last):
        return [Repeat(tuple(compose([Linked(link, s) for s in step.body], [last])), step.times)]
    if isinstance(last, Move):
        return _joined_to_move(last, step) if link == "and" else None
    return _joined_to_places(last, link, step) if isinstance(last, AtPlaces) else None


def _joined_to_move(last: Move, step: Step) -> list[Step] | None:
    """Join a move with the step after its "and": another move, or a loop that then includes the move."""
    if isinstance(step, Loop) and isinstance(step.body[0], Count | Snap | Ask):
        return [_stepped_loop(replace(step, body=(last, *step.body)))]
    if isinstance(step, Loop | Repeat) and (verbless := _verbless(step.body[0])):
        joined = _joined(last, verbless)
        return [replace(step, body=(joined[0], *step.body[1:]))] if len(joined) == 1 else [*joined[:-1], step]
    return _joined(last, step) if isinstance(step, Move) else None


def _joined_to_places(last: AtPlaces, link: str, step: Step) -> list[Step] | None:
    """Add a step to the steps that run at each of several presets."""
    if isinstance(step, Home | GoToPreset | AtPlaces) or (isinstance(step, Back) and not last.body):
        return None  # "visit every preset and come home"
    if not last.body and (link == "and" or not last.places):
        return [replace(last, body=(step,))]
    if last.body and link == "and":
        return [replace(last, body=tuple(compose([Linked("and", step)], last.body)))]
    return None


def _covers_before(step: Repeat, last: Step) -> bool:
    """Return whether "three times" also covers the previous step: after a comma, or for a picture after a move."""
    is_picture_after_move = isinstance(step.body[-1], Snap) and isinstance(last, Move)
    return (step.group or is_picture_after_move) and not isinstance(last, GoToPreset | Home | Repeat | Loop)


def _verbless(step: Step) -> Move | None:
    """Return the step if it is a move without a verb, which continues the previous move; otherwise None."""
    return step if isinstance(step, Move) and not step.has_verb else None


def _joined(first: Move, second: Move) -> list[Step]:
    """Join two moves with "and" between them, into one move if their axes differ."""
    axes = [_axis(p) for p in (*first.parts, *second.parts)]
    if len(set(axes)) == len(axes):
        parts = first.parts if second.has_verb else tuple(_shared(p, second.parts) for p in first.parts)
        return [_stepped(Move((*parts, *second.parts), first.has_verb))]
    one, other = first.parts[-1], second.parts[0]
    unspecified = (
        isinstance(one, Turn) and isinstance(other, Turn) and not second.has_verb and (one.amount is None or other.amount is None)
    )
    if unspecified and isinstance(one, Turn) and isinstance(other, Turn) and one.axis == other.axis and one.sign != other.sign:
        return [Unclear(_CONTRADICTION)]
    return [_stepped(first), _stepped(second)]


def _axis(part: Part) -> str:
    return part.axis if isinstance(part, Turn | Aim) else "zoom"


def _shared(part: Part, others: tuple[Part, ...]) -> Part:
    """Return a part that has no amount with the amount of the last part: in "up and left 20", 20 applies to both."""
    last = others[-1]
    if isinstance(part, Turn) and part.amount is None and part.step is None and isinstance(last, Turn):
        return replace(part, amount=last.amount, step=last.step, steps=last.steps)
    return part


def _step_size(step: Step) -> Turn | None:
    """Return the turn of a move that has a step size; None if there is none."""
    if isinstance(step, Move):
        return next((p for p in step.parts if isinstance(p, Turn) and p.step), None)
    return None


def _stepped(step: Step) -> Step:
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


def _stepped_loop(step: Loop | Repeat) -> Step:
    """Split the move with a step size in a loop: each iteration makes one step, and the whole move limits the loop."""
    turn = _step_size(step.body[0])
    if turn is None or not isinstance(step.body[0], Move):
        return step
    inner = _stepped(step.body[0])
    single = inner.body[0] if isinstance(inner, Repeat) else inner
    body = (single, *step.body[1:])
    if isinstance(step, Loop) and isinstance(inner, Repeat) and step.bound is None:
        return Loop(body, step.until, Bound(moves=inner.times), step.otherwise)
    return replace(step, body=body) if isinstance(step, Loop) else Repeat(body, step.times)


def _add_each_time(out: list[Step], step: EachTime) -> None:
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
    out.extend(step.body)


def _done_at_place(out: list[Step]) -> tuple[Step, ...]:
    """Return the steps that follow the last move to a preset or home."""
    if out and isinstance(out[-1], AtPlaces):
        return out[-1].body
    return tuple(out[max((i + 1 for i, s in enumerate(out) if isinstance(s, GoToPreset | Home)), default=0) :])


def _add_again(out: list[Step], step: DoAgain) -> None:
    """Repeat the steps that follow the last move to a preset or home.

    If that move is the last step ("count the cars, go to gate and do that again"), run the steps before it at the new place.
    """
    if isinstance(out[-1], GoToPreset) and len(out) > 1:
        out.extend(_done_at_place(out[:-1]))
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


def _interleaved(step: Step | None, between: tuple[Step, ...]) -> list[Step]:
    """Return a repeated step with other steps between its repetitions."""
    times = step.times if isinstance(step, Snap | Repeat) else 1
    if step is None or times < 2:
        return [*([step] if step else []), Unclear("How many times shall I do that?")]
    single = step.body if isinstance(step, Repeat) else (replace(step, times=1),) if isinstance(step, Snap) else (step,)
    return [*single, Repeat((*between, *single), times - 1)]


def _add_at_intervals(out: list[Step], step: AtIntervals) -> None:
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
            _interleaved(body, (Move((step_turn,)),)) if fixed else [Unclear("Over how many degrees shall I turn, and which way?")]
        )
        return
    total = turn.amount.degrees if turn.amount.kind == "degrees" else 360.0
    times = math.ceil(round(total / step.degrees, 6)) if step.degrees else 1
    single = replace(body, times=1) if isinstance(body, Snap) else body
    out.append(Repeat((Move((step_turn,)), single, *step.body[1:]), max(1, min(times, 24))))


def _compare_with_before(out: list[Step], step: CompareWithBefore) -> None:
    """Count again to compare with the last count; without one, compare the counts before and after the last moves."""
    counts = [s for s in out if isinstance(s, Count)]
    first = next((i + 1 for i in range(len(out) - 1, -1, -1) if not isinstance(out[i], Move | Repeat)), 0)
    moves = tuple(out[first:])
    if counts:
        out.append(replace(counts[-1], things=(step.thing,)) if step.thing.text else counts[-1])
    elif moves and step.thing.text:
        out[first:] = [BeforeAfter(step.thing, moves, step.comparison)]
    else:
        out.append(Unclear("More of what, and than when?"))


def _with_same_amounts(move: Move, before: Sequence[Step]) -> Step:
    """Resolve "by the same amount" to the amount of the last turn."""
    turns = [p for s in before if isinstance(s, Move) for p in s.parts if isinstance(p, Turn)]
    if not any(isinstance(p, Turn) and p.amount and p.amount.kind == "same" for p in move.parts):
        return move
    if not turns:
        return Unclear("The same as what? How far shall I turn?")
    same = turns[-1].amount
    return replace(move, parts=tuple(replace(p, amount=same) if isinstance(p, Turn) and p.amount else p for p in move.parts))
