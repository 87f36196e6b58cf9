"""Find the segments of an instruction that may take its command back, forbid it, postpone it, or be meant for somebody else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.remark_detection.features import statement_features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import withdrawal_model
from scope_ptz.planner.grammar.parsing.remark_detection.remark_forms import gives_reason_for_return
from scope_ptz.planner.grammar.parsing.remark_detection.segments import segments_of
from scope_ptz.planner.grammar.parsing.remark_detection.shorter_versions import MAX_SHORTENED_CHARS

_MIN_LOG_ODDS = 0.3
"""At this value, fewer than one in a hundred harmless instructions are asked about.

Source: ``python -m benchmarks.planner_models.withdrawal_model``.
"""

_COMMANDS = (
    "PAN", "TILT", "TURN", "AIM", "RAISE", "ZOOM", "ENLARGE", "WIDEN", "SHOW", "FIND", "COUNT", "READ", "DESCRIBE", "SNAP", "SCAN",
    "COMPARE",
)  # fmt: skip
"""Verbs that never begin a statement about a command, unlike "hold it", "leave it" and "check with me first"."""

_FRAGMENTS = frozenset({"what", "where", "which", "when", "if", "and", "as", "because", "but", "since", "so", "then", "while"})
"""Words that say nothing without the clause after them."""

_MAX_SEGMENTS = 3  # segments of one instruction that are yielded: for each of them the caller plans once more


@dataclass(frozen=True, slots=True)
class WithdrawingSegment:
    """A segment that probably takes a command back.

    Attributes:
        text: Its words.
        rest: The instruction without it.
        before: If other segments follow it, the beginnings of the instruction before it, each a segment shorter than the previous.
    """

    text: str
    rest: str
    before: tuple[str, ...]


def is_command(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a segment is no statement: it begins with the verb of a command ("then count the cars"), or is a mere "if".

    Args:
        text: The words of the segment.
        presets: The camera's presets.
    """
    if text.lower() in _FRAGMENTS:
        return True
    first = next((lexeme for lexeme in lexemes_of(text, presets) if not lexeme.has("FILLER", "AND", "THEN", "COMMA")), None)
    return first is not None and first.has(*_COMMANDS) and not first.has("TELL")


def withdrawing_segments(text: str, presets: tuple[str, ...]) -> Iterator[WithdrawingSegment]:
    """Yield each segment that probably takes a command back; the likeliest first.

    A segment that the plan depends on ("no, 30") is none: the caller compares the plans of both texts.

    Args:
        text: The instruction, written out. None is yielded of a text that is too long to be planned again.
        presets: The camera's presets.
    """
    segments = segments_of(text) if len(text) <= MAX_SHORTENED_CHARS else ()
    if len(segments) < 2:
        return
    log_odds = {
        index: withdrawal_model().log_odds(statement_features_of(segments, index, presets))
        for index, segment in enumerate(segments)
        if not is_command(segment.text, presets)
    }
    likeliest = sorted((index for index, value in log_odds.items() if value > _MIN_LOG_ODDS), key=lambda index: -log_odds[index])
    for index in likeliest[:_MAX_SEGMENTS]:
        segment, is_last = segments[index], index + 1 == len(segments)
        if gives_reason_for_return(text[: segment.start], segment.text):
            continue
        following = len(text) if is_last else segments[index + 1].start
        before = () if is_last else tuple(text[: earlier.end] for earlier in reversed(segments[:index]))
        yield WithdrawingSegment(segment.text, (text[: segment.start] + text[following:]).strip(" ,;:-–—"), before)
