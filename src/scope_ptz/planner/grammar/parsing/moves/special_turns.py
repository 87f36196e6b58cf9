"""Read turns that are not stated as a direction and an amount: "turn around", "level the camera", "pan 20, tilt -10"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from scope_ptz.planner.grammar.instruction_tree import Aim, Amount, Move, Part, Step, Turn, Unclear
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.moves.returns import BACK_UP
from scope_ptz.planner.grammar.parsing.moves.turn_words import ALLOWED_IN_TURNS, SURFACE_BELOW_OR_ABOVE, TURN_VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search

AXIS_TARGET = (
    r"(AND|COMMA|and)* (DET|ABSOLUTE)* (?P<axis>PAN|TILT|ZOOM|PANNOUN|TILTNOUN|ZOOMNOUN) "
    r"(to|of|at|on|is|EQUALS)? (?P<number>NUM) (DEG|X)?"
)

_ON_TARGET = r"(AND|COMMA|and)* (DET|ABSOLUTE)* (PAN|TILT|PANNOUN|TILTNOUN) (on|to|at) NUM DEG?"

_NO_COMPASS = Unclear(
    "I have no compass: I know directions only as left and right of where the camera points. Which way shall I turn?"
)

CLOCK_POSITION = "NUM (o_'_clock|o_clock)"
_NO_CLOCK = Unclear(
    "A clock position can mean a turn or a place in the picture. By how many degrees shall I turn, and which way, or "
    "what shall I look at?"
)
"""The answer to "look at 3 o'clock", which can mean a quarter turn or the right edge of the picture."""


def special_turn(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a turn that is not stated as a direction and an amount: "turn around", "level the camera"."""
    glue = "(" + "|".join(x for x in ALLOWED_IN_TURNS) + "|that|so|you|are)*"
    if (clock := full_match(f"{glue} (to|at|towards) SELF (?P<hour>NUM) (o_'_clock|o_clock) {glue}", lexemes)) is not None:
        return _to_hour(clock["hour"][0].value, lexemes)
    if search(CLOCK_POSITION, lexemes):
        return _NO_CLOCK
    if any(x.word in {"bearing", "heading"} for x in lexemes) and any(x.has("NUM") for x in lexemes):
        return _NO_COMPASS
    opposite = (
        r"((so_that|so|to) (SELF|it|CAMERA|DET|is)* (AIM|AIM-ING|AIM-S) (in)? (REVERSE|DET (other|opposite) (way|direction|SIDE)))?"
    )
    if full_match(rf"{glue} (REVERSE|(TURN|TURN-ING|CARRY|AIM) {glue} (AROUND|REVERSE)) {glue} {opposite}", lexemes):
        return Move((Turn("pan", 1, Amount("degrees", 180.0)),))
    if match := full_match(rf"{glue} (?P<way>VERTICALUP|VERTICALDOWN) ({SURFACE_BELOW_OR_ABOVE})? {glue}", lexemes):
        return Move((Turn("tilt", 1 if match["way"][0].has("VERTICALUP") else -1, Amount("limit")),))
    if (
        match := full_match(rf"(CARRY|AIM|SWITCH|TURN|FILLER|CAMERA|DET|GLUE)* (to|at) (?P<targets>({AXIS_TARGET})+)", lexemes)
    ) or (any(x.has("EQUALS") for x in lexemes) and (match := full_match(rf"(?P<targets>({AXIS_TARGET})+)", lexemes))):
        return _targets(match["targets"])
    if match := full_match(rf"(FILLER)* (set|put) (CAMERA|DET CAMERA)? (?P<targets>({_ON_TARGET})+)", lexemes):
        return _targets(match["targets"])  # "set the pan on -35 and the tilt on 4"
    if search("too (LOT|LEFT|RIGHT|UP|DOWN|much)", lexemes):
        return Unclear("Which way shall I turn, and how far?")  # "too far left" is a complaint
    if full_match(f"{glue} RIGHT AROUND {glue}", lexemes):
        return Unclear("Shall I turn right, or all the way round?")
    if search("EVERY (LEFT|RIGHT|UP|DOWN)", lexemes):
        return Unclear("Shall I turn all the way, or by how many degrees?")  # "all left"
    if (match := full_match("(FILLER)* (crank|turn) (it|DET CAMERA) (?P<way>UP|DOWN) (FILLER)*", lexemes)) is not None:
        way, zoom = ("up", "in") if match["way"][0].has("UP") else ("down", "out")
        return Unclear(f"Shall I tilt {way}, or zoom {zoom}?")  # "crank it up" may ask for more of anything
    if full_match(BACK_UP, lexemes):
        return Unclear("Shall I zoom out, tilt up, or go back to where I was?")
    if full_match(r"(FILLER)* go to the (LEFT|RIGHT) (FILLER)*", lexemes):
        return Unclear("By how many degrees shall I turn?")
    if full_match(
        (
            rf"{glue} CENTREALL {glue}|(FILLER)* CENTREWORD (DET)* (CAMERA|it|VIEWNOUN) (FILLER)*|(CARRY|SWITCH|TURN) "
            rf"{glue} (BACK)? to CENTREWORD (FILLER)*|BACK to CENTREWORD (FILLER|AGAINWORD)*"
        ),
        lexemes,
    ):
        return Move((Aim("pan", 0.0), Aim("tilt", 0.0)))
    if match := full_match(
        rf"{glue} (to|at) (?P<number>NUM) DEG? (to)? (DET)? (?P<way>LEFT|RIGHT|left_of|right_of) (of)? (DET)? "
        rf"(CENTREWORD|AHEAD|(?P<zero>NUM)) {glue}",
        lexemes,
    ):
        if match.has("zero") and match["zero"][0].value != 0:
            return Unclear("Is that the angle to turn to, or the angle to turn by?")
        sign = 1 if match["way"][0].has("RIGHT") or match["way"][0].word == "right_of" else -1
        return Move((Aim("pan", sign * abs(match["number"][0].value)),))  # "pan to 40 degrees left of centre"
    if match := full_match(
        rf"{glue} (?P<number>NUM) DEG (?P<way>above|below|under|over|UP from|DOWN from) (DET)? HORIZON {glue}", lexemes
    ):
        sign = 1 if match["way"][0].word in {"above", "over"} or match["way"][0].has("UP") else -1
        return Move((Aim("tilt", sign * abs(match["number"][0].value)),))
    if full_match(
        (
            rf"{glue} (LEVEL {glue} (HORIZON)?|(AIM|AIM-ING|TILT|CARRY|TURN|UP|DOWN) {glue} (HORIZON|LEVEL)|(to|at) "
            rf"the HORIZON) {glue} (HORIZON)? "
        ),
        lexemes,
    ):
        return Move((Aim("tilt", 0.0),))
    if full_match(
        rf"{glue} (AIM|TURN|PAN|AIM-ING|CARRY) {glue} AHEAD {glue}|(BACK to|FILLER)* (straight_ahead|dead_ahead) "
        rf"(FILLER|AGAINWORD)*",
        lexemes,
    ):
        if any(x.has("CARRY") and not x.has("AIM", "PAN", "TURN") for x in lexemes) and any(
            x.word.startswith("forward") for x in lexemes
        ):
            return Unclear("The camera cannot travel; it turns and zooms. Shall I zoom in?")
        return Move((Aim("pan", 0.0),))
    if any(x.has("COMPASS") for x in lexemes) and any(x.has(*TURN_VERBS) for x in lexemes):
        return _NO_COMPASS
    return None


