"""Combine neighbouring steps of a sentence: moves joined by "and", and steps such as "each time" with those that they refer to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    Aim,
    Ask,
    AtIntervals,
    AtPlaces,
    Back,
    BeforeAfter,
    Between,
    CompareWithBefore,
    Count,
    DoAgain,
    EachTime,
    FirstWith,
    Further,
    GoToPreset,
    Home,
    Linked,
    Loop,
    Move,
    Part,
    PresetRef,
    Read,
    Repeat,
    Rescope,
    SameAt,
    Snap,
    Step,
    Track,
    Turn,
    Unclear,
    WhichPreset,
    Zoom,
    ZoomTo,
)
from scope_ptz.planner.grammar.parsing.repeated_amounts import add_back_by, add_back_towards, add_further, with_same_amounts
from scope_ptz.planner.grammar.parsing.repetitions import (
    add_again,
    add_at_intervals,
    add_each_time,
    interleaved,
    steps_at_last_place,
)
from scope_ptz.planner.grammar.parsing.turns_in_steps import split_into_steps, split_loop_into_steps

_CONTRADICTION = "Those two directions contradict each other. Which way shall I turn?"


def compose(linked: Sequence[Linked], before: Sequence[Step]) -> list[Step]:
    """Return the steps of a sentence combined with the steps before it."""
    out = list(before)
    for item in linked:
        _add_step(out, item.link, item.step)
    return out


def _add_step(out: list[Step], link: str, step: Step) -> None:
    """Append a step to the previous steps, or combine it with them."""
    if isinstance(step, Move):
        step = with_same_amounts(step, out)
        if (
            isinstance(step, Move)
            and out
            and step == out[-1]
            and all(isinstance(part, Zoom) and part.kind in {"in", "out"} for part in step.parts)
        ):
            return  # "out all the way, widest angle"
    if isinstance(step, Move) and out and isinstance(out[-1], Move) and link in {",", "and"}:
        step = _as_aims_after(out[-1], step)
    if isinstance(step, Move) and out and isinstance(out[-1], Move) and link not in {".", "then"} and _restates(out[-1], step):
        out.append(Unclear("Is that part of the same move, or another one? Please give each move its amount."))
        return
    if out and isinstance(out[-1], Rescope) and isinstance(step, Count | Ask | Read) and step.view in (None, out[-1].view):
        out[-1] = replace(step, view=out[-1].view)  # "full view. Count the vans."
        return
    if _add_modifier(out, link, step):
        return
    last = out[-1] if out else None
    if last is not None and (joined := _joined_to_last(last, link, step)) is not None:
        out[-1:] = joined
    elif isinstance(step, Loop | Repeat):
        out.append(split_loop_into_steps(step))
    elif isinstance(step, GoToPreset) and step.how == "bare" and link == "and" and isinstance(last, Ask):
        out.append(
            Unclear("I can look at one place and then the other, but I cannot answer that for both at once. What shall I look for?")
        )
    else:
        out.append(split_into_steps(step))


def _add_modifier(out: list[Step], link: str, step: Step) -> bool:
    """Apply a step that modifies or repeats the previous steps. Return False for any other step, without applying it."""
    last = out[-1] if out else None
    match step:
        case EachTime():
            add_each_time(out, step)
        case Between():
            out[-1:] = interleaved(last, step.body)
        case AtIntervals():
            add_at_intervals(out, step)
        case Rescope() if link == "," and isinstance(last, Count | Ask) and last.view in (None, step.view):
            out[-1] = replace(last, view=step.view)  # "how many people are there, everywhere?"
        case Rescope(view="current") if isinstance(last, Snap):
            pass  # "a picture, current framing": a picture always shows the current view
        case Rescope():
            out.append(replace(last, view=step.view) if isinstance(last, Count | Ask) else step)  # the next step may be a count
        case CompareWithBefore():
            _compare_with_before(out, step)
        case DoAgain() if out:
            add_again(out, step)
        case Further():
            add_further(out, step)
        case Back() if step.amount is not None:
            add_back_by(out, step.amount)
        case Back() if step.turn is not None:
            add_back_towards(out, step.turn)
        case WhichPreset(places=()) if len(visited := _last_visited(out)) > 1:
            out[-len(visited) :] = [replace(step, places=visited)]  # "go to the gate, then the yard, and say which has more cars"
        case FirstWith(places=places) if places and (visited := _last_visited(out)):
            out[-len(visited) :] = [
                replace(step, places=(*visited, *places))
            ]  # "visit gate, then yard, and stop at the first with a van"
        case SameAt() if out:
            out.append(AtPlaces(step.places, steps_at_last_place(out)))
        case _:
            return False
    return True


def _as_aims_after(last: Move, step: Move) -> Move:
    """Return turns by signed angles as absolute targets after an absolute target of another axis: "pan to 34, tilt -17"."""
    if not last.parts or not all(isinstance(part, Aim) and part.axis != "zoom" for part in last.parts):
        return step
    aimed = {axis_of(part) for part in last.parts}
    aims = tuple(
        Aim(part.axis, part.sign * part.amount.degrees)
        if isinstance(part, Turn) and part.is_signed and part.amount and part.axis not in aimed and part.step is None
        else part
        for part in step.parts
    )
    return replace(step, parts=aims)


def _restates(first: Move, second: Move) -> bool:
    """Return whether a move without a verb or an amount may restate the previous one: "6 degrees of tilt, upwards".

    Such a move must not be made as a second move.
    """
    if second.has_verb:
        return False
    is_sized = any(isinstance(p, Aim) or (isinstance(p, Turn) and p.amount) or isinstance(p, Zoom) for p in first.parts)
    unsized = [p for p in second.parts if (isinstance(p, Turn) and p.amount is None and p.step is None) or isinstance(p, Zoom)]
    same = {axis_of(p) for p in first.parts} & {axis_of(p) for p in unsized}
    return is_sized and bool(unsized) and (bool(same) or all(isinstance(p, Turn) for p in unsized))


def _last_visited(steps: Sequence[Step]) -> tuple[PresetRef, ...]:
    """Return the presets that the last steps visit in a row."""
    visited: list[PresetRef] = []
    for step in reversed(steps):
        if not isinstance(step, GoToPreset):
            break
        visited.append(step.ref)
    return tuple(reversed(visited))


def _joined_to_last(last: Step, link: str, step: Step) -> list[Step] | None:
    """Return the steps that replace the last step if the new step belongs to it; None if the new step is separate."""
    if isinstance(step, Repeat) and link in {"and", ","} and _also_repeats_previous(step, last):
        return [Repeat(tuple(compose([Linked(link, s) for s in step.body], [last])), step.times)]
    if isinstance(last, Move):
        return _joined_to_move(last, step) if link == "and" else None
    return _joined_to_places(last, link, step) if isinstance(last, AtPlaces) else None


def _joined_to_move(last: Move, step: Step) -> list[Step] | None:
    """Join a move with the step after "and": another move, or a loop, whose body then begins with the move."""
    if isinstance(step, Loop) and isinstance(step.body[0], Count | Snap | Ask):
        return [split_loop_into_steps(replace(step, body=(last, *step.body)))]
    if isinstance(step, Loop | Repeat) and (verbless := _as_verbless_move(step.body[0])):
        joined = _joined_moves(last, verbless)
        return [replace(step, body=(joined[0], *step.body[1:]))] if len(joined) == 1 else [*joined[:-1], step]
    return _joined_moves(last, step) if isinstance(step, Move) else None


def _joined_to_places(last: AtPlaces, link: str, step: Step) -> list[Step] | None:
    """Add a step to the steps that run at each of several presets."""
    if isinstance(step, AtPlaces) and not step.places and step.body and not last.body:
        return [replace(last, body=step.body)]  # "walk through the presets and take a photo at each of them"
    if isinstance(step, Home | GoToPreset | AtPlaces) or (isinstance(step, Back) and not last.body):
        return None  # "visit every preset and come home"
    if not last.body and (link == "and" or not last.places):
        return [replace(last, body=(step,))]
    if last.body and link == "and":
        return [replace(last, body=tuple(compose([Linked("and", step)], last.body)))]
    if last.is_fronted and last.body and len(last.places) != 1 and link in {",", "then"}:
        if isinstance(step, Move | ZoomTo | Track):
            return [Unclear("Shall I do that at each of them, or only at the last one?")]
        if isinstance(step, Snap | Count | Ask):  # "at each preset zoom out a bit, then take a picture"
            return [replace(last, body=tuple(compose([Linked(link, step)], last.body)))]
    return None


def _also_repeats_previous(step: Repeat, last: Step) -> bool:
    """Return whether "three times" also repeats the previous step: after a comma, or for a picture after a move."""
    is_picture_after_move = isinstance(step.body[-1], Snap) and isinstance(last, Move)
    return (step.group or is_picture_after_move) and not isinstance(last, GoToPreset | Home | Repeat | Loop)


def _as_verbless_move(step: Step) -> Move | None:
    """Return the step if it is a move without a verb, which continues the previous move; otherwise None."""
    return step if isinstance(step, Move) and not step.has_verb else None


def _joined_moves(first: Move, second: Move) -> list[Step]:
    """Join two moves linked by "and". They become one move if their axes differ."""
    axes = [axis_of(p) for p in (*first.parts, *second.parts)]
    if len(set(axes)) == len(axes):
        parts = first.parts if second.has_verb else tuple(_with_shared_amount(p, second.parts) for p in first.parts)
        return [split_into_steps(Move((*parts, *second.parts), first.has_verb))]
    one, other = first.parts[-1], second.parts[0]
    if isinstance(one, Zoom) and isinstance(other, Zoom) and {one.kind, other.kind} == {"in", "out"}:
        return [Unclear("Shall I zoom all the way in, or all the way out?")]
    unspecified = (
        isinstance(one, Turn) and isinstance(other, Turn) and not second.has_verb and (one.amount is None or other.amount is None)
    )
    if unspecified and isinstance(one, Turn) and isinstance(other, Turn) and one.axis == other.axis and one.sign != other.sign:
        return [Unclear(_CONTRADICTION)]
    return [split_into_steps(first), split_into_steps(second)]


def axis_of(part: Part) -> str:
    """Return what a part of a move changes: "pan", "tilt" or "zoom"."""
    return part.axis if isinstance(part, Turn | Aim) else "zoom"


def _with_shared_amount(part: Part, others: tuple[Part, ...]) -> Part:
    """Give a part without an amount the amount of the last part: in "up and left 20", 20 applies to both."""
    last = others[-1]
    if isinstance(part, Turn) and part.amount is None and part.step is None and isinstance(last, Turn):
        return replace(part, amount=last.amount, step=last.step, steps=last.steps)
    return part


def _compare_with_before(out: list[Step], step: CompareWithBefore) -> None:
    """Repeat the last count to compare with it; if there is none, compare the counts before and after the last moves."""
    counts = [s for s in out if isinstance(s, Count)]
    first = next((i + 1 for i in range(len(out) - 1, -1, -1) if not isinstance(out[i], Move | Repeat)), 0)
    moves = tuple(out[first:])
    if counts:
        out.append(replace(counts[-1], things=(step.thing,)) if step.thing.text else counts[-1])
    elif moves and step.thing.text:
        out[first:] = [BeforeAfter(step.thing, moves, step.comparison)]
    else:
        out.append(Unclear("More of what, and than when?"))
