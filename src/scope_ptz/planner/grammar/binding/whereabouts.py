"""Answer "where did it go?" from what the camera recorded while it followed the thing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from scope_ptz.geometry import wrap_pan_deg
from scope_ptz.planner.grammar.execution.answer_sentences import noun, object_pronoun
from scope_ptz.planner.grammar.execution.move_sentences import degrees
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import Source, text_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_MOVING = "(CARRY|CARRY-ED|move|moved|walk|walked|run|drive|driven|ride|head|fly|disappear|disappeared|vanish|vanished)"
_WHERE = f"(where|which way|WHQ SIDE) (DOV|HAVEV|BE) (?P<thing>_+?) {_MOVING} (to|off|away|then|now|FILLER|NOW|QUESTION)*"

_LEAST_TURN_DEG = 2.0
"""Smallest turn of the camera, in degrees, that counts as a movement of the followed thing: a wobble of the box causes less."""


def thing_that_went(question: str) -> str:
    """Return the thing in "where did the red car go?"; empty for other questions."""
    match = full_match(_WHERE, lexemes_of(question))
    return text_of(Source(question), match["thing"]) if match is not None else ""


def report_of_last_following(thing: str, conversation: Sequence[PastTurn]) -> str:
    """Return where the thing went that the last look of a conversation followed; empty if it followed nothing of that name.

    Args:
        thing: A description or a pronoun.
        conversation: The earlier turns.
    """
    looks = (
        outcome
        for turn in reversed(conversation)
        for exchange in reversed(turn.exchanges)
        for outcome in reversed(exchange.outcomes)
        if "description" in outcome.call.arguments or "question" in outcome.call.arguments
    )
    last = next(looks, None)
    if last is None or last.call.name != "track_object" or not last.result:
        return ""
    followed = str(last.call.arguments["description"])
    is_pronoun = all(x.has("PRON") for x in _words(thing))
    is_followed = is_pronoun or f" {noun(followed, 1)}".lower().endswith(f" {_without_article(thing)}".lower())
    return _report(noun(followed, 1), last.result) if is_followed else ""


def _words(thing: str) -> list[Lexeme]:
    return [x for x in lexemes_of(thing) if not x.has("FILLER")]


def _without_article(thing: str) -> str:
    words = thing.split()
    return " ".join(words[1:] if _words(thing)[0].has("DET") and len(words) > 1 else words)


def _report(followed: str, result: Mapping[str, Any]) -> str:
    """Return where a thing went, according to the result of following it."""
    pronoun = object_pronoun(followed)
    if not result.get("found"):
        return f"I did not find the {followed}, so I do not know where {'they' if pronoun == 'them' else 'it'} went"
    seen = [point for point in result.get("path", ()) if point["seen"]]
    if len(seen) < 2:
        return f"I lost the {followed} at once, so I do not know where {'they' if pronoun == 'them' else 'it'} went"
    is_seen_last = bool(result["path"][-1]["seen"])
    ending = f"had {pronoun} in view to the end" if is_seen_last else f"lost {pronoun} after {_seconds(seen[-1]['time_s'])}"
    turn_deg = wrap_pan_deg(seen[-1]["pose"]["pan_deg"] - seen[0]["pose"]["pan_deg"])
    if abs(turn_deg) < _LEAST_TURN_DEG:
        return f"The {followed} stayed in about the same direction, and I {ending}"
    side = "right" if turn_deg > 0 else "left"
    return f"The {followed} went to the {side}: I turned {degrees(round(turn_deg))} to follow {pronoun}, and {ending}"


def _seconds(seconds: float) -> str:
    """Return a duration in whole seconds in words."""
    return f"{max(1, round(seconds))} second{'' if round(seconds) <= 1 else 's'}"
