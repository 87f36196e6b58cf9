"""Find the segments of an instruction that may take its command back, forbid it, postpone it, or be meant for somebody else."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.planner.grammar.parsing.remark_detection.features import statement_features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import withdrawal_model
from scope_ptz.planner.grammar.parsing.remark_detection.remark_forms import gives_reason_for_return
from scope_ptz.planner.grammar.parsing.remark_detection.segments import segments_of
from scope_ptz.planner.grammar.parsing.remark_detection.shorter_versions import MAX_SHORTENED_CHARS

_MIN_LOG_ODDS = 0.3
"""At this value, one in a hundred harmless instructions is asked about (``python -m benchmarks.withdrawal_model``)."""

_MAX_SEGMENTS = 3  # segments of one instruction that are yielded: for each of them the caller plans once more


def withdrawing_segments(text: str, presets: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Yield each segment that probably takes a command back, and the text without it; the likeliest first.

    A segment that the plan depends on ("no, 30") is none: the caller compares the plans of both texts.

    Args:
        text: The instruction, written out. None is yielded of a text that is too long to be planned again.
        presets: The camera's presets.
    """
    segments = segments_of(text) if len(text) <= MAX_SHORTENED_CHARS else ()
    if len(segments) < 2:
        return
    log_odds = [withdrawal_model().log_odds(statement_features_of(segments, index, presets)) for index in range(len(segments))]
    likeliest = sorted((index for index, value in enumerate(log_odds) if value > _MIN_LOG_ODDS), key=lambda index: -log_odds[index])
    for index in likeliest[:_MAX_SEGMENTS]:
        segment = segments[index]
        if gives_reason_for_return(text[: segment.start], segment.text):
            continue
        following = segments[index + 1].start if index + 1 < len(segments) else len(text)
        yield segment.text, (text[: segment.start] + text[following:]).strip(" ,;:-–—")
