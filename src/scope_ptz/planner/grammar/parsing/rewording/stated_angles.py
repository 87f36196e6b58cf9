"""Put the angles of turns beside the directions and axes that they belong to: "up and left, ten each" is "up ten and left ten"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.moves.turn_words import ALLOWED_IN_TURNS
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match, match_start, search

_AMOUNT = "(?P<amount>NUM DEG?|LITTLE|LOT)"
_EACH = (
    f"(?P<moves>_+?) (COMMA|STOP|by|AMOUNTISH|FILLER)* {_AMOUNT} (on|in|of|for)? (each|apiece) "
    "((of)? (them|both|those|DET two)|axis|axes|way|direction|SIDE|one)? (FILLER|STOP|COMMA)*"
)
"""Turns, then the amount of each: "pan right and tilt up, 8 degrees each"."""

_STEPS_FIRST = (
    f"(FILLER|LEADFILLER)* (in|with|using)? (DET)? ({_AMOUNT} STEPNOUN|STEPNOUN (of)? {_AMOUNT}) (each)? (COLON|COMMA|DASH) "
    "(?P<moves>_+)"
)
"""The amount of each turn, then the turns: "5 degree steps: pan right, pan right, tilt down"."""

_NAMED = "(?P<number>NUM) DEG? (of|in|on)? (DET)? (?P<axis>PAN|TILT|PANNOUN|TILTNOUN) (?!(LEFT|RIGHT|UP|DOWN|NUM|to|by))"
_TO_HORIZON = "(?P<number>NUM) DEG? (?P<way>above|below|under|over) (DET)? (?P<horizon>HORIZON)"
_AIMED = f"(CARRY|AIM|TURN|SWITCH) (DET|CAMERA|it|FILLER)* (?P<to>to|at) (?P<angles>{_NAMED} _*)"
"""A target whose angle comes before its axis: "point at minus 45 degrees pan"."""

_AXIS_LAST = (
    f"(FILLER)* (?P<turn>{_AMOUNT} (COMMA|COLON|DASH)* (to|DET|SIDE)* (COLON)? (LEFT|RIGHT|UP|DOWN) (SIDE)?) "
    "(COMMA|STOP) (?P<verb>PAN|TILT) (FILLER|STOP|COMMA)*"
)
"""An amount and a direction, and what to turn at the end: "15 degrees, direction down. Tilt."."""

_WARDS = frozenset({"leftward", "rightward", "upward", "downward"})
_NOT_SPREAD = ("NUM", "LITTLE", "LOT", "LIMIT", "REVERSE", "NOT", "NEGATED", "NONE")


def with_angles_in_place(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with each angle beside the direction or after the axis that it belongs to."""
    if (last := full_match(_AXIS_LAST, lexemes)) is not None:
        return [*last["verb"], *(x for x in last["turn"] if not x.has("COMMA", "COLON", "DASH", "SIDE"))]
    shared = full_match(_EACH, lexemes)
    if shared is not None and _are_plain_turns(shared["moves"]):
        return _with_amount_after_directions(shared)
    steps = full_match(_STEPS_FIRST, lexemes)
    if steps is not None and _are_plain_turns(steps["moves"]):
        return [x.reworded("then", "THEN") if x.has("COMMA") else x for x in _with_amount_after_directions(steps)]
    return _with_axis_first(_with_verb_before_direction(lexemes))


def _are_plain_turns(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes name at least two directions without an amount, and nothing that is not part of a turn."""
    is_plain = all(
        x.has(*ALLOWED_IN_TURNS, *DIRECTIONS, "AND", "THEN", "WRAPPER", "MODAL", "STOP") and not x.has(*_NOT_SPREAD)
        for x in lexemes
    )
    return is_plain and sum(x.has(*DIRECTIONS) for x in lexemes) > 1 and search("RIGHT (UP|DOWN|AROUND)", lexemes) is None


def _with_amount_after_directions(shared: Match) -> list[Lexeme]:
    """Return turns with their common amount after each direction."""
    spread: list[Lexeme] = []
    for x in shared["moves"]:
        spread.append(x)
        if x.has(*DIRECTIONS):
            spread += shared["amount"]
    return spread


def _with_verb_before_direction(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "a pan leftward of 33 degrees" in place of "a leftward pan of 33 degrees"."""
    out = list(lexemes)
    for i in range(len(out) - 2):
        if out[i].has("DET") and out[i + 1].word in _WARDS and out[i + 2].has("PAN", "TILT"):
            out[i + 1], out[i + 2] = out[i + 2], out[i + 1]
    return out


def _with_axis_first(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "point at pan -45 and tilt -12" in place of "point at -45 degrees pan and 12 degrees below level"."""
    match = search(_AIMED, lexemes)
    if match is None:
        return lexemes
    start = next(i for i, x in enumerate(lexemes) if x is match["angles"][0])
    out, rest = list(lexemes[:start]), list(lexemes[start:])
    while angle := match_start(f"(AND|COMMA)* ({_NAMED}|{_TO_HORIZON})", rest):
        number, axis = angle["number"][0], (angle["axis"] or angle["horizon"])[0]
        separators = [x for x in rest[: angle.size] if x.has("AND", "COMMA")]
        if angle.has("way"):
            sign = 1 if angle["way"][0].word in {"above", "over"} else -1
            number, axis = replace(number, value=sign * abs(number.value)), axis.reworded("tilt", "TILT", "TURNNOUN")
        out += [*separators, axis, number]
        rest = rest[angle.size :]
    return [*out, *rest]