def _to_hour(hour: float, lexemes: Sequence[Lexeme]) -> Step:
    """Return the turn to "your nine o'clock": 12 is where the camera points, and each hour is 30 degrees clockwise."""
    if not (any(x.word == "your" for x in lexemes) and 1 <= hour <= 12 and hour == int(hour)):
        return _NO_CLOCK
    pan_deg = 30.0 * (hour % 12)
    return (
        Move((Turn("pan", 1 if pan_deg <= 180 else -1, Amount("degrees", min(pan_deg, 360 - pan_deg))),)) if pan_deg else _NO_CLOCK
    )


def _targets(lexemes: Sequence[Lexeme]) -> Step:
    """Return the step of a list of absolute targets: "pan 20, tilt -10 and zoom 3"."""
    aims: list[Part] = []
    while lexemes and (match := match_start(AXIS_TARGET, lexemes)):
        axis = match["axis"][0]
        name: Literal["pan", "tilt", "zoom"] = (
            "pan" if axis.has("PAN", "PANNOUN") else "tilt" if axis.has("TILT", "TILTNOUN") else "zoom"
        )
        aims.append(Aim(name, match["number"][0].value))
        lexemes = lexemes[match.size :]
    return (
        Move(tuple(aims))
        if len({part.axis for part in aims if isinstance(part, Aim)}) == len(aims)
        else Unclear("Which way shall I turn, and how far?")
    )
