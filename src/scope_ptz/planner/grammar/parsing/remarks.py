"""Recognise clauses that add nothing to the steps of an instruction: reasons, comments on a move, and openers."""

from __future__ import annotations

from scope_ptz.planner.grammar.instruction_tree import Count, Move, Step
from scope_ptz.planner.grammar.parsing.asides import appeals_to_shared_knowledge, is_reason, is_wish, reports_event
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MOTION_VERBS, Clause
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.statements import is_statement
from scope_ptz.planner.grammar.parsing.restatements import repeats_previous_size

_TOO_MUCH = "(FILLER|LITTLE|LOT|PRON|BE|DET|AMOUNTISH)* too (LOT|LITTLE|much|FREE|ADVERB|CLOSER|WIDER|tight|UP|DOWN)"
"""A comment on the previous move: "left 20, too far, back 5"."""

_WANTS_A_LOOK = "(DET)? FREE{1,2} (wants|needs|WRAPPER|TAKE-S|SHOW-S) (to)? (DET)? (look|see|SEE|FREE look|SHOW)"
"""A reason for the previous move: "tilt down 10, the foreman wants a look at the pit"."""

_WANTED_VIEW = (
    "(FILLER)* (i_need|i_want|we_need|we_want|SELF (need|want)) DET (FREE|CLOSER|WIDER|TIGHT|WIDE)? (VIEWNOUN|look) (of|at) _+"
)
"""A statement of the view that the user wants. The next sentence commands the move for it."""

_NO_MORE = (
    "(FILLER|AND|BUT|DASH|just)* (not|no|NOT|NONE|NEGATED|nothing) (MORE|more|further) (than that)? (FILLER)*|no_more (FILLER)*"
)
"""A comment on the amount of the previous move: "left 20, not more"."""

_BEHIND = "(FILLER)* (WRAPPER|SELF|want|need|to|SEE|SHOW|let_me_see)+ what (BE|'s) behind (SELF|it|that|there) (FILLER)*"
"""A reason for turning round: "turn round, I want to see what's behind us"."""

_PERIODS = "(shift|day|week|watch|month|season|term|play|round)"
_TIME_OF_DAY = f"(FILLER)* (DET)? (end|start|beginning|middle|close) of (DET|my|our|SELF)* ({_PERIODS}|FREE {_PERIODS}) (FILLER)*"
"""Words that only say what time it is: "end of shift, go home"."""


def adds_nothing(clause: Clause, after: Clause | None, last: Step | None, *, is_first: bool) -> bool:
    """Return whether a clause only gives a reason, opens the next clause, or repeats how far the last move went.

    Args:
        clause: The clause.
        after: The next clause, if there is one.
        last: The last step before the clause, if there is one.
        is_first: Whether the clause is the first of the instruction.
    """
    if (
        clause.link in {",", "and", "."}
        and not is_first
        and (is_reason(clause.lexemes) or reports_event(clause) or appeals_to_shared_knowledge(clause))
    ):
        return True
    is_move_next = after is not None and after.link == "," and not after.marker and after.lexemes[0].has(*MOTION_VERBS)
    wants_a_look = full_match(f"(FILLER)* ({_WANTS_A_LOOK}) (FILLER|COMMA)*", clause.lexemes)
    is_motion_next = after is not None and not after.marker and after.lexemes[:1] and after.lexemes[0].has(*MOTION_VERBS)
    if (
        is_motion_next
        and after is not None
        and full_match(_WANTED_VIEW, clause.lexemes)
        and not search("(on|onto) PRON", after.lexemes)
    ):
        return True  # "I need a clear view of the load. Zoom right in."
    if is_move_next and (is_wish(clause.lexemes) or wants_a_look):
        return True  # "I need to see the door, pan left 20", "the foreman wants a look, pan left 20"
    words = [x.word for x in clause.lexemes if not x.has("FILLER", "COMMA")]
    if is_first and words == ["right"] and after is not None and _is_full_sentence(after):
        return True  # "right, count the cars"
    if is_first and after is not None and full_match(_TIME_OF_DAY, clause.lexemes):
        return True
    if (after is not None or not is_first) and clause.link in {",", "."} and full_match(_TOO_MUCH, clause.lexemes):
        return True
    if isinstance(last, Count) and full_match("(FILLER|AND)* HOWMANY (FILLER)*", clause.lexemes):
        return True  # "a head count of referees, how many?"
    if clause.link in {",", "and", "."} and isinstance(last, Move) and full_match(_BEHIND, clause.lexemes):
        return True
    if clause.link in {",", "and", "."} and isinstance(last, Move) and full_match(_NO_MORE, clause.lexemes):
        return True
    if clause.link != "," or not isinstance(last, Move):
        return False
    return repeats_previous_size(last, clause) or bool(match_start(_WANTS_A_LOOK, clause.lexemes))


def _is_full_sentence(clause: Clause) -> bool:
    """Return whether a clause is a sentence of its own, so that a word before it, such as "right,", is only an opener."""
    return (
        clause.link in {",", ".", ":"}
        and bool(clause.lexemes)
        and (
            clause.is_question
            or is_statement(clause.lexemes)
            or not clause.lexemes[0].has("NUM", "LITTLE", "LOT", "MORE", "AMOUNTISH", "DET", "PREP", *DIRECTIONS)
        )
    )
