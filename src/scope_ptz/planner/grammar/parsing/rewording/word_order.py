"""Put sentences in the order of a plain command: "it's the anchor that I'd like to see", "the cart should be followed"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import command_of
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.scopes import SECONDS

_OPENING = "(FILLER|LEADFILLER|COMMA)*"
_THING = "(?P<thing>(DET) _+?)"
_NOT_IN_THING = ("COMMA", "STOP", "QUESTION", "THEN", "NUM", "DEG", "NOT", "NEGATED", "PRESET", "PRESETNOUN")
_WISHED = "WRAPPER|(i|we) (want|need|WRAPPER) (you to|SELF to)"
_SIGHT = "(SEE|SHOW|ZOOM IN on|FIND|AIM at|TRACK|READ|have_a_look at|take_a_look at)"
_CLEFT = (
    f"(?P<opening>{_OPENING}) it BE {_THING} (that|which|who)? (?P<wish>{_WISHED}) (?P<act>{_SIGHT}) "
    f"(?P<rest>((up|in) close|close_up|close up|CLOSER|better|properly|for {SECONDS}|FILLER)*) (?P<end>STOP*)"
)
"""A sentence that puts the thing first: "it's the rusty anchor that I'd like to see up close"."""

_MUST = "(should|must|shall|ought to|needs to|has to|is to|BE to|need to|have to)"
_PASSIVE = (
    f"(?P<opening>{_OPENING}) {_THING} {_MUST} be (?P<act>TRACK-ED|COUNT-ED|READ-ED) "
    f"(?P<rest>((for|FILLER|AMOUNTISH)* {SECONDS} FILLER*)?) (?P<end>STOP*)"
)
"""A sentence that says what is to be done to a thing: "the baggage cart should be followed for a minute"."""


def in_order_of_command(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return a sentence about a thing with the command first: "follow the cart for a minute"; other lexemes unchanged.

    It must be the whole instruction, because a statement beside a command is a remark about it.
    """
    cleft = full_match(_CLEFT, lexemes)
    if cleft is not None and (_is_thing(cleft["thing"]) or full_match("(DET)? PRESET", cleft["thing"])):
        parts = (cleft["opening"], cleft["wish"], cleft["act"], cleft["thing"], cleft["rest"], cleft["end"])
        return [x for part in parts for x in part]
    passive = full_match(_PASSIVE, lexemes)
    if passive is None or not _is_thing(passive["thing"]) or (command := command_of(passive["act"][0])) is None:
        return lexemes
    return [*passive["opening"], command, *passive["thing"], *passive["rest"], *passive["end"]]


def _is_thing(lexemes: Sequence[Lexeme]) -> bool:
    return is_noun_phrase(lexemes) and not any(x.has(*_NOT_IN_THING) for x in lexemes)
