"""Parse a clause that turns the camera.

The words for amounts, steps and directions are found wherever they occur. Every other word must be one that adds nothing, such as
an article or "the camera"; otherwise the clause is not a turn.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.planner.grammar.instruction_tree import Aim, Amount, Further, Move, Part, Repeat, Step, Turn, Unclear
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.moves.special_turns import AXIS_TARGET, special_turn
from scope_ptz.planner.grammar.parsing.moves.turn_words import (
    ALLOWED_IN_TURNS,
    AXES,
    TURN_GERUNDS,
    TURN_VERBS,
    TurnParts,
    find_parts,
)
from scope_ptz.planner.grammar.parsing.parts.clause import DANGLING, DIRECTIONS, NotUnderstoodError
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search

HasClass = Callable[..., bool]
"""Returns whether any word of a turn, besides its amounts and directions, belongs to one of the given classes."""

_UNKNOWN_CARRIER = "FREE (it|her|him|DET CAMERA|DET VIEWNOUN|CAMERA)"
"""An unknown verb whose object is the camera, and which must therefore mean to move it: "lob it 15 degrees to the left"."""

_OPPOSED_VERBS = frozenset({
    "avoid", "ban", "cancel", "deny", "dislike", "forbid", "forget", "hate", "ignore", "miss", "omit", "oppose", "postpone",
    "prevent", "prohibit", "refuse", "reject", "resist", "skip", "suppress", "withhold",
})  # fmt: skip

_UNCLEAR_WAY = Unclear("Which way shall I turn, and how far?")
_CONTRADICTION = Unclear("Those two directions contradict each other. Which way shall I turn?")


def turn_step(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that turns the camera; None if the clause is about something else.

    Raises:
        NotUnderstoodError: The clause turns the camera, but has words that are not accounted for.
    """
    if not _is_about_turning(lexemes):
        return None
    if special := special_turn(lexemes):
        return special
    found, allowed, unread = find_parts(lexemes)
    has_verb = any(x.has(*TURN_VERBS, *TURN_GERUNDS, *(f"{verb}-ED" for verb in TURN_VERBS), "REVERSE") for x in lexemes)
    if not has_verb:  # "the one on the right" is not a turn
        unread += [
            x for x in allowed if x.word in {"on", "at", "in", "with", "across", "along", "is", "are", "that", "one", "of", "into"}
        ]
    unread += [x for x in lexemes if x.word == "one" and not match_start("one DEG", lexemes[lexemes.index(x) :])]
    named = search("CAMERA (?P<number>NUM)(?! (DEG|X))", lexemes)
    if named is not None and not search("DET CAMERA NUM", lexemes):
        unread += named["number"]  # "camera 2 left" is about another camera, unlike "turn the camera 20 left"
    unread += [x for x in lexemes if x.word == "any"]  # "any left?" is not a turn
    if lexemes[-1].word in DANGLING and not found.directions:
        unread.append(lexemes[-1])
    if unread == [lexemes[0]] and found.directions and found.amounts and _moves_camera(lexemes):
        unread = []
    if unread:
        raise NotUnderstoodError(unread)
    step = _step(found, allowed, lexemes)
    return Repeat((step,), found.times) if found.times > 1 and isinstance(step, Move) else step


