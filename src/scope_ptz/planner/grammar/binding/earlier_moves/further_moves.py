"""Read instructions that continue, repeat or take back the last move: "a bit more", "another 10", "pan left again"."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_moves.commands import Command
from scope_ptz.planner.grammar.binding.earlier_moves.single_moves import SingleMove, single_move, towards
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.instruction_parser import parse
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

_NUMBER = r"(?P<number>\d+(?:\.\d+)?)(?: degrees?| deg|°)?"
_LITTLE = r"(?:just )?(?:a )?(?:little |tiny |wee )?(?:bit|touch|smidge|smidgen|tad|fraction|hair|little)"
_MORE = re.compile(
    rf"(?:and |now |ok |okay |yes |please )*(?:(?P<little>{_LITTLE}) (?:more|further)|(?:another|by another) (?P<small>{_LITTLE})"
    rf"|(?P<lot>a lot|lots|much|way) (?:more|further)"
    rf"|{_NUMBER} (?:more|further)|(?:another|by another) {_NUMBER.replace('number', 'added')})(?: please)?[.!]*",
    re.IGNORECASE,
)
_SAME = re.compile(r"(?:and |now |ok |okay |yes |please )*(?:more|further|keep going|some more)(?: please)?[.!]*", re.IGNORECASE)
_NO_PAUSE = "(FILLER|oh|COMMA|DASH|STOP)* (no|nope|nah) (FILLER|COMMA|DASH|STOP)* (COMMA|DASH|STOP) (FILLER)*"
"""Words before "more" that reject the last amount. Without a pause, "no more" asks for the opposite."""

_NEXT_THING = "(FILLER|COMMA)* (now|NOW|AND|and|THEN|then) (FILLER|COMMA|now|then)* (on|onto) (?P<thing>DET _+?) (FILLER|STOP)*"
_SHARE = "(FILLER|AND|THEN)* ((?P<fraction>FRACTION)|(?P<twice>TWICE)) (of)? (that|it) (FILLER|AGAINWORD)*"


def more(lexemes: Sequence[Lexeme], said: str, last: Command) -> str | None:
    """Return the move of "a bit more" or "another 10" after a move or a close-up; None for other instructions."""
    said = _without_no(lexemes, said)
    move, match = single_move(last.steps), _MORE.fullmatch(said)
    if match is None and not _SAME.fullmatch(said):
        return None
    if move is None:
        is_close_up = len(last.steps) == 1 and isinstance(last.steps[0], ast.ZoomTo)
        move = towards("in") if is_close_up and (match is None or not (match["number"] or match["added"])) else None
        return None if move is None else f"{move.axis} {move.way} {'a lot' if match is not None and match['lot'] else 'a bit'}"
    if match is None:
        return "again"
    number = match["number"] or match["added"]
    if number and move.axis == "zoom":
        return None
    if number:
        return f"{move.axis} {move.way} {number} degrees"
    return f"{move.axis} {move.way} {'a lot' if match['lot'] else 'a bit'}"


def next_thing(lexemes: Sequence[Lexeme], said: str, last: Command) -> str | None:
    """Return the close-up of "now on the fountain" after a close-up; None for other instructions."""
    match = full_match(_NEXT_THING, lexemes)
    step = last.steps[0] if len(last.steps) == 1 else None
    if match is None or not isinstance(step, ast.ZoomTo) or not is_noun_phrase(match["thing"]):
        return None
    return f"zoom in on {said[match['thing'][0].start : match['thing'][-1].end]}"


def share_of_turn(lexemes: Sequence[Lexeme], move: SingleMove | None) -> str | None:
    """Return the question about "half of that" after a turn: whether it is meant instead, or in addition; None for others."""
    match = full_match(_SHARE, lexemes)
    if match is None or move is None or not move.size.endswith(" degrees"):
        return None
    factor = match["fraction"][0].value if match.has("fraction") else 2.0
    angle_deg = float(move.size.removesuffix(" degrees")) * factor
    return f"Shall I {move.axis} {move.way} {angle_deg:g} degrees instead, or {angle_deg:g} degrees more?"


def measured_by_last(said: str, last: Command, presets: tuple[str, ...]) -> str | None:
    """Return the move of an instruction that needs the last move, about one axis, to be understood: "back 5"."""
    alone = parse(said, presets).steps
    if single_move(last.steps) is None or alone is None or not any(isinstance(step, ast.Unclear) for step in alone):
        return None
    together = parse(f"{last.text.rstrip('.!? ')}, {said}", presets).steps
    if together is None or len(together) != 2 or together[:1] != last.steps:
        return None
    move = single_move(together[1:])
    return move.text if move is not None else None


def same_axis_again(said: str, lexemes: Sequence[Lexeme], commands: Sequence[Command], presets: tuple[str, ...]) -> str | None:
    """Return the amount that "pan left again" or "zoom back out" takes from the last move about that axis; None for others.

    In the same direction, it repeats that move. In the other direction, it undoes it.
    """
    is_again = any(x.has("AGAINWORD") or x.word in {"back_out", "back_in"} for x in lexemes)
    if not is_again or any(x.has("NUM", "LITTLE", "LOT", "LIMIT", "FRACTION") for x in lexemes):
        return None
    wanted = single_move(parse(said, presets).steps or ())
    if wanted is None:
        return None
    for command in reversed(commands):
        if command.effect not in {"done", "corrected"}:
            return None
        if wanted.axis == "zoom" and wanted.way == "out" and len(command.steps) == 1 and isinstance(command.steps[0], ast.ZoomTo):
            return "undo the zoom"
        if (move := single_move(command.steps)) is None or move.axis != wanted.axis:
            continue
        if move.way == wanted.way:
            return move.text if any(x.has("AGAINWORD") for x in lexemes) else None
        return "undo the zoom" if move.axis == "zoom" else move.reversed().text
    return None


def share_of_zoom(lexemes: Sequence[Lexeme], move: SingleMove | None) -> str | None:
    """Return the zoom to a multiple of the current magnification: "half of that", "double that" after a zoom."""
    match = full_match(_SHARE, lexemes)
    if match is None or move is None or move.axis != "zoom":
        return None
    factor = match["fraction"][0].value if match.has("fraction") else 2.0
    share = SingleMove("zoom", "in" if factor >= 1 else "out", f"{max(factor, 1 / factor):g} times")
    return "undo the zoom" if share == move.reversed() else share.text


def _without_no(lexemes: Sequence[Lexeme], said: str) -> str:
    """Return an instruction without a "no" and the pause after it: "a bit more" for "no, a bit more"."""
    lead = match_start(_NO_PAUSE, lexemes)
    return said if lead is None or lead.size >= len(lexemes) else said[lexemes[lead.size].start :]
