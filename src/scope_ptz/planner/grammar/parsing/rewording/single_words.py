"""Replace single words whose neighbours show that they stand for others: typing errors, and verbs in unusual forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS, command_of
from scope_ptz.planner.grammar.parsing.parts.patterns import match_start, search

_BREAKS = ("COMMA", "STOP", "AND", "THEN", "COLON", "DASH", "QUESTION")
_URGED = frozenset({"you", "it", "her", "him"})
_BEFORE_OBJECT = frozenset({"also", "please", "kindly", "quickly"})
"""Words that some speakers put between a verb and its object, where they add nothing."""

_COMMANDS = frozenset({"tilt", "zoom", "pan", "take", "go", "turn", "snap", "count", "tell", "read", "follow", "track", "find"})


def reworded_in_context(before: Sequence[Lexeme], lexeme: Lexeme, after: Lexeme | None) -> list[Lexeme] | None:
    """Return the lexemes that replace a lexeme; None if it stays.

    Args:
        before: The lexemes before it, already reworded.
        lexeme: The lexeme.
        after: The lexeme after it, if there is one.
    """
    last = before[-1] if before else None
    begins = last is None or last.has(*_BREAKS, "FILLER")
    ends = after is None or after.has("STOP", "QUESTION")
    if lexeme.word in _BEFORE_OBJECT and last is not None and last.has(*VERBS) and after is not None and after.has("DET", "NUM"):
        return []  # "make also one photo", "search please the shed"
    if lexeme.word == "an" and after is not None and after.word in _COMMANDS:
        return [lexeme.reworded("and", "AND", "GLUE")]  # "go to the gate an tilt down 6"
    begins_duration = after is not None and (after.has("NUM", "SECONDS", "MINUTES") or after.word == "few")
    if lexeme.word in {"next", "following"} and last is not None and last.has("DET") and begins_duration:
        return []  # "for the next two minutes"
    turns = last is not None and last.has("PAN", "TURN", "CARRY", "CAMERA", "AND", "NUM", "DEG")
    if lexeme.word == "right" and after is not None and after.word in {"here", "there"} and not turns:
        return [lexeme.reworded("right", "ADVERB")]  # "hold it right there"
    if lexeme.word == "neither" and search("IF|WHEN|UNLESS|UNTIL", before):
        return [lexeme.reworded("no", "NONE", "DET")]  # "if you see neither people nor cars"
    if lexeme.word == "nor" and any(x.has("NONE") for x in before):
        return [lexeme.reworded("and", "AND", "GLUE")]
    if lexeme.word in {"i_mean", "i_meant"} and ends and last is not None:
        return []  # "everywhere, I mean"
    if lexeme.has("PRESET") and lexeme.has(*VERBS) and begins and after is not None and after.has("DET"):
        return [replace(lexeme, classes=lexeme.classes - {"PRESET"}, preset="")]  # "track the tractor" with a preset "track"
    is_order = match_start("PRESET (PRESETNOUN|VIEWNOUN)?", before[-2:]) is not None and lexeme.has("ORDINAL", "FIRSTLY")
    if is_order and (after is None or after.has(*_BREAKS)):
        return []  # "photograph the spillway view first and the tailrace view second"
    is_urged = lexeme.word == "with" and after is not None and after.word in _URGED
    if is_urged and last is not None and last.has("HOME", *DIRECTIONS):
        return [lexeme.reworded("with_you", "FILLER")]  # "over to the right with you"
    if last is not None and last.word == "with_you" and lexeme.word in _URGED:
        return []
    if lexeme.word == "mind" and last is None and after is not None and after.has(*(f"{verb}-ING" for verb in VERBS)):
        return []  # "mind turning 15 left?"
    if lexeme.word == "its" and after is not None and (after.has("AIM-ING", "LOT") or after.word in {"too", "so", "getting"}):
        return [lexeme.reworded("it", "PRON", "ANOTHER"), lexeme.reworded("is", "BE", "GLUE")]  # "its pointing at the sky"
    if lexeme.word == "once" and begins and after is not None and after.word == "at":
        return []  # "once at the gate, zoom in"
    if lexeme.word in {"reaching", "arriving"} and last is not None and last.word == "on_reaching":
        return [] if after is not None and after.word == "at" else [lexeme.reworded("at", "PREP", "GLUE")]
    if lexeme.word in {"on", "upon"} and last is None and after is not None and after.word in {"reaching", "arriving"}:
        return [lexeme.reworded("on_reaching", "FILLER")]  # "on reaching the gate, take a picture"
    if (base := _base_of_past(before, lexeme)) is not None:
        return [base]
    return None


def _base_of_past(before: Sequence[Lexeme], lexeme: Lexeme) -> Lexeme | None:
    """Return the command for "you followed" in "I would be obliged if you followed the postman and then went home"."""
    command = command_of(lexeme)
    if command is None or not before:
        return None
    asked = search("(obliged|grateful|glad|pleased|happy|help|great|nice|good|lovely|appreciate_it) (if SELF|IF SELF)", before)
    is_asked = asked is not None or any(x.has("WRAPPER") and x.word.endswith("if_you") for x in before)
    follows = before[-1].has("SELF", "AND", "THEN") or before[-1].word.endswith("if_you")
    return command if is_asked and follows else None
