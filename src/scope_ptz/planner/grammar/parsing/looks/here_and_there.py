"""Read comparisons of the current view with a preset: "are there more people here than at the docks?"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import Compare, Comparison, Step
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Source
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of

_LEAD = "(FILLER|FIRSTLY|LEADFILLER|TELL|know|me|us|SELF|if|whether|IF|COMMA|check|see)* (BE there|there BE|DOV SELF (SEE|have))"
_WAY = "(the)? (?P<way>more|fewer|less)"
_HERE = "(here|NOW|in (this|DET) (VIEWNOUN|PICTURE))"
_THERE = "(at|in|on|from)* (?P<place>(DET)? PRESET PRESETNOUN?)"
_THAN = "(than|THAN) (there BE)?"
_FROM_HERE = rf"{_LEAD} {_WAY} (?P<thing>_+?) (VISIBLE)*? {_HERE} {_THAN} {_THERE} (FILLER|NOW)*"
_FROM_HERE_IMPLIED = rf"{_LEAD} {_WAY} (?P<thing>_+?) (than_at|than_in|(than|THAN) (at|in)) (?P<place>(DET)? PRESET PRESETNOUN?)"
_FROM_THERE = rf"{_LEAD} {_WAY} (?P<thing>_+?) {_THERE} {_THAN} (VISIBLE)*? {_HERE}"
_HERE_OR_THERE = rf"{_LEAD} {_WAY} (?P<thing>_+?) (COMMA|VISIBLE)*? {_HERE} (COMMA)? OR {_THERE} (FILLER|NOW)*"
_THERE_OR_HERE = rf"{_LEAD} {_WAY} (?P<thing>_+?) {_THERE} (COMMA)? OR (VISIBLE)*? {_HERE} (FILLER|NOW)*"
_OPPOSITE: dict[Comparison, Comparison] = {"more": "fewer", "fewer": "more"}


def comparison_with_preset(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Return the comparison of the current view with a preset; None for other clauses.

    The current view is counted first, because the camera leaves it: "more people at the docks than here" is read as "fewer
    people here than at the docks".
    """
    for pattern, is_from_here, is_choice in (
        (_FROM_HERE, True, False), (_FROM_HERE_IMPLIED, True, False), (_FROM_THERE, False, False),
        (_HERE_OR_THERE, True, True), (_THERE_OR_HERE, True, True),
    ):  # fmt: skip
        if (match := full_match(pattern, lexemes)) is None:
            continue
        thing, place = thing_of(source, match["thing"]), place_of(source, match["place"])
        if thing is None or not thing.text or place is None or search("(at|in|on|from) (DET)? PRESET", match["thing"]):
            continue
        way: Comparison = "more" if match["way"][0].word == "more" else "fewer"
        return Compare(thing, thing, way if is_from_here else _OPPOSITE[way], "current", yes_no=not is_choice, second_place=place)
    return None
