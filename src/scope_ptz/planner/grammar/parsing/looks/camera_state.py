"""Parse clauses about the camera itself: where it points, where it was, and what it can do."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import (
    Back,
    CameraState,
    Help,
    Repeat,
    Step,
    Unclear,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

_LEADS_BACK = (
    r"(CARRY|TURN|PAN|SWITCH|RESET|SHOW|TAKE|AIM|LIMIT|put|take|it|CAMERA|SELF|me|us|right|straight|DET CAMERA|BACK|to|at|FILLER|"
    r"GLUE|return|revert)*"
)
_BEGAN = "(started|began|begun|came_in)"
_AT_START = "(at|in|from) (the_start|DET (very)? (beginning|start|outset))"
_START = (
    rf"(where|how) (SELF|it|CAMERA|DET CAMERA|everything|WHOLETHING) "
    rf"((HAVEV)? {_BEGAN}|(BE|HAVEV) ({_AT_START}|when SELF {_BEGAN}))|"
    rf"DET (VIEWNOUN|PICTURE|position|pose|place|spot) (that|which)? SELF ({_BEGAN}|HAVEV {_BEGAN}|(BE|HAVEV|saw) {_AT_START})|"
    rf"DET (very)? (beginning|outset)|DET very start"
)
"""Where the camera was at the beginning of the conversation: "where we started", "the view I started with"."""

_AFTER_START = "(from|with|at|on|in|out|off|GLUE|FILLER|AGAINWORD|NOW)*"
_SEVERAL_BACK = (
    "(FILLER)* (UNDO|go_back|(CARRY|TURN) (it|CAMERA|SELF)? BACK(?= NUM (moves|MOVES|STEPNOUN|steps|views|VIEWNOUN|PRESETNOUN)))"
    " (DET|last|previous)* ((?P<number>NUM)|(?P<both>both)) "
    "((of)? (them|those|these|DET)* (moves|MOVES|TRIES|TURNNOUN|STEPNOUN|steps|commands|things|VIEWNOUN|PRESETNOUN)?) (FILLER)*"
)


def state_step(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause about the camera itself: where it points, where it was, or what it can do."""
    where = (
        r"(to|where|from|SELF|it|CAMERA|BE|HAVEV|DOV|start|started|began|begin|came|before|SWITCH-ED|CARRY-ED|"
        r"AIM-ING|BEFORE|how|DET|previous|earlier|former|original|last|old|pose|VIEWNOUN|PRESETNOUN|FILLER|AGAINWORD|GLUE|INSTEAD)*"
    )
    if full_match(f"{_LEADS_BACK} ({_START}) {_AFTER_START}|UNDO (WHOLETHING|all of (it|that)) (FILLER)*", lexemes):
        return Back(to_start=True)
    if (several := full_match(_SEVERAL_BACK, lexemes)) is not None:
        return Repeat((Back(),), 2 if several.has("both") else max(1, round(several["number"][0].value)))
    if full_match("(TURN|TURN-ING|CARRY) (your|my|its|his|her|their) BACK _*", lexemes):
        return Unclear("Which way shall I turn, and how far?")  # "turn your back to us"
    if full_match(
        (
            rf"(CARRY|TURN|PAN|SWITCH|RESET|put|take)* (it|CAMERA|SELF|right|straight|DET)* (BACK|BACK again) {where}|"
            rf"(FILLER|THEN)* back_out (again)? to (how|where) (it|SELF|PRON) {where}|"
            rf"(CARRY|TURN|PAN|TILT|FILLER)* BACK (UP|DOWN|LEFT|RIGHT|IN|OUT) to where SELF {where}|UNDO {where}|"
            rf"(SWITCH|CARRY|RESET) (it|CAMERA|SELF)* "
            rf"(to where SELF|to (DET)* (previous|earlier|former|original|last|old|start)) {where}|"
            rf"(return|come_back|go_back|swing_back|turn_back|switch_back|revert|get_back|move_back|head_back) {where}"
        ),
        lexemes,
    ) and not any(x.has("PRESET") for x in lexemes):
        return Back(again=any(x.has("AGAINWORD") for x in lexemes) and not any(x.has("UNDO") for x in lexemes))
    if full_match(
        (
            r"(FILLER)* (reverse|UNDO|undo|cancel) (DET)* (pan|tilt|turn|move|zoom|enlargement|TURNNOUN|last|ZOOMNOUN|"
            r"magnification) (move|turn)? (FILLER)*"
        ),
        lexemes,
    ):
        return Back(zoom_only=any(x.has("ZOOMNOUN", "ZOOM") or x.word == "enlargement" for x in lexemes))
    is_at_preset = full_match(
        "(FILLER|TELL|me|us)* WHQ PRESETNOUN (BE|DOV|SELF|CAMERA|this|that|it|PRON|at|on|in|looking|AIM-ING|VISIBLE|NOW|FILLER)+",
        lexemes,
    )
    is_zoomed = full_match(
        "(FILLER)* how (far|LOT|CLOSER|tight|close|wide) (in|IN)? BE (SELF|CAMERA|it|DET) (CAMERA)? (ZOOM-ED)? (IN|OUT)? "
        "(NOW|FILLER)*",
        lexemes,
    )
    is_facing = full_match(
        "(FILLER)* (which|what|WHQ) (way|direction|SIDE) (BE (SELF|CAMERA|it|DET CAMERA)|(SELF|CAMERA|it|DET CAMERA) BE) "
        "(looking|facing|pointing|AIM-ING|aimed|NOW|FILLER)+",
        lexemes,
    )
    is_located = full_match(
        "(FILLER|TELL|me|us)* where (BE (SELF|DET? CAMERA)|(SELF|DET? CAMERA) BE) (NOW|FILLER|VISIBLE)*", lexemes
    )
    if is_at_preset or is_zoomed or is_facing or is_located:
        return CameraState()  # "which preset are we on?", "how far are you zoomed in?", "where are you?"
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
