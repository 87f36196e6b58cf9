"""Drop negated alternatives: "go to the cove, not the pool", "pan right, not left, 20", "not the gate, the yard".

A negated alternative must be of the same kind as the one that is kept: a direction, a preset, or pan, tilt or zoom. Other negations
are left as they are.
"""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start
from scope_ptz.planner.grammar.parsing.rewording.repairs import ENDS, Repaired, without_text

_KINDS = (DIRECTIONS, ("PRESET",), ("PAN", "TILT", "ZOOM"), ("IN", "OUT"))
_DENIED = (
    "(NOT|negative on|instead_of|rather_than|do_not_bother with|do not bother with|skip|scratch|scrap|ditch) "
    "(to|at|on|DET|PRESETNOUN)* "
    "(?P<denied>LEFT|RIGHT|UP|DOWN|IN|OUT|PRESET|PAN|TILT|ZOOM) (PRESETNOUN|VIEWNOUN)?"
)
_AFTER = (
    rf"(that is)? (COMMA|DASH|OPEN)? {_DENIED} "
    r"(CLOSE|DASH|COMMA (?=(by)? (NUM|LEFT|RIGHT|UP|DOWN))|(?=COMMA|STOP|AND|THEN)|(FILLER)* \Z)"
)
_AHEAD = rf"(FILLER|COMMA|no|correction|COLON)* {_DENIED} (NUM DEG?|this TRIES)? (FILLER)* (COMMA|COLON|DASH|STOP|BUT)+"


def without_denials(repaired: Repaired) -> Repaired:
    """Return an instruction without its negated alternatives."""
    lexemes = repaired.lexemes
    if match_start("(FILLER)* (BE|DOV|WHQ|HOWMANY|MODAL)", lexemes):
        return repaired
    ahead = match_start(_AHEAD, lexemes)
    if ahead is not None and _is_complete(lexemes[ahead.size :], ahead["denied"][0]):
        return without_text(repaired, lexemes[ahead.size :])
    for i in range(2, len(lexemes)):
        number = match_start("(COMMA)? NOT NUM DEG? (FILLER)* (STOP|\\Z)", lexemes[i:])
        if number is not None and (lexemes[i - 1].has("NUM") or (lexemes[i - 1].has("DEG") and lexemes[i - 2].has("NUM"))):
            return without_text(repaired, lexemes[:i])  # "pan left 10, not 20"
    for i in range(1, len(lexemes)):
        after = match_start(_AFTER, lexemes[i:])
        start = max((j + 1 for j in range(i) if lexemes[j].has(*ENDS)), default=0)
        if after is not None and _alike(lexemes[start:i], after["denied"][0]):
            return without_text(repaired, (*lexemes[:i], *lexemes[i + after.size :]))
    return repaired


def _alike(lexemes: Sequence[Lexeme], denied: Lexeme) -> bool:
    """Return whether lexemes name something of the same kind as the negated alternative, but not the same thing."""
    kind = next(kind for kind in _KINDS if denied.has(*kind))
    return any(x.has(*kind) and x.word != denied.word for x in lexemes)


def _is_complete(lexemes: Sequence[Lexeme], denied: Lexeme) -> bool:
    """Return whether the words after a negated alternative are a complete command: a preset, or a move with an amount."""
    end = next((i for i, x in enumerate(lexemes) if x.has(*ENDS)), len(lexemes))
    return _alike(lexemes[:end], denied) and (denied.has("PRESET") or any(x.has("NUM") for x in lexemes[:end]))
