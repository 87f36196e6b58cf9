"""Read clauses about the camera itself: where it points, where it was, and what it can do."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import (
    Amount,
    Back,
    CameraState,
    Help,
    Step,
    Unclear,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match


def state_step(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause about the camera itself: where it points, where it was, or what it can do."""
    where = (
        r"(to|where|from|SELF|it|CAMERA|BE|HAVEV|DOV|start|started|began|begin|came|before|SWITCH-ED|CARRY-ED|"
        r"AIM-ING|BEFORE|how|DET|previous|original|last|old|VIEWNOUN|PRESETNOUN|FILLER|AGAINWORD|GLUE|INSTEAD)*"
    )
    if full_match("(TURN|TURN-ING|CARRY) (your|my|its|his|her|their) BACK _*", lexemes):
        return Unclear("Which way shall I turn, and how far?")  # "turn your back to us"
    if full_match(
        (
            rf"(CARRY|TURN|PAN|SWITCH|RESET|put|take)* (it|CAMERA|SELF|right|straight|DET)* (BACK|BACK again) {where}|"
            rf"UNDO {where}|(SWITCH|CARRY|RESET) (it|CAMERA|SELF)* (to where SELF|to (DET)* (previous|original|last|"
            rf"old|start)) {where}|(return|come_back|go_back|swing_back|turn_back|switch_back|revert|get_back|"
            rf"move_back|head_back) {where}"
        ),
        lexemes,
    ) and not any(x.has("PRESET") for x in lexemes):
        return Back()
    if full_match(
        (
            r"(FILLER)* (reverse|UNDO|undo|cancel) (DET)* (pan|tilt|turn|move|zoom|enlargement|TURNNOUN|last|ZOOMNOUN|"
            r"magnification) (move|turn)? (FILLER)*"
        ),
        lexemes,
    ):
        return Back(zoom_only=any(x.has("ZOOMNOUN", "ZOOM") or x.word == "enlargement" for x in lexemes))
    if match := full_match(
        (
            r"(CARRY|TURN|SWITCH|AIM|PAN|TILT)? (in|to|DET)* (other|opposite) (way|direction|side) (by|AMOUNTISH|"
            r"GLUE)* ((?P<number>NUM) DEG?|(?P<same>SAMEAMOUNT)) (FILLER)*"
        ),
        lexemes,
    ):
        return Back(amount=Amount("degrees", match["number"][0].value)) if match.has("number") else Back()
    if match := full_match(
        (
            r"(CARRY|TURN|SWITCH|AIM|PAN|TILT)? (it|CAMERA|DET)* (BACK|go_back|come_back|turn_back|swing_back|"
            r"move_back) (by|AMOUNTISH)* ((?P<number>NUM) DEG?|(?P<little>LITTLE)|(?P<lot>LOT)) (FILLER|AGAINWORD)*"
        ),
        lexemes,
    ):
        kind = "little" if match.has("little") else "lot" if match.has("lot") else "degrees"
        return Back(amount=Amount(kind, match["number"][0].value if match["number"] else 0.0))  # type: ignore[arg-type]
    if full_match(r"(FILLER)* HELP (FILLER)*", lexemes):
        return Help()
    if (
        full_match(
            (
                r"(FILLER|TELL|SELF|me|us)* (WHQ|what is) (BE|DET|SELF|current|PRON|CAMERA|now|of)* (pan|tilt|zoom|pose|"
                r"PANNOUN|TILTNOUN|ZOOMNOUN|position|orientation|angle|PRESETNOUN|AIM|AIM-ING|pointing|looking|and|at|"
                r"level|BE|CAMERA|SELF|DET|now|currently|NOW|current|set|HAVEV|aimed|is|PAN|TILT|ZOOM|to|facing|at)+ "
                r"(FILLER|NOW)*|(FILLER|REPORT|TELL|SHOW|me|GIVE)* (DET|SELF|current)* (pose|PANNOUN|pan angle|camera "
                r"position|pan and tilt) (FILLER|NOW)*"
            ),
            lexemes,
        )
        and any(
            x.has("PANNOUN", "TILTNOUN", "ZOOMNOUN", "PAN", "TILT", "ZOOM")
            or x.word in {"pose", "orientation", "pointing", "looking", "facing", "aimed"}
            for x in lexemes
        )
        and any(x.has("CAMERA", "SELF", "PANNOUN", "TILTNOUN", "ZOOMNOUN") or x.word in {"pose"} for x in lexemes)
    ):
        return CameraState()
    return None
