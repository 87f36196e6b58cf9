"""Recognise requests to see a thing that only say what the move beside them is for: "I want the ride in view, pull back a lot"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import Mention, Move, Step, Unclear, Zoom, ZoomTo
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Clause, NotUnderstoodError
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start
from scope_ptz.planner.grammar.parsing.reader import Reader

_WISH = (
    "(FILLER|COMMA)* (let_me_see|let_us_see|like_to_see|(let_us|let_me|let (me|us)|MODAL (i|we|SELF)) "
    "(SEE|have|get|take|view|look|SHOW|AIM|TAKE|have_a_look_at)|"
    "(?P<wish>WRAPPER)|(i|we) (MODAL|ADVERB|FILLER|really|just)* (want|need|like|love|wish|prefer|could_do_with))"
)
_WISHES = frozenset({
    "want", "need", "like", "love", "want_to", "need_to", "like_to", "love_to", "wish_to", "could_do_with", "let_us_have",
    "let_me_have", "can_i_have", "can_i_get", "could_i_have", "could_i_get", "may_i_have", "can_we_have", "can_we_get",
    "could_we_have", "could_we_get",
})  # fmt: skip
_ORDERS = ("ZOOM", "ZOOM-ING", "ENLARGE", "ENLARGE-ING", "TIGHTEN", "FIND", "TRACK", "PICTURE", "SNAP")
"""Words with which a wish is an order: "I want you to zoom in on the van", "I'd like a picture of it"."""

_AMOUNTS = ("NUM", "LITTLE", "LOT", "LIMIT", "PERCENT", "TWICE", "THRICE", "FRACTION", "MORE")


def purpose_of_move(
    reader: Reader, clause: Clause, steps: Sequence[Step], before: Step | None, after: Clause | None
) -> Step | None:
    """Return the step of a wish that belongs to a move beside it. None for other clauses.

    A wish is no order: "I want the ride in view, pull back a lot" zooms out, but "zoom in on the ride, pull back a lot" does both.
    After "and" and "then" a wish is the next step, and a close view that is wished for after a move is wanted as well. The step
    only names the thing, or asks about a close view before a move. For "let me see the ride, zoom in" it is the step of both.

    Args:
        reader: The reader of clauses.
        clause: The clause that may be a wish.
        steps: Its steps.
        before: The step before it.
        after: The clause after it.
    """
    step = steps[0] if len(steps) == 1 else None
    if not isinstance(step, ZoomTo) or not step.thing.text or not _is_wish(clause.lexemes):
        return None
    is_close = any(x.has("CLOSER") or x.word in {"close_up", "close"} for x in clause.lexemes)
    if clause.link in {",", "."} and isinstance(before, Move) and not _is_next(clause):
        return None if is_close else Mention(step.thing)
    if (move := _move_for_wish(reader, after)) is None:
        return None
    if _only_zooms_in(move, after):
        return step
    if is_close:
        return Unclear(f"Shall I zoom in on the {step.thing.text}, or only make the move that you describe?")
    return Mention(step.thing)


def _is_wish(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a clause begins with a wish of the speaker, and contains no order such as "zoom" or "find"."""
    match = match_start(_WISH, lexemes)
    if match is None or any(x.has(*_ORDERS) for x in lexemes):
        return False
    return not match.has("wish") or match["wish"][0].word.removeprefix("i_").removeprefix("we_").removeprefix("would_") in _WISHES


def _is_next(clause: Clause) -> bool:
    """Return whether "then" begins a clause, also after a full stop."""
    return clause.link == "then" or (clause.opener is not None and clause.opener.has("THEN"))


def _move_for_wish(reader: Reader, after: Clause | None) -> Move | None:
    """Return the move of the clause after a wish if a comma, a full stop or "so" stands between the two; otherwise None."""
    if after is None or after.marker or after.is_question or not after.lexemes or _is_next(after):
        return None
    if after.link not in {",", "."} and not (after.opener is not None and after.opener.word == "so"):
        return None
    try:
        steps = reader.read(after.lexemes)
    except NotUnderstoodError:
        return None
    return steps[0] if len(steps) == 1 and isinstance(steps[0], Move) else None


def _only_zooms_in(move: Move, after: Clause | None) -> bool:
    """Return whether a move is "zoom in" without an amount, which may mean the thing that the wish names."""
    is_sized = after is not None and any(x.has(*_AMOUNTS) for x in after.lexemes)
    return not is_sized and all(isinstance(part, Zoom) and part.kind == "factor" and part.value > 1 for part in move.parts)
