"""Replace wordings about lists of presets with equivalent ones that the other rules already cover."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

_CHECKED_FIRST = (
    "(FILLER|AND|COMMA|SHOW|SWITCH|CARRY|AIM|SCAN|SELF|at|through|to|over|round|around|AROUND)* "
    "EVERY (of|DET|SELF|single)* PRESETNOUN "
    "(AND|COMMA|THEN)+ (?P<asked>TELL|SHOW|LISTING) (me|us)? (?P<which>which) (?P<ones>ones|one)"
)
"""Words that go to every preset, before a question about which of them show something."""


_LISTED = "(?P<places>(DET)? PRESET PRESETNOUN? ((COMMA|AND|THEN)+ (DET)? PRESET PRESETNOUN?)+)"
_GO_ROUND = "(FILLER|SHOW|TELL|SWITCH|CARRY|TAKE|AIM|SCAN|at|to|through)*"
_CHECKED_IN_ORDER = f"{_GO_ROUND} {_LISTED} (COMMA)? (?P<end>for) (FREE|SOMEONE|ANY|DET)"
"""An ordered list of presets to check for something: "check the gate and then the yard for people"."""

_STOP_AT_FIRST = (
    f"{_GO_ROUND} {_LISTED} (?P<end>STOP|COMMA|COLON|THEN|AND) (AND|COMMA|THEN)* (HALT|STAY|KEEP|stop|end) (at|on|with)"
)
"""An ordered list of presets, with a condition for stopping at one: "try the gate, then the yard; stop at the first with a van"."""


def with_presets_reworded(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return lexemes with "at every preset, ... if there is a van" for "... at every preset where there is a van", and so on."""
    if (match := match_start(_CHECKED_FIRST, lexemes)) is not None:
        start = next(i for i, x in enumerate(lexemes) if x is match["asked"][0])
        ones = match["ones"][0]
        lexemes = [x.reworded("presets", "PRESETNOUN") if x is ones else x for x in lexemes[start:]]
    for pattern in (_CHECKED_IN_ORDER, _STOP_AT_FIRST):
        if (match := match_start(pattern, lexemes)) is not None:
            lexemes = [_joined(x) if x in match["places"] or x in match["end"] else x for x in lexemes]
    for i, x in enumerate(lexemes):
        if x.word == "where" and match_start("there BE|SELF (can)? SEE", lexemes[i + 1 :]):
            return _with_condition(lexemes, i)
    return lexemes


def _with_condition(lexemes: Sequence[Lexeme], i: int) -> Sequence[Lexeme]:
    """Return "at every preset, take a picture if there is a van" for "take a picture at every preset where there is a van"."""
    begins = [j + 1 for j in range(i) if lexemes[j].has("STOP", "COMMA", "AND", "THEN", "COLON", "QUESTION")]
    start = begins[-1] if begins else 0
    match = full_match("(?P<done>_+) (?P<place>at EVERY (of|DET|SELF)* PRESETNOUN)", lexemes[start:i])
    if match is None:
        return lexemes
    comma, condition = lexemes[i].reworded(",", "COMMA"), lexemes[i].reworded("if", "IF")
    return [*lexemes[:start], *match["place"], comma, *match["done"], condition, *lexemes[i + 1 :]]


def _joined(lexeme: Lexeme) -> Lexeme:
    """Return a comma for a separator, so that presets are read as one list; any other lexeme unchanged."""
    return lexeme.reworded(",", "COMMA") if lexeme.has("THEN", "STOP", "COLON") else lexeme