def _moves_camera(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a clause begins with an English verb that is not in the vocabulary and has the camera as its object."""
    verb = lexemes[0].word
    return bool(match_start(_UNKNOWN_CARRIER, lexemes)) and verb_form(verb) == "base" and verb not in _OPPOSED_VERBS


def _is_about_turning(lexemes: Sequence[Lexeme]) -> bool:
    if full_match(rf"(CARRY|AIM|SWITCH|FILLER|CAMERA|DET|GLUE)* (to|at) (ABSOLUTE)? ({AXIS_TARGET})+", lexemes):
        return True
    if any(x.has("EQUALS") for x in lexemes) and full_match(rf"({AXIS_TARGET})+", lexemes):
        return True
    if any(x.has("ZOOM", "ZOOMNOUN", "PERCENT", "ENLARGE", "WIDEN", "HALVE", "PRESET") for x in lexemes):
        return False
    if full_match(
        (
            r"(FILLER|CAMERA|it|LITTLE|LOT|MORE|DET VIEWNOUN|AROUND)* (CARRY|CARRY-ING) (FILLER|CAMERA|it|LITTLE|LOT|"
            r"MORE|DET VIEWNOUN|AROUND)*"
        ),
        lexemes,
    ):
        return True
    return any(
        x.has(
            *DIRECTIONS,
            "PAN",
            "TILT",
            "TURN",
            "PAN-ING",
            "TILT-ING",
            "TURN-ING",
            "AIM",
            "AIM-ING",
            "RAISE",
            "LOWER",
            "REVERSE",
            "LEVEL",
            "CENTREALL",
            "CENTREWORD",
            "PANNOUN",
            "TILTNOUN",
            "HORIZON",
            "VERTICALUP",
            "VERTICALDOWN",
            "COMPASS",
            "DEG",
            "AHEAD",
            "RAISE-ING",
            "LOWER-ING",
            "TURNNOUN",
        )
        for x in lexemes
    ) or (
        not any(x.has("PICTURE") for x in lexemes)
        and all(x.has("NUM", *ALLOWED_IN_TURNS, "SAMEAMOUNT", "LITTLE", "LOT") for x in lexemes)
        and any(x.has("NUM", "LITTLE", "SAMEAMOUNT", "LOT") for x in lexemes)
    )


def _step(found: TurnParts, allowed: Sequence[Lexeme], lexemes: Sequence[Lexeme]) -> Step:
    """Return the step for a turn, given its parts and its other allowed words."""

    def has(*classes: str) -> bool:
        return any(x.has(*classes, *(f"{name}-ING" for name in classes)) for x in allowed)

    has_verb = any(x.has(*TURN_VERBS, *TURN_GERUNDS) and not x.has(*DIRECTIONS) for x in allowed) or (
        len(lexemes) > 1 and has("LOWER")
    )
    directions = list(dict.fromkeys(found.directions))
    axes = {AXES[direction][0] for direction in directions}
    if len(directions) > len(axes):
        return _CONTRADICTION
    said_twice = len(found.amounts) > len(directions) and search(
        "(NUM DEG?|LITTLE|LOT) COMMA (FILLER|MORE)* (NUM|LITTLE|LOT)", lexemes
    )
    if said_twice or any(search(f"{direction} COMMA (FILLER)* {direction}", lexemes) for direction in directions):
        return Unclear("How far shall I turn in all?")  # "left, left, left"
    if search("RIGHT (UP|DOWN)", lexemes) and not search("right (hand|side)", lexemes) and len(found.amounts) < 2:
        return Unclear("Shall I also turn right?")  # "tilt it right down"
    if (has("TILT") and directions and "tilt" not in axes) or (has("PAN") and directions and "pan" not in axes):
        return Unclear("The camera tilts up and down and pans left and right. Which of the two shall I do?")
    if found.aims:
        return Move(tuple(found.aims)) if not found.parts and found.target is None else _UNCLEAR_WAY
    if match_start("(FILLER|COMMA)* UP to NUM", lexemes):
        return Unclear("Is that the angle to tilt to, or the most I should turn by?")
    if found.target is not None:
        return _absolute_turn(found, directions, has, lexemes)
    if not directions:
        return _turn_without_direction(found, has, has_verb, lexemes)
    amounts = found.amounts
    exact = [amount for amount in amounts if amount.kind == "degrees"]
    if len(directions) == 1:
        if len(set(exact)) > 1 or (len({amount.kind for amount in amounts}) > 1 and not exact):
            return Unclear("By how many degrees shall I turn?")
        amount = exact[0] if exact else amounts[0] if amounts else None
        return Move((_turn(directions[0], amount, found),), has_verb)
    if len(amounts) > len(directions):
        return Unclear("By how many degrees shall I turn, and which way?")
    return Move(_turns_about_two_axes(found, directions), has_verb)


def _turns_about_two_axes(found: TurnParts, directions: list[str]) -> tuple[Part, ...]:
    """Return the turns about two axes. A single amount applies to both; otherwise each direction takes the amount next to it."""
    amounts = found.amounts
    if len(amounts) < 2:
        return tuple(_turn(direction, amounts[0] if amounts else None, found) for direction in directions)
    return tuple(_turn(direction, amount, found) for direction, amount in zip(directions, amounts, strict=False))


def _turn(direction: str, amount: Amount | None, found: TurnParts) -> Turn:
    axis, sign = AXES[direction]
    step, count = found.step, found.count
    if found.divides and count and amount and amount.kind == "degrees":
        step = Amount("degrees", abs(amount.degrees) / count)
    elif found.divides:
        count = None
    return Turn(axis, sign, amount, step, count)


def _absolute_turn(found: TurnParts, directions: list[str], has: HasClass, lexemes: Sequence[Lexeme]) -> Step:
    """Return the step that turns to an absolute angle."""
    value = found.target or 0.0
    if found.amounts or len(directions) > 1:
        return Unclear("Is that the angle to turn to, or the angle to turn by?")
    if directions and search("at NUM", lexemes):
        return Unclear("Is that the angle to turn to, or the angle to turn by?")
    axis: Literal["pan", "tilt"] = AXES[directions[0]][0] if directions else "tilt" if has("TILT", "TILTNOUN") else "pan"
    if directions and AXES[directions[0]][1] < 0:
        value = -abs(value)
    if not directions and not has("TILT", "TILTNOUN", "PAN", "PANNOUN", "AIM", "TURN"):
        return Unclear("Is that number the pan angle in degrees, or the number of a preset?")
    return Move((Aim(axis, value),))


def _turn_without_direction(found: TurnParts, has: HasClass, has_verb: bool, lexemes: Sequence[Lexeme]) -> Step:
    """Return the step of a turn without a direction: a signed angle ("pan 25"), or more of the previous turn ("another 10")."""
    amount = next(iter(found.amounts), None)
    axis: Literal["pan", "tilt"] = "tilt" if has("TILT", "TILTNOUN") or search("TILT", lexemes) else "pan"
    is_axis = has("PAN", "TILT", "PANNOUN", "TILTNOUN") or bool(search("PAN|TILT", lexemes))
    if len(set(found.amounts)) > 1 or (has("PAN") and has("TILT")):
        return _UNCLEAR_WAY
    if len(found.amounts) > 1 and search("COMMA", lexemes):
        return Unclear("How far shall I turn in all?")  # "5 more, 5"
    if has("INCREASE", "DECREASE") and is_axis and amount:
        return Move((Turn(axis, -1 if has("DECREASE") else 1, amount),))
    if amount and amount.kind == "degrees" and any(x.has("ABSOLUTE") or x.word in {"set", "put"} for x in lexemes) and is_axis:
        return Move((Aim(axis, amount.degrees),))
    if amount and amount.kind == "degrees" and any(x.word == "face" for x in lexemes):
        return Move((Aim("pan", amount.degrees),))
    if (
        amount
        and amount.kind == "degrees"
        and (
            is_axis
            or (any(x.has("TURN", "TURNNOUN", "REVERSE") for x in lexemes) and (abs(amount.degrees) >= 180 or amount.degrees < 0))
        )
    ):
        return Move((Turn(axis, 1, amount, found.step, found.count, is_signed=is_axis),))
    if found.step and is_axis and not amount:
        return Move((Turn(axis, 1, amount, found.step, found.count),))
    if amount and not has_verb and any(x.has("MORE") or x.word in {"another", "more"} for x in lexemes):
        return Further(amount)
    if not amount and not found.step and has_verb and (is_axis or has("TURN", "AIM", "CARRY")):
        return Unclear("Shall I tilt up or down?" if axis == "tilt" else "Shall I turn left or right?")
    return _UNCLEAR_WAY
