"""Read clauses that turn back by an amount or by a part of the previous turn: "30 the other way", "then half of that back"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import Amount, Back, Move, Step, Turn
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import fraction_of
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, full_match

MULTIPLE = (
    r"((?P<fraction>FRACTION)|(?P<twice>TWICE)|(?P<thrice>THRICE)|(?P<multiple>NUM) X) (of)? "
    r"(SAMEAMOUNT|as (far|high|low)|DET (amount|distance|angle)|that|it)"
)
"""A multiple of the previous turn: "half of that", "twice as much", "three times as far"."""

_VERB = "(FILLER|CARRY|TURN|SWITCH|AIM|PAN|TILT)? (it|CAMERA|DET CAMERA|then|FILLER)*"
_HOW_FAR = (
    rf"(by|AMOUNTISH)* ((?P<number>NUM) DEG?|(?P<little>LITTLE)|(?P<lot>LOT)|{MULTIPLE}|(?P<same>SAMEAMOUNT)|"
    r"(?P<half>halfway|half_way)|DET? (?P<fraction>FRACTION) (of the way|of DET? way)?)"
)
_BACK = "(BACK|return|go_back|come_back|turn_back|swing_back|move_back|head_back)"
_TOWARDS = rf"{_VERB} {_BACK} (to|DET|GLUE)* (?P<way>LEFT|RIGHT|UP|DOWN) (GLUE|FILLER|AGAINWORD)*"
_TOWARDS_BY = rf"{_VERB} {_BACK} to DET (?P<way>LEFT|RIGHT) (GLUE)? (by)? (AMOUNTISH)* (?P<number>NUM) DEG (FILLER)*"
BACK_UP = "(FILLER)* BACK UP (FILLER|LITTLE|LOT)*"
"""Words that can ask for a tilt, a zoom or a return."""
_OTHER_WAY = "(in|to|DET)* (other|opposite) (way|direction|side)"


def return_step(lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the step of a clause that turns back, or the other way, by an amount; None for other clauses."""
    for way in (_BACK, _OTHER_WAY):
        for order in (f"{way} {_HOW_FAR}", f"{_HOW_FAR} {way}"):
            if (match := full_match(f"{_VERB} {order} (GLUE|FILLER|AGAINWORD)*", lexemes)) is not None:
                return Back(amount=_amount(match))
    if (sized := full_match(_TOWARDS_BY, lexemes)) is not None:
        sense = 1 if sized["way"][0].has("RIGHT") else -1
        return Move((Turn("pan", sense, Amount("degrees", sized["number"][0].value)),))
    if full_match(BACK_UP, lexemes) is None and (match := full_match(_TOWARDS, lexemes)) is not None:
        side = match["way"][0]
        return Back(turn=Turn("pan" if side.has("LEFT", "RIGHT") else "tilt", 1 if side.has("RIGHT", "UP") else -1))
    return None


def multiple_of(match: Match) -> float:
    """Return the multiple of the previous turn that a match of ``MULTIPLE`` asks for."""
    if match.has("fraction"):
        return fraction_of(match["fraction"][0])
    if match.has("multiple"):
        return match["multiple"][0].value
    return 2.0 if match.has("twice") else 3.0 if match.has("thrice") else 1.0


def _amount(match: Match) -> Amount:
    if match.has("number"):
        return Amount("degrees", match["number"][0].value)
    if match.has("little") or match.has("lot"):
        return Amount("little" if match.has("little") else "lot")
    return Amount("same", factor=0.5 if match.has("half") else multiple_of(match))
