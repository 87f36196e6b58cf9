"""Replace some wordings by others that mean the same, so that the rules for those also read them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS

_WISHES = ("want_to", "like_to", "love_to", "need_to", "wish_to")
_NOT_SHOWN = ("WHQ", "HOWMANY", "HOWMANYMORE", "IF", "REL", "PRON", "SOMEONE", "FULL", "ANY", "EVERY")
_ABSTRACT = frozenset({"whether", "if", "how", "what", "where", "who", "that", "it", "more", "less", "in", "a"})


def reworded(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return lexemes with "let me see the yard" for "I want to see the yard", and "go back left" for "return left"."""
    out: list[Lexeme] = []
    i = 0
    while i < len(lexemes):
        x, after = lexemes[i], lexemes[i + 1] if i + 1 < len(lexemes) else None
        beyond = lexemes[i + 2] if i + 2 < len(lexemes) else None
        is_wish = x.has("WRAPPER") and x.word.endswith(_WISHES) and after is not None and after.word == "see"
        if is_wish and _is_shown(beyond) and not _is_reason(out):
            out.append(replace(x, word="let_me_see", end=lexemes[i + 1].end, classes=frozenset({"SHOW", "SHOW-ED"})))
            i += 2
            continue
        if x.word in {"into", "close_to"} and out and _is_approach(out, x):
            ways = [] if out[-1].has("IN", "ENLARGE") else [replace(x, word="in", end=x.start, classes=frozenset({"IN", "GLUE"}))]
            out += [
                *ways,
                replace(x, word="on", classes=frozenset({"ADVERB", "GLUE", "PREP"})),
            ]  # "zoom into it", "get close to it"
        elif x.word == "right_now" and out and out[-1].word == "the":  # "over to the right now"
            out += [replace(x, word="right", end=x.start + 5, classes=frozenset({"RIGHT", "ADVERB"}))]
            out += [replace(x, word="now", start=x.end - 3, classes=frozenset({"NOW", "FILLER"}))]
        elif x.word == "return" and after is not None and after.has(*DIRECTIONS):
            out += [replace(x, word="go", classes=frozenset({"CARRY"})), replace(x, word="back", classes=frozenset({"BACK"}))]
        else:
            out.append(x)
        i += 1
    return tuple(out)


def _is_shown(lexeme: Lexeme | None) -> bool:
    """Return whether a lexeme can begin the name of a thing or preset to be shown."""
    if lexeme is None or lexeme.has(*_NOT_SHOWN) or lexeme.word in _ABSTRACT:
        return False
    return lexeme.has("DET", "PRESET", "FREE")


def _is_reason(before: Sequence[Lexeme]) -> bool:
    """Return whether a wish after these lexemes is the reason for a move: "tilt up a lot, I want to see the roof"."""
    sentence: list[Lexeme] = []
    for x in reversed(before):
        if x.has("STOP", "QUESTION"):
            break
        sentence.append(x)
    moves = any(x.has(*DIRECTIONS, "PAN", "TILT", "ZOOM", "ENLARGE", "WIDEN", "IN", "OUT") for x in sentence)
    return moves and not sentence[0].has("AND", "THEN")


def _is_approach(before: Sequence[Lexeme], preposition: Lexeme) -> bool:
    """Return whether "into" or "close to" after these lexemes says what to zoom in on: "zoom into", "zoom in close to"."""
    words = [x for x in before[-4:] if not x.has("FILLER", "CAMERA", "DET", "IN")]
    if not words:
        return False
    verb = words[-1]
    return verb.has("ZOOM", "ENLARGE") or (preposition.word == "close_to" and verb.word in {"get", "go", "move", "come"})
